"""Causes that imitate a force of another shape: a curve in their place against dense least squares, the rule, and whole logs."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.exam.cases import case

from diagnosis_logs import TWIN, logs_of_case, train_of, vehicle_of
from ivsid import diagnose
from ivsid.diagnosis.candidates.families import everything
from ivsid.diagnosis.data.channels import channels
from ivsid.diagnosis.estimation.learning import plain_fit
from ivsid.diagnosis.estimation.projection import Projection
from ivsid.diagnosis.selection import speed_curves as speed_curves_module
from ivsid.diagnosis.selection.force_rules import BETTER_CURVE, Curve
from ivsid.diagnosis.selection.in_their_place import Without
from ivsid.diagnosis.selection.speed_curves import SPEEDS, speed_curves
from ivsid.vehicle import parse_vehicle
from test_one_force import CAUSES, FORCES, MODEL, gram_of, least


def case_of(fall, alone, directions=9):
    return Curve(("drag.surge.linear",), fall, 1, "any function of u in surge", alone, directions=directions)


@given(st.integers(0, 10**6))
@settings(max_examples=40, deadline=None)
def test_the_curves_fall_is_that_of_all_its_columns(seed):
    rng = np.random.default_rng(seed)
    x, y = rng.standard_normal((80, 7)) * rng.uniform(0.1, 10.0, 7), rng.standard_normal(80)
    held = rng.standard_normal(2)
    g = gram_of(x, y - x[:, CAUSES] @ held)
    alone, left, directions = Without(Projection(g, MODEL), CAUSES, held * g.unit[list(CAUSES)]).by_curve(FORCES)
    bare, curve = least(x, y, [*MODEL]), least(x, y, [*MODEL, *FORCES])
    assert directions == len(FORCES)
    assert alone == pytest.approx(bare - curve, rel=1e-5, abs=1e-6)
    assert left == pytest.approx(curve - least(x, y, [*MODEL, *FORCES, *CAUSES]), rel=1e-5, abs=1e-6)


def test_columns_that_say_the_same_count_once():
    rng = np.random.default_rng(3)
    x, y = rng.standard_normal((80, 7)), rng.standard_normal(80)
    x[:, FORCES[2]] = x[:, FORCES[0]] - x[:, FORCES[1]]
    g = gram_of(x, y)
    alone, _, directions = Without(Projection(g, MODEL), CAUSES, np.zeros(2)).by_curve(FORCES)
    assert directions == 2
    assert alone == pytest.approx(least(x, y, [*MODEL]) - least(x, y, [*MODEL, *FORCES[:2]]), rel=1e-5)


def test_the_true_shape_is_beaten_by_chance_once_in_a_thousand():
    rng = np.random.default_rng(4)
    refused = sum(
        BETTER_CURVE.refuses(case_of(100.0, 100.0 + x)) is not None for x in rng.chisquare(8, 20_000).tolist()
    )
    assert 8 <= refused <= 36
    assert BETTER_CURVE.refuses(case_of(2000.0, 2035.0)) is None
    assert "any function of u in surge explains 2060" in BETTER_CURVE.refuses(case_of(2000.0, 2060.0)).sentence


@pytest.fixture(scope="module")
def fit():
    vehicle = vehicle_of(TWIN)
    return plain_fit(vehicle, channels(train_of(vehicle), vehicle), everything)


def test_a_sea_without_a_force_leaves_columns_of_unit_length(fit):
    """A length of zero would make every product of a column no number."""
    predictor = fit.noise.predictor
    calm = predictor.adopt(replace(predictor.ambient, deviation=(0.0, 0.0, 0.0)))
    _, x, unit, groups = speed_curves(replace(fit, noise=replace(fit.noise, predictor=calm)))
    assert groups and (unit > 0).all() and np.isfinite(x).all()
    np.testing.assert_allclose((x**2).sum(axis=(1, 2)), 1.0, rtol=1e-6)


def said(seed, effect, what):
    c = case(seed, duration=300.0, what=what, effect=effect)
    return diagnose(parse_vehicle(c.text, "vehicle.toml"), *logs_of_case(c))


# Nightly: whole diagnoses; the gate finds a hump of the catalogue's outline in test_hump.py.
@pytest.mark.nightly
@pytest.mark.parametrize("seed", [95100, 95102, 95103, 95107])
def test_a_hump_of_another_outline_is_a_hump_and_no_other_drag(seed):
    """A normal curve in the examiner's hands; the catalogue's falls off as the square of a hyperbolic secant."""
    result = said(seed, "x.hump", "outside")
    named, *others = [f.effect for f in result.findings]
    assert named == "drag.surge.hump" and others in ([], ["unknown"])
    # No interval holds numbers that a hump cannot have.
    assert all(b.lower >= 0.0 for b in result.findings[0].parameters.values())


@pytest.mark.nightly
@pytest.mark.parametrize("seed", [95100, 95103])
def test_a_thrust_curve_may_make_what_a_function_adds_to_a_cubic_drag(seed, without_hump):
    """Beside any thrust curve inside its accuracy the function of u explains 16 and 7 more in chi-squared: no more than its further numbers do by chance."""
    assert [f.effect for f in said(seed, "x.hump", "outside").findings] == ["drag.surge.cubic"]


@pytest.mark.nightly
@pytest.mark.parametrize("seed", [95102, 95107])
def test_a_force_of_one_velocity_that_the_catalogue_lacks_is_no_drag(seed, without_hump):
    result = said(seed, "x.hump", "outside")
    assert [f.effect for f in result.findings] == ["unknown"]
    assert any(r.refusal.rule == "better curve" for r in result.rejected)


@pytest.mark.parametrize(
    ("seed", "effect"),
    [
        # Nightly: whole diagnoses; the gate has one that names a hump.
        pytest.param(95204, "drag.surge.cubic", marks=pytest.mark.nightly),
        *(pytest.param(95201, f"drag.surge.{k}", marks=pytest.mark.nightly) for k in ("cubic", "linear")),
    ],
)
def test_a_drag_of_the_catalogue_keeps_its_name(seed, effect):
    assert [f.effect for f in said(seed, effect, "one").findings] == [effect]


def test_no_function_follows_the_error_of_a_velocity():
    """Straight stretches between turns: quantiles of the sway velocity lie within its error there, and most of the turns have none."""
    rng = np.random.default_rng(5)
    straight, turns = 1e-3 * rng.standard_normal(9000), rng.uniform(0.1, 0.4, 3000)
    velocity = np.r_[straight, turns]
    quantiles = np.quantile(velocity, np.linspace(0.0, 1.0, SPEEDS))
    assert np.diff(quantiles).min() < 6 * 1e-3
    for apart in (6e-3, 0.05):
        places = speed_curves_module._places(velocity, apart)
        assert np.diff(places).min() > max(apart, 0.5 * np.ptp(velocity) / (SPEEDS - 1))
        # Every quantile is a value or lies close above one, and the first is one.
        assert places[0] == velocity.min() and {*places} <= {*quantiles}
        below = places[np.searchsorted(places, quantiles, side="right") - 1]
        assert (quantiles - below).max() <= max(apart, 0.5 * np.ptp(velocity) / (SPEEDS - 1))
    # Velocities as far apart as even ones all stay.
    even = np.linspace(-1.0, 1.0, 17)
    np.testing.assert_allclose(speed_curves_module._places(even, 1e-3), np.quantile(even, np.linspace(0, 1, SPEEDS)))


# Nightly: a whole diagnosis.
@pytest.mark.nightly
def test_a_drag_keeps_its_name_where_the_vessel_mostly_keeps_straight(monkeypatch):
    """A steered vessel with a cubic drag of 26 standard deviations, which a function between values 1 mm/s apart beat by 54."""
    c = case(174040)
    vehicle = parse_vehicle(c.text, "vehicle.toml")
    logs = logs_of_case(c)
    assert [f.effect for f in diagnose(vehicle, *logs).findings] == ["drag.sway.cubic"]
    monkeypatch.setattr(speed_curves_module, "APART", 0.0)
    monkeypatch.setattr(speed_curves_module, "EVENLY", 0.0)
    assert [f.effect for f in diagnose(vehicle, *logs).findings] == ["unknown"]


# Nightly: a whole diagnosis; the gate has one that finds a curve, and one that finds none.
@pytest.mark.nightly
def test_velocities_of_a_few_values_have_no_curve_and_other_forces_are_asked(monkeypatch):
    """A sensor of few bits: beside nine speeds that are one there is no function to fit, and the cause keeps its name."""
    monkeypatch.setattr(
        "ivsid.diagnosis.selection.speed_curves.through_water",
        lambda s: tuple(np.round(q / np.ptp(q)) for q in s.states.points.nu),
    )
    assert [f.effect for f in said(95204, "drag.surge.cubic", "one").findings] == ["drag.surge.cubic"]
