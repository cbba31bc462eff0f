"""The model of a fit for the core: its columns, the vertices of its parameters, and the rigid body that the vehicle file knows."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

from ivsid.effects import terms_of
from ivsid.errors import IvsidError
from ivsid.identification import Identification
from ivsid.intervals import Interval
from ivsid.linear.trajectories import Model, Vertex
from ivsid.rows.equations import PRODUCT
from ivsid.rows.required_columns import needed_by
from ivsid.tubes.columns import columns_of
from ivsid.tubes.parameters import Block, blocks_of, members_of, vertices_of

# Single members that are simulated beside a tube.
# Source: resource: each costs a Runge-Kutta run of the log
MEMBERS: Final = 8


@dataclass(frozen=True)
class Equations:
    """The model of a fit.

    Attributes:
        model: of the core.
        ids: of its terms.
        blocks: sets of parameters that share rows, with their vertices.
        points: vertices in surge, sway and yaw, one end a term and known number.
        members: outermost parameters in plain floats, one number a term and known number.
    """

    model: Model
    ids: tuple[str, ...]
    blocks: tuple[Block, ...]
    points: tuple[list[Vertex], list[Vertex], list[Vertex]]
    members: list[list[float]]

    @property
    def vertices(self) -> tuple[int, int, int]:
        """Numbers of vertices in surge, sway and yaw."""
        return len(self.points[0]), len(self.points[1]), len(self.points[2])


def equations_of(fit: Identification, free: tuple[bool, bool, bool] = (True, True, True)) -> Equations:
    """The equations of motion of a fit.

    Args:
        fit: with finite intervals.
        free: which of u, v, r follow them; the others are given.

    Raises:
        IvsidError: a fit or a model that no tube can follow.
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
    ids = tuple(t.id for t in terms)
    blocks = blocks_of(fit)
    surge, sway, yaw = (vertices_of(blocks, ids, fit, known, c) for c in channels)
    hull: Vertex = (
        [fit.parameters[i].lower for i in ids] + [k.lower for k in known],
        [fit.parameters[i].upper for i in ids] + [k.upper for k in known],
    )
    model = Model(program, channels, (surge, sway, yaw), hull, free)
    return Equations(model, ids, tuple(blocks), (surge, sway, yaw), members_of(blocks, ids, fit, known, MEMBERS))
