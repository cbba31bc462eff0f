"""Many logs in one process: what they say together is what all rows say in one piece, and what changed is proved."""

import json
import shutil

import numpy as np
import polars as pl
import pytest

import ivsid
from command_line import run
from fleet_logs import in_one_piece, seasons
from ivsid import IvsidError
from ivsid.fleets import tables
from ivsid.vehicle import read_vehicle

TABLES = ("changes", "contradictions", "findings", "logs", "parameters", "pooled")


@pytest.fixture(scope="module")
def calm(once):
    return seasons(once) / "calm"


@pytest.fixture(scope="module")
def changed(once):
    return seasons(once) / "changed"


@pytest.fixture(scope="module")
def drifted(changed, tmp_path_factory):
    return ivsid.fleet(changed, "swan", tmp_path_factory.mktemp("drifted"), workers=0, diagnose=False)


def test_the_pooled_bounds_are_those_of_all_rows_in_one_piece(calm, tmp_path):
    found = ivsid.fleet(calm, "swan", tmp_path, workers=0, diagnose=False)
    assert found.pooled.solved.status == "enclosed" and found.pooled.complete and found.guaranteed
    vehicle = read_vehicle("swan")
    for columns in ([0, 1], [2]):
        whole = in_one_piece(sorted(calm.iterdir()), vehicle, columns)
        for j, a, b in zip(columns, whole.value.lower, whole.value.upper, strict=True):
            assert found.parameters[found.terms[j].id] == (a, b)
    # Together the logs say more than each by itself, and nothing that one of them denies.
    single = tables(found)["parameters"]
    for id_, (a, b) in found.parameters.items():
        mine = single.filter(pl.col("parameter") == id_)
        assert mine["lower"].max() <= a < b <= mine["upper"].min()
    narrower = [b - a < (single.filter(pl.col("parameter") == i)["upper"] - single.filter(pl.col("parameter") == i)["lower"]).min() for i, (a, b) in found.parameters.items()]  # fmt: skip
    assert all(narrower)


def test_only_violated_rows_travel(calm, tmp_path):
    traffic = ivsid.fleet(calm, "swan", tmp_path, workers=0, diagnose=False).traffic
    assert traffic.rows > 10_000
    assert 0 < traffic.passes < 15 and traffic.received < 0.02 * traffic.rows * 100


def test_rows_over_windows_pool_as_well(calm, tmp_path):
    found = ivsid.fleet(calm, "swan", tmp_path, workers=0, diagnose=False, rows="integral", window=2.0)
    vehicle = read_vehicle("swan")
    for columns in ([0, 1], [2]):
        whole = in_one_piece(sorted(calm.iterdir()), vehicle, columns, kind="integral", window=2.0)
        for j, a, b in zip(columns, whole.value.lower, whole.value.upper, strict=True):
            low, high = found.parameters[found.terms[j].id]
            assert low <= a and b <= high and high - low <= (b - a) * (1 + 1e-11)


def test_the_change_is_dated_named_and_proved(drifted, changed):
    assert drifted.pooled.solved.status == "empty" and not drifted.parameters
    assert drifted.drift.periods == ((0, 1, 2), (3, 4, 5))
    (change,) = drifted.drift.changes
    assert change.irreducible and len(change.logs) == 2 and change.logs[0] < 3 <= change.logs[1]
    ids = [t.id for t in drifted.terms]
    drag = ids.index("drag.surge.quadratic")
    assert change.changed == (drag,) == change.alone and set(change.excluded) == {0, 2}
    assert set(drifted.drift.pairs) == {(a, b) for a in range(3) for b in range(3, 6)}
    # The contradiction in one piece: the least set has none of its own, and no smaller one either.
    vehicle, paths = read_vehicle("swan"), sorted(changed.iterdir())
    assert in_one_piece([paths[k] for k in change.logs], vehicle, [0, 1]).status == "empty"
    for k in change.logs:
        assert in_one_piece([paths[k]], vehicle, [0, 1]).status == "enclosed"


