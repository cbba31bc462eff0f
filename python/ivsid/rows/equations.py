"""The equations of motion of a log and a model: what every kind of row is made of."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence
from copy import copy
from functools import cached_property, partial
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from ivsid.effects import Columns, Place, State, Term, rigid_body
from ivsid.errors import IvsidError
from ivsid.intervals import FloatArray, Interval, IntervalArray
from ivsid.propulsion.lag import GAP
from ivsid.rows.forces import Forces, KnownForces
from ivsid.rows.needs import lacking, needed_by
from ivsid.rows.record import ROW_KINDS, RegressionRows
from ivsid.sensors.bounds import BoundedLog
from ivsid.vehicle import Vehicle

# Decimals of the mass and the centre of gravity are rounded, and their products too: this factor holds what that can lose.
PRODUCT: Final = Interval(1 - 2.0**-50, 1 + 2.0**-50)
# A truth that turns by less than pi has readings less than this apart, errors included, only the right way round.
HALF_TURN: Final = np.pi * (1 - 1e-12)
# A place for questions of which quantities stand in a term.
SOMEWHERE: Final = Place(0.3, 0.0, 0.0, 0.0)


class Equations:
    """The log, the model and the forces, while rows are made of them; the whole log, or a part of it.

    Attributes:
        t: times [s], shape (n,).
        clock: the same enclosed.
        channels: intervals of each channel, shape (n,).
        present: where each has a sample.
        period: the usual step of the whole log [s].
        owned: rows that a part makes rows of the regression for; those after them complete its windows.
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
        # The decimals of a time may round, and a difference of doubles too: steps are enclosed like everything else.
        self.clock = IntervalArray.around(self.t, bounded.log.time_error)
        self.channels, self.present = bounded.channels, bounded.present
        self._first, self.owned = 0, self.t.size
        self._sources = KnownForces(bounded, vehicle)
        self._asked: dict[Hashable, Any] = {}
        self._made: dict[Hashable, Any] = {}
        for name in ("u", "v", "r"):
            self.channel(name)
        # Some terms turn with the vehicle; the heading is one more quantity that moves.
        self.turning = "psi" in needed_by(terms, vehicle)
        if self.turning:
            self.channel("psi")

    @cached_property
    def forces(self) -> Forces:
        """Known forces at the rows and over the steps between them."""
        return self._sources.part(self._first, self._first + self.t.size)

    def part(self, first: int, last: int, further: int) -> Equations:
        """Of rows from ``first`` up to ``last``, and of ``further`` rows after them that complete their windows."""
        end = min(last + further, self.t.size)
        if first == 0 and end == self.t.size and last == end:
            return self
        rows = slice(first, end)
        made = copy(self)
        made.__dict__.pop("forces", None)
        made.t, made.clock = self.t[rows], self.clock[rows]
        made.channels = {name: x[rows] for name, x in self.channels.items()}
        made.present = {name: there[rows] for name, there in self.present.items()}
        made._first, made.owned, made._made = self._first + first, last - first, {}
        return made

    @property
    def assumes(self) -> tuple[str, ...]:
        """What the known forces rest on."""
        return self._sources.assumes

    def ask(self, question: Hashable, answer: Callable[[], Any]) -> Any:
        """The answer to a question about the model alone, which is the same for all parts of a log."""
        if question not in self._asked:
            self._asked[question] = answer()
        return self._asked[question]

    def once(self, what: Hashable, make: Callable[[], Any]) -> Any:
        """What several channels and kinds of rows need of the same rows, made once."""
        if what not in self._made:
            self._made[what] = make()
        return self._made[what]

    def acts(self, channel: str) -> bool:
        """Whether a parameter stands in the channel's equation."""
        probe = State(1.0, 1.0, 1.0, 1.0, 1.0, 1.0, place=SOMEWHERE)
        return any(channel in term.columns(probe) for term in self.terms)

    def measured(self, channel: str) -> bool:
        """Whether the channel's own acceleration is logged and bounded."""
        names = {"surge": ("udot", "ax"), "sway": ("vdot", "ay"), "yaw": ("rdot",)}[channel]
        derived = self.bounded.log.derived
        return any(n in self.bounded.channels and n not in derived for n in names)

    def known(self, channel: str) -> bool:
        """Whether the channel's own acceleration is bounded at samples, measured or not."""
        own = {"surge": "udot", "sway": "vdot", "yaw": "rdot"}[channel]
        return self.measured(channel) or own in self.bounded.channels

    def channel(self, name: str) -> IntervalArray:
        """The intervals of a channel that the equations cannot do without."""
        self.bounded.log.column(name, "by the equations of motion")
        if name not in self.bounded.channels:
            section = {"u": "velocity", "v": "velocity", "r": "yaw_rate", "psi": "heading"}[name]
            raise IvsidError(
                f"vehicle file {self.vehicle.source or self.vehicle.name} has no [sensors.{section}]; it is needed to bound column {name}"
            )
        return self.bounded.channels[name]

    def known_part(self, state: State) -> Columns:
        """The left-hand side that the vehicle file knows already."""
        return rigid_body(state, self.mx, self.my, self.mass)

    def known_force(self, mean: Callable[[Callable[[State], Columns]], IntervalArray]) -> IntervalArray:
        """The same in intervals, from what ``mean`` makes of columns: number by number, since rounded ones may cancel in a sum."""
        parts = [mean(columns) * PRODUCT for columns in self._known]
        return sum(parts[1:], parts[0]) if parts else IntervalArray(np.array(0.0))

    def needs_rdot(self, channel: str) -> bool:
        """Whether the derivative of the yaw rate stands in the channel's equation."""
        still, probe = (State(0.0, 0.0, 0.0, 0.0, 0.0, rdot, place=SOMEWHERE) for rdot in (0.0, 1.0))
        return bool(
            self.ask(
                ("rdot", channel),
                lambda: any(
                    f(probe).get(channel, 0.0) != f(still).get(channel, 0.0)
                    for f in (*(t.columns for t in self.terms), self.known_part)
                ),
            )
        )

    def ambient(self, channel: str) -> IntervalArray:
        """All that the force [N] or moment [N m] that nobody models may be."""
        force, moment = self.bounded.ambient
        reach = moment if channel == "yaw" else force
        return IntervalArray(-reach, reach)

    def whole_steps(self, there: NDArray[np.bool_], usual: float, *, heading: bool) -> NDArray[np.bool_]:
        """Steps of no gap between rows that are both there, with known forces.

        Args:
            there: rows that have all that is needed.
            usual: length of the usual step [s].
            heading: it is followed, and must not be able to have turned either way round.
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
    """At rest, with one unit acceleration."""
    udot, vdot, rdot = (1.0 if derivative == name else 0.0 for name in ("udot", "vdot", "rdot"))
    return State(0.0, 0.0, 0.0, udot, vdot, rdot, place=SOMEWHERE)


def complete(whole: NDArray[np.bool_], count: int) -> NDArray[np.int64]:
    """Where ``count`` whole steps follow each other."""
    if whole.size < count:
        return np.zeros(0, dtype=np.int64)
    total = np.r_[0, np.cumsum(whole)]
    return np.flatnonzero(total[count:] - total[:-count] == count)
