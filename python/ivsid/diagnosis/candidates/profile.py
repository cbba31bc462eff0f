"""Profiles of chi-squared: numbers in which the errors bend or jump, as a limit, a dead band, a delay or a start.

A slope at the best value says little of such a number: a dead band may stand anywhere between two demands that were sent. So chi-squared is
worked out at other values of the one number, with everything else fitted beside it. The interval ends where it has risen too far.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ivsid.diagnosis.candidates.starts import proposed_starts
from ivsid.diagnosis.estimation.problem import Problem
from ivsid.diagnosis.estimation.projection import Projection
from ivsid.diagnosis.estimation.signatures import free_parameters
from ivsid.diagnosis.plant.physics import Hypothesis
from ivsid.diagnosis.prediction.filtered_states import FilteredStates
from ivsid.effects import Given, Grid

Array = NDArray[np.float64]
# Directions of the search for an anchor, north and east.
# Source: geometry: eight directions of the compass
COMPASS: Final = ((1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0), (0.7, 0.7), (0.7, -0.7), (-0.7, 0.7), (-0.7, -0.7))
# First step of a search for an anchor, in extents of the track.
# Source: geometry: one and three quarters of the distance between two anchors of the grid (kinds.tether.GRID)
ANCHOR_STEP: Final = 0.25
# Halvings of that step.
# Source: geometry: the last step is a sixty-fourth of the extent
ANCHOR_HALVINGS: Final = 5
# Least extent of a track in that step [m].
# Source: geometry: the step of a vehicle that stays where it is
LEAST_EXTENT: Final = 1.0
# Shares of the first value that are tried before it is refined: its score came from a column of another value.
# Source: resource: sixteen fits over a factor of twelve, in steps of 18 %
SHARES: Final = tuple(np.geomspace(0.2, 2.5, 16).tolist())
# Factor from the last share to the value beyond it, while that is the best.
# Source: geometry: the factor between two shares
OUTWARD_FACTOR: Final = SHARES[1] / SHARES[0]
# Most values beyond the shares.
# Source: resource: reaches a hundred times the first value
OUTWARD: Final = 22
# Bisections of an end of an interval.
# Source: geometry: the end is known to a 128th of the last step
HALVINGS: Final = 7
# Most doublings of the first step until chi-squared has risen.
# Source: geometry: the last of them is 2048 first steps, 40 times the number itself or an hour
DOUBLINGS: Final = 12
# First steps on either side within which the best value is looked for.
# Source: measured: make constants
AROUND: Final = 6
# Passes of that search, each with steps that are ``AROUND`` times as small.
# Source: measured: make constants
PASSES: Final = 2
# Least first step of a starting time [s].
# Source: measured: make constants
TIME_STEP: Final = 2.0
# Least first step of a starting time, in steps of the clock.
# Source: measured: make constants
TIME_STEPS: Final = 4
# First step of another number, as a share of it.
# Source: measured: make constants
NUMBER_STEP: Final = 0.02
# Factor of the rise of chi-squared that ends the interval of a starting time: the size of the effect, which is off as well, goes with it.
# Source: measured: make constants
START_RISE: Final = 2.0
# Least distance by which the ends of a starting time's interval are moved apart [s]: the memory of the filters blurs a start.
# Source: measured: make constants
START_SLACK: Final = 1.0
# The same in steps of the clock.
# Source: measured: make constants
START_SLACK_STEPS: Final = 3
# The same for a delay or a lag, in steps of the clock.
# Source: measured: the examination; two of some hundred intervals of delays missed, at 330 and 775 standard deviations, by 0.3 ms at steps of 100 ms
INSIDE_SLACK: Final = 0.01

# Places at which a region of possible anchors is asked before its lattice is made four times as coarse.
# Source: resource: a place costs a hundredth of a second
PLACES: Final = 250
# First step of that lattice, in half-widths of the interval by slopes.
# Source: geometry: three steps from the best place to the end of a region that is no wider than the slopes say
REGION_STEP: Final = 1.0 / 3.0
# Steps by which the ends stand outside of the last place that is inside: a strip that ends between places narrows before.
# Source: geometry: half a step to the next place, and one that the end of a strip may pass between two places
REGION_SLACK: Final = 1.5
# Lattices at most.
# Source: resource: the third one reaches 8 times as many half-widths as it has places in a row
LATTICES: Final = 3


def bent(given: Given) -> list[int]:
    """Indices of an effect's numbers that are profiled."""
    if given.effect.form.bends:
        return [0]
    return [j for j, p in enumerate(given.effect.parameters) if p.draw == "time"]


def sought(given: Given) -> bool:
    """Whether an effect has numbers that a coarse search found, and that are refined before slopes are followed."""
    # No slope leads a hull that sails around an anchor to its place.
    return bool(bent(given) or given.effect.form.place)


def first_step(problem: Problem, given: Given, j: int) -> float:
    """A small change of an effect's j-th number: two seconds, or a fiftieth."""
    if given.effect.parameters[j].draw == "time":
        return max(TIME_STEP, TIME_STEPS * problem.noise.predictor.log.h)
    return NUMBER_STEP * max(abs(given.values[j]), 1e-9)


