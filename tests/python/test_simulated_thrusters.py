"""Thrusters in time: lags, delays, and what changes a thrust, against closed forms."""

import numpy as np
import pytest

from ivsid import IvsidError
from ivsid.propulsion.thrust import ThrustCurve
from test_simulation import boat, move


@pytest.mark.parametrize("where", ["claim", "effect"])
def test_lag_delay_and_their_closed_forms(where):
    """A step of thrust through a lag: m udot = T (1 - exp(-t / tau)); through a delay: T from d on."""
    tau = 0.4
    vehicle = boat() if where == "effect" else boat(edit=("gain = 1.0\n", f"gain = 1.0\ntime_constant = {tau}\n"))
    values = {"thruster__lag": tau} if where == "effect" else {}
    t, m = move(5, rate=10.0, demand=(29.0, 29.0), drag__surge__quadratic=0.0, vehicle=vehicle, **values)
    np.testing.assert_allclose(m["u"], t - tau * (1 - np.exp(-t / tau)), atol=1e-5)
    t, late = move(5, rate=10.0, demand=(29.0, 29.0), drag__surge__quadratic=0.0, thruster__delay=0.13)
    np.testing.assert_allclose(late["u"], np.maximum(t - 0.13, 0), atol=1e-9)
    t, short = move(5, rate=2.0, demand=(29.0, 29.0), drag__surge__quadratic=0.0, thruster__lag=0.01)
    np.testing.assert_allclose(short["u"][1:], t[1:] - 0.01, atol=1e-5)
    t, both = move(
        5, rate=10.0, demand=(29.0, 29.0), drag__surge__quadratic=0.0, thruster__delay=0.25, thruster__lag=tau
    )
    since = np.maximum(t - 0.25, 0)
    np.testing.assert_allclose(both["u"], since - tau * (1 - np.exp(-since / tau)), atol=1e-5)


@pytest.mark.parametrize("where", ["claim", "effect"])
def test_a_shaft_lags_in_its_speed_and_thrust_follows_its_square(where):
    quadratic = "quadratic = { forward = 0.01, reverse = 0.006 }"
    said = '\ntime_constant = 0.3\nlag = "demand"' if where == "claim" else ""
    values = {"thruster__shaft_lag": 0.3} if where == "effect" else {}
    vehicle = boat(edit=("gain = 1.0", quadratic + said))
    t, m = move(4, rate=20.0, demand=(50.0, 50.0), drag__surge__quadratic=0.0, vehicle=vehicle, **values)
    grown = t - 2 * 0.3 * (1 - np.exp(-t / 0.3)) + 0.15 * (1 - np.exp(-2 * t / 0.3))
    np.testing.assert_allclose(m["u"], 2 * 0.01 * 2500 / 58 * grown, atol=2e-5)


@pytest.mark.parametrize(
    ("values", "demand", "thrust"),
    [
        ({"thruster__gain": 0.1}, (10.0, 10.0), (11.0, 11.0)),
        ({"thruster__gain__port": 0.1}, (10.0, 10.0), (11.0, 10.0)),
        ({"thruster__asymmetry": 0.05}, (10.0, 10.0), (10.5, 9.5)),
        (
            {"thruster__failure__thruster": 1, "thruster__failure__loss": 0.3, "thruster__failure__time": 0},
            (10.0, 10.0),
            (10.0, 7.0),
        ),
        ({"thruster__deadband": 8.0}, (7.9, 8.1), (0.0, 8.1)),
        ({"thruster__saturation": 30.0}, (40.0, -50.0), (30.0, -30.0)),
        ({"thruster__reverse_loss": 0.2}, (10.0, -10.0), (10.0, -8.0)),
        ({"thruster__voltage_sag": 0.5}, (10.0, 10.0), (10.0, 10.0)),
        ({"thruster__deadband": 8.0, "thruster__deadband__port": 2.0}, (7.9, 7.9), (7.9, 0.0)),
    ],
)
def test_changes_of_a_thrust_at_rest(values, demand, thrust):
    _, m = move(1, demand=demand, **values)
    assert m["udot"][0] == pytest.approx(sum(thrust) / 58, rel=1e-8, abs=1e-12)
    assert m["rdot"][0] == pytest.approx(0.28 * (thrust[0] - thrust[1]) / 9, rel=1e-8, abs=1e-12)


def test_thrust_that_depends_on_time_speed_and_shape():
    t, sagging = move(20, demand=(10.0, 10.0), drag__surge__quadratic=0.0, thruster__voltage_sag=0.02)
    np.testing.assert_allclose(sagging["u"], 20 / 58 * (t - 0.01 * t**2), atol=1e-9)
    # Advance: with w = u cos a the thrust T (1 - k u) settles at 2 T (1 - k u) = X_uu u^2.
    _, fast = move(200, demand=(31.5, 31.5), thruster__advance_loss=0.1)
    assert fast["u"][-1] == pytest.approx((-6.3 + np.sqrt(6.3**2 + 4 * 28 * 63)) / 56, rel=1e-6)
    shaped = boat(edit=("gain = 1.0", "gain = 1.0\ndemand_range = [-40, 40]"))
    _, m = move(1, demand=(20.0, 40.0), vehicle=shaped, thruster__curve=0.1)
    assert m["udot"][0] == pytest.approx((20 + 0.1 * 20 * 0.5 + 40) / 58)
    with pytest.raises(IvsidError, match=r"port has no end; give a table or demand_range"):
        move(1, thruster__curve=0.1)


def test_what_the_file_claims_of_a_thruster_is_true_unless_an_effect_says_otherwise():
    claims = "gain = 1.0\ndead_band = 5.0\nlimit = 30.0\nreverse_factor = 0.8"
    vehicle = boat(edit=("gain = 1.0", claims))
    for demand in (4.0, 20.0, 50.0, -20.0, -50.0):
        _, m = move(1, demand=(demand, demand), vehicle=vehicle)
        assert m["thrust"][0] == pytest.approx(2 * ThrustCurve(vehicle.thrusters[0]).value(demand))
    _, m = move(1, demand=(50.0, 50.0), vehicle=vehicle, thruster__saturation=40.0)
    assert m["thrust"][0] == pytest.approx(80)


def test_the_fast_curve_is_the_curve(swan):
    from ivsid.simulation.true_thrust import scalar_curve

    rng = np.random.default_rng(0)
    table = {"demand": [-3.0, -1.0, 0.0, 2.0, 5.0], "thrust": [-4.0, -0.5, 0.0, 3.0, 3.5]}
    changed = [
        {"table": table},
        {"table": {"demand": [1.0, 2.0], "thrust": [1.0, 3.0]}},
        {"table": {"demand": [0.0, 2.0], "thrust": [0.0, 3.0]}, "neutral": 1500.0},
        {"table": None, "polynomial": (0.1, -2.0, 3.0)},
        {"table": None, "quadratic": {"forward": 0.2, "reverse": 0.1}, "neutral": 3.0},
        {},
    ]
    for change in changed:
        thruster = type(swan.thrusters[0]).model_validate({**swan.thrusters[0].model_dump(), **change})
        curve = ThrustCurve(thruster)
        low, high = (q if np.isfinite(q) else s * 9.0 for q, s in zip(curve.range, (-1, 1), strict=True))
        demands = rng.uniform(low, high, 300)
        fast = scalar_curve(curve)
        np.testing.assert_allclose([fast(float(d)) for d in demands], curve.value(demands), rtol=1e-12, atol=1e-12)
