"""Declared thrust errors as what they are: any curve inside the stated accuracy makes no finding, and one that leaves it is told."""

import os
from dataclasses import replace

import numpy as np
import pytest
from tests.exam.draw import case
from tests.exam.thrust_errors import SHAPES, with_errors

from diagnosis_logs import screened, train_of, vehicle_of
from ivsid import diagnose
from ivsid.diagnosis.estimation.declared_errors import through_water, thrust_answers
from ivsid.diagnosis.estimation.projection import Projection
from ivsid.diagnosis.plant.declared_curve import DeclaredCurve, ThrustAt
from ivsid.diagnosis.plant.thrust_errors import BOUNDED, BRANCHES, KNOTS, bound_of, thrust_errors, upward
from ivsid.log import Log
from ivsid.propulsion.thrust import ThrustCurve
from ivsid.vehicle import Thruster

SEED = int(os.environ.get("IVSID_SEED", "0"))


def log_of(made, name="1.csv"):
    return Log(name, "0" * 64, made.t, made.columns)


def calm(seed, family, share, **more):
    """A log in a tenth of the usual sea, where a thrust error stands out most."""
    return case(seed, what="none", thrust=family, share=share, style="rich", rate=10.0, ambient=0.2, **more)


# The first of each kind was named or called unknown while the declared errors were seven waves.
LOGS = (
    (924, "sawtooth"),
    pytest.param(927, "two_waves", marks=pytest.mark.nightly),
    # Nightly: the gate takes the family that jumps.
    pytest.param(932, "spline", marks=pytest.mark.nightly),
    pytest.param(937, "steps", marks=pytest.mark.nightly),
    pytest.param(923, "hump", marks=pytest.mark.nightly),
    pytest.param(904, "offset", marks=pytest.mark.nightly),
    pytest.param(943, "steps", marks=pytest.mark.nightly),
    pytest.param(930, "sawtooth", marks=pytest.mark.nightly),
)


@pytest.mark.parametrize(("seed", "family"), LOGS)
def test_a_curve_that_fills_its_accuracy_makes_no_finding(seed, family):
    c = calm(seed, family, 1.0, duration=600.0, train_alone=True)
    found = screened(c.vehicle, log_of(c.train))
    assert not found.passed and found.quiet


# Nightly: a whole diagnosis; the gate screens such a log.
@pytest.mark.nightly
def test_the_sentence_names_the_thruster_and_what_to_do():
    # 955 is told as a wrong thrust curve by name since the catalogue holds one, and 956 as one of port since one thruster alone is asked for.
    c = calm(958, "two_waves", 3.0, duration=300.0)
    result = diagnose(c.vehicle, log_of(c.train), log_of(c.test, "2.csv"))
    assert result.verdict == "unknown"
    text = result.findings[-1].description
    assert "by more than the stated accuracy" in text and "bollard test" in text
    assert any(t.name in text for t in c.vehicle.thrusters)


# Nightly: the rate over families, vehicles and seas that no one has looked at; 2 of 48 has a chance of 9 % at the stated 1 %.
@pytest.mark.nightly
@pytest.mark.slow
def test_false_alarms_are_rare_whatever_the_family():
    families = sorted(SHAPES)
    bad = []
    for seed in range(48):
        c = case(SEED + 5000 + seed, what="none", thrust=families[seed % len(families)], share=1.0, duration=300.0)
        result = diagnose(c.vehicle, log_of(c.train), log_of(c.test, "2.csv"))
        if result.verdict != "adequate":
            bad.append((SEED + 5000 + seed, families[seed % len(families)], [f.effect for f in result.findings]))
    # At the demanded 1 %, three or more of 48 have a chance of about 1 %.
    assert len(bad) <= 2, bad


# The fall of each was lost beside soft priors: half of the curve was taken by errors of twice their accuracy.
# The drawn bend of 9.5 % was half of the detection limit that the diagnosis states (19 %): the worst curve inside the accuracy makes it with
# noise that one log of a hundred has. It is 15 % here, still below the limit, and beside it the errors keep their bounds.
@pytest.mark.nightly
@pytest.mark.parametrize("seed", [310000])
def test_a_curve_that_bends_beyond_its_accuracy_is_named(seed):
    c = case(seed, what="one", effect="thruster.curve", size=1.5, duration=300.0)
    result = diagnose(c.vehicle, log_of(c.train), log_of(c.test, "2.csv"), null_logs=0)
    (one,) = result.findings
    assert "thruster.curve" in (one.effect, *one.alternatives)
    bound = one.parameters["thruster.curve"]
    assert bound.lower <= c.truth["thruster.curve"] <= bound.upper


