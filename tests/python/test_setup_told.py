"""A finding on the set-up is told first, refused or accepted, by commands and functions alike. The faults are those of ``setup_faults``."""

import json

import numpy as np
import pytest

import ivsid
import setup_faults
from ivsid import IvsidError, setup_findings, workflow
from ivsid.diagnosis import search
from ivsid.identification import read_identification
from ivsid.report import page
from ivsid.setup import refuse
from ivsid.setup.findings import IDS
from ivsid.vehicle import parse_vehicle
from setup_faults import MOTION, drawn, named


def files(folder, text, t, columns):
    (folder / "v.toml").write_text(text)
    (folder / "log.csv").write_text(_csv(t, columns))
    return folder / "v.toml", folder / "log.csv"


def _csv(t, columns):
    names = ["t", *columns]
    rows = np.stack([t, *columns.values()], axis=1)
    return "\n".join([",".join(names), *(",".join(repr(float(x)) for x in row) for row in rows)]) + "\n"


def test_degrees_for_radians_are_refused_with_the_key_and_the_way_round(tmp_path):
    text, t, columns = drawn(7004)
    vehicle, log = files(tmp_path, text, t, setup_faults.times(r=setup_faults.DEGREES)(columns))
    for command in (
        lambda: workflow.identify(vehicle, log),
        lambda: workflow.diagnose(vehicle, log, log, cache=False),
        lambda: ivsid.identify(vehicle, log),
        lambda: ivsid.diagnose(vehicle, log, log),
    ):
        with pytest.raises(IvsidError) as refusal:
            command()
        words = str(refusal.value)
        assert "yaw rate r is in deg/s and taken for rad/s" in words
        assert 'r = { from = "r", unit = "deg/s" } under [log.columns]' in words
        assert '[setup] accept = ["setup.yaw_rate.unit"]' in words


def test_an_accepted_fault_is_told_first(tmp_path):
    text, t, columns = drawn(7004)
    accepted = text + '\n[setup]\naccept = ["setup.yaw_rate.sign"]\n'
    vehicle, log = files(tmp_path, accepted, t, setup_faults.times(r=-1)(columns))
    heard = []
    report = workflow.identify(vehicle, log, progress=heard.append)
    assert [f["id"] for f in report.record["setup"]] == ["setup.yaw_rate.sign"]
    assert report.lines[0].startswith("set-up: log.csv: yaw rate r has the wrong sign")
    assert report.sections[0].title == "Set-up" and report.summary.startswith("The set-up is doubtful")
    assert heard.index(next(h for h in heard if h.startswith("set-up"))) < next(
        k for k, h in enumerate(heard) if h.startswith("identifying")
    )
    page.write(report, tmp_path / "fit")
    # The record keeps its seal, and validate reads it.
    assert ivsid.verify(tmp_path / "fit", log).failures == ()
    assert json.loads((tmp_path / "fit" / "result.json").read_text())["setup"][0]["certain"] is True


def test_results_of_functions_carry_the_finding_and_print_nothing(tmp_path, capsys):
    """Commands and functions say the same, since both ask one place."""
    text, t, columns = drawn(7004)
    wrong = {"t": t, **setup_faults.times(demand_port=-1)(columns)}
    vehicle = parse_vehicle(text, "v.toml")
    fit = ivsid.identify(vehicle, wrong)
    (found,) = fit.setup
    assert found.id == "setup.thruster.reversed" and "doubtful: setup.thruster.reversed" in repr(fit)
    fit.save(tmp_path / "fit")
    assert read_identification(tmp_path / "fit").setup == fit.setup
    told = workflow.identify(*files(tmp_path, text, t, {k: x for k, x in wrong.items() if k != "t"})).record["setup"]
    assert [f["evidence"] for f in told] == [dict(found.evidence)]
    sound = ivsid.identify(vehicle, {"t": t, **columns})
    assert sound.setup == () and "doubtful" not in repr(sound)
    if sound.estimate:
        assert [f.id for f in ivsid.validate(sound, wrong).setup] == ["setup.thruster.reversed"]
        with pytest.raises(IvsidError, match="yaw rate r has the wrong sign"):
            ivsid.validate(sound, {"t": t, **setup_faults.times(r=-1)(columns)})
    assert capsys.readouterr() == ("", "")


