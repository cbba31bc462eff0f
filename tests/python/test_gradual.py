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
from ivsid.diagnosis.null.family_wise import Threshold
from ivsid.diagnosis.null.gradual import abrupt, gradual, gradual_forces, shapes
from ivsid.diagnosis.null.thresholds import calibrate
from ivsid.diagnosis.null.visibility import visibility
from ivsid.vehicle import parse_vehicle


def drawn(seed, **given):
    c = case(seed, **given)
    return parse_vehicle(c.text, "v.toml"), *logs_of_case(c)


def test_the_fall_is_that_of_the_best_gradual_force_by_least_squares():
    """The oracle solves the whole log with each force, priors as rows, and knows of no blocks but their middles."""
    vehicle = vehicle_of()
    fit = plain_fit(vehicle, channels(train_of(vehicle, duration=120.0), vehicle), everything)
    g = fit.gram
    base = g.columns(fit.base).reshape(len(fit.base), -1)
    soft = np.diag(np.sqrt(g.prior[list(fit.base)]))
    right = np.r_[g.y.ravel(), -soft @ g.centre[list(fit.base)]]

    def chi2(more):
        A = np.vstack([np.vstack([base, *more]).T, np.hstack([soft, np.zeros((len(soft), len(more)))])])
        return float(np.sum((right - A @ lstsq(A, right)[0]) ** 2))

    least, (names, x, unit) = chi2([]), gradual_forces(fit)
    steps = [s for s in score(fit)[1] if s.candidate.starts]
    assert steps and len(names) % 5 == 0 and len(names) >= 15
    for s in steps:
        column = g.columns(s.columns)[0]
        slow = [np.repeat(w, column.shape[1]).reshape(column.shape) * column for w in shapes(len(g.blocks))]
        falls = [least - chi2([w.reshape(1, -1)]) for w in slow]
        signed = s.candidate.effect.parameters[s.candidate.number].signed
        assert gradual(fit, s) <= max(falls) * (1 + 1e-6) + 1e-6
        if signed:
            assert gradual(fit, s) == pytest.approx(max(falls), rel=1e-5)
    assert x[0].shape == g.y.shape and np.all(unit > 0)
    # The approach over a tenth of the log, in the middle of the first of 24 blocks.
    first = shapes(24)[0]
    assert first[0] == pytest.approx(1 - np.exp(-10 / 48)) and first[-1] > 0.99 and np.all(np.diff(first) > 0)


@pytest.mark.parametrize(("what", "effect"), [("outside", "x.heat"), ("one", "thruster.failure")])
def test_a_motor_that_grows_warm_does_not_fail_at_a_time(what, effect):
    vehicle, train, _ = drawn(203001, what=what, effect=effect, kind="twin", style="rich", duration=300.0, ambient=1.0)
    fit, scored = score(plain_fit(vehicle, channels(train, vehicle), everything))
    shown = visibility(fit)
    tested = frozenset(i for i, v in shown.items() if v.tested)
    found = Threshold(calibrate(fit, tested, 0.005, 1), shown)(fit, scored)
    failure = next(s for s in scored if s.id == "thruster.failure")
    assert failure.fall > 100.0 and abrupt(fit, failure) == (what == "one")
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
