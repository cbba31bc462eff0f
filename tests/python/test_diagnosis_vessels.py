"""The paper's model against twins that have more, and vessels at sea and in the basin: what the diagnosis says of each."""

import re
from importlib.resources import files

import numpy as np
import pytest

from diagnosis_logs import screened
from ivsid import diagnose
from ivsid.adapters.cse1 import read_cse1
from ivsid.adapters.rov30k import read_rov30k
from ivsid.diagnosis import isolability
from ivsid.diagnosis.data.channels import channels
from ivsid.diagnosis.null.visibility import visibility
from ivsid.log import Log, read_log
from ivsid.programme.scenario import parse_scenario
from ivsid.propulsion.bollard import PUBLISHED_CUBIC
from ivsid.simulation import simulate
from ivsid.vehicle import parse_vehicle

DATA = files("ivsid") / "data"
SWAN = (DATA / "swan.toml").read_text()
PLAIN = 'terms = ["mass.surge", "mass.sway", "inertia.yaw", "drag.surge.quadratic", "drag.sway.quadratic"]'


def trials(vehicle, truth="", effects=None):
    """The two trials of the demo, at 10 Hz, of a vehicle with other drags."""
    logs = []
    for name in ("swan_train.toml", "swan_test.toml"):
        text = (DATA / name).read_text().replace("rate = 20.0", "rate = 10.0")
        if truth:
            text = text.replace('"drag.surge.quadratic" = 255.0', truth)
        made = simulate(vehicle, parse_scenario(text, name), 3, effects or {})
        logs.append(Log(name, "0" * 64, made.t, made.columns))
    return logs


# Nightly: causes are named in whole diagnoses of the gate in test_own_effects.py and test_diagnosis_claims.py.
@pytest.mark.nightly
def test_the_papers_model_shares_a_drag_that_the_hull_does_not(tmp_path):
    """model.terms = "paper" against a twin with two drags and damping in yaw: both are named, with their numbers."""
    twin = parse_vehicle(SWAN.replace('terms = "paper"', PLAIN), "twin.toml")
    truth = '"drag.surge.quadratic" = 80.0\n"drag.sway.quadratic" = 255.0\n"mass.sway" = 60.45'
    result = diagnose(parse_vehicle(SWAN, "swan.toml"), *trials(twin, truth, {"drag.yaw.linear": 3.0}))
    # Which of them explains more depends on the noise that is learnt beside them.
    assert sorted(f.effect for f in result.findings) == ["drag.sway.quadratic", "drag.yaw.linear"]
    bounds = {id_: b for f in result.findings for id_, b in f.parameters.items()}
    assert bounds["drag.sway.quadratic"].lower <= 255.0 <= bounds["drag.sway.quadratic"].upper
    assert bounds["drag.yaw.linear"].lower <= 3.0 <= bounds["drag.yaw.linear"].upper
    # Less than 2.5 % of the structure is left, which is no structure by the rules: memories of the path stand out of that by 45 of 68,000.
    before, after = result.adequacy
    assert after.unexplained < 0.025 * before.unexplained
    # Errors of the thrusters on TRAIN are not carried over to TEST. The limits are 0.3 of what the paper's model left of each channel while
    # it could not bend the thrust curve inside its accuracy; it leaves less now, so that the ratio has grown.
    limits = {"u": 0.039, "v": 0.064, "r": 0.049}
    for name, (before, after) in result.gain.simulation_rms.items():
        assert after < min(0.45 * before, limits[name])


# Nightly: the gate has another log that nothing explains, below, and the printed curve in test_paper.py.
@pytest.mark.nightly
def test_equation_18_as_printed_is_no_curve_of_the_catalogue():
    """Its rounded coefficients miss Table III by up to 47 N, half of which no mass or drag takes up: unknown, and nothing is named for it."""
    demand = np.arange(5.0, 86.0, 5.0)
    thrust = np.polyval(PUBLISHED_CUBIC, demand)
    table = f"[thrusters.table]\ndemand = {demand.tolist()}\nthrust = {thrust.tolist()}\n"
    text = re.sub(r"\[thrusters.table\]\ndemand = \[[^\]]*\]\nthrust = \[[^\]]*\]\n", table, SWAN)
    result = diagnose(parse_vehicle(text, "printed.toml"), *trials(parse_vehicle(SWAN, "swan.toml")))
    assert [f.effect for f in result.findings] == ["unknown"]
    assert result.findings[0].evidence["channel"] == "surge"
    assert "thrust" in result.findings[0].description


