"""Evidence of the findings in TRAIN: the force that the model lacks without a finding, the force that it lacks with it, and the cause's own.

Two questions have two answers. How much more is missing where all other numbers may take the place of a cause says how much of it the log
shows. The force of the cause itself, with all other numbers held, says where it acts: a refit spreads a delay over steady turns, where a
delay does nothing.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ivsid.diagnosis.estimation.fit import Fit
from ivsid.diagnosis.plant.physics import acceleration
from ivsid.diagnosis.prediction.filtered_states import FilteredStates
from ivsid.diagnosis.prediction.innovations import Predictor
from ivsid.diagnosis.statements.binning import Binned, binned, ordered_by
from ivsid.diagnosis.statements.comparison import low, missing
from ivsid.diagnosis.statements.diagnosis import Diagnosis
from ivsid.diagnosis.statements.findings import Finding
from ivsid.diagnosis.statements.without import without
from ivsid.effects import CHANNELS

Array = NDArray[np.float64]
# Length of the stretch of time that a figure shows [s].
# Source: resource: the width of a figure
STRETCH: Final = 90.0
# Share of the missing force below which the force of a cause is rounding.
# Source: definition: rounding of doubles, with a margin
LEAST_SHARE: Final = 1e-6


@dataclass(frozen=True)
class Evidence:
    """One finding in the channel that shows it most.

    Attributes:
        effect: id of the finding.
        channel: surge, sway or yaw.
        time: of the samples [s], shape (n,).
        before: low-passed force that is missing without the finding, with all else fitted again [N, N m], shape (n,).
        after: low-passed force that is missing with the finding [N, N m], shape (n,); equal to ``before`` for ``unknown``.
        window: first sample of the stretch with most of the cause's own force, and the sample after its last.
        quantity: name of the quantity of the motion that orders the cause's own force best.
        means: of before, after and their difference along that quantity.
        rms: of before, after and their difference [N, N m].
        own: low-passed force of the cause itself, with all other numbers held [N, N m], shape (n,); ``before`` for ``unknown``.
        own_means: of it along the quantity.
    """

    effect: str
    channel: str
    time: Array
    before: Array
    after: Array
    window: tuple[int, int]
    quantity: str
    means: tuple[Binned, Binned, Binned]
    rms: tuple[float, float, float]
    own: Array
    own_means: Binned

    @property
    def acts(self) -> bool:
        """Whether the cause is a force here; one that changes an accelerometer's reading alone is none."""
        return float(np.abs(self.own).max()) > LEAST_SHARE * float(np.abs(self.before).max())

    @property
    def unit(self) -> str:
        """Unit of the force."""
        return "N m" if self.channel == "yaw" else "N"


def evidence(result: Diagnosis) -> tuple[Evidence, ...]:
    """Evidence of each finding that TRAIN shows, in the order of the findings."""
    plain, last = result.selection.plain, result.selection.last
    predictor = last.noise.predictor
    after = missing(predictor, last.states)
    found = []
    for f in result.findings:
        if f.effect == "unknown":
            found.append(_of(f, last, predictor, after, after, after))
        elif any(f.effect == q.id for q in result.selection.found):
            before = missing(predictor, without(plain, last, (f.effect,)))
            found.append(_of(f, last, predictor, before, after, own_force(predictor, plain, last, f.effect)))
    return tuple(found)


def own_force(predictor: Predictor, plain: Fit, last: Fit, id_: str) -> Array:
    """Force of a cause itself, low-passed [N, N m], shape (3, n): what goes missing where it alone is taken out of the extended model."""
    h = last.h.without(id_, plain.h)
    points = last.states.points.under(*predictor.driving.force(h))
    bare = replace(last.states, h=h, points=points, nudot=acceleration(predictor.vehicle, h, points))
    return missing(predictor, bare) - missing(predictor, last.states)


def _of(f: Finding, last: Fit, predictor: Predictor, before: Array, after: Array, own: Array) -> Evidence:
    """Evidence of a finding from the missing forces without and with it, and from its own, each of shape (3, n)."""
    good = last.noise.good
    shown = before - after if f.effect != "unknown" else before
    k = _channel(f, shown[:, good], after[:, good])
    quantities = {n: x[good] for n, x in motion(predictor, last.states).items()}
    name = ordered_by(own[k, good], quantities)
    x = quantities[name]
    rows = (before[k], after[k], before[k] - after[k])
    means = tuple(binned(row[good], x, predictor.log.h) for row in rows)
    rms = tuple(float(np.sqrt(np.mean(row[good] ** 2))) for row in rows)
    return Evidence(
        f.effect,
        CHANNELS[k],
        predictor.log.t,
        before[k],
        after[k],
        _window(np.where(good, own[k], 0.0), predictor.log.h),
        name,
        (means[0], means[1], means[2]),
        (rms[0], rms[1], rms[2]),
        own[k],
        binned(own[k, good], x, predictor.log.h),
    )


def _channel(f: Finding, shown: Array, after: Array) -> int:
    """Index of the channel where the finding stands out most from the rest; an ``unknown`` names its own."""
    named = f.evidence.get("channel")
    if f.effect == "unknown" and named in CHANNELS:
        return CHANNELS.index(named)
    return int(np.argmax((shown**2).mean(axis=1) / np.maximum((after**2).mean(axis=1), 1e-300)))


def _window(x: Array, step: float) -> tuple[int, int]:
    """First sample of the stretch with most of a force, and the sample after its last."""
    count = min(round(STRETCH / step), x.size)
    energy = np.cumsum(np.r_[0.0, x**2])
    first = int(np.argmax(energy[count:] - energy[: x.size - count + 1]))
    return first, first + count


def motion(predictor: Predictor, states: FilteredStates) -> dict[str, Array]:
    """Quantities of the motion along which a force may be ordered, by name, each of shape (n,)."""
    n, p = predictor.log.n, states.points
    u, v, r = p.nu[:, :n]
    c, s = np.cos(p.angles[:, :n]), np.sin(p.angles[:, :n])
    arms = np.array([t.position for t in predictor.vehicle.thrusters]).reshape(-1, 2)
    thrust = p.thrusts[:, :n]
    ahead, turning = (thrust * c).sum(axis=0), (thrust * (arms[:, :1] * s - arms[:, 1:] * c)).sum(axis=0)
    changes = low(predictor, np.gradient(np.stack([ahead, turning]), predictor.log.h, axis=1))
    found = {
        "u": u,
        "v": v,
        "r": r,
        "heading": np.mod(p.psi[:n], 2 * np.pi),
        "thrust ahead": ahead,
        "turning thrust": turning,
        "udot": states.nudot[0, :n],
        "rdot": states.nudot[2, :n],
        "u v": u * v,
        "u r": u * r,
        "change of thrust": changes[0],
        "change of turning thrust": changes[1],
        "time": predictor.log.t,
    }
    if predictor.log.psi is None:
        del found["heading"]
    if predictor.log.place is not None:
        found |= {"north": p.place[0, :n], "east": p.place[1, :n]}
    return found
