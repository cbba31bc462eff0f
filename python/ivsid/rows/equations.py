"""The equations of motion of a log and a model, from which every kind of row is made."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence
from copy import copy
from functools import partial
from typing import Final, TypeAlias, TypeVar, cast

import numpy as np
from numpy.typing import NDArray

from ivsid.effects import Columns, Place, State, Term, rigid_body
from ivsid.errors import IvsidError
from ivsid.intervals import FloatArray, Interval, IntervalArray
from ivsid.intervals.pieces import interval_pieces
from ivsid.propulsion.lag import GAP
from ivsid.rows.forces import Forces, KnownForces
from ivsid.rows.record import ROW_KINDS, RegressionRows
from ivsid.rows.required_columns import lacking, needed_by
from ivsid.sensors.bounds import BoundedLog
from ivsid.vehicle import Vehicle

# Holds the rounding of the decimals of the mass and the centre of gravity, and of their products: four roundings of 2^-53 are less.
# Source: theorem: standard model of floating-point arithmetic, Higham 2002, section 2.2
PRODUCT: Final = Interval(1 - 2.0**-50, 1 + 2.0**-50)
# Largest distance between two readings of a heading [rad], errors included, that leaves no doubt about the direction of a turn.
# Source: geometry: below half a turn the shorter way round is the only one
HALF_TURN: Final = np.pi * (1 - 1e-12)
# An arbitrary place, for finding the quantities of a term by numbers.
SOMEWHERE: Final = Place(0.3, 0.0, 0.0, 0.0)

ColumnsOf: TypeAlias = Callable[[State], Columns]
_T = TypeVar("_T")


class Equations:
    """The log, the model and the forces, from which rows are made; the whole log, or a part of it.

    Attributes:
        t: times [s], shape (n,).
        clock: intervals of the times [s], shape (n,).
        channels: intervals of each channel, shape (n,).
        present: where each channel has a sample, shape (n,).
        period: the usual step of the whole log [s].
        owned: number of first samples at which the rows of this part begin; the samples after them complete its windows.
        turning: whether a term turns with the heading, which is then one more quantity that moves.
    """

    def __init__(self, bounded: BoundedLog, vehicle: Vehicle, terms: tuple[Term, ...], known_mass: float) -> None:
        self.bounded, self.vehicle, self.terms = bounded, vehicle, terms
        x_g, y_g = vehicle.hull.centre_of_gravity
        self.mx, self.my, self.mass = vehicle.hull.mass * x_g, vehicle.hull.mass * y_g, known_mass
        numbers = ((self.mx, 0.0, 0.0), (0.0, self.my, 0.0), (0.0, 0.0, self.mass))
        self._known = [partial(rigid_body, mx=a, my=b, mass=c) for a, b, c in numbers if a or b or c]
        self.t = bounded.log.t
        self.period = bounded.log.period
        if (words := lacking(bounded.log, terms, vehicle)) is not None:
            raise IvsidError(words)
        # Decimals of a time are rounded, and so are differences of doubles: steps are intervals, too.
        lost = bounded.log.time_error
        self.clock = interval_pieces(self.t.size, lambda rows: IntervalArray.around(self.t[rows], lost))
        self.channels, self.present = bounded.channels, bounded.present
        self._first, self.owned = 0, self.t.size
        self._sources = KnownForces(bounded, vehicle)
        self._asked: dict[Hashable, object] = {}
        self._made: dict[Hashable, object] = {}
        for name in ("u", "v", "r"):
            self.channel(name)
        self.turning = "psi" in needed_by(terms, vehicle)
        if self.turning:
            self.channel("psi")

    @property
    def forces(self) -> Forces:
        """Known forces at the rows and over the steps between them."""
        return self.once("forces", lambda: self._sources.part(self._first, self._first + self.t.size))

    def part(self, first: int, last: int, further: int) -> Equations:
        """The part of rows from ``first`` up to ``last``, with ``further`` rows after them that complete their windows."""
        end = min(last + further, self.t.size)
        if first == 0 and end == self.t.size and last == end:
            return self
        rows = slice(first, end)
        made = copy(self)
        made.t, made.clock = self.t[rows], self.clock[rows]
        made.channels = {name: x[rows] for name, x in self.channels.items()}
        made.present = {name: there[rows] for name, there in self.present.items()}
        made._first, made.owned, made._made = self._first + first, last - first, {}
        return made

    @property
    def assumes(self) -> tuple[str, ...]:
        """Sentences that the known forces rely on."""
        return self._sources.assumes

    def ask(self, question: Hashable, answer: Callable[[], _T]) -> _T:
        """The answer to a question about the model alone, found once for all parts of a log."""
        if question not in self._asked:
            self._asked[question] = answer()
        return cast(_T, self._asked[question])

    def once(self, key: Hashable, make: Callable[[], _T]) -> _T:
        """A quantity of this part that several channels and kinds of rows share, made once."""
        if key not in self._made:
            self._made[key] = make()
        return cast(_T, self._made[key])

    def acts(self, channel: str) -> bool:
        """Whether the equation of a channel has a parameter."""
        probe = State(1.0, 1.0, 1.0, 1.0, 1.0, 1.0, place=SOMEWHERE)
        return any(channel in term.columns(probe) for term in self.terms)

    def measured(self, channel: str) -> bool:
        """Whether the acceleration of a channel is logged and bounded."""
        names = {"surge": ("udot", "ax"), "sway": ("vdot", "ay"), "yaw": ("rdot",)}[channel]
        derived = self.bounded.log.derived
        return any(n in self.bounded.channels and n not in derived for n in names)

    def known(self, channel: str) -> bool:
        """Whether the acceleration of a channel is bounded at samples, measured or not."""
        own = {"surge": "udot", "sway": "vdot", "yaw": "rdot"}[channel]
        return self.measured(channel) or own in self.bounded.channels

    def channel(self, name: str) -> IntervalArray:
        """The intervals of a channel that the equations need.

        Raises:
            IvsidError: the log lacks the column, or the vehicle file lacks the section of its sensor.
        """
        self.bounded.log.column(name, "by the equations of motion")
        if name not in self.bounded.channels:
            section = {"u": "velocity", "v": "velocity", "r": "yaw_rate", "psi": "heading"}[name]
            raise IvsidError(
                f"vehicle file {self.vehicle.source or self.vehicle.name} has no [sensors.{section}]; it is needed to bound column {name}"
            )
        return self.bounded.channels[name]

    def known_part(self, state: State) -> Columns:
        """The left-hand side of the rigid body, which the vehicle file knows."""
        return rigid_body(state, self.mx, self.my, self.mass)

    def known_force(self, mean: Callable[[ColumnsOf], IntervalArray]) -> IntervalArray:
        """The left-hand side of the rigid body as intervals, from the ``mean`` of its columns.

        Each number of the vehicle file counts by itself, since rounded numbers may cancel in a sum.
        """
        parts = [mean(columns) * PRODUCT for columns in self._known]
        return sum(parts[1:], parts[0]) if parts else IntervalArray(np.array(0.0))

    def needs_rdot(self, channel: str) -> bool:
        """Whether the equation of a channel has the derivative of the yaw rate."""
        rest, probe = (State(0.0, 0.0, 0.0, 0.0, 0.0, rdot, place=SOMEWHERE) for rdot in (0.0, 1.0))
        return self.ask(
            ("rdot", channel),
            lambda: any(
                bool(f(probe).get(channel, 0.0) != f(rest).get(channel, 0.0))
                for f in (*(t.columns for t in self.terms), self.known_part)
            ),
        )

    def ambient(self, channel: str) -> IntervalArray:
        """The interval of the ambient force [N] or moment [N m], which the model leaves out."""
        force, moment = self.bounded.ambient
        reach = moment if channel == "yaw" else force
        return IntervalArray(-reach, reach)

    def whole_steps(self, there: NDArray[np.bool_], usual: float, *, heading: bool) -> NDArray[np.bool_]:
        """Whether each step has no gap, complete rows at both ends and known forces.

        Args:
            there: rows with all needed channels, shape (n,).
            usual: length of the usual step [s].
            heading: the heading is followed, and the direction of its turn must be certain.

        Returns:
            Shape (n - 1,).
        """
        whole: NDArray[np.bool_] = there[1:] & there[:-1] & (np.diff(self.t) <= GAP * usual)
        if heading:
            psi = self.channels["psi"]
            whole &= np.maximum(psi.upper[1:] - psi.lower[:-1], psi.upper[:-1] - psi.lower[1:]) < HALF_TURN
        return whole if self.forces.whole is None else whole & self.forces.whole

    def rows(
        self,
        kind: str,
        index: int,
        matrix: IntervalArray,
        right: IntervalArray,
        time: FloatArray,
        duration: FloatArray,
        assumes: Sequence[str],
    ) -> RegressionRows:
        """Rows of one kind of one channel."""
        channel, kinds = (np.full(time.shape, k, dtype=np.int64) for k in (index, ROW_KINDS.index(kind)))
        return RegressionRows(self.terms, matrix, right, channel, time, duration, kinds, tuple(assumes))


def unit(derivative: str) -> State:
    """The state at rest with one unit acceleration, ``udot``, ``vdot`` or ``rdot``; with none for an empty name."""
    udot, vdot, rdot = (1.0 if derivative == name else 0.0 for name in ("udot", "vdot", "rdot"))
    return State(0.0, 0.0, 0.0, udot, vdot, rdot, place=SOMEWHERE)


def complete(whole: NDArray[np.bool_], count: int) -> NDArray[np.int64]:
    """The starts of ``count`` successive whole steps."""
    if whole.size < count:
        return np.zeros(0, dtype=np.int64)
    total = np.r_[0, np.cumsum(whole)]
    return np.flatnonzero(total[count:] - total[:-count] == count)