def profile(problem: Problem, states: FilteredStates, given: Given, *places: int) -> Callable[..., float]:
    """Chi-squared as a function of one number of an effect of the hypothesis, or of several.

    Args:
        problem: the log.
        states: of the hypothesis.
        given: the effect as it stands in the hypothesis.
        places: indices of the numbers among the effect's.
    """
    g = problem.gram(states, sums=False)
    own = {given.parts[j] for j in places}
    base = [k for k, name in enumerate(g.names) if name not in own]
    predictor = problem.noise.predictor
    errors, later = predictor.errors(states), predictor.later(states.h)

    def chi2(*numbers: float) -> float:
        values = list(given.values)
        for j, value in zip(places, numbers, strict=True):
            values[j] = value
        other = moved(states.h, problem.fixed, given, values)
        if predictor.later(other) != later:
            # Samples have other readings there, and states that follow them.
            return Projection(g.of(predictor.errors(predictor.settle(states.under(other), 2))), base).chi2
        return Projection(g.of(errors - predictor.difference(states, other)), base).chi2

    return chi2


def of_starts(problem: Problem, states: FilteredStates, given: Given, j: int) -> Callable[[float], float]:
    """Chi-squared as a function of the start of an effect, with its size fitted anew at each.

    The slope with the size belongs to one start: beside another it would be a second step, which fits whatever the first one left.

    Args:
        problem: the log.
        states: of the hypothesis.
        given: the effect as it stands in the hypothesis.
        j: index of the start among its numbers.
    """
    g, predictor = problem.gram(states, sums=False), problem.noise.predictor
    sizes = {k: name for name, _, k in free_parameters(given)}
    base = [k for k, name in enumerate(g.names) if name not in {*sizes.values(), given.parts[j]}]

    def change(values: Sequence[float]) -> Array:
        return predictor.difference(states, moved(states.h, problem.fixed, given, values))

    # A size that has one sign alone is not fitted with the other.
    sided = not any(given.effect.parameters[k].signed for k in sizes)
    none = change([given.effect.parameters[k].none if k in sizes else x for k, x in enumerate(given.values)])
    without = g.of(predictor.errors(states) - none)
    p = Projection(without, base)

    def chi2(start: float) -> float:
        # The signature of the whole effect with this start, with what the base leaves of it.
        column = g.of(change([start if k == j else x for k, x in enumerate(given.values)]) - none)
        score = column.score.sum(axis=0)[base]
        solved = np.linalg.solve(p.normal, score)
        length = float(column.energy.sum()) - float(score @ solved)
        along = float(np.sum(column.y * without.y)) - float(p.score[base] @ solved)
        along = max(along, 0.0) if sided else along
        return p.chi2 - (along**2 / length if length > 0.0 else 0.0)

    return chi2


def moved(h: Hypothesis, fixed: Mapping[str, float], given: Given, values: Sequence[float]) -> Hypothesis:
    """The hypothesis with other numbers of an effect.

    Masses and drags that are fitted change with a limit of all thrusts: if most stand at it, little else tells it from their scale.
    """
    other = h.with_effect(replace(given, values=tuple(values)))
    if not given.effect.form.limits or given.thruster is not None:
        return other
    share = values[0] / given.values[0]
    return replace(other, values={k: x if k in fixed else x * share for k, x in other.values.items()})


def refined(problem: Problem, states: FilteredStates, given: Given, *, wide: bool) -> FilteredStates:
    """The hypothesis with the profiled numbers of an effect at the least chi-squared nearby.

    Args:
        problem: the log.
        states: of the hypothesis.
        given: the effect as it stands in the hypothesis.
        wide: whether ``SHARES`` of the first value are tried before.
    """
    if given.effect.form.place:
        return _moored(problem, states, given)
    for j in bent(given):
        in_time = given.effect.parameters[j].draw == "time"
        chi2 = of_starts(problem, states, given, j) if in_time else profile(problem, states, given, j)
        step, best = first_step(problem, given, j), given.values[j]
        tried = {best: chi2(best)}
        if wide and given.effect.form.bends:
            tried |= {best * share: chi2(best * share) for share in SHARES}
            best = bracketed(chi2, tried)
        if in_time:
            tried |= {start: chi2(start) for start in proposed_starts(problem, states, given, j) if start > 0}
            best = min(tried, key=lambda q: tried[q])
        for _ in range(PASSES):
            for k in range(-AROUND, AROUND + 1):
                value = best + k * step
                if value > 0 and value not in tried:
                    tried[value] = chi2(value)
            best = min(tried, key=lambda q: tried[q])
            step /= AROUND
        values = list(given.values)
        values[j] = best
        states = states.under(moved(states.h, problem.fixed, given, values))
        given = replace(given, values=tuple(values))
    return states


