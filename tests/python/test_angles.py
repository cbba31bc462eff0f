"""Angles of thrusters run from row to row where they turn all the time, and hold where they jump: a log tells."""

from dataclasses import replace

import numpy as np
import polars as pl
import pytest
from scipy.integrate import solve_ivp
from tests.exam.cases import case

from ivsid.diagnosis.candidates.families import everything, score
from ivsid.diagnosis.data.channels import channels
from ivsid.diagnosis.estimation.angles import RUNS
from ivsid.diagnosis.estimation.learning import plain_fit
from ivsid.diagnosis.plant.driving import Driving
from ivsid.diagnosis.statements.proved import proof_of, upheld
from ivsid.log import Log, read_log
from ivsid.vehicle import parse_vehicle

BOAT = """
name = "pod"
[hull]
mass = 90.0
length = 1.8
[[thrusters]]
name = "pod"
position = [-0.9, 0.0]
steering = "azimuth"
quadratic = { forward = 0.004, reverse = 0.003 }
demand_range = [-100.0, 100.0]
accuracy = { absolute = 0.2, relative = 0.02 }
[sensors]
confidence = 0.999
[sensors.velocity]
accuracy = 0.006
[sensors.acceleration]
random_walk = 0.002
[sensors.yaw_rate]
random_walk = 1.0e-3
[sensors.heading]
accuracy = 0.01
[ambient]
force = 0.2
moment = 0.05
time = 2.0
[model]
terms = ["mass.surge", "mass.sway", "inertia.yaw", "drag.surge.quadratic", "drag.sway.quadratic", "drag.yaw.linear"]
"""
M_U, M_V, I_R, D_U, D_V, D_R = 100.0, 135.0, 60.0, 30.0, 160.0, 40.0
# Rows come five times a second, and the pod turns by up to 0.2 rad between two of them.
H, SECONDS = 0.2, 300.0


def angle(t):
    return 0.5 * np.sin(0.9 * t) + 0.25 * np.sin(2.3 * t + 1.0)


def sailed(turned):
    """A log of a pod whose angle is a function of time; the demand holds for ten seconds."""
    rng = np.random.default_rng(11)
    levels = rng.uniform(40.0, 90.0, int(SECONDS / 10.0))
    push = lambda t: 0.004 * levels[min(int(t / 10.0), levels.size - 1)] ** 2  # noqa: E731

    def rates(t, x):
        u, v, r = x[:3]
        force, a = push(t), turned(t)
        X, Y = force * np.cos(a) - D_U * u * abs(u), force * np.sin(a) - D_V * v * abs(v)
        N = -0.9 * force * np.sin(a) - D_R * r
        return [(X + M_V * v * r) / M_U, (Y - M_U * u * r) / M_V, N / I_R, r]

    t = np.arange(0.0, SECONDS, H)
    x, states = np.zeros(4), []
    for now in t:
        states.append(x)
        x = solve_ivp(rates, (now, now + H * (1 - 1e-12)), x, max_step=H / 4, rtol=1e-8, atol=1e-10).y[:, -1]
    u, v, r, psi = np.array(states).T
    after = np.array([rates(now + 1e-9, s) for now, s in zip(t, states, strict=True)])
    noisy = lambda x, size: x + size * rng.standard_normal(x.size)  # noqa: E731
    walk = 1 / np.sqrt(H)
    columns = {
        "u": noisy(u, 0.002),
        "v": noisy(v, 0.002),
        "r": noisy(r, 1e-3 * walk),
        "ax": noisy(after[:, 0] - v * r, 0.002 * walk),
        "ay": noisy(after[:, 1] + u * r, 0.002 * walk),
        "psi": noisy(psi, 0.01 / 3),
        "demand_pod": np.array([levels[min(int((now + 1e-9) / 10.0), levels.size - 1)] for now in t]),
        "azimuth_pod": np.array([turned(now + 1e-9) for now in t]),
    }
    return Log("1.csv", "0" * 64, t, columns)


def fitted(log):
    vehicle = parse_vehicle(BOAT, "vehicle.toml")
    return plain_fit(vehicle, channels(log, vehicle), everything)


