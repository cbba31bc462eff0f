"""``ivsid import``: the public sets load with the facts that are known of them, and a wrong folder gets one sentence."""

import json

import numpy as np
import pytest

from command_line import run
from conftest import embedded
from ivsid import IvsidError, read_log, read_vehicle, workflow
from ivsid.adapters import ADAPTERS, read_cse1, read_rov30k
from ivsid.propulsion.thrust import ThrustCurve


@pytest.fixture(scope="module")
def sets(tmp_path_factory):
    """Each set imported once by the command, or a skip."""
    from conftest import SHARED

    done = {}

    def get(name, folder):
        if not (SHARED / folder).exists():
            pytest.skip(f"the shared data set {folder} is not on this machine")
        if name not in done:
            out = tmp_path_factory.mktemp("import") / name
            made = run("import", name, SHARED / folder, "--out", out)
            assert made.returncode == 0, made.stderr
            done[name] = out, json.loads((out / "result.json").read_text())
        return done[name]

    return get


def test_cse1_free_runs(sets):
    out, record = sets("cse1", "cse1")
    facts = record["facts"]["dropouts"]
    # Facts of the recordings: 20 Hz, the longest drop-outs 0.25 to 1.95 s, a pose of exactly 0 is missing
    assert {n: (f["samples"], f["missing"], f["dropouts"], f["left_out"]) for n, f in facts.items()} == {
        "random_run1": (14101, 136, 36, 43),
        "random_run3": (7304, 84, 14, 16),
        "run1": (4963, 174, 74, 122),
    }
    assert max(f["longest"] for f in facts.values()) == pytest.approx(1.95)
    for name, fact in facts.items():
        log = read_log(out / f"{name}.csv")
        assert log.period == pytest.approx(0.05)
        for channel in ("x", "y", "psi"):
            found = record["logs"][name]["quality"][channel]
            assert np.isnan(log.columns[channel]).sum() == found["missing"]
            assert found["missing"] == fact["missing"] + fact["left_out"] + found["held"]
            assert found["held"] <= 2 and not (log.columns[channel] == 0).any()


def test_cse1_raw_velocities_are_differences_of_the_pose(real):
    """Why they are no measurements: each is the step from the pose before, turned by the heading."""
    part = read_cse1(real("cse1")).logs["random_run3"]
    c, psi = part.columns, part.columns["psi"][1:]
    north, east = np.diff(c["x"]) / 0.05, np.diff(c["y"]) / 0.05
    raw = np.c_[c["raw_u"], c["raw_v"]][1:]
    made = np.c_[north * np.cos(psi) + east * np.sin(psi), east * np.cos(psi) - north * np.sin(psi)]
    there = np.isfinite(raw).all(axis=1)
    assert there.sum() > 7000
    assert np.median(np.abs(raw - made)[there]) < 2e-5 and np.abs(raw - made)[there].max() < 2e-3
    # Without the rows that touch a drop-out; with them it would be 35 m/s.
    assert np.abs(raw[there]).max() < 0.4
    assert not {"u", "v", "r"} & set(c)


def test_cse1_runs_identify_from_their_cameras(sets):
    """From poses and demands alone: the plain model is contradicted, damping in yaw is proved, surge is left open."""
    from ivsid import identify

    out, _ = sets("cse1", "cse1")
    vehicle = read_vehicle(out / "cse1.toml")
    log = read_log(out / "random_run1.csv", vehicle.log)
    fit = identify(vehicle, log, window=5.0)
    assert fit.status == "unbounded" and fit.guaranteed and fit.inflation < 1 and fit.directions
    assert 0 < fit.parameters["drag.yaw.linear"].lower < fit.parameters["drag.yaw.linear"].upper < 10
    assert fit.parameters["drag.surge.quadratic"].lower == -np.inf
    assert any("follow from the pose" in a for a in fit.assumes)
    plain = identify(vehicle.model_copy(update={"model": type(vehicle.model)()}), log, window=5.0)
    assert plain.status == "empty" and plain.guaranteed and plain.inflation > 1


