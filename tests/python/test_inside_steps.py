"""Steps of a quick vessel: its predictions follow an exact motion, wherever the demands jump."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from diagnosis_logs import SENSORS, TRUTH, train_of, vehicle_of
from ivsid.diagnosis.data.channels import channels
from ivsid.diagnosis.estimation.noise import declared_ambient
from ivsid.diagnosis.plant.physics import Hypothesis
from ivsid.diagnosis.prediction.innovations import Predictor
from ivsid.diagnosis.prediction.inside_steps import GAUSS, InsideSteps, Places
from ivsid.effects import EFFECTS, Given, terms_of
from ivsid.log import Log
from ivsid.vehicle import parse_vehicle

# A craft of 12 kg that forgets a fifth of its yaw rate in a tenth of a second.
LIGHT = (
    "name = 'light'\n[hull]\nmass = 12.0\nlength = 0.5\n"
    + "".join(
        f"[[thrusters]]\nname = '{name}'\nposition = [-0.15, {y}]\nquadratic = {{ forward = 0.0012, reverse = 0.0012 }}\n"
        "demand_range = [-100.0, 100.0]\naccuracy = { absolute = 0.1, relative = 0.01 }\n"
        for name, y in (("port", -0.11), ("starboard", 0.11))
    )
    + SENSORS
    + "[model]\nterms = ['mass.surge', 'mass.sway', 'inertia.yaw', 'drag.surge.quadratic', 'drag.sway.quadratic', 'drag.yaw.linear', "
    "'drag.yaw.quadratic']\n"
)
TRUE = {
    "mass.surge": 15.0,
    "mass.sway": 19.0,
    "inertia.yaw": 0.35,
    "drag.surge.quadratic": 20.0,
    "drag.sway.quadratic": 35.0,
    "drag.yaw.linear": 0.3,
    "drag.yaw.quadratic": 0.6,
}
# Standard deviations of good sensors: a third of what the accuracies stand for.
GOOD = {"u": 4e-4, "v": 4e-4, "r": 1.6e-3, "ax": 6e-3, "ay": 6e-3, "psi": 1e-3, "x": 0.02, "y": 0.02}


def sailed(h, duration=120.0, late=0.0):
    """Exact readings, by an integrator of eighth order that begins anew at each demand, which acts some seconds later."""
    rng = np.random.default_rng(3)
    n = round(duration / h)
    hold = round(1.2 / h)
    demands = np.repeat(rng.uniform(-40.0, 90.0, (2, n // hold + 1)), hold, axis=1)[:, :n]
    T = 0.0012 * demands * np.abs(demands)
    # The thrust of a row is that of the demand before it, up to the part of a step that the delay lasts longer than whole ones.
    behind = int(late / h) + 1 if late else 0
    T = np.concatenate([np.repeat(T[:, :1], behind, axis=1), T[:, : n - behind]], axis=1)
    m_u, m_v, inertia, d_u, d_v, d_r, d_rr = TRUE.values()

    def rates(_, s, thrusts):
        u, v, r, psi = s[:4]
        du = (thrusts.sum() + m_v * v * r - d_u * u * abs(u)) / m_u
        dv = (-m_u * u * r - d_v * v * abs(v)) / m_v
        dr = (0.11 * (thrusts[0] - thrusts[1]) - d_r * r - d_rr * r * abs(r)) / inertia
        return [du, dv, dr, r, u * np.cos(psi) - v * np.sin(psi), u * np.sin(psi) + v * np.cos(psi)]

    s, rows = np.zeros(6), []
    for k in range(n):
        du, dv, *_ = rates(0.0, s, T[:, k])
        rows.append([*s, du - s[1] * s[2], dv + s[0] * s[2]])
        for thrusts, seconds in (
            ((T[:, k], late % h), (T[:, min(k + 1, n - 1)], h - late % h)) if late else ((T[:, k], h),)
        ):
            s = solve_ivp(rates, (0.0, seconds), s, "DOP853", args=(thrusts,), rtol=1e-9, atol=1e-11).y[:, -1]
    u, v, r, psi, x, y, ax, ay = np.array(rows).T
    read = {"u": u, "v": v, "r": r, "ax": ax, "ay": ay, "psi": psi, "x": x, "y": y}
    return h * np.arange(n), read, {"demand_port": demands[0], "demand_starboard": demands[1]}


def wrong(h, *, middle=False, late=0.0):
    """Errors of the true model's predictions without noise, in the noise of good sensors, by row, and the predictor."""
    vehicle = parse_vehicle(LIGHT, "light.toml")
    t, read, demands = sailed(h, late=late)
    data = channels(Log("a.csv", "0" * 64, t, {**read, **demands}), vehicle)
    predictor = Predictor(vehicle, replace(data, noise=dict(GOOD)), declared_ambient(vehicle))
    if middle:
        predictor.fine = False
    true = Hypothesis(terms_of(vehicle), dict(TRUE))
    if late:
        true = true.with_effect(Given(EFFECTS["thruster.delay"], (late,)))
    states = predictor.settle(predictor.start(true), 6)
    rms = np.sqrt(np.mean(predictor.errors(states)[:, round(5 / h) :] ** 2, axis=1))
    return {name: x / GOOD[name] for (_, name), x in zip(predictor.labels, rms, strict=True)}, predictor


