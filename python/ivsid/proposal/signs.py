"""Units and signs that names leave open: guesses from the ranges of the readings, each with its reason."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ivsid.proposal.columns import Columns
from ivsid.proposal.found import Found
from ivsid.proposal.thrusters import steps_of, word

Array = NDArray[np.float64]

# Angles beyond this [rad] in a column without a unit are degrees, but for a heading that counts its turns.
# Source: geometry: a little more than a full turn, 2 pi
TURN: Final = 6.4
# Range beyond which a heading without a unit is in degrees: as radians it would be ten turns to one side.
# Source: definition: a guess that the proposed file states as a question
TURNS: Final = 60.0
# Yaw rates beyond this in a column without a unit are degrees per second: as radians, a full turn in less than two seconds.
# Source: physics: no vessel of the examples turns faster than 1.5 rad/s
FAST: Final = 3.5
# Time over which changes of the heading are compared with the yaw rate [s].
# Source: physics: the noise of a heading is small against its change over a second of turning
SPAN: Final = 1.0
# Smallest correlation at which the yaw rate and the heading, or demands and the yaw rate, are compared.
# Source: definition: a third of the variance is something else's
CLEAR: Final = 0.8
DEGREE: Final = np.pi / 180.0
# Correlation of sway with the turning beyond which its sign is read off.
# Source: physics: only a strong side thrust or current moves a vessel to the inside of its turns
DRIFT: Final = 0.5
# Words of a heading that counts from north to east, whatever the other axes.
COMPASS: Final = frozenset({"heading", "compass", "hdg", "hdt", "cog"})
UNSAID: Final = "the names do not say"
ASKED: Final = ", and does the sway velocity need the opposite sign, too?"


def settled(columns: Columns) -> tuple[dict[str, Found], str, list[str]]:
    """The channels with the units and signs that their ranges suggest, the frame, and questions for the user.

    Returns:
        Channels by name, ``frd`` or ``flu``, and sentences.
    """
    channels, questions = dict(columns.channels), []
    questions += _heading_unit(channels)
    for name, limit, unit in (("roll", TURN, "deg"), ("pitch", TURN, "deg"), ("r", FAST, "deg/s")):
        found = channels.get(name)
        if found is None or found.stated:
            continue
        largest = _largest(found.values)
        if largest > limit:
            channels[name] = found.with_meaning(unit=unit)
            questions.append(f"{found.match.column} reaches {largest:.4g}, so it is read in {unit}: is that right?")
    heading = _against_heading(channels)
    if any("as if it were in deg" in q for q in heading):
        # The turning of the vessel decides what the range left open.
        questions = [q for q in questions if not q.startswith(f"{channels['psi'].match.column} reaches")]
    questions += _with_it(channels, heading)
    frame: str = columns.program.frame
    if columns.program.plain:
        frame, words = _frame(columns, channels)
        if words and words[-1].startswith(UNSAID) and _with_compass(channels):
            words = []
        questions += words
    questions += _compass(channels, frame)
    mixed = sorted({f.program.name for f in channels.values() if not f.program.plain and f.program.frame != frame})
    if mixed:
        questions.append(
            f"columns of {', '.join(mixed)} have other axes than the rest; their signs are turned here: are they right?"
        )
    return _east_first(_one_frame(channels, frame), frame), frame, questions


def _heading_unit(channels: dict[str, Found]) -> list[str]:
    """The unit of a heading whose name states none: it may count its turns, so that its size alone does not tell."""
    psi = channels.get("psi")
    if psi is None or psi.stated:
        return []
    values = psi.values[np.isfinite(psi.values)]
    if _largest(values) <= TURN:
        return []
    name, largest = psi.match.column, _largest(values)
    unit = _by_course(channels)
    if unit is None:
        rate = _largest(channels["r"].values) if "r" in channels else 0.0
        begins_turned = abs(float(values[0])) > TURN
        unit = "deg" if begins_turned or float(np.ptp(values)) > TURNS or rate > FAST else "rad"
    channels["psi"] = psi.with_meaning(unit=unit)
    return [f"{name} reaches {largest:.4g} and is read in {unit}: is that right?"]


def _by_course(channels: Mapping[str, Found]) -> str | None:
    """The unit in which the heading points along the motion over ground; None where there is none, or where neither does."""
    north, east = ("x", "y") if "x" in channels else ("velocity_north", "velocity_east")
    if north not in channels or east not in channels:
        return None
    psi, n, e = channels["psi"], channels[north], channels[east]
    grid = np.arange(max(f.t[0] for f in (psi, n, e)), min(f.t[-1] for f in (psi, n, e)), SPAN)
    if grid.size < 10:
        return None
    a, b, heading = (_at(f, grid) for f in (n, e, psi))
    if north == "x":
        a, b, heading = np.diff(a), np.diff(b), heading[:-1]
    speed = np.hypot(a, b)
    moving = speed > 0.3 * speed.max()
    course = np.arctan2(b, a)[moving]
    along = {u: abs(np.exp(1j * (course - k * heading[moving])).mean()) for u, k in (("rad", 1.0), ("deg", DEGREE))}
    best = max(along, key=lambda u: along[u])
    return best if along[best] > CLEAR and min(along.values()) < CLEAR else None


def _at(found: Found, grid: Array) -> Array:
    ok = np.isfinite(found.values)
    return np.interp(grid, found.t[ok], found.values[ok])


def _largest(values: Array) -> float:
    return float(np.nanmax(np.abs(values), initial=0.0))


def _against_heading(channels: dict[str, Found]) -> list[str]:
    """The unit and the sign of the yaw rate against the changes of the heading."""
    if "psi" not in channels or "r" not in channels:
        return []
    psi, r = channels["psi"], channels["r"]
    ratio = _turns(psi, r)
    if ratio is None:
        return []
    name, other = r.match.column, psi.match.column
    if not r.stated and 0.5 * DEGREE < abs(ratio) < 2 * DEGREE:
        channels["r"] = r = r.with_meaning(unit="deg/s")
        ratio /= DEGREE
        return [
            f"{other} changes as if {name} were in deg/s, and it is read so: is that right?",
            *_sign(channels, ratio),
        ]
    if not psi.stated and psi.meaning.unit != "deg" and 0.5 < abs(ratio) * DEGREE < 2:
        channels["psi"] = psi.with_meaning(unit="deg")
        return [
            f"{other} changes as if it were in deg where {name} is in rad/s, and it is read so: is that right?",
            *_sign(channels, ratio),
        ]
    if not 0.5 < abs(ratio) < 2:
        return [f"{other} changes {ratio:.3g} times as fast as {name} says: is one of their units another?"]
    return _sign(channels, ratio)


def _sign(channels: dict[str, Found], ratio: float) -> list[str]:
    psi, r = channels["psi"], channels["r"]
    if ratio > 0 or psi.program.frame != r.program.frame:
        return []
    channels["r"] = r.with_meaning(scale=-r.meaning.scale)
    return [
        f"{r.match.column} falls while {psi.match.column} rises, so it is read with the opposite sign: is the heading the one that is positive to "
        f"starboard{ASKED}"
    ]


def _with_it(channels: dict[str, Found], heading: list[str]) -> list[str]:
    """The questions on the heading, after sway and its acceleration took the sign that a turned yaw rate asks of them.

    A vessel drifts to the outside of its turns, v against r, and its specific force points to the inside, a_y along u r.
    """
    if not heading or ASKED not in heading[-1]:
        return heading
    words, found = [], _together(channels, "v", lambda v, r, u: (-v, r))
    for name, agrees in (("v", found), ("ay", _together(channels, "ay", lambda a, r, u: (a, u * r)))):
        if agrees is not None and agrees < -DRIFT:
            channels[name] = f = channels[name].with_meaning(scale=-channels[name].meaning.scale)
            what = "is on the outside of the turns" if name == "v" else "points to the inside of the turns"
            words.append(f"{f.match.column} {what} with the opposite sign alone, so it is read with it: is that right?")
    if found is None or abs(found) <= DRIFT:
        return [*heading, *words]
    return [*heading[:-1], heading[-1].replace(ASKED, "?"), *words]


def _together(
    channels: Mapping[str, Found], name: str, pair: Callable[[Array, Array, Array], tuple[Array, Array]]
) -> float | None:
    """The correlation of two quantities of a channel, the yaw rate and the surge velocity; None where one is missing or at rest."""
    if not {name, "r", "u"} <= channels.keys() or channels[name].program.frame != channels["r"].program.frame:
        return None
    own, r, u = (channels[n] for n in (name, "r", "u"))
    grid = np.arange(max(f.t[0] for f in (own, r, u)), min(f.t[-1] for f in (own, r, u)), SPAN)
    if grid.size < 10 or not all(np.isfinite(f.values).any() for f in (own, r, u)):
        return None
    a, b = pair(*(_at(f, grid) * f.factor for f in (own, r, u)))
    a, b = a - a.mean(), b - b.mean()
    size = float(np.sqrt((a @ a) * (b @ b)))
    return float(a @ b) / size if size > 0 else None


def _with_compass(channels: Mapping[str, Found]) -> bool:
    """Whether the yaw rate turns with a heading that is named as a compass's, and sway lies on the outside of those turns or is not logged."""
    psi, r = channels.get("psi"), channels.get("r")
    if psi is None or r is None or not COMPASS & steps_of(psi.match.column) or (_turns(psi, r) or 0.0) <= 0:
        return False
    outward = _together(channels, "v", lambda v, r, u: (-v, r))
    return "v" not in channels or (outward is not None and outward > DRIFT)