# Nightly: a run of 700 s; the gate has weak rows in test_weak_form.py and the fit of this run by its velocities.
@pytest.mark.slow
@pytest.mark.nightly
def test_rows_from_the_pose_itself_say_more_of_cse1(sets):
    """Damping in yaw within a factor of three, where velocities gave sixteen; the towing tank's drag is not contradicted."""
    from ivsid import IntervalArray, identify, regression
    from ivsid.effects import terms_of
    from ivsid.rows import build_rows
    from ivsid.sensors.bounds import bound_log

    out, record = sets("cse1", "cse1")
    vehicle = read_vehicle(out / "cse1.toml")
    log = read_log(out / "random_run1.csv", vehicle.log)
    yaw = vehicle.model_copy(
        update={"model": vehicle.model.model_copy(update={"terms": ("inertia.yaw", "drag.yaw.linear")})}
    )
    fit = identify(yaw, log, rows="weak", window=3.0)
    assert fit.status == "enclosed" and fit.guaranteed and fit.inflation < 1
    p = fit.parameters["drag.yaw.linear"]
    assert p.lower > 0 and p.upper < 3 * p.lower
    terms = terms_of(vehicle)
    rows = build_rows(bound_log(log, vehicle), vehicle, terms, kind="weak", window=6.0)
    ids, surge = [t.id for t in terms], rows.channel == 0
    tank = record["facts"]["towing"]
    held = [ids.index("drag.surge.linear"), ids.index("drag.surge.quadratic")]
    inflation = []
    for factor in (0.0, 1.0, 4.0):
        drag = IntervalArray(np.array([-tank["linear"], -tank["quadratic"]]) * factor)
        right = rows.right[surge] - (rows.matrix[surge][:, held] * drag).sum(axis=1)
        found = regression.feasible_set(rows.matrix[surge][:, [ids.index("mass.surge"), ids.index("mass.sway")]], right)
        assert found.status != "empty"
        inflation.append(found.inflation)
    # Bisection with HiGHS in every orthant says 0.3227, 0.2510, 0.3487; factors that stopped short of a ray once looked larger.
    assert np.allclose(inflation, [0.3227, 0.2510, 0.3487], rtol=5e-3)
    assert inflation[1] < 0.8 * min(inflation[0], inflation[2])


def test_a_glimpse_of_something_else_is_found_by_the_limits(real):
    """In random_run1 the pose between two drop-outs at 264.75 s belongs to something else: no vessel within the limits moves so."""
    from scipy.io import loadmat

    from ivsid.log import Log
    from ivsid.sensors.bounds import bound_log
    from ivsid.vehicle import parse_vehicle

    vehicle = parse_vehicle(embedded("cse1.toml"), "cse1.toml")
    part = read_cse1(real("cse1")).logs["random_run1"]
    bound_log(Log("random_run1.csv", "", part.t, part.columns), vehicle)
    data = loadmat(real("cse1/freerun/CSE1_data_random_run1.mat"))["cse1_data"].astype(np.float64)
    lost = (data[1] == 0) & (data[2] == 0) & (data[6] == 0)
    whole = {n: np.where(lost, np.nan, data[k]) for n, k in (("x", 1), ("y", 2), ("psi", 6))}
    with pytest.raises(IvsidError, match="around t = 264"):
        bound_log(Log("random_run1.csv", "", data[0], {**part.columns, **whole}), vehicle)


def test_cse1_without_known_thrust_has_no_demands(sets):
    """The bollard pulls were taken at a propeller speed of 0.4; run1 turned at 0.3."""
    out, record = sets("cse1", "cse1")
    assert record["facts"]["dropouts"]["run1"]["propeller_speed"] == pytest.approx(0.3)
    assert not any(c.startswith("demand_") for c in read_log(out / "run1.csv").columns)
    assert any("no thrust is known" in n for n in record["logs"]["run1"]["notes"])
    made = run("identify", out / "cse1.toml", out / "run1.csv", "--out", out / "fit")
    assert made.returncode == 2 and "demand_vsp1_surge" in made.stderr and made.stderr.count("\n") == 1


