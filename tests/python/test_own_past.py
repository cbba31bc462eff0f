"""Falls of chi-squared beside the log's own past errors: least squares with all of them, and no cause that is a filter of coloured noise."""

import itertools
from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import lstsq
from scipy.signal import lfilter
from tests.exam.cases import case

from diagnosis_logs import STRAIGHT, screened, train_of, vehicle_of
from ivsid.diagnosis.candidates.families import everything, score
from ivsid.diagnosis.data.channels import channels
from ivsid.diagnosis.estimation.learning import plain_fit
from ivsid.diagnosis.null import family_wise
from ivsid.diagnosis.null.own_past import OwnPast
from ivsid.diagnosis.null.screening import ANY_CURVE, CLOSER_CURVE, OWN_PAST
from ivsid.log import Log
from ivsid.vehicle import parse_vehicle

DRAWS = 60
# Numerators and denominators of recursions: white, and a narrow band of which a few lags tell the next value.
COLOURS = {"white": ([1.0], [1.0]), "swell": ([1.0], [1.0, -1.9, 0.95])}


@pytest.fixture(scope="module")
def logged():
    vehicle = vehicle_of()
    return screened(vehicle, train_of(vehicle))


def by_row(fit, x):
    """Numbers of blocks as rows, shape (..., rows, n)."""
    rows = len(fit.noise.predictor.labels)
    parts = x.reshape(*x.shape[:-1], rows, fit.gram.length)
    return np.moveaxis(parts, -2, -3).reshape(*x.shape[:-2], rows, -1)


def by_block(fit, x):
    """The inverse of ``by_row``."""
    parts = x.reshape(*x.shape[:-1], -1, fit.gram.length)
    return np.moveaxis(parts, -3, -2).reshape(*x.shape[:-2], parts.shape[-2], -1)


def with_errors(fit, rows):
    """The fit to whitened errors, shape (rows, n)."""
    g, y = fit.gram, by_block(fit, rows)
    score = np.concatenate([np.einsum("cbi,bi->bc", part, y) for part in g.parts], axis=1)
    made = replace(g, y=y, score=score, energy=(y**2).sum(axis=1), centre=np.zeros_like(g.centre))
    return replace(fit, gram=made)


def with_cause(fit, like, column):
    """The fit with a further column, and a cause that is it."""
    x = by_block(fit, column)
    size = np.linalg.norm(x)
    made = fit.gram.joined(["it"], (x / size)[None], np.array([size]))
    at = (len(fit.gram.names),)
    fall = replace(fit, gram=made).projection.solve(at)[1]
    return replace(fit, gram=made), replace(like, columns=at, fall=fall)


def linear(logged):
    """Scores with one column over the whole log, of as many kinds as there are."""
    return [s for s in logged.scores if len(s.columns) == 1 and not s.candidate.starts]


def test_the_falls_are_those_of_least_squares_with_every_past_error(logged):
    """The oracle solves the whole log in one dense problem, priors as rows, without any cross-product."""
    fit = logged.fit
    g, rows = fit.gram, len(fit.noise.predictor.labels)
    base, y = by_row(fit, g.columns(fit.base)), by_row(fit, g.y)
    prior = np.sqrt(g.prior[list(fit.base)])
    known = prior * g.centre[list(fit.base)]

    def solved(columns, priors, known, past=()):
        A = np.concatenate([columns, past]) if len(past) else columns
        A = A.reshape(len(A), -1).T
        soft = np.zeros((len(priors), A.shape[1]))
        soft[:, : len(priors)] = np.diag(priors)
        A, right = np.vstack([A, soft]), np.r_[y.ravel(), -known]
        x = lstsq(A, right)[0]
        return float(np.sum((right - A @ x) ** 2)), y - np.tensordot(x[: len(columns)], columns, 1)

    def past_of(errors):
        past = []
        for group in fit.noise.whitening.groups:
            for i, j, lag in itertools.product(group, group, range(1, 25)):
                x = np.zeros((rows, y.shape[1]))
                x[i, lag:] = errors[j, :-lag]
                x[i, errors[i] == 0.0] = 0.0
                past.append(x)
        return np.array(past)

    plain = base, prior, known
    without = past_of(solved(*plain)[1])
    # The number of past errors is that of the rows, which are whitened with others or alone.
    assert len(without) >= 24 * rows
    least = solved(*plain, without)[0]
    own = OwnPast(fit)
    for s in linear(logged)[::6]:
        soft = np.sqrt(g.prior[list(s.columns)])
        both = np.concatenate([base, by_row(fit, g.columns(s.columns))]), np.r_[prior, soft], np.r_[known, 0.0 * soft]
        assert own.fall(s) == pytest.approx(least - solved(*both, without)[0], rel=1e-4, abs=1e-3), s.id