def rov(real, tmp_path, model=""):
    parts = read_rov30k(real("rov_30k")).logs
    text = (DATA / "rov30k.toml").read_text()
    vehicle = parse_vehicle(text.split("[model]")[0] + model if model else text, "rov30k.toml")
    logs = []
    for name in ("manual", "automatic"):
        (tmp_path / f"{name}.csv").write_text(parts[name].text)
        logs.append(read_log(tmp_path / f"{name}.csv", vehicle.log))
    return vehicle, logs


def test_the_vehicle_at_sea_is_screened_at_the_clock_of_its_doppler_log(real, tmp_path):
    """One Doppler velocity a second of a tethered vehicle in a current: the model fails, and small causes cannot be seen."""
    vehicle, (manual, _) = rov(real, tmp_path)
    # Held samples are none: the clock is the Doppler log's own.
    assert channels(manual, vehicle).h == pytest.approx(1.0, abs=0.01)
    found = screened(vehicle, manual)
    assert not found.quiet
    shown = visibility(found.fit)
    assert not any(shown[id_].tested for id_ in ("drag.surge.astern", "friction.coulomb", "drag.cross_flow"))


# Nightly: a whole diagnosis of half an hour at sea; the gate screens the same log.
@pytest.mark.nightly
def test_the_vehicle_at_sea_is_unknown_and_not_a_list_of_guesses(real, tmp_path):
    """One Doppler velocity a second of a tethered vehicle in a current: its model fails, and no cause explains how."""
    vehicle, (manual, automatic) = rov(real, tmp_path)
    result = diagnose(vehicle, manual, automatic)
    assert [f.effect for f in result.findings] == ["unknown"]
    assert result.unexplained["sway"] > 0.1
    untested = {q["effect"] for q in result.not_tested}
    assert {"drag.surge.astern", "friction.coulomb", "drag.cross_flow"} <= untested
    # Held samples are none: the clock is the Doppler log's own.
    assert channels(manual, vehicle).h == pytest.approx(1.0, abs=0.01)
    assert any("holds each value over" in note for note in result.notes)


# Nightly: the gate diagnoses the same logs without claims, and claims in test_diagnosis_claims.py.
@pytest.mark.nightly
def test_the_claims_of_the_vehicle_at_sea_are_held_against_its_log(real, tmp_path):
    """Tether, current, lever arm and held samples, and each claimed number with what the log allows: none is a finding."""
    values = {
        "mass.surge": 1862.87 + 779.79,
        "mass.sway": 1862.87 + 1222.0,
        "drag.surge.linear": 74.82,
        "drag.surge.quadratic": 748.22,
        "drag.sway.linear": 69.48,
        "drag.sway.quadratic": 992.53,
        "drag.yaw.linear": 105.0,
        "drag.yaw.quadratic": 523.27,
    }
    pairs = ", ".join(f'"{k}" = {v}' for k, v in values.items())
    terms = ", ".join(f'"{k}"' for k in ("inertia.yaw", *values))
    vehicle, (manual, automatic) = rov(real, tmp_path, f"[model]\nterms = [{terms}]\nvalues = {{ {pairs} }}\n")
    result = diagnose(vehicle, manual, automatic)
    assert [f.effect for f in result.findings] == ["unknown"]
    record = result.record()
    said = {c["parameter"]: c for c in record["claims"]}
    assert list(said) == list(values) and not any(c["contradicted"] for c in said.values())
    # By hand: thrusts of 219 N and four bounds more, all along the motion, in all axes, drive no drag above 2,504 kg/s through the run. Since humps of a
    # drag are in the catalogue, one of the surge drag is tried here; it drives at some speeds, and the end is 2,657 beside it (7,324 without an end by power).
    drag, alone = (said["drag.surge.linear"][end] for end in ("interval", "without_claims"))
    assert drag["lower"] < 74.82 < drag["upper"] and 200 < drag["upper"] < 2700
    # With all drags free none is told from a hump: half-minutes scatter the linear one by 5,600 kg/s, and the interval says so (2,006 without humps).
    assert alone["lower"] == 0.0 and alone["upper"] > drag["upper"]
    may = record["allowed"]
    # The water may have moved by a few centimetres a second beside what the extended model says, and no more.
    # A current of typical size stood out by more than 8 until thrusts at rest had their whole absolute accuracy, as the contract says.
    assert 7.0 < result.visible["current.steady"].z < 10.0
    assert all(
        -0.2 < may[f"current.steady.{q}"]["lower"] < may[f"current.steady.{q}"]["upper"] < 0.2
        for q in ("north", "east")
    )
    assert may["tether.tension.force"]["upper"] < 200
    reasons = {q["effect"]: q["reason"] for q in record["not_tested"]}
    assert reasons["sensor.velocity.lever_arm"] == "no ay or vdot"
    assert any(n.startswith("u holds each value over") for n in record["notes"])