def test_a_diagnosis_carries_the_finding():
    text, t, columns = drawn(7004)
    tight = text.replace("yaw_acceleration = 3.0", "yaw_acceleration = 0.001") + '[setup]\naccept = ["setup.r.limit"]\n'
    heard = []
    table = {"t": t, **columns}
    result = ivsid.diagnose(parse_vehicle(tight, "v.toml"), table, table, null_logs=0, progress=heard.append)
    # Once for each log.
    assert [f.id for f in result.setup] == ["setup.r.limit"] * 2
    assert result.record()["setup"] == [f.record() for f in result.setup]
    assert "doubtful: setup.r.limit" in repr(result)
    before = heard[: heard.index("looking for causes")]
    assert sum(h.startswith("set-up: ") for h in before) == 2


def test_a_fault_beyond_doubt_is_said_before_any_fit(monkeypatch):
    """A fit of a log in degrees takes the longest of all, and its sentence says nothing of the cause."""
    text, t, columns = drawn(7004)
    degrees = {"t": t, **columns, "r": np.degrees(columns["r"])}
    monkeypatch.setattr(search, "plain_fit", lambda *_: pytest.fail("a fit was begun"))
    with pytest.raises(IvsidError, match=r"deg"):
        ivsid.diagnose(parse_vehicle(text, "v.toml"), degrees, degrees, null_logs=0)


def test_a_reversed_thruster_is_reported_and_refuses_nothing(tmp_path):
    text, t, columns = drawn(7004)
    vehicle, log = files(tmp_path, text, t, setup_faults.times(demand_port=-1)(columns))
    report = workflow.identify(vehicle, log)
    (found,) = report.record["setup"]
    assert found["id"] == "setup.thruster.reversed" and not found["certain"]
    assert "thruster port pushes the wrong way" in found["sentence"]
    assert found["remedy"].startswith("mirror the curve of thruster port under [[thrusters]], or state azimuth = ")


def test_a_sound_log_has_an_empty_list(tmp_path):
    text, t, columns = drawn(7004)
    vehicle, log = files(tmp_path, text, t, columns)
    report = workflow.identify(vehicle, log)
    assert report.record["setup"] == [] and report.sections[0].title != "Set-up"
    page.write(report, tmp_path / "fit")
    if report.record["estimate"]:
        assert workflow.validate(tmp_path / "fit", log).record["setup"] == []
        (tmp_path / "wrong.csv").write_text(_csv(t, setup_faults.times(r=-1)(columns)))
        with pytest.raises(IvsidError, match="yaw rate r has the wrong sign"):
            workflow.validate(tmp_path / "fit", tmp_path / "wrong.csv")


def test_an_unknown_id_is_refused():
    text, t, columns = drawn(7004)
    with pytest.raises(
        IvsidError, match=r"\[setup\] accept names setup.yaw, which is no finding; use setup.demand.unit"
    ):
        named(text + '\n[setup]\naccept = ["setup.yaw"]\n', t, columns)


def test_records_have_ids_that_can_be_accepted():
    text, t, columns = drawn(7004)
    for change, _ in list(MOTION.values())[::6]:
        for found in setup_findings(parse_vehicle(text, "v.toml"), {"t": t, **change(columns)}):
            assert found.id in IDS
            assert set(found.record()) == {"id", "sentence", "evidence", "remedy", "certain"}
            if found.certain:
                with pytest.raises(IvsidError):
                    refuse([found], parse_vehicle(text, "v.toml"))
                refuse([found], parse_vehicle(f'{text}\n[setup]\naccept = ["{found.id}"]\n', "v.toml"))
