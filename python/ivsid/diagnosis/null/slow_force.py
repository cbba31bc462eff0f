"""What a slow ambient force inside the declared one takes of columns and of a log.

An ambient force may have any spectrum, and the whitening knows a few seconds of it. A force that changes over minutes looks like a place, a heading, a
time or an offset. The declared rms bounds it: cosines over the log along the hull and over ground, each with that deviation, hold what is slower than
a few periods a log. Where those that the log asks for are larger together than the declared rms, it is no declared force.

Source: docs/theory.md, "Slow forces"; the cosines are those of the discrete cosine transform, Rao and Yip, 1990.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import cached_property
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cho_factor, cho_solve

from ivsid.diagnosis.estimation.cross_products import Gram
from ivsid.diagnosis.estimation.fit import Fit
from ivsid.diagnosis.null.beside import Beside

Array = NDArray[np.float64]
# Half waves of a slow force over the log, at most.
# Source: geometry: eight are four periods a log
HALF_WAVES: Final = 8
# Standard errors above its bound from which on a slow force is larger.
# Source: definition: of normal estimates one in a thousand lies above
ERRORS: Final = 3.0
# Least size that is divided by.
# Source: geometry: the smallest doubles
LEAST: Final = 1e-300


class SlowForce(Beside):
    """The base of a fit beside slow forces inside the declared ambient force, which the vehicle file of the fit has to declare."""

    @cached_property
    def _shapes(self) -> tuple[Array, Array, tuple[Array, bool]]:
        """Signatures of forces of the declared rms, shape (forces, numbers), their products by axis over the log, and the factor of theirs.

        Along a straight course a force ahead and one over ground are the same one, so that the bound is on their sum along each axis of the hull.
        """
        g = self.fit.gram
        made = list(_forces(self.fit))
        x, unit = g.white.blocks([answer for _, answer in made], g.good, g.length)
        s = x.reshape(len(x), -1) * unit[:, None]
        force = np.stack([f for f, _ in made], axis=1)
        return s, force @ force.transpose(0, 2, 1) / force.shape[2], cho_factor(s @ s.T + np.eye(len(s)))

    def beside(self, g: Gram) -> Gram:
        """Cross-products over the whole log, of what slow forces leave of columns and of the log.

        Args:
            g: cross-products.
        """
        s, _, factor = self._shapes
        own = np.concatenate([x.reshape(len(x), -1) @ s.T for x in g.parts])
        taken = cho_solve(factor, own.T)
        total = g.total - own @ taken
        score = g.score.sum(axis=0) - (s @ g.y.ravel()) @ taken
        return replace(g.whole(), blocks=total[None], score=score[None])

    @cached_property
    def inside(self) -> bool:
        """Whether the slow force that the log asks for beside the base is one of the declared rms or less, along each axis of the hull."""
        s, products, _ = self._shapes
        g = self._base
        base = range(len(g.names))
        cross = g.parts[0].reshape(len(base), -1) @ s.T
        held = np.linalg.solve(g.normal(base), cross)
        information = s @ s.T + np.eye(len(s)) - cross.T @ held
        score = s @ g.y.ravel() - held.T @ (g.score.sum(axis=0) - g.prior * g.centre)
        covariance = np.linalg.inv(information)
        size = covariance @ score
        # What the prior holds of a size scatters less than it is uncertain.
        scatter = covariance - covariance @ covariance
        for product in products:
            slope = product @ size
            length = float(np.sqrt(max(size @ slope, 0.0)))
            error = float(np.sqrt(max(slope @ scatter @ slope, 0.0))) / max(length, LEAST)
            if length - ERRORS * error > 1.0:
                return False
        return True


def slow_force(fit: Fit) -> SlowForce | None:
    """The base of a fit beside slow forces; None where the log asks for larger ones than the vehicle file declares, or that declares none."""
    sea = fit.noise.predictor.vehicle.ambient
    slow = SlowForce(fit) if sea is not None and sea.force else None
    return slow if slow is not None and slow.inside else None


def _forces(fit: Fit) -> Iterator[tuple[Array, Array]]:
    """Slow forces by axis, over the declared rms, and their signatures: ahead, sideways, in yaw, north and east."""
    s, sea = fit.signatures, fit.noise.predictor.vehicle.ambient
    assert sea is not None
    p = s.states.points
    c, sine = np.cos(p.psi), np.sin(p.psi)
    begin, end = float(p.t.min()), float(p.t.max())
    none = np.zeros_like(p.t)
    for k in range(HALF_WAVES + 1):
        wave = (np.sqrt(2.0) if k else 1.0) * np.cos(np.pi * k * (p.t - begin) / max(end - begin, LEAST))
        north, east = (wave * c, -wave * sine, none), (wave * sine, wave * c, none)
        for along in ((wave, none, none), (none, wave, none), (none, none, wave), north, east):
            force = np.stack(along)
            answer = s.force(force * np.array([[sea.force], [sea.force], [sea.moment]]))
            if np.any(answer):
                yield force, answer
