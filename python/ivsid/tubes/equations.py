"""The model of a fit for the core: its columns, the vertices of its parameters, and the rigid body that the vehicle file knows."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

from ivsid.effects import CHANNELS, terms_of
from ivsid.errors import IvsidError
from ivsid.identification import Identification
from ivsid.intervals import Interval
from ivsid.linear.trajectories import Model, Vertex
from ivsid.rows.equations import PRODUCT
from ivsid.rows.required_columns import needed_by
from ivsid.tubes.columns import columns_of
from ivsid.tubes.parameters import Block, blocks_of, members_of, pieces_of, vertices_of

# Single members that are simulated beside a tube.
# Source: resource: each costs a Runge-Kutta run of the log
MEMBERS: Final = 8
# Most pieces of the parameters.
# Source: resource: a tube takes its time for each
MOST_PIECES: Final = 512


@dataclass(frozen=True)
class Piece:
    """A part of the parameters, as the core and as the checker take it.

    Attributes:
        model: of the core.
        points: vertices in surge, sway and yaw, one end a term and known number.
    """

    model: Model
    points: tuple[list[Vertex], list[Vertex], list[Vertex]]


@dataclass(frozen=True)
class Equations:
    """The model of a fit.

    Attributes:
        pieces: of the parameters, which cover them.
        ids: of its terms.
        blocks: sets of parameters that share rows, with their vertices.
        members: outermost parameters in plain floats, one number a term and known number.
        yaw_cells: cells of the yaw rate, at most, that are followed by themselves where all components are free.
    """

    pieces: tuple[Piece, ...]
    ids: tuple[str, ...]
    blocks: tuple[Block, ...]
    members: list[list[float]]
    yaw_cells: int = 1

    @property
    def model(self) -> Model:
        """The model of the first piece, which is all of the parameters where they are not cut."""
        return self.pieces[0].model

    @property
    def vertices(self) -> tuple[int, int, int]:
        """Largest numbers of vertices in surge, sway and yaw."""
        surge, sway, yaw = (max(len(p.points[k]) for p in self.pieces) for k in range(3))
        return surge, sway, yaw


def equations_of(
    fit: Identification, free: tuple[bool, bool, bool] = (True, True, True), *, cells: int = 1
) -> Equations:
    """The equations of motion of a fit.

    Args:
        fit: with finite intervals of the parameters that act on them.
        free: which of u, v, r follow them; the others are given.
        cells: equal parts into which the interval of each parameter is cut that acts on them.

    Raises:
        IvsidError: a fit or a model that no tube can follow, or more pieces than ``MOST_PIECES``.
    """
    vehicle, form = fit.vehicle, fit.options["form"]
    terms = terms_of(vehicle, form)
    if "psi" in needed_by(terms, vehicle):
        raise IvsidError(
            "the model has a wind that keeps its direction over ground, and a tube follows terms of the velocities alone; leave it out"
        )
    x_g, y_g = vehicle.hull.centre_of_gravity
    mass = vehicle.hull.mass
    numbers = (mass * x_g, mass * y_g, mass if form == "added" else 0.0)
    has = (numbers[0] != 0.0, numbers[1] != 0.0, numbers[2] != 0.0)
    known = [Interval(x) * PRODUCT for x in numbers if x != 0.0]
    program, channels = columns_of(terms, has)
    for k, name in enumerate(CHANNELS):
        if free[k] and not any(column[2][k] for column in channels[k]):
            raise IvsidError(
                f"the model has no mass or inertia in {name}, so that nothing says how it moves there; add the term, or follow surge alone with "
                "--channels surge or straight"
            )
    ids = tuple(t.id for t in terms)
    acting = {ids[c[0]] for k in range(3) if free[k] for c in channels[k] if c[0] < len(ids)}
    blocks = blocks_of(fit, sorted(acting, key=ids.index))
    if cells ** len(acting) > MOST_PIECES:
        raise IvsidError(
            f"cells = {cells} cuts {len(acting)} parameters into {cells ** len(acting)} pieces; {MOST_PIECES} are the most, so give fewer"
        )
    pieces = []
    for piece in [blocks] if cells == 1 else pieces_of(fit, acting, cells):
        # No parameter acts on a channel that is given.
        surge, sway, yaw = (
            vertices_of(piece, ids, known, c if followed else []) for c, followed in zip(channels, free, strict=True)
        )
        ends = {i: e for b in piece for i, e in zip(b.ids, b.box, strict=True)}
        both = [ends.get(i, (0.0, 0.0)) for i in ids] + [(k.lower, k.upper) for k in known]
        hull: Vertex = ([a for a, _ in both], [b for _, b in both])
        pieces.append(Piece(Model(program, channels, (surge, sway, yaw), hull, free), (surge, sway, yaw)))
    return Equations(tuple(pieces), ids, tuple(blocks), members_of(blocks, ids, known, MEMBERS))
