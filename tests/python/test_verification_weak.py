"""Rows straight from the pose once more in fractions: they hold the truth, and no edit of a result of theirs passes."""

import copy
import json
from dataclasses import replace

import numpy as np
import pytest

from edited_results import written
from ivsid import identify, verify
from ivsid.log import Log
from ivsid.vehicle import parse_vehicle
from ivsid.verification.errors import UnprovedError
from ivsid.verification.rows import Rows
from ivsid.workflow.verification import verdict_lines
from sampling import spaced
from test_pose import boat, motion
from test_verification_rows import ends, outside
from test_weak_form import towed as from_pose
from test_weak_form import worst

# Rows of the core are compared with those of the checker: some of them in the gate, more in the nightly run.
pytestmark = [pytest.mark.sampled, pytest.mark.same_rows]


def test_rows_straight_from_the_pose_are_proved_and_rougher_poses_or_limits_are_not(tmp_path):
    log, vehicle = from_pose(1, length=60.0)
    assert outside(vehicle, log, kind="weak", window=2.0, picked=8) == []
    fit = identify(vehicle, log, rows="weak", window=2.0)
    fit.save(tmp_path / "fit.json")
    record = json.loads((tmp_path / "fit.json").read_text())
    assert {r["kind"] for c in record["certificates"] for r in c.get("rows", ())} == {"weak"}
    verdict = verify(tmp_path / "fit.json", log)
    assert fit.status == "enclosed" and verdict.proved, verdict.failures[:3]
    assert verdict_lines(verdict)[0].startswith("PROVED")
    limits = vehicle.sensors.limits
    declared = (
        ("[sensors.position]\naccuracy", vehicle.sensors.position.accuracy),
        ("[sensors.heading]\naccuracy", vehicle.sensors.heading.accuracy),
        ("\nacceleration", limits.acceleration),
        ("yaw_acceleration", limits.yaw_acceleration),
    )
    for key, value in spaced(declared, 1):
        old = f"{key} = {value}"
        assert vehicle.text.count(old) == 1, old
        other = parse_vehicle(vehicle.text.replace(old, f"{key} = {1.3 * value!r}"), "o.toml")
        edited = {**record, "vehicle": other.text}
        edited["inputs"] = [{**record["inputs"][0], "sha256": other.sha256}, record["inputs"][1]]
        verdict = verify(written(tmp_path / "r.json", edited), log)
        assert verdict.status == "failed" and any("recomputed as" in f for f in verdict.failures), key
    # Called a row over a window, it is recomputed, and does not follow; nor does one that stands elsewhere, or has no middle.
    step = float(np.median(np.diff(log.t)))
    changes = (
        lambda row: row.update(kind="integral"),
        lambda row: row.update(time=float(log.t[int(np.searchsorted(log.t, row["time"])) + 1])),
        lambda row: row.update(duration=row["duration"] - step),
        lambda row: row.update(duration=-row["duration"]),
    )
    for change in spaced(changes, 1):
        edited = copy.deepcopy(record)
        for certificate in edited["certificates"]:
            for row in certificate.get("rows", ()):
                change(row)
        assert verify(written(tmp_path / "r.json", edited), log).status == "failed"


# Nightly: a proof for every end; the gate moves rows and ends of other kinds in test_verification_edits.py.
@pytest.mark.slow
@pytest.mark.nightly
def test_no_end_of_rows_straight_from_the_pose_can_be_moved(tmp_path):
    log, vehicle = from_pose(1, length=60.0)
    fit = identify(vehicle, log, rows="both", window=2.0)
    fit.save(tmp_path / "fit.json")
    verdict = verify(tmp_path / "fit.json", log)
    assert fit.status == "enclosed" and verdict.proved, verdict.failures[:3]
    assert not ends(json.loads((tmp_path / "fit.json").read_text()), log, tmp_path)


@pytest.mark.parametrize("seed", range(6))
def test_ways_straight_from_the_pose_hold_the_truth_under_the_worst_errors(seed):
    """The checker's own integrals of u and v, and its rows at the true parameters and motion."""
    from scipy.integrate import cumulative_simpson

    t, pose, truth, (acceleration, yaw) = motion(seed)
    vehicle = boat(0.004, 0.006, acceleration * 1.001, yaw * 1.001)
    log = Log("a.csv", "0" * 64, t, worst(pose, t, seed))
    own, rng = Rows(log, vehicle, "total"), np.random.default_rng(seed)
    for name in ("u", "v"):
        way = cumulative_simpson(truth[name], x=t, initial=0)
        for _ in range(6):
            i = int(rng.integers(200, t.size - 300))
            j = i + int(rng.integers(2, 40))
            found, true = own.weak.way(name, i, j), way[j] - way[i]
            assert float(found.lower) - 1e-6 <= true <= float(found.upper) + 1e-6, (name, i, j, found, true)
            assert float(found.upper - found.lower) < 0.1


def test_a_pose_that_is_missing_or_behind_a_gap_gives_no_weak_row():
    log, vehicle = from_pose(2, length=40.0)
    t, kept = log.t, np.r_[np.arange(300), np.arange(310, log.t.size)]
    gap = replace(log, t=t[kept], columns={k: v[kept] for k, v in log.columns.items()})
    lost = replace(log, columns={**log.columns, "x": np.where(np.arange(t.size) == 305, np.nan, log.columns["x"])})
    stormy = parse_vehicle(vehicle.text + "\n[ambient]\nforce = 0.1\n", "s.toml")
    for other, own, words in ((gap, vehicle, "gap"), (lost, vehicle, "missing"), (log, stormy, "ambient")):
        rows = Rows(other, own, "total")
        duration = float(other.t[320] - other.t[290])
        with pytest.raises(UnprovedError, match=words):
            rows.row("weak", "surge", float(other.t[290]), duration)
    with pytest.raises(UnprovedError, match="no middle"):
        Rows(log, vehicle, "total").row("weak", "surge", float(t[290]), float(t[321] - t[290]))
    psi = log.columns["psi"].copy()
    psi[300:] += 3.14 - (psi[300] - psi[299])
    turned = replace(log, columns={**log.columns, "psi": np.angle(np.exp(1j * psi))})
    with pytest.raises(UnprovedError, match="way round|missing or unbounded"):
        Rows(turned, vehicle, "total").row("weak", "surge", float(t[290]), float(t[320] - t[290]))