def test_cse1_captive_tests(sets):
    out, record = sets("cse1", "cse1")
    drag = record["facts"]["towing"]
    # The towing tank's own fit: -0.137 u - 3.088 u|u|, rms 0.040 N; slope for slow speeds -0.550 kg/s
    assert drag["runs"] == 54
    assert drag["linear"] == pytest.approx(-0.137, abs=5e-4) and drag["quadratic"] == pytest.approx(-3.088, abs=5e-4)
    assert drag["rms"] == pytest.approx(0.040, abs=5e-4) and drag["slow_slope"] == pytest.approx(-0.550, abs=5e-3)
    # and 1.276, 1.050, 2.148 N at full demand
    slopes = record["facts"]["slopes"]
    assert slopes["vsp_surge"] == pytest.approx(1.276, abs=1e-3)
    assert slopes["vsp_sway"] == pytest.approx(1.050, abs=5e-3)
    assert slopes["bow_thruster"] == pytest.approx(2.148, abs=5e-3)
    surge = read_cse1_table(out / "vsp_surge.csv")
    # wrong sign at pitch -0.1 and -0.2, +1.40 and -1.31 N at the ends, no more beyond 0.9
    assert surge[-0.1] > 0 and surge[-0.2] > 0
    assert surge[1.0] == pytest.approx(1.40, abs=0.005) and surge[-1.0] == pytest.approx(-1.31, abs=0.005)
    assert surge[1.0] < surge[0.9]
    sway = read_cse1_table(out / "vsp_sway.csv")
    assert sway[1.0] == pytest.approx(1.39, abs=0.015) and sway[-1.0] == pytest.approx(-0.80, abs=0.02)


def read_cse1_table(path):
    rows = [line.split(",") for line in path.read_text().splitlines()[1:]]
    return {float(d): float(t) for d, t in rows}


def test_cse1_summary_agrees_with_the_recordings(real):
    """The set's own summary of the towing runs, made apart from this adapter."""
    summary = np.loadtxt(real("cse1/captive_surge_summary.csv"), delimiter=",", skiprows=1)
    towing = read_cse1(real("cse1")).others["towing"]
    np.testing.assert_allclose(towing["u"], summary[:, 0], atol=6e-6)
    force = {(round(u, 5)): f for u, f in summary}
    for u, f in zip(towing["u"], towing["force_X"], strict=True):
        near = [g for v, g in force.items() if abs(v - u) < 6e-6]
        assert any(abs(f - g) < 6e-6 for g in near) or len(near) < 2


def test_the_vehicle_file_of_cse1_holds_its_bollard_pulls(real):
    from ivsid.vehicle import parse_vehicle

    made = read_cse1(real("cse1"))
    vehicle = parse_vehicle(embedded("cse1.toml"), "cse1.toml")
    tables = {
        "vsp1_surge": "vsp_surge",
        "vsp2_surge": "vsp_surge",
        "vsp1_sway": "vsp_sway",
        "vsp2_sway": "vsp_sway",
        "bow": "bow_thruster",
    }
    assert {t.name for t in vehicle.thrusters} == set(tables)
    for thruster in vehicle.thrusters:
        table = made.tables[tables[thruster.name]]
        thrust = ThrustCurve(thruster)
        np.testing.assert_allclose(thrust.value(table.demand), table.thrust, atol=1e-4)
        held = thrust.interval(table.demand)
        assert held.contains(table.thrust).all()
        assert thrust.value(1.0028) == thrust.value(1.0)
    # The vessel's thrust allocation: N = 0.055 K1 u1 - 0.425 K2 u2 - 0.055 K3 u3 - 0.425 K4 u4 + 0.415 K5 u5
    arms = [t.position[0] * np.sin(t.azimuth) - t.position[1] * np.cos(t.azimuth) for t in vehicle.thrusters]
    np.testing.assert_allclose(arms, [0.055, -0.425, -0.055, -0.425, 0.415], atol=1e-12)


def test_rov30k(sets):
    out, record = sets("rov30k", "rov_30k")
    facts = record["facts"]
    # Means of the deck recording: gyro bias (-.00449, .00398, -.00110) rad/s on deck for 845 s, median step 0.17 s
    assert facts["gyro_bias"] == pytest.approx([-0.00449, 0.00398, -0.00110], abs=5e-6)
    assert facts["deck_duration"] == pytest.approx(845, abs=1) and facts["period"] == pytest.approx(0.17, abs=0.005)
    assert facts["invalid_velocity"] == 305
    manual, automatic = read_log(out / "manual.csv"), read_log(out / "automatic.csv")
    assert (manual.t[0], manual.t[-1]) == (pytest.approx(60, abs=1), pytest.approx(690, abs=1))
    assert (automatic.t[0], automatic.t[-1]) == (pytest.approx(700, abs=1), pytest.approx(1930, abs=1))
    # gaps to 9.1 s
    assert np.diff(manual.t).max() == pytest.approx(9.1, abs=0.05)
    for log in (manual, automatic):
        # held between new values about once a second, while the gyro changes every cycle
        for held in ("u", "v", "x", "y"):
            assert log.quality[held].rate == pytest.approx(1.0, abs=0.05)
            assert any(n.startswith(f"{held} holds each value over 6") for n in log.notes)
        assert log.quality["r"].rate > 5
        assert not (log.columns["u"] == -32.768).any()
    # r = -gyr_z: the heading turns with it
    turned = np.diff(np.unwrap(automatic.columns["psi"][np.isfinite(automatic.columns["psi"])]))
    rates = automatic.columns["r"][np.isfinite(automatic.columns["psi"])][1:]
    there = np.isfinite(rates)
    assert np.corrcoef(turned[there], rates[there])[0, 1] > 0.8
    assert any("rejected" in n for n in record["notes"])