def bracketed(chi2: Callable[[float], float], tried: dict[float, float]) -> float:
    """The value of least chi-squared, followed outward while it is the last that was tried; ``tried`` gets all that are asked.

    A score's column of a short lag is proportional to those of all shorter ones, and tells little of one that is ten times as long.
    """
    for _ in range(OUTWARD):
        best = min(tried, key=lambda q: tried[q])
        beyond = {max(tried): best * OUTWARD_FACTOR, min(tried): best / OUTWARD_FACTOR}.get(best)
        if beyond is None:
            break
        tried[beyond] = chi2(beyond)
    return min(tried, key=lambda q: tried[q])


def _moored(problem: Problem, states: FilteredStates, given: Given) -> FilteredStates:
    """The hypothesis with a tether's anchor at the least chi-squared, by a search in eight directions."""
    log = problem.noise.predictor.log
    if log.place is None:
        return states
    north, east = given.effect.form.place
    chi2 = profile(problem, states, given, north, east)
    here = (float(given.values[north]), float(given.values[east]))
    least = chi2(*here)
    step = ANCHOR_STEP * max(float(np.ptp(log.place[0])), float(np.ptp(log.place[1])), LEAST_EXTENT)
    for _ in range(ANCHOR_HALVINGS):
        for _ in range(DOUBLINGS):
            tried = {(here[0] + a * step, here[1] + b * step) for a, b in COMPASS}
            worth, best = min((chi2(*q), q) for q in tried)
            if worth >= least:
                break
            least, here = worth, best
        step /= 2
    values = list(given.values)
    values[north], values[east] = here
    return states.under(states.h.with_effect(replace(given, values=tuple(values))))


def region(
    chi2: Callable[..., float], best: tuple[float, float], reach: tuple[float, float], most: float
) -> tuple[tuple[float, float], tuple[float, float]]:
    """Ends of both coordinates of the places at which chi-squared is within ``most`` of the least, a little outside of the last that is.

    The places that a log allows for an anchor are a bent strip along the direction of its pull, so that slopes at the best one show its width
    alone. They are followed on a lattice from the best one to its neighbours.

    Args:
        chi2: as a function of a place.
        best: place.
        reach: half-widths of the intervals by slopes, of which a share is the first step.
        most: rise.
    """
    step = np.maximum(REGION_STEP * np.array(reach), 1e-9)
    ends = np.array([best, best], dtype=np.float64)
    least = chi2(*best)
    for _ in range(LATTICES):
        asked, edge = {(0, 0)}, [(0, 0)]
        while edge and len(asked) < PLACES:
            # The oldest first: the region grows evenly from the best place.
            i, j = edge.pop(0)
            at = np.array(best) + np.array([i, j]) * step
            ends = np.array(
                [np.minimum(ends[0], at - REGION_SLACK * step), np.maximum(ends[1], at + REGION_SLACK * step)]
            )
            for place in [(i + a, j + b) for a in (-1, 0, 1) for b in (-1, 0, 1)]:
                if place not in asked:
                    asked.add(place)
                    here = chi2(best[0] + place[0] * step[0], best[1] + place[1] * step[1])
                    least = min(least, here)
                    if here - least <= most:
                        edge.append(place)
        if not edge:
            break
        # What is left of the region is followed on a coarser lattice, which may lose a narrow strip: the ends so far stay.
        step = 4 * step
    (low, least_east), (high, most_east) = ends.tolist()
    return (low, high), (least_east, most_east)


def rise(given: Given, j: int, sigmas: float, worse: float) -> float:
    """Rise of chi-squared at the ends of an interval.

    Args:
        given: the effect.
        j: index of its number.
        sigmas: half-width in standard deviations.
        worse: variance by the scatter of half-minutes over the variance by the noise model.
    """
    return sigmas**2 * worse * (START_RISE if given.effect.parameters[j].draw == "time" else 1.0)


def slack(problem: Problem, given: Given, j: int) -> float:
    """Distance by which the ends of an interval are moved apart.

    A start is not known within a few samples, nor within a filter's memory, and a delay or a lag not within a small share of a step, inside which the
    filters take accelerations as even.
    """
    h = problem.noise.predictor.log.h
    if given.effect.parameters[j].draw == "time":
        return max(START_SLACK, START_SLACK_STEPS * h)
    return INSIDE_SLACK * h if isinstance(given.effect.form, Grid) and given.effect.parameters[j].unit == "s" else 0.0


def ends(chi2: Callable[[float], float], best: float, step: float, most: float) -> tuple[float, float]:
    """The interval around the best value outside of which chi-squared has risen by more than ``most``.

    Args:
        chi2: as a function of the number, which is positive.
        best: value.
        step: first step to either side.
        most: rise.
    """
    least = chi2(best)
    found = []
    for sign in (-1.0, 1.0):
        inside, reach = 0.0, step
        for _ in range(DOUBLINGS):
            here = chi2(best + sign * reach) if best + sign * reach > 0 else np.inf
            if here - least > most:
                break
            least = min(least, here)
            inside, reach = reach, 2 * reach
        outside = reach
        for _ in range(HALVINGS):
            middle = 0.5 * (inside + outside)
            here = chi2(best + sign * middle) if best + sign * middle > 0 else np.inf
            if here - least > most:
                outside = middle
            else:
                inside = middle
        found.append(best + sign * outside)
    return max(found[0], 0.0), found[1]