@pytest.mark.parametrize("family", sorted(SHAPES))
def test_the_examiners_curves_fill_the_accuracy_and_do_not_leave_it(family):
    c = case(7, what="none", kind="twin", duration=30.0, style="rich", train_alone=True)
    true = with_errors(c.vehicle, family, 1.0, np.random.default_rng(3))
    for t, wrong in zip(c.vehicle.thrusters, true.thrusters, strict=True):
        curve = ThrustCurve(t)
        d = np.asarray(wrong.table.demand)
        off = np.abs(np.asarray(wrong.table.thrust) - curve.value(d))
        bound = np.minimum(t.accuracy.absolute + t.accuracy.relative * np.abs(curve.value(d)), np.abs(curve.value(d)))
        assert (off <= bound * (1 + 1e-9) + 1e-12).all()
        assert off.max() > 0.5 * bound[np.argmax(off)] > 0


def test_values_at_the_knots_are_the_error_in_units_of_its_bound():
    c = case(7, what="none", kind="twin", duration=30.0, style="rich", train_alone=True)
    t = c.vehicle.thrusters[0]
    curve = ThrustCurve(t.model_copy(update={"outside": "hold"}))
    d = np.linspace(-80.0, 90.0, 400)
    errors = thrust_errors(t, curve, d)
    rng = np.random.default_rng(1)
    at_knots = rng.uniform(-1, 1, len(errors.places))
    sizes = np.linalg.solve(errors.knots, at_knots)
    error = sizes @ errors.at(d)[: sizes.size]
    bound = bound_of(t, curve, d)
    assert (np.abs(error) <= bound * (1 + 1e-9)).all()
    np.testing.assert_allclose(error, bound * np.interp(d, np.linspace(-80, 90, at_knots.size), at_knots), atol=1e-9)
    # Beforehand the error at any knot has the stated deviation, and neighbours go together.
    covariance = errors.knots * errors.spreads[: sizes.size] ** 2 @ errors.knots.T
    np.testing.assert_allclose(np.diag(covariance), BOUNDED**2)
    assert covariance[0, 1] > 0.5 * BOUNDED**2 > covariance[0, -1]


def test_a_thrust_that_should_be_none_has_the_absolute_accuracy():
    """Identification and the vehicle file know no other bound: absolute + relative |T| at every demand."""
    given = {"name": "a", "position": [0.0, 0.0], "azimuth": 0.0, "gain": 0.5, "dead_band": 4.0}
    t = Thruster.model_validate({**given, "accuracy": {"absolute": 0.4, "relative": 0.1}})
    curve, demand = ThrustCurve(t), np.array([-20.0, -5.0, -1.0, 0.0, 2.0, 6.0])
    interval = curve.interval(demand)
    half = 0.5 * (interval.upper - interval.lower)
    np.testing.assert_allclose(bound_of(t, curve, demand), half, rtol=1e-9, atol=1e-9)
    assert bound_of(t, curve, np.zeros(1))[0] == 0.4