def test_a_second_run_does_nothing_again_and_gives_the_same_tables(changed, drifted, tmp_path):
    first = ivsid.fleet(changed, "swan", tmp_path, workers=0, diagnose=False)
    again = ivsid.fleet(changed, "swan", tmp_path, workers=0, diagnose=False)
    assert not any(e.outcome.reused for e in first.entries) and all(e.outcome.reused for e in again.entries)
    for name in TABLES:
        assert tables(first)[name].equals(tables(again)[name]) and tables(first)[name].equals(tables(drifted)[name])
    # Another option is other work.
    other = ivsid.fleet(changed, "swan", tmp_path, workers=0, diagnose=False, form="added")
    assert not any(e.outcome.reused for e in other.entries)


def test_results_of_other_code_are_not_taken_for_those_of_this(calm, tmp_path, monkeypatch):
    """Between two states of the code the version is the same, and a bound that was mended is not."""
    first = ivsid.fleet(calm, "swan", tmp_path, workers=0, diagnose=False)
    monkeypatch.setattr("ivsid.fleets.finished._code", lambda: "another state")
    again = ivsid.fleet(calm, "swan", tmp_path, workers=0, diagnose=False)
    assert not any(e.outcome.reused for e in (*first.entries, *again.entries))


def test_damaged_finished_logs_are_done_again(calm, tmp_path):
    ivsid.fleet(calm, "swan", tmp_path, workers=0, diagnose=False)
    done = sorted((tmp_path / "done").rglob("*.json"))
    done[0].write_text(done[0].read_text()[:-100])
    done[1].write_text(done[1].read_text().replace("enclosed", "empty"))
    done[2].unlink()
    again = ivsid.fleet(calm, "swan", tmp_path, workers=0, diagnose=False)
    assert sum(e.outcome.reused for e in again.entries) == 0 and again.pooled.solved.status == "enclosed"


def test_failed_logs_and_logs_that_contradict_the_model_are_told_and_left_out(calm, tmp_path):
    logs = tmp_path / "logs"
    shutil.copytree(calm, logs)
    (logs / "broken.csv").write_text("t,u\n0,1\n")
    table = pl.read_csv(logs / "day000.csv")
    (logs / "wrong.csv").write_text(table.with_columns(pl.col("ax") * 0.5 + 0.2).write_csv())
    found = ivsid.fleet(logs, "swan", tmp_path / "out", workers=0, diagnose=False)
    assert list(found.failed) == ["broken.csv"] and "\n" not in found.failed["broken.csv"]
    assert found.contradicted == ("wrong.csv",)
    assert found.pooled.solved.status == "enclosed" and len(found.order) == 3
    status = dict(tables(found)["logs"].select("log", "status").iter_rows())
    assert status["broken.csv"] == "failed" and status["wrong.csv"] == "empty"


def test_too_many_logs_for_the_stated_confidence_guarantee_nothing(calm, tmp_path):
    text = read_vehicle("swan").text.replace("confidence = 0.999", "confidence = 0.6")
    (tmp_path / "boat.toml").write_text(text)
    assert "confidence = 0.6" in text
    found = ivsid.fleet(calm, tmp_path / "boat.toml", tmp_path / "out", workers=0, diagnose=False)
    assert found.joint == 0.0 and not found.guaranteed
    made = run(
        "fleet", calm, "--vehicle", tmp_path / "boat.toml", "--out", tmp_path / "out", "--workers", 0, "--no-diagnose"
    )
    assert "not guaranteed" in made.stdout


