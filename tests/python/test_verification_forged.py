"""Forged results: rows that no log supports, and readings that say something else, prove nothing."""

import json
from dataclasses import replace

import numpy as np
import pytest

from conftest import as_log
from edited_results import written
from ivsid import identify, verify
from ivsid.errors import IvsidError
from ivsid.log import Log
from ivsid.simulation import simulate
from ivsid.vehicle import parse_vehicle
from ivsid.verification.errors import UnprovedError
from ivsid.verification.outliers import Proof, left_open
from ivsid.verification.rows import Rows
from test_mounting import MOUNTS, changed
from test_verification_rows import windy
from test_weak_form import towed as from_pose


def test_a_window_in_which_a_wind_may_have_turned_either_way_is_no_row(swan, programme):
    vehicle, log = windy(swan, programme, duration=20.0)
    psi = log.columns["psi"].copy()
    psi[101:] += 3.138 - np.angle(np.exp(1j * (psi[101] - psi[100])))
    turned = replace(log, columns={**log.columns, "psi": np.angle(np.exp(1j * psi))})
    made = Rows(turned, vehicle, "total")
    with pytest.raises(UnprovedError, match="way round"):
        made.row("integral", "surge", float(log.t[98]), float(log.t[104] - log.t[98]))
    made.row("integral", "surge", float(log.t[110]), float(log.t[116] - log.t[110]))


def test_a_heading_whose_reading_lost_much_is_not_followed_through_half_a_turn():
    log, vehicle = from_pose(2, length=20.0)
    psi = log.columns["psi"].copy()
    psi[300:] += 2.6 - np.angle(np.exp(1j * (psi[300] - psi[299])))
    columns = {**log.columns, "psi": np.angle(np.exp(1j * psi))}
    sure = Rows(replace(log, columns=columns), vehicle, "total").readings.pose
    lossy = replace(log, columns=columns, rounding={**log.rounding, "psi": np.full(log.t.size, 0.4)})
    unsure = Rows(lossy, vehicle, "total").readings.pose
    assert sure.piece[0] == sure.piece[-1] and unsure.piece[299] != unsure.piece[300]


AVERAGED = ("[sensors.acceleration]\n", '[sensors.acceleration]\nsampling = "averaged"\n')
GRAVITY = (
    ("[sensors.acceleration]\n", "[sensors.acceleration]\ngravity = true\n"),
    ("[sensors.velocity]\n", "[sensors.attitude]\naccuracy = 0.002\n\n[sensors.velocity]\n"),
)


@pytest.mark.parametrize(
    ("edits", "columns", "gone"),
    [
        ((AVERAGED,), {"udot": 0.0}, ()),
        (MOUNTS, {"udot": 0.0}, ()),
        (MOUNTS, {}, ("ay",)),
        (GRAVITY, {"roll": 0.0, "pitch": 0.0, "vdot": 0.0}, ()),
        (GRAVITY, {"roll": 0.0, "pitch": 0.0}, ("ax",)),
        ((AVERAGED, *MOUNTS), {}, ()),
    ],
)
def test_readings_that_identify_refuses_prove_nothing(swan, twin, tmp_path, edits, columns, gone):
    """Of the same log under a vehicle file that says more of its sensors."""
    vehicle = changed(swan, *edits)
    made = {**twin.columns, **{k: np.full(twin.t.size, v) for k, v in columns.items()}}
    log = Log("o.csv", "0" * 64, twin.t, {k: v for k, v in made.items() if k not in gone})
    with pytest.raises(IvsidError):
        identify(vehicle, log)
    with pytest.raises(UnprovedError):
        Rows(log, vehicle, "total")
    plain = Log("o.csv", "0" * 64, twin.t, twin.columns)
    identify(swan, plain).save(tmp_path / "fit.json")
    record = json.loads((tmp_path / "fit.json").read_text())
    record["vehicle"], record["inputs"][0]["sha256"] = vehicle.text, vehicle.sha256
    assert verify(written(tmp_path / "r.json", record), log).status == "failed"


@pytest.mark.parametrize("claims", ["advance_loss = 0.1\n", ""])
def test_behind_a_lag_a_force_that_depends_on_the_motion_has_no_row_from_the_pose(claims):
    log, vehicle = from_pose(1, length=20.0)
    body = vehicle.text.replace(
        "[sensors.position]",
        '[[thrusters]]\nname = "m"\ngain = 0.1\ndemand_range = [-9.0, 9.0]\n'
        f"time_constant = 0.3\n{claims}[sensors.position]",
        1,
    )
    pushed = parse_vehicle(body, "p.toml")
    demand = {"demand_m": np.sin(log.t)}
    rows = Rows(replace(log, columns={**log.columns, **demand}), pushed, "total")
    asked = ("weak", "surge", float(log.t[100]), float(log.t[120] - log.t[100]))
    if claims:
        with pytest.raises(UnprovedError, match="behind a lag"):
            rows.row(*asked)
    else:
        assert rows.row(*asked).right.magnitude < 10


def test_a_number_of_wrong_rows_that_nobody_could_follow_is_refused(swan, programme, tmp_path):
    log = as_log(simulate(swan, programme.model_copy(update={"noise": "uniform", "duration": 30.0}), 3))
    identify(swan, log, outliers=1).save(tmp_path / "fit.json")
    record = json.loads((tmp_path / "fit.json").read_text())
    for wrong in (10**6, 10**30):
        record["options"]["outliers"] = wrong
        assert verify(written(tmp_path / "r.json", record), log).status == "failed"
    # Proofs that share no row make a tree as deep as there are wrong rows, and as wide as they are long.
    proofs = [
        Proof(None, None, frozenset(("pointwise", "surge", float(7 * k + j), 0.0) for j in range(7))) for k in range(9)
    ]
    with pytest.raises(UnprovedError, match="more than"):
        left_open(proofs, 8)


def test_stored_multipliers_are_a_proposal_and_nothing_else(fits, tmp_path):
    files, log, _ = fits
    record = json.loads(files["empty"].read_text())
    for value in (None, "one", -1.0, 0.0, 1e308, 10**400, 1.0):
        for certificate in record["certificates"]:
            for row in certificate.get("rows", ()):
                row["multiplier"] = value
        record["certificate"] = [c for c in record["certificates"] if c["proves"] == "empty"]
        verdict = verify(written(tmp_path / "r.json", record), log)
        assert verdict.proved, (value, verdict.failures[:2])


def test_the_verdict_says_how_many_rows_may_be_wrong(swan, programme, tmp_path):
    from ivsid.workflow.verification import verdict_lines

    log = as_log(simulate(swan, programme.model_copy(update={"noise": "uniform", "duration": 30.0}), 3))
    identify(swan, log, outliers=2).save(tmp_path / "fit.json")
    verdict = verify(tmp_path / "fit.json", log)
    assert verdict.proved and verdict.wrong == verdict.record()["outliers"] == 2
    assert "if at most 2 rows of each set of parameters that share rows are wrong" in verdict_lines(verdict)[0]
