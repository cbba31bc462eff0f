"""What thrust curves and the noise make of a cause together: draws of both, a cause that neither alone makes, and a dense oracle."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import chi2

from diagnosis_logs import screened, train_of, vehicle_of
from ivsid.diagnosis.null.any_curve import AnyCurve
from ivsid.diagnosis.null.directions import Directions
from ivsid.diagnosis.null.inside_cells import FINER
from ivsid.diagnosis.null.own_past import OwnPast
from ivsid.diagnosis.null.round import Round
from ivsid.diagnosis.null.slow_force import SlowForce, slow_force
from test_any_curve import drawn


@pytest.fixture(scope="module")
def sound():
    vehicle = vehicle_of()
    return screened(vehicle, train_of(vehicle, duration=160.0))


def whole_causes(found):
    """Causes of one column over the whole log, a thrust that fades with time among them."""
    return [s for s in found.scores if len(s.columns) == 1 and not s.candidate.starts]


@pytest.mark.parametrize("kind", ["slow", "past"])
def test_what_curves_and_the_noise_make_together_is_no_more_than_chance(sound, kind):
    """Errors at their bounds, slow forces of the declared rms and white noise, in place of the log."""
    fit, free = sound.fit, AnyCurve(sound.fit)
    slow = slow_force(fit)
    shapes, products = slow._shapes
    causes = whole_causes(sound)[::4]
    left = []
    for seed in range(6):
        rng = np.random.default_rng(seed)
        errors = drawn(free, rng)
        size = rng.standard_normal(len(shapes))
        size /= np.sqrt((size @ products @ size).max())
        y = np.tensordot(errors, free.g.columns(free.projection.base), 1)
        y += (shapes.T @ size).reshape(y.shape) * (kind == "slow")
        y += rng.standard_normal(y.shape)
        here = Round(with_log(fit, y.reshape(fit.gram.y.shape)), causes, 1e-3, {})
        other = here.slow if kind == "slow" else here.past
        assert isinstance(other, SlowForce if kind == "slow" else OwnPast)
        left += [here.left_beside(s, other) for s in causes]
    assert len(causes) >= 5
    # Chi-squared of one degree of freedom at most, over thirty of them.
    assert max(left) < chi2.isf(1e-4, 1) and np.mean(left) < 1.5


def with_log(fit, y):
    """The fit to other whitened errors, shape (blocks, numbers)."""
    g = fit.gram
    score = np.concatenate([np.einsum("cbi,bi->bc", part, y) for part in g.parts], axis=1)
    return replace(
        fit, gram=replace(g, y=y, score=score, energy=(y**2).sum(axis=1), centre=np.zeros_like(g.centre)), candidates=()
    )


def test_a_fading_thrust_stands_beside_curves_and_slow_forces_together(sound):
    """No curve of the demand fades, and a slow force takes its mean alone: what each takes by itself, in sum, left nothing of it."""
    fit = sound.fit
    sag = next(s for s in sound.scores if s.id == "thruster.voltage_sag")
    own = fit.gram.columns(list(sag.columns))[0]
    information = float(fit.projection.information(list(sag.columns))[0, 0])
    size = 25.0 / np.sqrt(information)
    y = np.random.default_rng(2).standard_normal(own.shape) + size * own
    here = with_log(fit, y)
    theta, fall = here.projection.solve(list(sag.columns))
    s = replace(sag, fall=fall, theta=tuple(theta / fit.gram.unit[list(sag.columns)]), boxed=0.0)
    asked = Round(here, [s], 1e-3, {})
    apart = max(np.sqrt(asked.slow.fall(s)) - asked.lost(s), 0.0) ** 2
    together = asked.left_beside(s, asked.slow)
    assert apart < together <= asked.slow.fall(s) < fall and together > 25.0
    # A cause in time stands beside errors that jump more often.
    free = AnyCurve(here, finer=FINER)
    both, curves = (Directions(q).left(s) for q in (free.under(asked.slow), free))
    assert together == pytest.approx(min(both, asked.slow.fall(s))) and both < 0.9 * curves
    # The oracle takes the forces out of the columns and of the log themselves, as ones with their own prior.
    g, at = free.under(asked.slow).beside(s)
    shapes, _ = asked.slow._shapes
    x = g.columns(list(range(len(g.names)))).reshape(len(g.names), -1)
    held = np.linalg.solve(shapes @ shapes.T + asked.slow.prior, shapes @ np.vstack([x, here.gram.y.ravel()]).T)
    left = x @ np.vstack([x, here.gram.y.ravel()]).T - (x @ shapes.T) @ held
    assert g.total == pytest.approx(left[:, :-1], abs=1e-6) and g.score.sum(axis=0) == pytest.approx(
        left[:, -1], abs=1e-6
    )
    assert at == [len(g.names) - 1]