def _compass(channels: dict[str, Found], frame: str) -> list[str]:
    """A heading from north to east in a log whose other axes are forward, port, up: it is turned, and a question says so."""
    psi, r = channels.get("psi"), channels.get("r")
    if frame != "flu" or psi is None or not psi.program.plain or psi.meaning.offset or psi.meaning.scale < 0:
        return []
    ratio = None if r is None else _turns(psi, r)
    named = bool(COMPASS & steps_of(psi.match.column))
    if (ratio is None and not named) or (ratio is not None and ratio > 0):
        return []
    channels["psi"] = psi.with_meaning(scale=-psi.meaning.scale, offset=float(np.pi / 2))
    why = "rises where the yaw rate turns to starboard" if ratio is not None else "is named as a compass heading"
    return [f"{psi.match.column} {why}, so it is read from north to east, unlike the other axes: is that right?"]


def _turns(psi: Found, r: Found) -> float | None:
    """Changes of the heading over those that the yaw rate says, both in SI units; None where they do not go together."""
    ok, good = np.isfinite(psi.values), np.isfinite(r.values)
    if ok.sum() < 10 or good.sum() < 10:
        return None
    tr, rate = r.t[good], r.values[good] * r.factor
    angle = np.concatenate([[0.0], np.cumsum(0.5 * (rate[1:] + rate[:-1]) * np.diff(tr))])
    tp, heading = psi.t[ok], psi.values[ok] * psi.factor
    full = 2 * np.pi
    step = np.diff(heading)
    heading = np.concatenate([[0.0], np.cumsum(step - full * np.round(step / full))])
    grid = np.arange(max(tp[0], tr[0]), min(tp[-1], tr[-1]), SPAN)
    if grid.size < 10:
        return None
    a, b = np.diff(np.interp(grid, tr, angle)), np.diff(np.interp(grid, tp, heading))
    size = float(a @ a), float(b @ b)
    if min(size) <= 0 or abs(float(a @ b)) < CLEAR * np.sqrt(size[0] * size[1]):
        return None
    return float(a @ b) / size[0]