def test_rov30k_thrusters_give_the_logged_demand(real):
    """The rpm columns, at the places of the vehicle file, reproduce the demanded forces and moment."""
    from ivsid.log import open_source
    from ivsid.propulsion.configuration import combine
    from ivsid.vehicle import parse_vehicle

    vehicle = parse_vehicle(embedded("rov30k.toml"), "rov30k.toml")
    assert vehicle.hull.mass == 1862.87
    part = read_rov30k(real("rov_30k")).logs["automatic"]
    with open_source(real("rov_30k/20150518--1829_decoded.csv.gz")) as source:
        cells = source.numeric(["t_s", "tau_X_N", "tau_Y_N", "tau_N_Nm"])
    inside = (cells["t_s"] >= 700) & (cells["t_s"] < 1930)
    thrusts = {t.name: ThrustCurve(t).interval(part.columns[f"demand_{t.name}"]) for t in vehicle.thrusters}
    total = combine(vehicle, thrusts)
    for made, tau in ((total.X, "tau_X_N"), (total.Y, "tau_Y_N"), (total.N, "tau_N_Nm")):
        assert np.corrcoef(made.midpoint, cells[tau][inside])[0, 1] > 0.95


def test_rov30k_identifies(sets):
    """The plain model is contradicted at sea; the structure of the vessel's own simulation is not."""
    out, _ = sets("rov30k", "rov_30k")
    vehicle = read_vehicle(out / "rov30k.toml")
    from ivsid import identify

    log = read_log(out / "manual.csv", vehicle.log)
    full = identify(vehicle, log)
    assert full.status in ("unbounded", "enclosed") and full.guaranteed and full.inflation < 1
    plain = vehicle.model_copy(update={"model": type(vehicle.model)()})
    wrong = identify(plain, log)
    assert wrong.status == "empty" and wrong.guaranteed and wrong.inflation > 1


@pytest.mark.parametrize("volts", [10, 16, *(pytest.param(v, marks=pytest.mark.nightly) for v in (12, 14, 18, 20))])
def test_t200(sets, volts):
    out, record = sets("t200", "t200")
    fact = record["facts"]["tables"][f"t200_{volts}V"]
    assert fact["points"] == 201
    if volts == 16:
        assert fact["forward"] == pytest.approx(5.245 * 9.80665, rel=1e-4)
        assert fact["reverse"] == pytest.approx(-4.069 * 9.80665, rel=2e-4)
        assert fact["dead_band"] == [1472, 1528]
    thrust = workflow.thrust(out / f"t200_{volts}V.csv").record
    assert thrust["unit"] == "N" and thrust["points"] == 201 and thrust["range"] == [1100, 1900]


def test_an_import_leaves_a_whole_folder_with_its_sources(sets):
    out, record = sets("cse1", "cse1")
    assert set(record["files"]) <= {p.name for p in out.iterdir()}
    assert len(record["inputs"]) == 3 + 54 + 21 + 11 + 6 and all(len(i["sha256"]) == 64 for i in record["inputs"])
    page = (out / "report.html").read_text()
    assert "Nothing is filled in" in page and "data:image/png;base64," in page and "https://" not in page
    assert read_vehicle(out / "cse1.toml").name == "CyberShip Enterprise I"


@pytest.mark.parametrize("name", list(ADAPTERS))
def test_a_wrong_folder_is_one_sentence_and_leaves_nothing(tmp_path, name):
    for folder in (tmp_path / "none", tmp_path):
        made = run("import", name, folder, "--out", tmp_path / "out")
        assert made.returncode == 2 and made.stderr.count("\n") == 1 and "which can be had from" in made.stderr
        assert str(folder) in made.stderr
        assert not (tmp_path / "out").exists()


def test_an_unknown_set_is_refused(tmp_path):
    made = run("import", "titanic", tmp_path, "--out", tmp_path / "out")
    assert made.returncode == 2 and "choose one of cse1, hsva, marin, rov30k, t200" in made.stderr