def test_the_command_writes_tables_a_record_and_a_page(changed, tmp_path):
    out = tmp_path / "out"
    made = run("fleet", changed / "*.csv", "--vehicle", "swan", "--out", out, "--workers", 0, "--no-diagnose")
    assert made.returncode == 0, made.stderr
    assert "must have changed: drag.surge.quadratic" in made.stdout
    record = json.loads((out / "result.json").read_text())
    assert record["command"] == "fleet" and record["pooled"]["status"] == "empty" and record["guaranteed"]
    assert any("one vehicle" in a for a in record["assumes"])
    assert any("all 6 logs at once" in a for a in record["assumes"]) and record["joint_confidence"] == pytest.approx(
        0.994
    )
    for name in (*TABLES, "times"):
        assert pl.read_parquet(out / f"{name}.parquet").width > 3
    page = (out / "report.html").read_text()
    assert "drag.surge.quadratic" in page and "2023-11-17" in page
    kept = {n: (out / f"{n}.parquet").read_bytes() for n in TABLES}
    again = run("fleet", changed, "--vehicle", "swan", "--out", out, "--workers", 0, "--no-diagnose")
    assert "6 of 6 logs were identified before" in again.stdout
    assert kept == {n: (out / f"{n}.parquet").read_bytes() for n in TABLES}


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["nowhere/*.csv", "--vehicle", "swan"], "names no log"),
        (["LOGS", "--vehicle", "nobody.toml"], "nobody.toml"),
        (["LOGS"], "vehicle"),
        (["LOGS", "--vehicle", "swan", "--scheduler", "tcp://127.0.0.1:1"], "no cluster answers"),
    ],
)
def test_wrong_use_is_a_sentence(words, sentence, calm, tmp_path, monkeypatch):
    from ivsid.fleets import crew

    pytest.importorskip("distributed") if "--scheduler" in words else None
    monkeypatch.setattr(crew, "PATIENCE", 1)
    made = run("fleet", *(calm if w == "LOGS" else w for w in words), "--out", tmp_path / "out")
    assert made.returncode == 2 and sentence in made.stderr and made.stderr.count("\n") == 1


def test_a_missing_package_is_a_sentence(calm, tmp_path, monkeypatch):
    from ivsid.fleets import extra

    def gone(name):
        raise ImportError(name)

    monkeypatch.setattr(extra, "import_module", gone)
    with pytest.raises(IvsidError, match=r"pip install 'ivsid\[fleet\]'"):
        ivsid.fleet(calm, "swan", tmp_path, diagnose=False)
    with pytest.raises(IvsidError, match=r"pip install 'ivsid\[fleet\]'"):
        ivsid.fleet("memory://season", "swan", tmp_path, workers=0)


def test_logs_that_only_together_bound_a_parameter(tmp_path):
    """Each log of itself leaves the set open; the search has to close it by rows of both."""
    from ivsid.fleets.consistency import Model, pooled
    from ivsid.fleets.log_rows import LogRows, empty
    from ivsid.fleets.scan import scan, together

    def log(number, row, right):
        one = np.full(1, number, dtype=np.int64)
        bounds = np.array([row], dtype=float)
        zero = np.zeros(1, dtype=np.int64)
        return LogRows(
            one, bounds, bounds, np.array([right - 1.0]), np.array([right + 1.0]), zero, zero, np.zeros(1), np.zeros(1)
        )

    parts = [log(0, [1.0, 1.0], 10.0), log(1, [1.0, -1.0], 2.0)]
    terms = read_terms()[:2]
    model = Model(terms, ((0, 1),))
    alone = pooled(empty(2), model, lambda qs: [together([a], 2) for a in scan(parts[:1], qs)])
    assert alone.solved.status == "unbounded" and alone.complete
    both = pooled(empty(2), model, lambda qs: [together([a], 2) for a in scan(parts, qs)])
    # x + y in [9, 11] and x - y in [1, 3] give x in [5, 7] and y in [3, 5].
    assert both.solved.lower == pytest.approx([5.0, 3.0]) and both.solved.upper == pytest.approx([7.0, 5.0])


def read_terms():
    from ivsid.effects import terms_of

    return tuple(terms_of(read_vehicle("swan")))