@pytest.mark.parametrize(
    ("turned", "running"), [(angle, True), (lambda t: angle(H * np.floor(t / H)), False)], ids=["runs", "holds"]
)
def test_a_log_tells_whether_an_angle_runs_or_holds(turned, running):
    """Held over each step, the pod's force lagged behind by half a step, and a sound model was unknown."""
    fit = fitted(sailed(turned))
    log = fit.noise.predictor.log
    assert log.running == running and (RUNS in log.notes) == running
    assert fit.h.values["mass.sway"] == pytest.approx(M_V, rel=0.03)
    assert fit.h.values["inertia.yaw"] == pytest.approx(I_R, rel=0.03)


def test_an_angle_that_runs_takes_the_shorter_way_and_demands_hold():
    vehicle = parse_vehicle(BOAT, "vehicle.toml")
    log = channels(sailed(lambda t: angle(H * np.floor(t / H))), vehicle)
    turned = np.array([[3.1, -3.1, 3.0] + [0.0] * (log.n - 3)])
    run, held = (Driving(vehicle, replace(log, angles=turned, running=q)).turned[0, log.n :] for q in (True, False))
    assert held[:3] == pytest.approx([3.1, -3.1, 3.0])
    assert np.cos(run[:2]) == pytest.approx(np.cos([np.pi, np.pi - 0.05]), abs=5e-3)


def test_nothing_is_proved_from_held_angles_where_the_log_shows_that_they_run(tmp_path):
    """Short of a stated rate the rows of a proof hold each angle for a step."""
    log, text = sailed(angle), BOAT + "[sensors.limits]\nacceleration = 1.0\nyaw_acceleration = 1.0\n"
    proof = proof_of(parse_vehicle(text, "vehicle.toml"), log)
    assert proof.status != "not_applicable" and any("azimuth_pod holds" in a for a in proof.identification.assumes)
    assert upheld(proof, running=False) is proof
    gone = upheld(proof, running=True)
    assert gone.status == "not_applicable" and "azimuth_pod holds" in gone.reason and "rates" in gone.record()["reason"]
    stated = parse_vehicle(text + "[log.rates]\nazimuth_pod = 1.2\n", "vehicle.toml")
    pl.DataFrame({"t": log.t, **log.columns}).write_csv(tmp_path / "1.csv")
    by_rate = proof_of(stated, read_log(tmp_path / "1.csv", stated.log))
    assert by_rate.status != "not_applicable" and upheld(by_rate, running=True) is by_rate


def test_a_held_angle_of_the_examination_stays_held():
    c = case(178009, kind="azimuth", what="none", duration=120.0, rate=20.0, style="rich")
    vehicle = parse_vehicle(c.text, "vehicle.toml")
    log = Log("1.csv", "0" * 64, c.logs[0]["t"], {k: x for k, x in c.logs[0].items() if k != "t"})
    assert not plain_fit(vehicle, channels(log, vehicle), everything).noise.predictor.log.running


def test_a_lag_of_the_shaft_is_no_angle_that_runs():
    """Both come half a row late. A model whose angles ran beside the right lag had a delay of its velocities by name."""
    c = case(252037, what="one", effect="thruster.shaft_lag", size=1.0, kind="azimuth", style="circle")
    vehicle = parse_vehicle(c.text, "vehicle.toml")
    log = Log("1.csv", "0" * 64, c.logs[0]["t"], {k: x for k, x in c.logs[0].items() if k != "t"})
    assert not plain_fit(vehicle, channels(log, vehicle), everything).noise.predictor.log.running


def test_a_heading_adds_up_what_a_running_angle_turns_inside_each_step():
    """Without it the scale of an exact gyro was 7 standard deviations from one."""
    fit = fitted(sailed(angle))
    predictor = fit.noise.predictor
    assert predictor.fine
    scored = {q.id: q for q in score(fit)[1]}
    assert scored["sensor.yaw_rate.scale"].fall < 9.0
    # The oracle: angles that stand in the middle of each step, which is what steps as a whole know of them.
    driving = predictor.driving
    inside = driving.inside(fit.h, (0.25, 0.75))
    t = predictor.log.t
    for place, found in zip((0.25, 0.75), np.split(inside.angles[0], 2), strict=True):
        assert found[5:-5] == pytest.approx(angle(t + place * H)[5:-5], abs=0.01)
    assert np.split(inside.thrusts[0], 2)[0] == pytest.approx(driving.thrusts(fit.h)[0, predictor.log.n :])
