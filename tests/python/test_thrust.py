"""Thrust curves and their bounds."""

import re

import numpy as np
import pytest

from ivsid import IvsidError
from ivsid.propulsion.bollard import TABLE_III, examine
from ivsid.propulsion.configuration import combine
from ivsid.propulsion.thrust import ThrustCurve
from ivsid.simulation.true_thrust import scalar_curve
from ivsid.vehicle import Thruster, Vehicle, parse_vehicle


def thruster(**changes) -> Thruster:
    table = {"demand": TABLE_III[0], "thrust": TABLE_III[1]}
    return Thruster.model_validate({"name": "p", "table": table, **changes})


def test_the_table_is_followed_monotonically_and_to_zero():
    curve = ThrustCurve(thruster())
    np.testing.assert_allclose(curve.value(np.array(TABLE_III[0])), TABLE_III[1], rtol=1e-12)
    fine = curve.value(np.linspace(0, 85, 2000))
    assert (np.diff(fine) >= 0).all() and fine[0] == 0
    assert curve.value(7.5) == pytest.approx(4.654 / 2)


def test_demands_outside_are_refused_or_held():
    for demand in (86.0, -1.0):
        with pytest.raises(IvsidError, match=f"demand {demand:g} of thruster p lies outside its table \\(0 to 85\\)"):
            ThrustCurve(thruster()).value([20.0, demand])
    held = ThrustCurve(thruster(outside="hold"))
    assert held.value([100.0, -5.0]) == pytest.approx([78.924, 0.0], abs=1e-12)


@pytest.mark.parametrize(
    "curve",
    [
        {"gain": 0.5},
        {"quadratic": {"forward": 0.01, "reverse": 0.004}},
        {"polynomial": (0.001, 0.0, 0.5, 0.0)},
        {"gain": 0.5, "dead_band": 120.0},
        {"table": {"demand": [-100, 0, 100], "thrust": [-40, 0, 60]}},
    ],
)
@pytest.mark.parametrize("neutral", [0.0, 30.3])
def test_a_demand_outside_is_held_at_the_same_end_by_value_interval_and_simulator(curve, neutral):
    ends = {} if "table" in curve else {"demand_range": (-100, 100)}
    name = {"name": "a", "outside": "hold", "neutral": neutral, **ends}
    held = ThrustCurve(Thruster.model_validate({**name, **curve}))
    demand = np.array([150.0, -150.0, 100.0, -100.0]) + neutral
    x, value = held.interval(demand), held.value(demand)
    assert x.contains(value).all() and (x.width <= 1e-9).all()
    assert value[0] == pytest.approx(value[2]) and value[1] == pytest.approx(value[3])
    wide = held.interval(demand[:2], error=300.0)
    assert (wide.lower <= value.min()).all() and (wide.upper >= value.max()).all()
    one = scalar_curve(
        ThrustCurve(Thruster.model_validate({**name, **{k: v for k, v in curve.items() if k != "dead_band"}}))
    )
    if "dead_band" not in curve:
        assert [one(d) for d in demand] == pytest.approx(value.tolist())
    # The end itself is a sum of rounded decimals; what is held there lies within it.
    inside = held.interval(np.array([100.0 + neutral]))
    assert x.lower[0] <= inside.upper[0] and inside.lower[0] <= x.upper[0]


def test_an_interval_of_demands_that_reaches_outside_is_refused():
    """60 and 140 within one row: their middle is inside the table."""
    curve = ThrustCurve(
        Thruster.model_validate({"name": "a", "table": {"demand": [-100, 0, 100], "thrust": [-40, 0, 60]}})
    )
    with pytest.raises(IvsidError, match=r"demand 140 of thruster a lies outside its table \(-100 to 100\)"):
        curve.interval(np.array([100.0]), error=np.array([40.0]))
    with pytest.raises(IvsidError, match="demand -110 of thruster a lies outside"):
        curve.interval(np.array([50.0]), np.array([-70.0]), error=np.array([40.0]))
    # The rounding of a demand's decimals is not outside.
    assert curve.interval(np.array([100.0]), error=np.spacing(100.0)).upper[0] == pytest.approx(60)


def test_the_interval_holds_every_error_inside_the_accuracy():
    curve = ThrustCurve(thruster(accuracy={"absolute": 0.5, "relative": 0.02}))
    demand = np.linspace(0, 85, 300)
    value = curve.value(demand)
    bound = 0.5 + 0.02 * np.abs(value)
    for share in (-1, -0.3, 0, 1):
        assert curve.interval(demand).contains(value + share * bound).all()
    assert (curve.interval(demand).width <= 2 * bound * (1 + 1e-9) + 1e-9).all()


def test_units_neutral_polynomial_and_gain():
    kgf = ThrustCurve(thruster(table={"demand": [0, 1, 2], "thrust": [0, 1, 2], "unit": "kgf"}))
    assert kgf.value(1.0) == pytest.approx(9.80665)
    pwm = ThrustCurve(thruster(table={"demand": [-400, 0, 400], "thrust": [-1, 0, 2]}, neutral=1500))
    assert pwm.value([1100.0, 1500.0, 1900.0]).tolist() == [-1.0, 0.0, 2.0]
    with pytest.raises(IvsidError, match="1100 to 1900"):
        pwm.value(1000.0)
    assert ThrustCurve(Thruster(name="q", polynomial=(2.0, 0.0, 1.0))).value(3.0) == 19.0
    assert ThrustCurve(Thruster(name="q", gain=0.5)).value(-4.0) == -2.0


