"""Cells to channels: scales, missing markers, frames, heading from attitude."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ivsid.errors import IvsidError
from ivsid.files.log_map import Column
from ivsid.memory.pieces import array_pieces

COLUMNS: Final = (
    *("u", "v", "r", "udot", "vdot", "rdot", "ax", "ay", "psi", "x", "y"),
    *("force_X", "force_Y", "moment_N", "wind_speed", "wind_direction"),
    *("qw", "qx", "qy", "qz", "velocity_north", "velocity_east", "depth", "voltage"),
    *("roll", "pitch"),
)
QUATERNION: Final = ("qw", "qx", "qy", "qz")
# One column a thruster: its demand, its direction, its rudder angle.
DEMAND: Final = "demand_"
BY_THRUSTER: Final = (DEMAND, "azimuth_", "rudder_")
# Channels whose sign changes from forward-left-up to forward-right-down body axes; earth axes are handled apart.
_FLU_FLIPPED: Final = ("v", "r", "vdot", "rdot", "ay", "force_Y", "moment_N", "pitch")
_FLU_ANGLES: Final = ("psi", "wind_direction")
# A heading is used only above this cosine of the pitch: its error is that of the attitude divided by the cosine.
# Source: geometry: the horizontal part of the forward axis has the length cos(pitch)
UPRIGHT: Final = 0.1
# Largest deviation of the squared norm of a quaternion from 1: components of two decimals, 0.005 off each, deviate by at most this.
# Source: geometry: the components of a unit quaternion sum to at most 2
NORM_TOLERANCE: Final = 0.02
# Bound on the rounding of a heading [rad] from a quaternion of norm 1: ten roundings of 2^-53 divided by UPRIGHT make 1.1e-14.
# Source: theorem: standard model of floating-point arithmetic, Higham 2002, section 2.2
HEADING_ROUNDING: Final = 1e-13

Array = NDArray[np.float64]
Clocked = tuple[str, str]


@dataclass(frozen=True)
class Channel:
    """Values on a clock.

    Attributes:
        values: shape (n,); NaN is a missing sample.
        clock: table and column of the stamps.
        lost: bound on the error of each conversion, shape (n,); None where there is none beside the rounding of decimals.
    """

    values: Array
    clock: Clocked
    lost: Array | None = None


def converted(values: Array, column: Column, clock: Clocked, lost: Array | None = None) -> Channel:
    """A foreign column as a channel in SI units: without missing markers, scaled and shifted.

    Args:
        values: of the column, or of a formula, shape (n,).
        column: as the map gives it.
        clock: table and column of the stamps.
        lost: bounds on the errors of the values of a formula, shape (n,); None for cells.
    """
    if column.missing is not None and lost is None:
        marked = values
        values = array_pieces(marked.size, lambda part: np.where(marked[part] == column.missing, np.nan, marked[part]))
    if column.factor == 1.0 and column.offset == 0.0:
        return Channel(values, clock, lost)

    def made(part: slice) -> Array:
        # The reader refuses infinities with the name of the column.
        with np.errstate(over="ignore"):
            return np.asarray(values[part] * column.factor + column.offset)

    def rounded(part: slice) -> Array:
        with np.errstate(over="ignore"):
            # Three roundings (factor, product, sum), each of half a unit of the larger operand.
            own = 4 * np.spacing(np.abs(np.nan_to_num(values[part] * column.factor)) + abs(column.offset))
            # The slack holds the rounding of the factor and of both products.
            before = None if lost is None else abs(column.factor) * (1 + 1e-12) * lost[part]
            return _sum(before, own)

    return Channel(array_pieces(values.size, made), clock, array_pieces(values.size, rounded))


def turned(channels: Mapping[str, Channel]) -> dict[str, Channel]:
    """Forward-left-up body and east-north-up earth axes (REP 103) to forward-right-down and north-east-down.

    The angles of azimuth thrusters and rudders turn with the body axes. Channels that name their direction, such as
    ``velocity_north``, are the same in both frames.
    """
    flipped = (*_FLU_FLIPPED, *(c for c in channels if c.startswith(BY_THRUSTER[1:])))
    result: dict[str, Channel] = {}
    for name, c in channels.items():
        if name in flipped:
            result[name] = replace(c, values=_negated(c.values))
        elif name in _FLU_ANGLES:
            # A quarter turn is no double: half a unit of it, and one rounding of the difference.
            lost = 2 * np.spacing(np.abs(np.nan_to_num(c.values)) + 2.0)
            result[name] = replace(c, values=np.pi / 2 - c.values, lost=_sum(c.lost, lost))
        elif name in ("x", "y"):
            result["y" if name == "x" else "x"] = c
        else:
            result[name] = c
    if all(q in channels for q in QUATERNION):
        w, x, y, z = (channels[q].values for q in QUATERNION)
        half = np.sqrt(0.5)
        parts = (half * (w + z), half * (x + y), half * (x - y), half * (w - z))
        for name, part in zip(QUATERNION, parts, strict=True):
            lost = sum(
                (c for c in (channels[q].lost for q in QUATERNION) if c is not None), 8 * np.spacing(np.ones_like(w))
            )
            result[name] = replace(channels[name], values=part, lost=lost)
    return result


def _negated(values: Array) -> Array:
    return array_pieces(values.size, lambda part: np.negative(values[part]))


def with_heading(channels: Mapping[str, Channel], source: str) -> tuple[dict[str, Channel], list[str]]:
    """The channels with ``psi`` from the attitude, where a log has the attitude alone; and notes about it.

    Args:
        channels: by name.
        source: name of the log, for messages.

    Raises:
        IvsidError: a part of the quaternion is missing, or has another clock.
    """
    result = dict(channels)
    has = [q for q in QUATERNION if q in channels]
    if not has or "psi" in channels:
        return result, []
    lacking = [q for q in QUATERNION if q not in channels]
    if lacking or len({channels[q].clock for q in QUATERNION}) > 1:
        raise IvsidError(
            f"{source} has {', '.join(has)} but not {', '.join(lacking) or 'all four on one clock'}; an attitude needs qw, qx, qy, qz"
        )
    w, x, y, z = (channels[q].values for q in QUATERNION)
    norm = w * w + x * x + y * y + z * z
    east, north = 2 * (w * z + x * y), w * w + x * x - y * y - z * z
    usable = (np.abs(norm - 1) < NORM_TOLERANCE) & (np.hypot(east, north) > UPRIGHT * norm)
    psi = np.where(usable, np.arctan2(east, north), np.nan)
    lost = sum((c for c in (channels[q].lost for q in QUATERNION) if c is not None), np.zeros_like(w))
    result["psi"] = Channel(psi, channels["qw"].clock, HEADING_ROUNDING + 4 / UPRIGHT * np.nan_to_num(lost))
    bad = int((~usable & np.isfinite(norm)).sum())
    notes = ["psi follows from the attitude qw, qx, qy, qz"]
    if bad:
        notes.append(f"{bad} attitudes are not of norm 1 or point straight up or down; their heading is missing")
    return result, notes


def _sum(a: Array | None, b: Array) -> Array:
    return b if a is None else a + b
