"""Past errors over some correlation times, and large ones apart: gusts that begin at once are no noise of a linear filter."""

import numpy as np
import pytest
from scipy.signal import lfilter
from tests.exam.cases import case

from diagnosis_logs import logs_of_case, screened, train_of, vehicle_of
from ivsid.diagnosis.candidates.families import everything
from ivsid.diagnosis.data.channels import channels
from ivsid.diagnosis.estimation.learning import plain_fit
from ivsid.diagnosis.null import leaving
from ivsid.diagnosis.null.long_past import LongPast
from ivsid.diagnosis.null.own_past import OwnPast
from ivsid.diagnosis.selection.structure import RISK
from ivsid.vehicle import parse_vehicle
from test_own_past import linear, shares_kept, with_cause, with_errors

DRAWS = 20


@pytest.fixture(scope="module")
def logged():
    vehicle = vehicle_of()
    return screened(vehicle, train_of(vehicle))


def gusts(rng, n):
    """What the best autoregression of twelve lags leaves of a force that jumps between a few strengths, beside white noise."""
    force, at = np.zeros(n), 0
    while at < n:
        count = 1 + int(rng.exponential(60.0))
        force[at : at + count] = 4.0 * rng.choice([0.0, 0.0, 1.0, 1.6])
        at += count
    y = force + rng.standard_normal(n)
    past = np.stack([*(np.r_[np.zeros(k), y[:-k]] for k in range(1, 13)), np.ones(n)])
    left = y - np.linalg.lstsq(past.T, y, rcond=None)[0] @ past
    return left / left.std()


def answer(y):
    """A demand that a feedback sets by the large errors of its readings."""
    return lfilter([0.0, 1.0], [1.0, -0.8], np.where(np.abs(y) > 2.0, y, 0.0))


@pytest.mark.parametrize("sea", ["gusts", "white"])
def test_a_curve_of_large_past_errors_explains_nothing_beside_them(logged, sea):
    """Errors that no linear filter foretells are foretold by their size: a thrust error by such a demand stood out by 10 standard deviations."""
    fit, like = logged.fit, linear(logged)[0]
    rows = len(fit.noise.predictor.labels)
    n = fit.gram.y.size // rows
    without, linear_past, beside = [], [], []
    for seed in range(DRAWS):
        rng = np.random.default_rng(seed)
        y = rng.standard_normal((rows, n))
        if sea == "gusts":
            y[0] = gusts(rng, n)
        column = np.zeros_like(y)
        column[0] = answer(y[0])
        made, s = with_cause(with_errors(fit, y), like, column)
        without.append(s.fall)
        linear_past.append(OwnPast(made).fall(s))
        beside.append(LongPast(made).fall(s))
    assert (min(np.median(without), np.median(linear_past)) > 25.0) == (sea == "gusts")
    # The answer counts errors as large that the product does not, so that little of it is left; white noise leaves chi-squared of one degree of freedom.
    assert np.mean(beside) < (0.1 * np.mean(linear_past) if sea == "gusts" else 1.0 + 4.0 * np.sqrt(2.0 / DRAWS))
    assert max(beside) < 25.0


def test_a_cause_that_is_there_stands_beside_them(logged):
    kept = shares_kept(logged, LongPast)
    assert len(kept) > 5 and np.median(kept) > 0.85 and min(kept) > 0.6


# Nightly: a second catamaran, with a hysteresis.
@pytest.mark.parametrize("seed", [258615, pytest.param(258352, marks=pytest.mark.nightly)])
def test_gusts_that_push_and_turn_at_once_move_no_thrust_out_of_its_bounds(seed, monkeypatch):
    """An autopilot on a circle answers gusts along all axes, in ten times the usual sea: errors were fitted at 4 to 6 times their accuracy."""
    c = case(seed, what="none", sea="any", sensors="any")
    vehicle = parse_vehicle(c.text, "v.toml")
    fit = plain_fit(vehicle, channels(logs_of_case(c)[0], vehicle), everything)
    others = leaving.Others(fit)
    assert leaving.chdtrc(*reversed(leaving.thrusts(others)[:2])) > RISK
    monkeypatch.setattr(leaving, "LongPast", OwnPast)
    monkeypatch.setattr(leaving, "spectrum", lambda *_: None)
    assert leaving.chdtrc(*reversed(leaving.thrusts(others)[:2])) < RISK