def test_forces_and_moment_of_any_number_of_thrusters():
    vehicle = Vehicle.model_validate(
        {
            "name": "v",
            "hull": {"mass": 1},
            "thrusters": [
                {"name": "a", "position": [-1.0, -0.5], "gain": 1.0},
                {"name": "b", "position": [-1.0, 0.5], "gain": 1.0},
                {"name": "c", "position": [2.0, 0.0], "azimuth": np.pi / 2, "gain": 1.0},
            ],
        }
    )
    thrusts = {
        t.name: ThrustCurve(t).interval(np.array([d])) for t, d in zip(vehicle.thrusters, (3.0, 1.0, 2.0), strict=True)
    }
    total = combine(vehicle, thrusts)
    # X = 3 + 1, Y = 2, N = 0.5 * 3 - 0.5 * 1 + 2 * 2
    for found, exact in ((total.X, 4.0), (total.Y, 2.0), (total.N, 5.0)):
        assert found.midpoint[0] == pytest.approx(exact) and found.width[0] < 1e-9
    assert total.X.contains([4.0]).all()


def test_a_line_is_recommended_for_a_straight_table_and_dead_bands_are_found():
    x = np.linspace(-10, 10, 41)
    assert "degree 1" in examine(x, 2 * x).recommended.name
    y = np.where(np.abs(x) < 3, 0.0, x)
    table = examine(x, y)
    assert table.dead_band == (-2.5, 2.5)
    assert table.recommended.name == "monotone table (PCHIP)"


def held(text, demand, thrust):
    from ivsid.vehicle import parse_vehicle

    unit = parse_vehicle(f'name = "b"\n[hull]\nmass = 1\n{text}', "b.toml").thrusters[0]
    return ThrustCurve(unit).interval(demand).contains(thrust).all()


def test_every_candidate_with_its_band_holds_the_bollard_data():
    """Table III, a PWM table with a dead band, and a noisy one: each candidate's text encloses every point, and no half of it does."""
    from ivsid.propulsion.bollard import PUBLISHED_CUBIC
    from ivsid.workflow.thrust_curves import candidate_toml

    rng = np.random.default_rng(1)
    pwm = np.arange(1100.0, 1901.0, 20)
    n = pwm - 1500
    tables = [
        (np.array(TABLE_III[0]), np.array(TABLE_III[1]), PUBLISHED_CUBIC),
        (pwm, np.where(abs(n) < 30, 0, np.where(n > 0, 3.1e-4, 2.4e-4) * n * abs(n)) * 9.80665, None),
        (np.linspace(-50, 50, 31), 0.02 * np.linspace(-50, 50, 31) ** 3 / 50 + rng.normal(0, 0.4, 31), None),
    ]
    for demand, thrust, published in tables:
        table = examine(demand, thrust, published)
        for fit in table.fits:
            text = candidate_toml(table, fit)
            assert held(text, demand, thrust), fit.name
            if fit.largest > 0.01:
                half = re.sub(r"absolute = \S+", f"absolute = {fit.band / 2!r}", text)
                assert half != text and not held(half, demand, thrust), fit.name


def test_the_published_cubic_misses_and_the_quadratic_finds_its_own():
    from ivsid.propulsion.bollard import PUBLISHED_CUBIC

    table = examine(np.array(TABLE_III[0]), np.array(TABLE_III[1]), PUBLISHED_CUBIC)
    cubic = table.fits[0]
    assert cubic.largest == pytest.approx(np.abs(np.polyval(PUBLISHED_CUBIC, TABLE_III[0]) - TABLE_III[1]).max())
    assert cubic.largest > 20 and table.recommended.name == "monotone table (PCHIP)"
    n = np.linspace(-10.0, 10.0, 21)
    exact = examine(n, np.where(n < 0, 0.3, 0.5) * n * abs(n))
    quadratic = next(f for f in exact.fits if f.quadratic)
    assert quadratic.quadratic == pytest.approx((0.5, 0.3)) and quadratic.largest < 1e-12


def test_held_demands_give_the_bits_of_single_ones():
    rng = np.random.default_rng(5)
    text = "{ demand = [15, 20, 40, 85], thrust = [4.654, 6.297, 14.463, 78.924] }\naccuracy = { absolute = 0.5, relative = 0.03 }\ndead_band = 20.0"
    unit = parse_vehicle(
        f'name = "b"\n[hull]\nmass = 1\n[[thrusters]]\nname = "m"\ntable = {text}\n', "b.toml"
    ).thrusters[0]
    demand = np.repeat(rng.uniform(0, 85, 40), rng.integers(1, 12, 40))
    held = ThrustCurve(unit).interval(demand, error=1e-9)
    for k, d in enumerate(demand):
        single = ThrustCurve(unit).interval(np.array([d]), error=1e-9)
        assert (held.lower[k], held.upper[k]) == (single.lower[0], single.upper[0])
    with pytest.raises(IvsidError, match="outside its table"):
        ThrustCurve(unit).interval(np.array([20.0, 85.1, 85.1, 85.1, 85.1]))
