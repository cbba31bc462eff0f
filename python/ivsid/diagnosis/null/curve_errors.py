"""Thrust errors of one bound that a curve of the fit's knots cannot follow, and their signatures.

Each is one of several kinds, and an error of a thruster is any of one kind inside the bound, or a mean of several kinds:
- ``cell``: it jumps between cells of demand, for rising and for falling demands apart,
- ``inflow``: it is linear between some speeds of the water along the thruster,
- ``late``: the same of the thrust at rest, where a thrust lags,
- ``stop``: a hysteresis, the stop operator of a width.

Source: docs/theory.md, "Any thrust curve inside its accuracy".
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ivsid.diagnosis.estimation.declared_errors import through_water, thrust_answers
from ivsid.diagnosis.estimation.fit import Fit
from ivsid.diagnosis.estimation.signatures import Signatures
from ivsid.diagnosis.plant.hysteresis import stop
from ivsid.diagnosis.plant.thrust_errors import bound_of, upward

Array = NDArray[np.float64]
# Cells of all thrusters together.
# Source: resource: a fifth of a gigabyte for a log of 600 s at 20 Hz
CELLS: Final = 192
# Cells of one thruster at most, for each direction of its demand.
# Source: geometry: four cells between two knots of the declared errors
MOST_CELLS: Final = 64
# Speeds of the inflow along a thruster, with as many samples between any two, at which its error is free; it is linear between them.
# Source: measured: beside six steps six effects were named at a third of their limits, beside eight speeds one; twelve and sixteen do no better
INFLOWS: Final = 8
# Widths of the plays whose hysteresis an error may follow, as shares of the range of the demands.
# Source: measured: beside (0.005, 0.02, 0.08, 0.32) as many sound logs stand, and 3 % less of a drag in yaw is left
WIDTHS: Final = (0.02, 0.08)
# First words of the errors that are none of the demand.
BEYOND_DEMAND: Final = ("~inflow.", "~late.", "~stop.")


def cells_of(thrusters: int) -> int:
    """Cells of the demand of each of so many thrusters, for each direction of it."""
    return min(MOST_CELLS, max(CELLS // (2 * max(thrusters, 1)), 1))


def curve_errors(fit: Fit, over: Sequence[Array] | None = None, finer: int = 1) -> Iterator[tuple[str, Array]]:
    """Name and signature of each error: in each cell of demand that the log visits, at each speed of the inflow, and of each play.

    Args:
        fit: of the log.
        over: demands of each thruster from its neutral over which the cells stand, without errors by inflow or play; those of the log by default.
        finer: multiple of the number of cells.
    """
    s = fit.signatures
    propulsion = s.predictor.propulsion
    thrusters = [k for k, e in enumerate(propulsion.errors) if len(e.spreads)]
    relative = through_water(s)
    for k in thrusters:
        count = finer * cells_of(len(thrusters))
        place = _places((over or propulsion.demands)[k], count)
        # A shaft that lags runs through demands that nobody sends.
        thruster = s.predictor.vehicle.thrusters[k]
        late = thruster.lag == "demand" and bool(thruster.time_constant)
        visited = np.arange(2 * count) if late else np.unique(place(propulsion.demands[k]))
        errors = [("cell", visited.tolist(), s.predictor.driving.slopes(s.h, k, _in_cells(fit, k, place, visited)))]
        if over is None:
            # Two logs share the error of a demand. The speeds of their inflow differ, and so do their turns.
            errors += [(kind, list(range(len(each))), each) for kind, each in _beyond_demand(s, k, relative)]
        for kind, numbers, each in errors:
            for j, answer in zip(numbers, thrust_answers(s, k, each, relative), strict=True):
                if np.any(answer):
                    yield f"~{kind}.{thruster.name}.{j}", answer


def kinds(found: Sequence[str], thruster: str) -> tuple[NDArray[np.int64], ...]:
    """Places of a thruster's errors among names, by kind; each play is a kind of its own."""
    by_kind: dict[str, list[int]] = {}
    for i, name in enumerate(found):
        kind, _, number = name.removeprefix("~").partition(f".{thruster}.")
        if number:
            by_kind.setdefault(name if kind == "stop" else kind, []).append(i)
    return tuple(np.array(x, dtype=np.int64) for x in by_kind.values())


def _beyond_demand(s: Signatures, k: int, relative: tuple[Array, Array, Array]) -> Iterator[tuple[str, Array]]:
    """Kinds of errors [N] of one bound that are none of the demand, shape (errors, 2 n) each."""
    driving, n = s.predictor.driving, s.predictor.log.n
    thruster, curve = s.predictor.vehicle.thrusters[k], s.predictor.propulsion.curves[k]

    def at_rest(shapes: Callable[[Array], Array]) -> Array:
        return driving.slopes(s.h, k, lambda d: bound_of(thruster, curve, d) * shapes(d))

    speed = inflow(s, k, relative)
    nodes = np.unique(np.quantile(speed, np.linspace(0.0, 1.0, INFLOWS)))
    hats = np.array([np.interp(speed, nodes, hat) for hat in np.eye(nodes.size)])
    yield "inflow", at_rest(lambda d: np.ones((1, d.size))) * hats
    lag, of_shaft = s.predictor.propulsion.lag(k, s.h.given)
    if lag and not of_shaft:
        yield "late", at_rest(lambda d: np.repeat(hats[:, n:], d.size // n, axis=1))
    span = float(np.ptp(s.predictor.propulsion.demands[k]))
    if span:
        yield "stop", at_rest(lambda d: np.stack([stop(d, share * span) for share in WIDTHS]))


def inflow(s: Signatures, k: int, relative: tuple[Array, Array, Array]) -> Array:
    """Velocity of the water along a thruster [m/s], shape (2 n,).

    Args:
        s: signatures at a hypothesis.
        k: index of the thruster.
        relative: u, v, r relative to the water.
    """
    (u, v, r), (x, y) = relative, s.predictor.vehicle.thrusters[k].position
    angle = s.predictor.driving.turned[k]
    return np.asarray((u - y * r) * np.cos(angle) + (v + x * r) * np.sin(angle))


def _places(demand: Array, count: int) -> Callable[[Array], NDArray[np.int64]]:
    """Cells of demands in the order of time: twice as many as ``count``, the second half for falling demands.

    Half of the cells are equally wide, and the other half are equally full: where a demand is kept, the error may jump among its small changes.
    """
    even = np.linspace(demand.min(), demand.max(), count - count // 2 + 1)[1:-1]
    full = np.quantile(demand, np.linspace(0.0, 1.0, count // 2 + 2)[1:-1])
    edges = np.sort(np.r_[even, full])

    def place(d: Array) -> NDArray[np.int64]:
        return np.searchsorted(edges, d) + count * ~upward(d)

    return place


def _in_cells(
    fit: Fit, k: int, place: Callable[[Array], NDArray[np.int64]], visited: NDArray[np.int64]
) -> Callable[[Array], Array]:
    """The errors [N] of one bound in each cell of a thruster's demands."""
    vehicle, propulsion = fit.noise.predictor.vehicle, fit.noise.predictor.propulsion
    return lambda d: bound_of(vehicle.thrusters[k], propulsion.curves[k], d) * (place(d) == visited[:, None])
