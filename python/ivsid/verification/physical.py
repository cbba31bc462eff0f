"""Physical bounds as rows, written down a second time: masses of a body in water, and drags that do not drive.

The left-hand side of such a row is at least its right-hand side. It is an assumption and no measurement, so that it holds only where the options of
a result say that it is made.
"""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING, Final

from ivsid.verification.columns import Row, share, value
from ivsid.verification.decimals import stated
from ivsid.verification.errors import UnprovedError
from ivsid.verification.physics import CHANNELS, State
from ivsid.verification.rational import Range

if TYPE_CHECKING:
    from ivsid.verification.rows import Rows

KINDS: Final = ("physical.least", "physical.most", "physical.drag")
# Least and largest total mass, in the hull's mass.
# Source: definition: the assumption of ``ivsid identify --physical`` (docs/theory.md, "Physical bounds")
LEAST, MOST = Fraction(1, 2), Fraction(10)
# Largest variance of positions along a hull, in its squared length.
# Source: theorem: Popoviciu 1935
VARIANCE: Final = Fraction(1, 4)
# Terms that only take energy.
DRAGS: Final = frozenset(
    {
        "drag.surge.quadratic",
        "drag.sway.quadratic",
        "drag.surge.linear",
        "drag.surge.cubic",
        "friction.coulomb",
        "drag.surge.astern",
        "drag.sway.linear",
        "drag.sway.cubic",
        "drag.yaw.linear",
        "drag.yaw.quadratic",
        "drag.yaw.cubic",
        "drag.cross_flow",
        "drag.lift.sway",
    }
)
_OWN: Final = {"surge": "udot", "sway": "vdot", "yaw": "rdot"}
_NAMES: Final = {"surge": "u", "sway": "v", "yaw": "r"}


def physical_row(rows: Rows, kind: str, channel: str, time: float) -> Row:
    """The row of a bound; its right-hand side is the least value of the left one.

    Raises:
        UnprovedError: there is no such row, and why.
    """
    return _drag(rows, channel, time) if kind == "physical.drag" else _mass(rows, kind, channel)


def _mass(rows: Rows, kind: str, channel: str) -> Row:
    """An end of the coefficient of a channel's own acceleration: the whole mass, or the moment of inertia."""
    own = {id_: share(m.columns, _OWN[channel], channel) for id_, m in rows.terms.items()}
    if not any(x.magnitude for x in own.values()):
        raise UnprovedError(f"the model has no mass in {channel}")
    mass = rows.readings.exact(rows.vehicle.hull.mass)
    known = share(rows.known, _OWN[channel], channel)
    if kind == "physical.least":
        return Row(own, (mass * LEAST if channel != "yaw" else Range(0)) - known)
    most = mass * MOST
    if channel == "yaw":
        if rows.vehicle.hull.length is None:
            raise UnprovedError("a hull without a length has no largest moment of inertia")
        length = Fraction(stated(rows.vehicle.text)["hull"]["length"])
        x_g, y_g = rows.readings.exact.pair(rows.vehicle.hull.centre_of_gravity)
        most = most * (x_g.square() + y_g.square() + Range(VARIANCE * length * length))
    return Row({id_: -x for id_, x in own.items()}, known - most)


def _drag(rows: Rows, channel: str, time: float) -> Row:
    """The force of all drags against a motion along one axis alone, at a velocity that the log shows."""
    first, _ = rows.span(time, 0.0)
    along = rows.readings.channel(_NAMES[channel], first)
    if along is None or along.lower <= 0 <= along.upper:
        raise UnprovedError(f"{_NAMES[channel]} at t = {time!r} s has no certain sign")
    zero = Range(0)
    u, v, r = (along if c == channel else zero for c in CHANNELS)
    state = State(u, v, r, zero, zero, zero, psi=zero)
    sign = 1 if along.lower > 0 else -1
    drags = {i: value(m.columns, state, channel) * sign for i, m in rows.terms.items() if i in DRAGS}
    return Row(drags, zero)