def test_a_quick_vessel_leaves_nothing_of_its_steps():
    """The middles of the steps leave a seventh of the velocities' noise, and half of the heading's, after each demand alike."""
    coarse, _ = wrong(0.1, middle=True)
    found, predictor = wrong(0.1)
    assert predictor.fine
    for name in ("u", "v", "r", "psi"):
        assert coarse[name] > 0.1
        assert found[name] < 0.02
    assert max(found.values()) < 0.03


@pytest.mark.parametrize("late", [0.24, pytest.param(0.36, marks=pytest.mark.nightly)])
def test_a_late_demand_jumps_inside_a_step(late):
    """A delay of 0.34 s in a ROV of 11.5 kg at 10 Hz brought in one of its velocities of 5 ms: the jump acted all over its step."""
    found, _ = wrong(0.1, late=late)
    assert all(found[name] < 0.05 for name in ("u", "v", "r", "psi"))


@pytest.mark.parametrize("rate", [20.0, 50.0])
def test_demands_inside_a_step_leave_little(rate):
    """A few readings make one of the clock, and a demand may come between them."""
    coarse, found = wrong(1 / rate, middle=True)[0], wrong(1 / rate)[0]
    for name in ("u", "v", "r", "psi"):
        assert found[name] < min(0.05, 0.4 * coarse[name])


def test_a_heavy_vessel_needs_no_more_than_the_middles():
    vehicle = vehicle_of()
    log = channels(train_of(vehicle), vehicle)
    predictor = Predictor(vehicle, log, declared_ambient(vehicle))
    states = predictor.settle(predictor.start(Hypothesis(terms_of(vehicle), dict(TRUTH))), 2)
    assert predictor.fine is False and states.inside is None
    assert np.array_equal(states.over_steps, states.nudot[:, log.n :])


def test_parts_hold_what_is_found_in_them():
    """Oracle: a broken line, its mean and the mean of what is behind it by hand."""
    places = Places((0.125, 0.375, 0.625, 0.875), held=True)
    found = InsideSteps(np.array([8.0, 0.0, 0.0, 0.0])[:, None, None], places)
    assert found.mean == pytest.approx(2.0)
    # 8 over a quarter of the step, with seven eighths of it to come on average; 2 all along has a half.
    assert found.moment == pytest.approx(8 * 0.25 * 0.875 - 2.0 * 0.5)
    assert [found.until(c).item() for c in (0.0, 0.1, 0.25, 0.6, 1.0)] == pytest.approx([0.0, 0.8, 2.0, 2.0, 2.0])


@pytest.mark.parametrize("degree", range(4))
def test_two_points_integrate_what_they_are_said_to(degree):
    """Oracle: powers of time by their integrals."""
    first, second = (np.full((3, 1), c**degree) for c in GAUSS)
    inside = InsideSteps(np.stack([first, second]), Places.of(None))
    assert inside.mean == pytest.approx(1 / (degree + 1))
    # The rest of the step times what is beyond the mean.
    moment = 1 / (degree + 1) - 1 / (degree + 2) - 0.5 / (degree + 1)
    if degree < 3:
        assert inside.moment == pytest.approx(moment)
    if degree < 2:
        for place in (0.2, 0.5, 1.0):
            assert inside.until(place) == pytest.approx(place ** (degree + 1) / (degree + 1))