def _frame(columns: Columns, channels: Mapping[str, Found]) -> tuple[str, list[str]]:
    """The frame of plain names: more thrust to port turns the vessel to starboard."""
    sides = {side: [f for n, f in columns.demands.items() if word(n, side)] for side in ("port", "starboard")}
    usual = (
        f'{UNSAID} whether sway and yaw are positive to starboard; frame = "frd" says that they are, "flu" that they are positive to port: '
        "which one is right?"
    )
    if "r" not in channels or not sides["port"] or not sides["starboard"]:
        return "frd", [usual]
    r = channels["r"]
    difference = np.interp(r.t, sides["port"][0].t, sides["port"][0].values) - np.interp(
        r.t, sides["starboard"][0].t, sides["starboard"][0].values
    )
    ok = np.isfinite(difference) & np.isfinite(r.values)
    rate = r.values[ok] * r.factor
    if ok.sum() < 10 or np.ptp(difference[ok]) == 0 or np.ptp(rate) == 0:
        return "frd", [usual]
    together = float(np.corrcoef(difference[ok], rate)[0, 1])
    if together > 0.5:
        return "frd", []
    if together < -0.5:
        return "flu", [
            f'{r.match.column} falls where port pushes more than starboard, so the axes are read as forward, port, up (frame = "flu"): is that right?'
        ]
    return "frd", [usual]


def _east_first(channels: dict[str, Found], frame: str) -> dict[str, Found]:
    """Positions of plain names in the axes of ``flu``, which begin in the east: a name that says north is its y."""
    x, y = channels.get("x"), channels.get("y")
    if frame != "flu" or x is None or y is None or not (x.program.plain and y.program.plain):
        return channels
    if not {"north", "lat", "latitude"} & steps_of(x.match.column):
        return channels
    return {**channels, "x": y.with_meaning(channel="x"), "y": x.with_meaning(channel="y")}


def _one_frame(channels: Mapping[str, Found], frame: str) -> dict[str, Found]:
    """All channels in the axes of one frame; columns of a program with other axes get the opposite sign where they need it."""
    made = dict(channels)
    for name, f in channels.items():
        if f.program.plain or f.program.frame == frame:
            continue
        if name in ("v", "r", "vdot", "rdot", "ay", "pitch"):
            made[name] = f.with_meaning(scale=-f.meaning.scale)
        elif name in ("psi", "x", "y", "qw", "qx", "qy", "qz"):
            # A heading from east or a swapped position would need more than a sign: it is left out.
            del made[name]
    return made
