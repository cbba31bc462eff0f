"""The best of many programmes, by differential evolution (Storn and Price 1997)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final, TypeAlias

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import Bounds, differential_evolution

from ivsid.plans.purpose import Purpose
from ivsid.plans.sailed import Sailed, sail, scenario_of
from ivsid.plans.shape import PARTS, Shape

Array: TypeAlias = NDArray[np.float64]
# Programmes of a generation.
# Source: resource: a tenth of a second each for widths
POPULATION: Final = 24
# Share of the fence and of the limits that the estimate may use: other vehicles go farther and turn harder.
# Source: definition: members of a fit within 15 % stay inside
SHARE: Final = 0.85
# Spread of the numbers of all parts about those of the one that is repeated.
# Source: definition: an eighth of the range, so that parts differ and most of them can be sailed
SPREAD: Final = 0.125
# Value of a programme that cannot be sailed.
# Source: definition: beyond all others
USELESS: Final = 1e12


@dataclass(frozen=True)
class Setting:
    """What all programmes share.

    Attributes:
        shape: of programmes.
        purpose: of the plan.
        truth: by which they are sailed.
        rate: of the samples [Hz].
        fence: radius [m]; infinite without one.
        seed: of the search and of the draws.
    """

    shape: Shape
    purpose: Purpose
    truth: dict[str, float]
    rate: float
    fence: float
    seed: int

    def cost(self, x: Array) -> float:
        """The value of the programme x, small where it is good; programmes that leave fence or limits cost more than any that keeps them."""
        scenario = scenario_of(self.shape.segments(x), self.shape.seconds, self.rate, self.truth)
        sailed = sail(self.shape.vehicle, scenario, self.seed)
        if sailed is None:
            return USELESS
        over = self.over(sailed)
        if over > 0:
            return USELESS / 2 * over / (1 + over)
        return self.purpose.cost(sailed)

    def over(self, sailed: Sailed) -> float:
        """How far a programme goes beyond the shares of fence and limits that it may use; 0 inside."""
        return max(sailed.reach / (SHARE * self.fence) - 1, sailed.hardest / SHARE - 1, sailed.spin / SHARE - 1, 0.0)


def best(setting: Setting, generations: int, progress: Callable[[str], None]) -> Array:
    """The numbers of the best programme that the search finds, shape (size,).

    One part that is repeated comes first: it has a sixth of the numbers, and finds how hard the vehicle can be pushed and turned. All parts
    are then let go from there.

    Args:
        setting: purpose, vehicle and area.
        generations: of both searches together; each tries ``POPULATION`` programmes.
        progress: told of each generation.
    """
    rng = np.random.default_rng(setting.seed)
    shape = setting.shape
    kinds, sides = len(shape.kinds), shape.sides // PARTS
    first = rng.uniform(size=(POPULATION, kinds))
    # Each has a strength of its own to the sides, from a twentieth to all of the room: few of the strongest can be sailed.
    strength = 0.05 ** rng.uniform(size=(POPULATION, 1))
    first[:, sides:] = 0.5 + strength * (first[:, sides:] - 0.5)
    head = max(1, generations // 2)
    one = _evolved(lambda x: setting.cost(np.repeat(x, PARTS)), first, head, rng, 0, generations, progress)
    around = np.repeat(one, PARTS) + SPREAD * rng.standard_normal((POPULATION, shape.size))
    around[0] = np.repeat(one, PARTS)
    if generations == head:
        return np.asarray(around[0])
    return _evolved(setting.cost, np.clip(around, 0.0, 1.0), generations - head, rng, head, generations, progress)


def _evolved(
    cost: Callable[[Array], float],
    first: Array,
    generations: int,
    rng: np.random.Generator,
    done: int,
    total: int,
    progress: Callable[[str], None],
) -> Array:
    """The best numbers between 0 and 1 after some generations."""
    count = done

    def told(*_: object, **__: object) -> None:
        nonlocal count
        count += 1
        progress(f"generation {count} of {total}")

    found = differential_evolution(
        cost,
        Bounds(np.zeros(first.shape[1]), np.ones(first.shape[1])),
        maxiter=generations,
        init=first,
        mutation=(0.4, 0.9),
        recombination=0.7,
        polish=False,
        tol=0.0,
        rng=rng,
        callback=told,
    )
    return np.asarray(found.x, dtype=np.float64)