# Nightly: white errors, in which any filter is as good as another.
@pytest.mark.parametrize("colour", [pytest.param(c, marks=[pytest.mark.nightly] * (c == "white")) for c in COLOURS])
def test_a_filter_of_coloured_errors_explains_nothing_beside_them(logged, colour):
    """A state that an ambient force pushes: its slope is a filter of past errors, and any noise with a colour correlates with it."""
    top, below = COLOURS[colour]
    fit, like = logged.fit, linear(logged)[0]
    rows = len(fit.noise.predictor.labels)
    without, beside = [], []
    for seed in range(DRAWS):
        drawn = np.random.default_rng(seed).standard_normal((rows, fit.gram.y.size // rows + 300))
        y = lfilter(top, below, drawn, axis=1)[:, 300:]
        y /= y.std()
        column = np.zeros_like(y)
        # The slope of a leaky sum of the past errors of one row.
        column[0, 2:] = np.diff(lfilter([0.0, 1.0], [1.0, -0.8], y[0]))[1:]
        made, s = with_cause(with_errors(fit, y), like, column)
        without.append(s.fall)
        beside.append(OwnPast(made).fall(s))
    without, beside = np.array(without), np.array(beside)
    assert (np.median(without) > 25.0) == (colour == "swell")
    # Chi-squared of one degree of freedom: its mean is 1 and its variance 2.
    assert np.mean(beside) < 1.0 + 4.0 * np.sqrt(2.0 / DRAWS) and beside.max() < 15.0


def shares_kept(logged, past):
    """What causes of ten standard deviations, that follow the programme, keep of them beside a past."""
    rng = np.random.default_rng(4)
    kept = []
    for s in linear(logged)[::5]:
        own = by_row(logged.fit, logged.fit.gram.columns(s.columns))[0]
        information = float(logged.fit.projection.information(list(s.columns))[0, 0])
        drawn = rng.standard_normal(own.shape)
        fit = with_errors(logged.fit, drawn + 10.0 / np.sqrt(information) * own)
        kept.append(np.sqrt(past(fit).fall(s) / fit.projection.solve(s.columns)[1]))
    return kept


def test_a_cause_that_is_there_stands_beside_the_past(logged):
    """It keeps nine tenths of its standard deviations."""
    kept = shares_kept(logged, OwnPast)
    assert len(kept) > 5 and np.median(kept) > 0.9 and min(kept) > 0.75


def test_means_that_count_alone_foretell_nothing():
    """On a straight course sway counts by its means over seconds, which the rows hold many times: a wind of 64 in chi-squared kept 14."""
    vehicle = vehicle_of()
    fit, scored = score(plain_fit(vehicle, channels(train_of(vehicle, segments=STRAIGHT), vehicle), everything))
    assert fit.noise.whitening.slow
    rows = by_row(fit, fit.gram.y)
    drawn = np.random.default_rng(7).standard_normal(rows.shape) * (rows != 0.0)
    for k in fit.noise.whitening.slow:
        span = fit.noise.whitening.span
        held = drawn[k, : drawn.shape[1] // span * span].reshape(-1, span)
        drawn[k, : held.size] = np.repeat(held[:, 0] / np.sqrt(span), span)
    wind = next(s for s in scored if s.id == "wind.steady")
    own = by_row(fit, fit.gram.columns(wind.columns))[0]
    information = float(fit.projection.information(list(wind.columns))[0, 0])
    there = with_errors(fit, drawn * (rows != 0.0) + 10.0 / np.sqrt(information) * own)
    assert OwnPast(there).fall(wind) > 0.8 * there.projection.solve(wind.columns)[1] > 50.0


@pytest.mark.nightly
@pytest.mark.parametrize("seed", [192029, 192039, 196096])
def test_a_swell_is_no_late_velocity(seed, monkeypatch):
    """Sound logs in narrow seas, whose velocities lagged by milliseconds with 6 to 8 standard deviations."""
    c = case(seed, what="none", sea="any", sensors="any")
    vehicle = parse_vehicle(c.text, "v.toml")
    train = Log("1.csv", "0" * 64, c.logs[0]["t"], {k: x for k, x in c.logs[0].items() if k != "t"})
    found = screened(vehicle, train)
    assert found.passed == [] and found.quiet
    # Curves are asked beside the log's own past as well.
    without = tuple(r for r in family_wise.SCREENING if r not in (OWN_PAST, ANY_CURVE, CLOSER_CURVE))
    monkeypatch.setattr(family_wise, "SCREENING", without)
    assert "sensor.velocity.delay" in screened(vehicle, train).passed