def test_velocities_of_a_pose_alone_are_its_differences(real, tmp_path):
    """CyberShip Enterprise I has cameras and nothing else: the differences agree with the set's own raw velocities."""
    part = read_cse1(real("cse1")).logs["random_run3"]
    (tmp_path / "run.csv").write_text(part.text)
    vehicle = parse_vehicle((DATA / "cse1.toml").read_text(), "cse1.toml")
    log = read_log(tmp_path / "run.csv", vehicle.log)
    data = channels(log, vehicle)
    assert data.h == pytest.approx(0.25)
    at = data.t[data.good] + log.t[0]
    for k, name in enumerate(("u", "v", "r")):
        raw = part.columns[f"raw_{name}"]
        there = np.isfinite(raw)
        # Over a quarter of a second the noise of single differences averages out.
        smooth = np.convolve(np.interp(log.t, log.t[there], raw[there]), np.ones(5) / 5, mode="same")
        off = data.nu[k][data.good] - np.interp(at, log.t - 0.025, smooth)
        assert np.median(np.abs(off)) < 0.1 * data.nu[k].std(), name


CLAIMED = """[model]
terms = ["mass.surge", "mass.sway", "inertia.yaw", "drag.surge.linear", "drag.sway.linear", "drag.sway.quadratic", "drag.yaw.linear"]
values = { "drag.surge.linear" = 0.66, "mass.surge" = 16.1 }
"""
# The sizes of the towing tank and of the bollard pulls, beside the claim: sway gives +1.39 N and -0.80 N.
MEASURED = {
    "drag.surge.linear": 0.66 - 0.137,
    "drag.surge.quadratic": 3.088,
    "thruster.asymmetry": 0.1,
    "thruster.reverse_loss": 0.42,
}


def tug(real, tmp_path, accuracy="{ absolute = 0.10, relative = 0.10 }"):
    """The model tug with its authors' surge drag claimed, and its runs for which thrusts are known."""
    text = (DATA / "cse1.toml").read_text().split("[model]")[0] + CLAIMED
    vehicle = parse_vehicle(text.replace("{ absolute = 0.10, relative = 0.10 }", accuracy), "cse1.toml")
    parts = read_cse1(real("cse1")).logs
    logs = []
    for name in ("random_run1", "random_run3"):
        (tmp_path / f"{name}.csv").write_text(parts[name].text)
        logs.append(read_log(tmp_path / f"{name}.csv", vehicle.log))
    return vehicle, *logs


def joined(a, b, gap=30.0):
    """Both runs in one log, with nothing between them."""
    count = round(gap / a.period) - 1
    t = np.r_[a.t, a.t[-1] + a.period * np.arange(1, count + 1), b.t - b.t[0] + a.t[-1] + gap]
    both = {k: np.r_[a.columns[k], np.full(count, np.nan), b.columns[k]] for k in a.columns if k in b.columns}
    return Log("joined", "0" * 64, t, both)


def predicted(vehicle, log):
    visible = isolability(vehicle, log).visible
    return {i: visible[i].z * abs(size / visible[i].typical[i]) for i, size in MEASURED.items()}