def test_the_total_of_errors_is_the_sum_of_each_by_its_size():
    c = case(7, what="none", kind="twin", duration=30.0, style="rich", train_alone=True)
    t = c.vehicle.thrusters[0]
    rng = np.random.default_rng(2)
    d = np.repeat(rng.uniform(-80.0, 90.0, 60), 5)
    curve = ThrustCurve(t.model_copy(update={"outside": "hold"}))
    errors = thrust_errors(t, curve, d)
    sizes = rng.standard_normal(len(errors.spreads))
    # Also at demands in another order, whose branches are others.
    for at in (d, d[::-1]):
        total = errors.total(at, sizes, bound_of(t, curve, at))
        np.testing.assert_allclose(total, sizes @ errors.at(at), rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize(
    "curve",
    [
        {"table": {"demand": [-80.0, -30.0, 0.0, 20.0, 90.0], "thrust": [-40.0, -12.0, 0.0, 9.0, 70.0], "unit": "N"}},
        {"table": {"demand": [20.0, 50.0, 90.0], "thrust": [5.0, 30.0, 70.0], "unit": "N"}},
        {"table": {"demand": [-80.0, 90.0], "thrust": [-40.0, 50.0], "unit": "N"}},
        {"gain": 0.6},
    ],
)
def test_thrusts_with_errors_are_the_curve_and_the_errors(curve):
    thruster = {"name": "a", "position": [0.0, 0.0], "azimuth": 0.0, "accuracy": {"absolute": 1.0, "relative": 0.05}}
    t = Thruster.model_validate({**thruster, "neutral": 3.0, "outside": "hold", **curve})
    of = ThrustCurve(t)
    d = np.repeat(np.random.default_rng(5).uniform(-85.0, 95.0, 60), 5)
    errors = thrust_errors(t, of, d)
    worked = DeclaredCurve(t, of, errors)
    np.testing.assert_allclose(worked.thrust(d), of.value(d + 3.0), rtol=1e-13, atol=1e-13)
    # Without the hysteresis as well.
    for sizes in (np.arange(len(errors.spreads)) - 7.0, np.arange(len(errors.spreads)) * (errors.spreads > 0.4)):
        expected = of.value(d + 3.0) + sizes @ errors.at(d)
        np.testing.assert_allclose(worked.thrust(d, sizes), expected, rtol=1e-12, atol=1e-12)
        np.testing.assert_allclose(ThrustAt(worked, d, kept=True).pushed(sizes), expected, rtol=1e-12, atol=1e-12)


def test_the_smoothest_functions_of_a_hysteresis_change_sign_with_the_side_of_a_demand():
    c = case(7, what="none", kind="twin", duration=30.0, style="rich", train_alone=True)
    t = c.vehicle.thrusters[0]
    curve = ThrustCurve(t.model_copy(update={"outside": "hold"}))
    d = np.r_[np.linspace(-80.0, 90.0, 200), np.linspace(90.0, -80.0, 200)]
    errors = thrust_errors(t, curve, d)
    assert len(errors.names("a")) == len(errors.spreads) == len(errors.at(d)) == KNOTS + BRANCHES
    sides = errors.at(d)[KNOTS:]
    rising, falling = sides[:, :200], sides[:, 200:][:, ::-1]
    np.testing.assert_allclose(rising[:, 1:-1], -falling[:, 1:-1], atol=1e-12)
    # They hold nearly all of a hysteresis that is the same share of the bound everywhere.
    whole = bound_of(t, curve, d) * np.where(upward(d), 1.0, -1.0)
    left = whole - sides.T @ np.linalg.lstsq(sides.T, whole, rcond=None)[0]
    assert left @ left < 0.02 * whole @ whole
    # A demand that never changes has one branch, and a thruster without a stated accuracy has no error.
    assert errors.names("a")[0] == "~thrust.a.0" and errors.names("a")[-1] == f"~hysteresis.a.{BRANCHES - 1}"
    assert len(thrust_errors(t, curve, np.full(5, 20.0)).spreads) == 1


def test_a_hysteresis_inside_its_accuracy_is_no_noise():
    """Beside the base of a fit hardly anything is left of it, nor of its share in the ambient force that is learnt."""
    vehicle = vehicle_of()
    fit = screened(vehicle, train_of(vehicle, duration=120.0)).fit
    s, bounds = fit.signatures, fit.noise.predictor.propulsion
    errors = s.predictor.driving.slopes(
        s.h,
        0,
        lambda d: (bound_of(s.predictor.vehicle.thrusters[0], bounds.curves[0], d) * np.where(upward(d), 1, -1))[None],
    )
    (answer,) = thrust_answers(s, 0, errors, through_water(s))
    g = fit.gram.extended(["wrong"], [answer])
    p = Projection(replace(g, prior=np.zeros(len(g.names))), fit.base)
    k = g.index["wrong"]
    assert p.information([k])[0, 0] < 0.1


def test_the_direction_of_a_demand_is_that_of_its_last_change():
    d = np.array([3.0, 3.0, 4.0, 4.0, 2.0, 2.0, 5.0])
    assert upward(d).tolist() == [True, True, True, True, False, False, True]
    assert upward(np.ones(3)).all() and upward(-d).tolist() == [True, True, False, False, True, True, False]
