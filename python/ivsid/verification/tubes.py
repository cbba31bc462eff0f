"""Parts of steps of a tube, proved once more in exact ranges (docs/theory.md, "Guaranteed simulation", "Checking").

A part claims: velocities that start in a box, under forces and parameters of given ranges, have accelerations inside ``rates`` over the part and
end inside a second box. The proof here takes the terms by their second definitions (``physics``), differentiates by ``Motion``, finds a
parabola of its own, integrates the row of yaw over all parts since the start, and bounds the momentum that no turn changes. It does not prove that the forces are those of the log, nor that the vertices hold the fit's parameters.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Final, TypeAlias

from ivsid.vehicle import Vehicle
from ivsid.verification.decimals import Decimals
from ivsid.verification.integrated import YAW, Integrals
from ivsid.verification.momentum import Momentum
from ivsid.verification.physics import CHANNELS, Columns, Motion, State, model, rigid_body
from ivsid.verification.rational import Range, to_range
from ivsid.verification.turning import forms_of

Three: TypeAlias = tuple[Range, Range, Range]
Vertex: TypeAlias = tuple[Range, ...]
ZERO: Final = Range(0)
# Attempts to find a parabola: each takes the right-hand side of the inequality for the last one.
# Source: resource: each costs a product of ranges, and a claim that no attempt proves is called unproved
ATTEMPTS: Final = 6
# Attempts that repeat the inequality before one goes beyond it.
# Source: resource: the change falls by a H / 2 with each, so that the last is small
REPEATED: Final = 3
# Share of the last change by which later attempts go beyond it, so that the inequality holds for them if a H / 2 is below a ninth.
# Source: theorem: a map that contracts by q < 1 / 9 moves a step of (1 + 1 / 8) by less than its eighth
BEYOND: Final = Fraction(1, 8)


@dataclass(frozen=True)
class Part:
    """A claim: ``start`` and ``end`` hold velocities, ``rates`` accelerations, ``force`` X, Y, N, and ``h`` the length [s]."""

    start: Three
    rates: Three
    end: Three
    force: Three
    h: Range


@dataclass
class Since:
    """What is known since the start of a tube: the velocities now, the integrals, and the bound of the momentum."""

    now: Three
    integrals: Integrals
    size: Range | None = None


class TubeChecker:
    """The equations of a vehicle, for the parts of one tube that are checked one after the other, in order.

    Args:
        vehicle: the checked file.
        form: ``total`` or ``added``.
        vertices: by channel, of the parameters in the order of the model's ids, each with lower and upper ends.
        free: which of u, v, r follow the equations; the others keep their start, and have rates of 0.
    """

    def __init__(
        self,
        vehicle: Vehicle,
        form: str,
        vertices: Sequence[Sequence[tuple[Sequence[float], Sequence[float]]]],
        free: tuple[bool, bool, bool] = (True, True, True),
    ) -> None:
        meanings = model(vehicle, form)
        exact = Decimals(vehicle.text)
        mass = exact(vehicle.hull.mass)
        x_g, y_g = exact.pair(vehicle.hull.centre_of_gravity)
        left_out = mass if form == "added" else None
        self._columns: list[Callable[[State], Columns]] = [m.columns for m in meanings.values()]
        self._known: Callable[[State], Columns] = lambda s: rigid_body(s, mass * x_g, mass * y_g, left_out)
        n = len(self._columns)
        self._vertices: list[list[Vertex]] = [
            [tuple(_range(a, b) for a, b in zip(low[:n], high[:n], strict=True)) for low, high in channel]
            for channel in vertices
        ]
        self._free = [k for k in range(3) if free[k]]
        units = [[Range(int(k == i)) for i in range(3)] for k in range(3)]
        # The factors of the accelerations, which are the same at all velocities: by term (the known body last), acceleration, channel.
        self._inertia = [[self._at(j, State(ZERO, ZERO, ZERO, a, b, c)) for a, b, c in units] for j in range(n + 1)]
        self._since: Since | None = None
        self._forms = forms_of(self._forces, [any(x.low or x.high for k in f for x in k) for f in self._inertia])
        found = None
        if len(self._free) == len(free):
            found = Momentum(self._inertia, self._vertices[:YAW], self._forces, self._forms)
        self._momentum = found if found is not None and found.turns else None

    def _at(self, term: int, state: State) -> list[Range]:
        made = (self._known if term == len(self._columns) else self._columns[term])(state)
        return [to_range(made[c]) if c in made else ZERO for c in CHANNELS]

    def _forces(self, nu: Sequence[Range]) -> list[list[Range]]:
        """The columns at rest of accelerations, by term and channel."""
        u, v, r = nu
        state = State(u, v, r, ZERO, ZERO, ZERO)
        return [self._at(j, state) for j in range(len(self._columns) + 1)]

    def _drifts(self, nu: Sequence[Range], rates: Sequence[Range], i: int) -> list[Range]:
        """Rates of the columns of row i while the velocities move at ``rates``."""
        still = Motion(ZERO, ZERO)
        u, v, r = (Motion(x, rate) for x, rate in zip(nu, rates, strict=True))
        state = State(u, v, r, still, still, still)
        found = []
        for columns in (*self._columns, self._known):
            made = columns(state).get(CHANNELS[i])
            found.append(made.rate if isinstance(made, Motion) else ZERO)
        return found

    def _over_vertices(self, i: int, parts: Sequence[Range], force: Range) -> Range:
        """The range of (force - sum of theta_j parts_j) / M_ii over the vertices of row i, the known body counting once.

        Raises:
            ZeroDivisionError: a mass that is not proved positive.
        """
        found: Range | None = None
        for vertex in self._vertices[i]:
            total, mass = force - parts[-1], self._inertia[-1][i][i]
            for value, part, inertia in zip(vertex, parts, self._inertia, strict=False):
                total, mass = total - value * part, mass + value * inertia[i][i]
            if mass.low <= 0:
                raise ZeroDivisionError("a mass is not proved positive")
            quotient = total / mass
            found = quotient if found is None else found.hull(quotient)
        assert found is not None
        return found

    def _row(self, i: int, columns: Sequence[Sequence[Range]], force: Range, rates: Sequence[Range]) -> Range:
        """Row i solved for its acceleration, the others given."""
        parts = []
        for at, inertia in zip(columns, self._inertia, strict=True):
            part = at[i]
            for k in range(3):
                if k != i and (inertia[k][i].low or inertia[k][i].high):
                    part = part + inertia[k][i] * rates[k]
            parts.append(part)
        return self._over_vertices(i, parts, force)

    def _regular(self) -> bool:
        """Whether each row's mass exceeds the sum of its couplings at every vertex, so that the accelerations are unique."""
        for i in self._free:
            for vertex in self._vertices[i]:
                sizes = []
                for k in range(3):
                    total = self._inertia[-1][k][i]
                    for value, inertia in zip(vertex, self._inertia, strict=False):
                        total = total + value * inertia[k][i]
                    sizes.append(total)
                coupled = sum((sizes[k].magnitude for k in self._free if k != i), Fraction(0))
                if sizes[i].lower <= coupled:
                    return False
        return True

    def fault(self, part: Part) -> str | None:
        """The first claim of a part that is not proved, in words; None where all are.

        What follows a part that is not proved counts from its own start.
        """
        found = self._fault(part)
        if found is not None:
            self._since = None
        return found

    def _fault(self, part: Part) -> str | None:
        names = ("u", "v", "r")
        if not self._regular():
            return "the mass matrix is not proved regular"
        span = Range(0, part.h.upper)
        over = [
            x + span * p if k in self._free else x for k, (x, p) in enumerate(zip(part.start, part.rates, strict=True))
        ]
        since = self._continued(part.start)
        since.now = part.end
        if self._momentum is not None:
            size = self._momentum.size(part.start)
            before = size if since.size is None or since.size.high > size.high else since.size
            since.size = self._momentum.after(before, over, part.force, part.h)
            over = self._momentum.within(since.size, over)
            if any(x.low > x.high for x in over):
                return "the momentum leaves no velocities"
        try:
            columns = self._forces(over)
            if len(self._free) == len(over):
                since.integrals.add(part.h, over, columns, part.force)
            for i in self._free:
                if not _holds(part.rates[i], self._row(i, columns, part.force[i], part.rates)):
                    return f"the accelerations of {names[i]} are not proved"
            for i in self._free:
                for side in (-1, 1):
                    # The row of yaw takes the ends of u and v, which are proved before it.
                    if not self._end(part, over, i, side) and not (
                        i == YAW and self._integrated(part, since.integrals, side)
                    ):
                        return f"the {'lower' if side < 0 else 'upper'} end of {names[i]} is not proved"
        except ZeroDivisionError as error:
            return str(error)
        return None

    def _continued(self, start: Three) -> Since:
        """What is known since the start of the tube, which is this one where the last part does not end inside it."""
        since = self._since
        if since is None or not all(_holds(a, b) for a, b in zip(start, since.now, strict=True)):
            since = Since(start, Integrals(start, self._inertia, self._vertices, self._forms))
        self._since = since
        return since

    def _integrated(self, part: Part, integrals: Integrals, side: int) -> bool:
        """Whether an end of yaw holds by its row over all parts since the start, with one parameter for all of them."""
        if len(self._free) < len(part.end):
            return False
        reached = integrals.yaw(part.end)
        return part.end[YAW].high >= reached.high if side > 0 else part.end[YAW].low <= reached.low

    def _end(self, part: Part, over: Sequence[Range], i: int, side: int) -> bool:
        """Whether one end holds: by the range of the accelerations, or by a parabola that no solution crosses."""
        b = part.start[i].upper if side > 0 else part.start[i].lower
        claim = side * ((part.end[i].upper if side > 0 else part.end[i].lower) - b)
        if claim >= (part.h * part.rates[i] * side).upper or claim >= ((over[i] - Range(b)) * side).upper:
            return True
        face = [Range(b) if k == i else x for k, x in enumerate(part.start)]
        gamma = (self._row(i, self._forces(face), part.force[i], part.rates) * side).upper
        beside = [Range(b) if k == i else x for k, x in enumerate(over)]
        moving = [ZERO if k == i or k not in self._free else p for k, p in enumerate(part.rates)]
        delta = (self._over_vertices(i, self._drifts(beside, moving, i), ZERO) * side).upper
        half, span = Range(0, part.h.upper / 2), Range(0, part.h.upper)
        # The slope of the parabola is asked to stay within this range, and the slopes of the row are those over it.
        room = 8 * (part.rates[i].magnitude + abs(gamma)) * part.h.upper
        reach = Range(gamma - room, gamma + room)
        beside[i] = Range(b) + span * reach * side
        unit = [Range(int(k == i)) for k in range(3)]
        slopes = self._over_vertices(i, self._drifts(beside, unit, i), ZERO)
        kappa = delta + (slopes * Range(gamma)).upper
        for attempt in range(ATTEMPTS):
            slope = Range(gamma) + half * Range(kappa)
            least = delta + (slopes * slope).upper
            if kappa >= least and _holds(reach, slope):
                moved = part.h * Range(gamma) + part.h.square() * Range(kappa) / 2
                if claim >= moved.upper:
                    return True
            kappa = least + (BEYOND * abs(least - kappa) if attempt >= REPEATED else 0)
        return False


def _range(low: float, high: float) -> Range:
    return Range(Fraction(low), Fraction(high))


def _middle(x: Range) -> Fraction:
    return (x.lower + x.upper) / 2


def _holds(outer: Range, inner: Range) -> bool:
    return outer.low <= inner.low and inner.high <= outer.high


def part_of(
    row: Sequence[tuple[float, float]], force: Sequence[tuple[float, float]], h: tuple[float, float], parts: int
) -> Part:
    """A part from the ends of its nine ranges (start, rates, end), the forces of its step, the step's length and its number of parts."""
    ranges = [_range(low, high) for low, high in row]
    push = [_range(low, high) for low, high in force]
    length = Range(Fraction(h[0]) / parts, Fraction(h[1]) / parts)
    return Part(
        (ranges[0], ranges[1], ranges[2]),
        (ranges[3], ranges[4], ranges[5]),
        (ranges[6], ranges[7], ranges[8]),
        (push[0], push[1], push[2]),
        length,
    )