# Nightly: the prediction for a perfect bollard pull, below, is made of the same logs.
@pytest.mark.nightly
def test_a_slow_run_of_the_model_tug_does_not_show_its_drag(real, tmp_path):
    """The published linear drag, 0.66 kg/s, is a third of the towing tank's at 0.6 m/s; below 0.15 m/s, where the run is, both push alike.

    What the bollard pulls show of the propellers is no more visible: each z is below 8, in each run and in both together.
    """
    vehicle, run, other = tug(real, tmp_path)
    speed = np.quantile(np.abs(channels(run, vehicle).nu[0]), 0.9)
    tank = 0.137 * speed + 3.088 * speed**2
    assert speed < 0.2 and abs(tank / (0.66 * speed) - 1) < 0.3
    alone, slower, both = (predicted(vehicle, log) for log in (run, other, joined(run, other)))
    for z in (alone, slower, both):
        assert max(z.values()) < 8, z
    # Information of two runs adds at most; both together have other knots of their thrust errors. While thrusts at rest had no accuracy the slower run
    # showed 2.0 of the linear drag, the first 4.1 and both 4.7; with the absolute accuracy, as the contract says, these are 4.2, 3.3 and 3.7.
    drags = ("drag.surge.linear", "drag.surge.quadratic")
    assert all(0.5 * alone[i] ** 2 < both[i] ** 2 < 1.2 * (alone[i] ** 2 + slower[i] ** 2) for i in drags)


def test_a_perfect_bollard_pull_would_not_show_the_tugs_drag_either(real, tmp_path):
    """Speed is what the run lacks: without any doubt of the thrusts the propellers' unevenness shows, and the drag does not."""
    vehicle, run, _ = tug(real, tmp_path, "{ absolute = 0.0 }")
    z = predicted(vehicle, run)
    assert z["drag.surge.linear"] < 8 and z["drag.surge.quadratic"] < 8
    assert z["thruster.reverse_loss"] > 8


# Nightly: 700 s at 20 Hz; the gate asks what the same runs can show.
@pytest.mark.slow
@pytest.mark.nightly
def test_what_the_tugs_run_says_of_its_drag_is_no_name(real, tmp_path):
    """The propellers push otherwise than their curves, by more than a tenth, and late: unknown, with the lag as the nearest cause.

    A drag four times the tank's would fit the run; on the other run it does harm, and the extended model lacks it.
    """
    vehicle, run, other = tug(real, tmp_path)
    result = diagnose(vehicle, run, other)
    # The lag was named while soft priors took thrust errors of two to four times the accuracy beside it.
    (unknown,) = result.findings
    assert unknown.effect == "unknown" and result.verdict == "unknown"
    for words in ("vsp2_sway", "by more than the stated accuracy"):
        assert words in unknown.description
    given = {g.effect.id: g.values[0] for g in result.selection.last.h.given}
    # A lag or a delay: the run hardly tells them apart, and the delay has been the nearer one since passes of the filters settle.
    (late,) = {"thruster.lag", "thruster.delay"} & set(given)
    assert late in unknown.description and 0.05 < given[late] < {"thruster.lag": 0.35, "thruster.delay": 0.4}[late]
    drag = next(c for c in result.claims if c.parameter == "drag.surge.linear")
    # Linear drag that fits the towing tank's forces at the run's own speeds.
    u = channels(run, vehicle).nu[0]
    tank = float(u @ (0.137 * u + 3.088 * u * np.abs(u)) / (u @ u))
    # The fit's own interval begins above the tank's drag, at 0.83: beside a lag it began at 0.42, and the fit has a delay in its place. What
    # is unknown may push along the drag's signature as much as beside it: with room for that the claim's interval holds no number that a drag cannot have.
    low, high = drag.beside.within
    assert 0.6 < tank < 0.8 and low < 1.2 * tank and high > 3 * tank and not drag.contradicted
    assert 0.0 <= drag.beside.lower < tank < drag.beside.upper < 10 * high and drag.z > 7
    before, after = result.gain.simulation_rms["u"]
    # A model with the lag simulates the other run 1.5 times worse; the extended model holds findings only.
    assert after <= before and not result.gain.losses
