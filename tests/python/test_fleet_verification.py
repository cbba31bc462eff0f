"""``ivsid verify`` on a fleet: its statements are proved from the logs, and an edited one is not."""

import copy
import json
import shutil

import pytest

import ivsid
from command_line import run
from edited_results import outward
from fleet_logs import seasons
from ivsid import IvsidError
from ivsid.files.records import sealed, to_json
from ivsid.files.seal import KEY


@pytest.fixture(scope="module")
def made(once, tmp_path_factory):
    """Logs without and with a change, and the results of both."""
    place = tmp_path_factory.mktemp("verified")
    for name in ("calm", "changed"):
        (place / name).mkdir()
        logs = (place / name / "logs").resolve()
        logs.symlink_to(seasons(once) / name)
        done = run("fleet", logs, "--vehicle", "swan", "--out", place / name / "out", "--workers", 0, "--no-diagnose")
        assert done.returncode == 0, done.stderr
    return place


def edited(place, name, change, tmp_path):
    """The verdict on a result after an edit, with a seal made anew."""
    record = json.loads((place / name / "out" / "result.json").read_text())
    change(record)
    pooled = record["pooled"].get("parameters", {})
    record["pooled"] |= {"parameters": {k: outward(p) for k, p in pooled.items()}} if pooled else {}
    (tmp_path / "result.json").write_text(to_json(sealed({k: v for k, v in record.items() if k != KEY})))
    return ivsid.verify(tmp_path, place / name / "logs")


@pytest.mark.parametrize(("name", "claim"), [("calm", "enclosed"), ("changed", "empty")])
def test_every_statement_is_proved(made, name, claim, tmp_path):
    verdict = edited(made, name, lambda _: None, tmp_path)
    assert verdict.proved and verdict.claim == claim and verdict.certificates > 5, verdict.failures
    done = run("verify", made / name / "out", made / name / "logs", "--out", tmp_path / "verdict")
    assert done.returncode == 0 and done.stdout.startswith("PROVED"), done.stdout


def _first(record, proves):
    return next(c for c in record["pooled"]["certificates"] if c["proves"] == proves)


def narrower(record):
    p = record["pooled"]["parameters"]["mass.surge"]
    p["lower"] = p["lower"] + 0.01 * (p["upper"] - p["lower"])


def of_another_log(record):
    # Each log has a row of every time, with other readings.
    names = record["logs"]["together"]
    row = _first(record, "bound")["rows"][0]
    row["log"] = next(n for n in names if n != row["log"])


def bounds_left_out(record):
    kept = [c for c in record["pooled"]["certificates"] if c.get("end") != "upper"]
    record["pooled"]["certificates"] = kept


def moved_row(record):
    row = _first(record, "bound")["rows"][0]
    row["right"][0] = (float.fromhex(row["right"][0]) + 1.0).hex()


def fewer_together(record):
    row = _first(record, "bound")["rows"][0]
    record["logs"]["together"].remove(row["log"])


@pytest.mark.parametrize("change", [narrower, of_another_log, bounds_left_out, moved_row, fewer_together])
def test_an_edited_bound_is_not_proved(made, change, tmp_path):
    assert edited(made, "calm", change, tmp_path).status == "failed"


def another_period(record):
    periods = record["drift"]["periods"]
    record["drift"]["periods"] = [periods[0][:1], periods[0][1:] + periods[1]]


def one_more_period(record):
    record["drift"]["periods"].append([record["drift"]["periods"][1].pop()])


def another_culprit(record):
    change = record["drift"]["changes"][0]
    change["changed"] = {"mass.surge": change["changed"]["drag.surge.quadratic"]}
    change["proofs_changed"] = {"mass.surge": change["proofs_changed"]["drag.surge.quadratic"]}


def excluded_without_a_proof(record):
    change = record["drift"]["changes"][0]
    change["cannot_explain_alone"].append("drag.surge.quadratic")
    change["proofs_alone"]["drag.surge.quadratic"] = copy.deepcopy(change["proof"])


def a_certificate_less(record):
    proof = record["drift"]["changes"][0]["proof"]
    proof["certificates"] = proof["certificates"][:-1]


def shared_after_all(record):
    """The proof that the mass alone cannot explain it, with the mass in a shared column."""
    change = record["drift"]["changes"][0]
    change["proofs_alone"]["mass.surge"] = copy.deepcopy(change["proof"])


def sure_of_too_much(record):
    record["vehicle"] = record["vehicle"].replace("confidence = 0.999", "confidence = 0.8")


CHANGES = [another_period, one_more_period, another_culprit, excluded_without_a_proof, a_certificate_less, shared_after_all, sure_of_too_much]  # fmt: skip


@pytest.mark.parametrize("change", CHANGES)
def test_an_edited_change_is_not_proved(made, change, tmp_path):
    assert edited(made, "changed", change, tmp_path).status == "failed"


def test_an_edit_without_a_new_seal_is_seen(made, tmp_path):
    text = (made / "calm" / "out" / "result.json").read_text()
    (tmp_path / "result.json").write_text(text.replace('"complete": true', '"complete": false'))
    assert "seal" in ivsid.verify(tmp_path, made / "calm" / "logs").failures[0]


def test_a_changed_log_and_a_missing_one_are_sentences(made, tmp_path):
    shutil.copytree(made / "calm" / "logs", tmp_path / "logs")
    verdict = ivsid.verify(made / "calm" / "out", sorted((tmp_path / "logs").iterdir()))
    assert verdict.proved
    record = json.loads((made / "calm" / "out" / "result.json").read_text())
    victim = tmp_path / "logs" / _first(record, "bound")["rows"][0]["log"]
    victim.write_text(victim.read_text() + "\n")
    with pytest.raises(IvsidError, match="are not there"):
        ivsid.verify(made / "calm" / "out", tmp_path / "logs")
    damaged = edited(made, "calm", lambda r: r.update(pooled={}), tmp_path)
    assert damaged.status == "failed"
