"""Dead bands between two values of the grid, and hypotheses each under declared errors that end at their own edges."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from tests.exam.cases import case

from diagnosis_logs import logs_of_case
from ivsid.diagnosis.candidates.families import everything
from ivsid.diagnosis.candidates.finer import _once, with_finer
from ivsid.diagnosis.data.channels import channels
from ivsid.diagnosis.estimation.columns import Columns
from ivsid.diagnosis.estimation.gauss_newton import improve
from ivsid.diagnosis.estimation.kinds.grid import GridCandidate
from ivsid.diagnosis.estimation.learning import plain_fit
from ivsid.diagnosis.estimation.problem import Problem
from ivsid.diagnosis.estimation.projection import Projection
from ivsid.diagnosis.selection.admission import _exact
from ivsid.effects import EFFECTS, Given
from ivsid.vehicle import parse_vehicle

BAND = EFFECTS["thruster.deadband"]


@cache
def fit_of(seed, **how):
    hidden = case(seed, duration=200.0, **how)
    vehicle, train = parse_vehicle(hidden.text, "vehicle.toml"), logs_of_case(hidden)[0]
    return plain_fit(vehicle, channels(train, vehicle), everything)


def candidate(fit):
    """The fit with columns at the values of the grid, and the candidate."""
    out = Columns()
    (made,) = GridCandidate.made(fit.signatures, BAND, out)
    return replace(fit, gram=fit.gram.extended(out.names, out.arrays)), made


def value_of(fit, s):
    """The value in the name of a score's column."""
    return float(fit.gram.names[s.columns[0]].rsplit("@", 1)[1])


@pytest.mark.parametrize(("seed", "least"), [(330423, 0.95), (330403, 0.5)])
def test_a_dead_band_anywhere_between_the_values_of_the_grid_keeps_its_fall(seed, least):
    """Prediction errors are those of a band and nothing else, so that its own column explains all that the model leaves.

    By values beside the best one of the grid alone the least share was 0.13 and 0.15.
    """
    fit, made = candidate(fit_of(seed, what="none"))
    shares = []
    for band in np.random.default_rng(3).uniform(min(made.values), 0.7 * max(made.values), 10).tolist():
        own = fit.signatures.secant(Given(BAND, (band,)))
        alike = replace(fit, gram=fit.gram.of(own))
        whole = Projection(alike.gram.extended(["own"], [own]), alike.base).solve([len(alike.gram.names)])[1]
        coarse = made.score(Projection(alike.gram, alike.base), alike.signatures)
        wide, (best,) = with_finer(alike, [coarse])
        # The column that joins is that of the best value, and the fall is its own.
        assert value_of(wide, best) == pytest.approx(best.values[0], rel=1e-5)
        assert Projection(wide.gram, wide.base).solve(best.columns)[1] == pytest.approx(best.fall, rel=1e-9)
        # What is searched counts.
        assert best.looks > coarse.looks + 0.3 * 12
        shares.append(best.fall / whole)
    assert len(shares) == 10 and least < min(shares) and max(shares) < 1.0 + 1e-6


def test_columns_of_several_causes_join_in_the_order_of_their_scores():
    """A band of all thrusters and one of a single thruster, each at the value of its own column; other causes are left as they are."""
    fit, made = candidate(fit_of(330423, what="none"))
    out, name = Columns(), fit.noise.predictor.vehicle.thrusters[0].name
    (alone,) = made.alone_on(fit.signatures, name, out)
    band = fit.signatures.secant(Given(BAND, (0.5 * (made.values[3] + made.values[4]),)))
    alike = replace(fit, gram=fit.gram.extended(out.names, out.arrays).of(band))
    lag = next(c for c in alike.candidates if c.effect.id == "thruster.lag")
    scores = [c.score(Projection(alike.gram, alike.base), alike.signatures) for c in (made, lag, alone)]
    wide, (one, kept, two) = with_finer(alike, scores)
    assert kept is scores[1]
    assert one.columns + two.columns == tuple(range(len(alike.gram.names), len(wide.gram.names)))
    p = Projection(wide.gram, wide.base)
    for best, coarse in ((one, scores[0]), (two, scores[2])):
        assert best.values != coarse.values and value_of(wide, best) == best.values[0]
        assert p.solve(best.columns)[1] == pytest.approx(best.fall, rel=1e-9)


def test_columns_of_any_blocks_have_the_products_of_the_whole_log():
    """Joined to the base as one block they stand as they do block by block, to rounding."""
    fit = fit_of(330423, what="none")
    names = ["one", "other"]
    x, unit = fit.gram.white.blocks(
        [fit.signatures.secant(Given(BAND, (v,))) for v in (20.0, 30.0)], fit.gram.good, fit.gram.length
    )
    one, each = fit.bare.joined(names, x, unit), fit.gram.only(fit.base).joined(names, x, unit)
    assert len(one.blocks) == 1 < len(each.blocks) and one.names == each.names
    np.testing.assert_allclose(one.total, each.total, rtol=0.0, atol=1e-12)
    np.testing.assert_allclose(one.score[0], each.score.sum(axis=0), rtol=1e-9, atol=1e-9 * np.sqrt(each.energy.sum()))
    at = range(len(fit.base), len(one.names))
    np.testing.assert_array_equal(one.columns(at).ravel(), each.columns(at).ravel())


def test_a_model_without_a_band_is_fitted_beside_errors_that_end_at_none():
    """Errors that jump where a band ends let a model without it follow the band that the log holds."""
    fit = fit_of(330410, what="one", effect=BAND.id, size=1.5)
    h = fit.h.with_effect(Given(BAND, (12.0,)))
    banded = improve(fit.problem.under(fit.states.under(h)), fit.states.under(h))
    problem = Problem.at(fit.noise, fit.fixed, banded)
    assert problem.edges == {(BAND.id, None, (12.0,))} and not fit.problem.edges
    plain = fit.problem.chi2(improve(fit.problem, fit.states, 6))
    assert _exact(problem, fit.states, "")[1] == pytest.approx(plain, abs=1.0)
    assert problem.chi2(improve(problem, fit.states, 6)) < plain - 25.0
    # Each is asked under its own errors, whichever problem is at hand.
    assert problem.under(banded) is problem
    assert problem.under(fit.states).chi2(fit.states) == pytest.approx(fit.problem.chi2(fit.states), abs=0.01)
    assert fit.problem.under(banded).chi2(banded) == pytest.approx(problem.chi2(banded), abs=0.01)


def test_a_band_takes_the_thrust_once():
    """With a column x and errors y = t x chi-squared falls by t^2 |x|^2 at t times the column, and by (2 t - 1) |x|^2 at once."""
    x = np.array([1.0, -2.0, 0.5])
    for t in (0.4, 1.0, 1.5, 3.0):
        y = t * x
        once = y @ y - (y - x) @ (y - x) if t > 1.0 else y @ y
        assert _once(float(y @ y), t) == pytest.approx(once)
