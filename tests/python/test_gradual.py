"""Forces that come gradually: least squares with each of them, and motors that grow warm, which fail at no time."""

import numpy as np
import pytest
from scipy.linalg import lstsq
from tests.exam.cases import case

from diagnosis_logs import logs_of_case, train_of, vehicle_of
from ivsid import diagnose
from ivsid.diagnosis.candidates.families import everything, score
from ivsid.diagnosis.data.channels import channels
from ivsid.diagnosis.estimation.learning import plain_fit
from ivsid.diagnosis.null.any_curve import AnyCurve
from ivsid.diagnosis.null.family_wise import Threshold
from ivsid.diagnosis.null.gradual import beyond_step, gradual, gradual_forces, shapes
from ivsid.diagnosis.null.thresholds import calibrate
from ivsid.diagnosis.null.visibility import visibility
from ivsid.vehicle import parse_vehicle


def drawn(seed, **given):
    c = case(seed, **given)
    return parse_vehicle(c.text, "v.toml"), *logs_of_case(c)


def least_squares(g, at):
    """Chi-squared of a base with further columns, priors as rows."""
    base = g.columns(at).reshape(len(at), -1)
    soft = np.diag(np.sqrt(g.prior[list(at)]))
    right = np.r_[g.y.ravel(), -soft @ g.centre[list(at)]]

    def chi2(more):
        A = np.vstack([np.vstack([base, *more]).T, np.hstack([soft, np.zeros((len(soft), len(more)))])])
        return float(np.sum((right - A @ lstsq(A, right)[0]) ** 2))

    return chi2


def slow_columns(g, s):
    """The column of a step times each gradual shape."""
    column = g.columns(s.columns)[0]
    return [
        (np.repeat(w, column.shape[1]).reshape(column.shape) * column).reshape(1, -1) for w in shapes(len(g.blocks))
    ]


def test_the_fall_is_that_of_the_best_gradual_force_by_least_squares():
    """The oracle solves the whole log with each force, priors as rows, and knows of no blocks but their middles."""
    vehicle = vehicle_of()
    fit = plain_fit(vehicle, channels(train_of(vehicle, duration=120.0), vehicle), everything)
    g = fit.gram
    chi2 = least_squares(g, fit.base)
    least, (names, x, unit) = chi2([]), gradual_forces(fit)
    steps = [s for s in score(fit)[1] if s.candidate.starts]
    assert steps and len(names) % 5 == 0 and len(names) >= 15
    for s in steps:
        falls = [least - chi2([w]) for w in slow_columns(g, s)]
        signed = s.candidate.effect.parameters[s.candidate.number].signed
        assert gradual(fit, s) <= max(falls) * (1 + 1e-6) + 1e-6
        if signed:
            assert gradual(fit, s) == pytest.approx(max(falls), rel=1e-5)
    assert x[0].shape == g.y.shape and np.all(unit > 0)
    # The approach over a tenth of the log, in the middle of the first of 24 blocks.
    first = shapes(24)[0]
    assert first[0] == pytest.approx(1 - np.exp(-10 / 48)) and first[-1] > 0.99 and np.all(np.diff(first) > 0)


def test_beside_thrust_curves_the_step_and_the_gradual_force_stand_by_least_squares():
    vehicle = vehicle_of()
    fit = plain_fit(vehicle, channels(train_of(vehicle, duration=120.0), vehicle), everything)
    curve, g = AnyCurve(fit), fit.gram
    chi2 = least_squares(curve.g, range(len(curve.g.names)))
    least, steps = chi2([]), [s for s in score(fit)[1] if s.candidate.starts]
    assert steps
    for s in steps:
        step = g.columns(s.columns)[0]
        step[: s.first_block(g, fit.noise.predictor.log)] = 0.0
        signed = s.candidate.effect.parameters[s.candidate.number].signed
        falls = [least - chi2([w]) for w in (step.reshape(1, -1), *slow_columns(g, s))]
        if signed:
            assert beyond_step(curve, s) == pytest.approx(max(falls[1:]) - falls[0], rel=1e-4, abs=1e-4)
        else:
            assert -falls[0] - 1e-4 <= beyond_step(curve, s) <= max(falls[1:]) + 1e-4


def test_a_failure_that_errors_of_thrusts_make_look_gradual_starts_at_a_time():
    """Thrust errors in levels of the demand, which drifts over minutes, made a failure of a quarter of the usual size gradual by 30 in chi-squared."""
    result = diagnose(*drawn(263003, what="two"))
    assert [f.effect for f in result.findings] == ["drag.surge.sideslip", "thruster.failure"]


@pytest.mark.parametrize(("what", "effect"), [("outside", "x.heat"), ("one", "thruster.failure")])
def test_a_motor_that_grows_warm_does_not_fail_at_a_time(what, effect):
    vehicle, train, _ = drawn(203001, what=what, effect=effect, kind="twin", style="rich", duration=300.0, ambient=1.0)
    fit, scored = score(plain_fit(vehicle, channels(train, vehicle), everything))
    shown = visibility(fit)
    tested = frozenset(i for i, v in shown.items() if v.tested)
    found = Threshold(calibrate(fit, tested, 0.005, 1), shown)(fit, scored)
    failure = next(s for s in scored if s.id == "thruster.failure")
    assert failure.fall > 100.0 and found.round.abrupt(failure) == (what == "one")
    assert ("thruster.failure" in [p.id for p in found.passed]) == (what == "one")
    if what == "outside":
        assert found.refused["thruster.failure"].rule == "abrupt"


# Nightly: whole diagnoses; the gate screens such a log.
@pytest.mark.nightly
@pytest.mark.parametrize("seed", [201002, 201005])
def test_a_motor_that_grows_warm_is_no_cause_of_the_catalogue(seed):
    """A failing thruster, then an asymmetry with fouling and a battery that runs down stood for it."""
    result = diagnose(*drawn(seed, what="outside", effect="x.heat", sea="any", sensors="any"))
    assert [f.effect for f in result.findings] == ["unknown"]
