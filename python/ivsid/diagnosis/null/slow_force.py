"""What a slow ambient force inside the declared one takes of columns and of a log.

An ambient force may have any spectrum, and the whitening knows a few seconds of it. A force that changes over minutes looks like a place, a heading, a
time or an offset. Cosines over the log along the hull and over ground hold what is slower than a few periods a log. Each has the declared rms as its prior,
and their sum along an axis of the hull is no larger than that: what a log asks for beyond it stays with the causes. A wave that a log shows may stand among them,
with its harmonics.

Source: docs/theory.md, "Slow forces"; the cosines are those of the discrete cosine transform, Rao and Yip, 1990, and the bound
is kept by multipliers, Boyd and Vandenberghe, Convex Optimization, 2004, section 5.5.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import cached_property
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cho_factor, cho_solve

from ivsid.diagnosis.candidates.searched import with_searched
from ivsid.diagnosis.estimation.cross_products import Gram
from ivsid.diagnosis.estimation.fit import Fit
from ivsid.diagnosis.null.beside import Beside
from ivsid.diagnosis.null.frequencies import Spectrum, spectrum
from ivsid.effects import Harmonic

Array = NDArray[np.float64]
# Half waves of a slow force over the log, at most.
# Source: geometry: eight are four periods a log
HALF_WAVES: Final = 8
# Sines that a wave is made of, its own with it.
# Source: geometry: a square wave has nine tenths of its power in the first and the third
HARMONICS: Final = 3
# Chi-squared, and share of a bound, by which its multiplier may miss.
# Source: definition: a tenth of a standard deviation, squared
GAP: Final = 0.01
# Steps of multipliers, at most; few are asked for.
# Source: resource: a few milliseconds of forty-five unknowns
STEPS: Final = 200
# Multiplier at the first step; it grows as its bound is passed, at most tenfold a step.
# Source: geometry: far less than the prior of a force
FIRST: Final = 1e-3
MOST: Final = 10.0
# Mean square of a force over the log, in that of the declared one, up to which it is no more than that.
# Source: geometry: the mean square of a wave beside its crest is twice that of all of it
CREST: Final = 2.0
# Chance of the fall of chi-squared by a wave, over all periods that are searched, from which on none stands out.
# Source: definition: one in a thousand logs without a wave
RARE: Final = 1e-3
# Least duration that is divided by [s].
# Source: geometry: the smallest doubles
LEAST: Final = 1e-300


class SlowForce(Beside):
    """The base of a fit beside slow forces inside the declared ambient force, which the vehicle file of the fit has to declare.

    Args:
        fit: of the model without causes.
        period: of a wave that the force holds as well, with its harmonics [s], or None.
    """

    def __init__(self, fit: Fit, period: float | None = None) -> None:
        super().__init__(fit)
        self._period = period

    @cached_property
    def _shapes(self) -> tuple[Array, Array]:
        """Signatures of forces of the declared rms, shape (forces, numbers), and their products by axis over the log.

        Along a straight course a force ahead and one over ground are the same one, so that the bound is on their sum along each axis of the hull.
        """
        g = self.fit.gram
        made = list(_forces(self.fit, self._period))
        x, unit = g.white.blocks([answer for _, answer in made], g.good, g.length)
        force = np.stack([f for f, _ in made], axis=1)
        return x.reshape(len(x), -1) * unit[:, None], force @ force.transpose(0, 2, 1) / force.shape[2]

    @property
    def prior(self) -> Array:
        """Information on the sizes of the forces before the log, shape (forces, forces), with multipliers that keep the bound of each axis.

        They are those of the base, so that the fall of a cause is an upper limit of the one with multipliers of its own.
        """
        return self._held[0]

    @property
    def beyond(self) -> bool:
        """Whether the log asks for clearly more than the declared rms along an axis."""
        return self._held[1]

    @cached_property
    def _held(self) -> tuple[Array, bool]:
        g = self.fit.bare
        return self._multiplied(g, range(len(g.names)), np.zeros(len(g.names)))

    def under(self, g: Gram, base: Sequence[int], known: Array) -> SlowForce:
        """The same where some columns have known coefficients, which leave the forces more or less to explain.

        Args:
            g: cross-products whose first columns are those of the base.
            base: indices of the columns that are free.
            known: coefficients by column, 0 for those that are free, shape (columns,).
        """
        other = SlowForce(self.fit, self._period)
        # Signatures and bounds are those of the same fit.
        other.__dict__.update(_shapes=self._shapes, _of_base=self._of_base, _held=self._multiplied(g, base, known))
        return other

    @cached_property
    def _of_base(self) -> Array:
        """Products of the base's columns with the forces, which all causes share, shape (base, forces)."""
        return self._products(self.fit.bare.parts)

    def _products(self, parts: Sequence[Array]) -> Array:
        """Products of columns with the forces, shape (columns, forces)."""
        s, _ = self._shapes
        return np.concatenate([np.zeros((0, len(s))), *(x.reshape(len(x), -1) @ s.T for x in parts)])

    def _with_forces(self, g: Gram) -> Array:
        """Products of all columns with the forces, shape (columns, forces).

        Args:
            g: cross-products whose first columns are those of the base.
        """
        return np.concatenate([self._of_base, self._products(g.parts[len(self.fit.bare.parts) :])])

    def _multiplied(self, g: Gram, base: Sequence[int], known: Array) -> tuple[Array, bool]:
        """Information before the log with multipliers, and whether a bound is far passed without them."""
        s, products = self._shapes
        cross = self._with_forces(g)
        at = list(base)
        held = np.linalg.solve(g.normal(at), cross[at])
        information = s @ s.T - cross[at].T @ held
        left = (g.score.sum(axis=0) - g.prior * g.centre - g.total @ known)[at]
        score = s @ g.y.ravel() - cross.T @ known - held.T @ left
        own, times, beyond = np.eye(len(s)), np.full(len(products), FIRST), None
        for _ in range(STEPS):
            own = np.eye(len(s)) + np.tensordot(times, products, 1)
            size = np.linalg.solve(information + own, score)
            square = size @ products @ size
            beyond = bool(np.any(square > CREST)) if beyond is None else beyond
            # Where a bound is passed its share counts, however small the multiplier.
            counted = np.where(square > 1.0, np.maximum(times, 1.0), times)
            if np.all(counted * np.abs(square - 1.0) < GAP):
                break
            times = times * np.clip(np.sqrt(square), 1 / MOST, MOST)
        return own, bool(beyond)

    @cached_property
    def _factor(self) -> tuple[Array, bool]:
        s, _ = self._shapes
        factor: tuple[Array, bool] = cho_factor(s @ s.T + self.prior)
        return factor

    def beside(self, g: Gram) -> Gram:
        """Cross-products over the whole log, of what slow forces leave of columns and of the log.

        Args:
            g: cross-products whose first columns are those of the base.
        """
        s, _ = self._shapes
        own = self._with_forces(g)
        taken = cho_solve(self._factor, own.T)
        total = g.total - own @ taken
        score = g.score.sum(axis=0) - (s @ g.y.ravel()) @ taken
        return replace(g.whole(), blocks=total[None], score=score[None])

    def spectrum(self, g: Gram) -> Spectrum | None:
        """Spectrum of the noise above the frequencies of slow forces; None where the log asks for more of these than is declared, and what is left need not be noise.

        Args:
            g: cross-products of the base and of further columns.
        """
        return None if self.beyond else spectrum(self.fit, g, self._shapes[0], HALF_WAVES // 2 + 1)


def slow_force(fit: Fit) -> SlowForce | None:
    """The base of a fit beside slow forces; None where the vehicle file declares no ambient force."""
    sea = fit.noise.predictor.vehicle.ambient
    return SlowForce(fit) if sea is not None and sea.force else None


def wave_beside(fit: Fit) -> SlowForce | None:
    """The same with the wave that the log shows most, where one stands out; None where none does, or no ambient force is declared.

    A force of any spectrum may be a line, and one that is no sine has harmonics.
    """
    sea = fit.noise.predictor.vehicle.ambient
    swell = tuple(c for c in fit.candidates if isinstance(c.effect.form, Harmonic) and c.effect.form.of != "flow")
    if sea is None or not sea.force or not swell:
        return None
    _, scored = with_searched(replace(fit, candidates=swell), fit.projection)
    best = max(scored, key=lambda s: s.fall, default=None)
    if best is None or best.chance > RARE:
        return None
    numbers = dict(zip((p.part for p in best.candidate.effect.parameters), best.values, strict=True))
    return SlowForce(fit, numbers["period"])


def _forces(fit: Fit, period: float | None) -> Iterator[tuple[Array, Array]]:
    """Slow forces by axis, over the declared rms, and their signatures: ahead, sideways, in yaw, north and east."""
    s, sea = fit.signatures, fit.noise.predictor.vehicle.ambient
    assert sea is not None
    p = s.states.points
    c, sine = np.cos(p.psi), np.sin(p.psi)
    none = np.zeros_like(p.t)
    for wave in _waves(p.t, period):
        north, east = (wave * c, -wave * sine, none), (wave * sine, wave * c, none)
        for along in ((wave, none, none), (none, wave, none), (none, none, wave), north, east):
            force = np.stack(along)
            answer = s.force(force * np.array([[sea.force], [sea.force], [sea.moment]]))
            if np.any(answer):
                yield force, answer


def _waves(t: Array, period: float | None) -> Iterator[Array]:
    """Shapes of the forces in time, of unit mean square over the log, shape of the times."""
    begin, end = float(t.min()), float(t.max())
    for k in range(HALF_WAVES + 1):
        yield (np.sqrt(2.0) if k else 1.0) * np.cos(np.pi * k * (t - begin) / max(end - begin, LEAST))
    if period is None:
        return
    for k in range(1, HARMONICS + 1):
        for wave in (np.sin, np.cos):
            yield np.sqrt(2.0) * wave(2.0 * np.pi * k * t / period)