def random_logs(rng, n):
    """Rows of a few logs about a common truth, some of them coarse, some with coefficients of either sign."""
    from ivsid.fleets.log_rows import LogRows

    truth = rng.uniform(-2, 2, n) * rng.choice([1.0, 0.05, 20.0], n)
    parts = []
    for log in range(int(rng.integers(2, 6))):
        m = int(rng.integers(1, 40))
        middle, radius = rng.uniform(-1, 1, (m, n)), rng.uniform(0, 0.03, (m, 1)) * rng.integers(0, 2, n)
        right = middle @ truth
        slack = rng.uniform(0.2, 2.0, m) * (0.05 + (radius * np.abs(truth)).sum(axis=1))
        zero = np.zeros(m, dtype=np.int64)
        time = np.arange(m, dtype=float)
        low, high = right - slack, right + slack * rng.uniform(0.1, 1.0, m)
        lower, upper = middle - radius, middle + radius
        parts.append(LogRows(np.full(m, log), lower, upper, low, high, zero, zero, time, np.zeros(m)))
    return parts


@pytest.mark.parametrize("cases", [25, pytest.param(1500, marks=pytest.mark.nightly)])
def test_constraint_generation_never_loses_a_bound_of_random_rows(cases):
    """Against all rows in one piece: the same status, an interval that holds the other, and the same one where the search says so."""
    from ivsid.fleets.consistency import Model, pooled
    from ivsid.fleets.log_rows import empty, joined
    from ivsid.fleets.scan import scan, together
    from ivsid.fleets.working_set import solve

    complete = tight = 0
    for seed in range(cases):
        rng = np.random.default_rng([seed, cases])
        n = int(rng.integers(1, 4))
        parts = random_logs(rng, n)
        model = Model(read_terms()[:n], (tuple(range(n)),))
        whole = solve(joined(parts), model.terms, model.blocks)
        found = pooled(empty(n), model, lambda qs, parts=parts, n=n: [together([a], n) for a in scan(parts, qs)])
        assert found.rows.count <= sum(p.count for p in parts)
        if whole.status == "not_applicable" or found.solved.status == "not_applicable":
            continue
        assert (found.solved.lower <= whole.lower).all() and (whole.upper <= found.solved.upper).all(), seed
        if found.complete:
            complete += 1
            assert found.solved.status == whole.status, seed
            gap = np.nan_to_num(np.abs(found.solved.upper - whole.upper) + np.abs(found.solved.lower - whole.lower))
            width = np.where(np.isfinite(whole.upper - whole.lower), whole.upper - whole.lower, np.inf)
            tight += bool((gap <= 1e-9 * width).all() or whole.status == "empty")
    assert complete >= 0.9 * cases and tight >= 0.98 * complete, (complete, tight)


@pytest.mark.nightly
def test_each_log_is_diagnosed_and_tried_on_the_next(tmp_path):
    """The findings are those of ``ivsid diagnose`` on the same two logs, and are counted."""
    assert run("example", tmp_path / "logs").returncode == 0
    logs = [tmp_path / "logs" / f"run{k}.csv" for k in (1, 2)]
    boat = tmp_path / "logs" / "boat.toml"
    found = ivsid.fleet(logs, boat, tmp_path / "out", workers=0)
    for entry, (train, test) in zip(found.entries, (logs, logs[::-1]), strict=True):
        alone = ivsid.diagnose(boat, train, test)
        record = entry.diagnosis.record
        assert record["verdict"] == alone.verdict and record["other"] == test.name
        assert [f["effect"] for f in record["findings"]] == [f.effect for f in alone.findings]
        for f, g in zip(record["findings"], alone.findings, strict=True):
            ends = {k: (float.fromhex(b["lower"]), float.fromhex(b["upper"])) for k, b in f["parameters"].items()}
            assert ends == {k: (b.lower, b.upper) for k, b in g.parameters.items()}
    (cause,) = {json.loads((tmp_path / "logs" / "truth" / "truth.json").read_text())["effect"]}
    assert cause in found.findings() and sum(found.verdicts().values()) == 2
    table = tables(found)["findings"]
    assert set(table["effect"]) == set(found.findings()) and set(table["log"]) == {"run1.csv", "run2.csv"}
    made = run("fleet", *logs, "--vehicle", boat, "--out", tmp_path / "out", "--workers", 0)
    assert f"{cause} in " in made.stdout and "2 of 2 logs were identified before" in made.stdout
    assert ivsid.fleet(logs, boat, tmp_path / "out", workers=0).entries[0].diagnosis.reused
