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
from ivsid.verification.claims import Part, Three, holds, inside, range_of
from ivsid.verification.covered import covers, meet
from ivsid.verification.decimals import Decimals
from ivsid.verification.integrated import YAW, Integrals
from ivsid.verification.momentum import Momentum
from ivsid.verification.physics import CHANNELS, Columns, Motion, State, model, rigid_body
from ivsid.verification.rational import Range, to_range
from ivsid.verification.turning import forms_of

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
            [tuple(range_of(a, b) for a, b in zip(low[:n], high[:n], strict=True)) for low, high in channel]
            for channel in vertices
        ]
        self._free = [k for k in range(3) if free[k]]
        units = [[Range(int(k == i)) for i in range(3)] for k in range(3)]
        # The factors of the accelerations, which are the same at all velocities: by term (the known body last), acceleration, channel.
        self._inertia = [[self._at(j, State(ZERO, ZERO, ZERO, a, b, c)) for a, b, c in units] for j in range(n + 1)]
        self._since: dict[int, Since] = {}
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

    def begin(self, start: Three) -> None:
        """States in which a tube starts, which the cells of its first step have to hold."""
        self._since = {0: self._fresh(start)}

    def faults(self, parts: Sequence[tuple[int, Part]]) -> list[str | None]:
        """As ``fault``, of all parts of one step, each with the number of its cell of the yaw rate.

        Cells that do not hold every state of the step before are a fault of the first part.
        """
        starts: dict[int, Three] = {}
        for cell, part in parts:
            starts.setdefault(cell, part.start)
        left = self._cut(starts)
        found = [self.fault(part, cell) for cell, part in parts]
        return [left or found[0], *found[1:]]

    def _cut(self, starts: dict[int, Three]) -> str | None:
        """Hands what is known since the start to the cells of the next step; in words where they leave states out."""
        old, free = self._since, len(self._free)
        # A state that is given stands beside the tube, and cells that hold their own last states are the same cells.
        if (
            not old
            or free < 3
            or (old.keys() == starts.keys() and all(inside(starts[c], s.now) for c, s in old.items()))
        ):
            return None
        self._since = {}
        if not all(covers(list(starts.values()), s.now) for s in old.values()):
            return "the cells of the yaw rate leave states of the step before out"
        for cell, start in starts.items():
            first, *others = [s for s in old.values() if meet(s.now, start)] or [self._fresh(start)]
            sizes = [s.size for s in (first, *others)]
            known = [s for s in sizes if s is not None]
            largest = max(known, key=lambda s: s.high) if len(known) == len(sizes) else None
            self._since[cell] = Since(start, first.integrals.joined([s.integrals for s in others]), largest)
        return None

    def fault(self, part: Part, cell: int = 0) -> str | None:
        """The first claim of a part that is not proved, in words; None where all are.

        What follows a part that is not proved counts from its own start.
        """
        found = self._fault(part, cell)
        if found is not None:
            self._since.pop(cell, None)
        return found

    def _fault(self, part: Part, cell: int) -> str | None:
        names = ("u", "v", "r")
        if not self._regular():
            return "the mass matrix is not proved regular"
        span = Range(0, part.h.upper)
        over = [
            x + span * p if k in self._free else x for k, (x, p) in enumerate(zip(part.start, part.rates, strict=True))
        ]
        since = self._continued(part.start, cell)
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
                if not holds(part.rates[i], self._row(i, columns, part.force[i], part.rates)):
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

    def _fresh(self, start: Three) -> Since:
        return Since(start, Integrals(start, self._inertia, self._vertices, self._forms))

    def _continued(self, start: Three, cell: int) -> Since:
        """What is known since the start of the tube, which is this one where the last part does not end inside it."""
        since = self._since.get(cell)
        if since is None or not inside(start, since.now):
            since = self._fresh(start)
        self._since[cell] = since
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
            if kappa >= least and holds(reach, slope):
                moved = part.h * Range(gamma) + part.h.square() * Range(kappa) / 2
                if claim >= moved.upper:
                    return True
            kappa = least + (BEYOND * abs(least - kappa) if attempt >= REPEATED else 0)
        return False
