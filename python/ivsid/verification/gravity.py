"""Gravity in the readings of an accelerometer, by the logged attitude, in fractions.

With roll a and pitch b the reading holds g sin b along the vehicle and -g cos b sin a across it. Roll and pitch are logged, or follow
from the vertical that a quaternion turns to.
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from typing import Final, TypeAlias

from ivsid.verification.angles import direction
from ivsid.verification.decimals import Decimals
from ivsid.verification.rational import Range, cosine, pi, root, sided, sine

Raw: TypeAlias = Callable[[str, int], Range | None]

# Gravity [m/s^2] near sea level, from the equator to the poles (9.7803 to 9.8322), with room for mountains and seamounts.
# Source: geometry/physics: normal gravity of the WGS 84 ellipsoid
ANYWHERE: Final = Range(Fraction(976, 100), Fraction(984, 100))
# Half-width [m/s^2] of a stated gravity, as the assumptions of a result give it.
# Source: definition: "within 1e-6" in the assumptions of a result
STATED: Final = Fraction(1, 10**6)
QUATERNION: Final = ("qw", "qx", "qy", "qz")
# A quaternion whose squared norm is off by more than this is no attitude: components logged with two decimals, each off by 0.005 at
# most, change it by 0.01 times the sum of their sizes, which is 2 at most.
# Source: geometry/physics: rounding of a unit quaternion to two decimals
MOST_OFF_UNIT: Final = Fraction(2, 100)


def size(exact: Decimals, stated: bool | float) -> Range:
    """Gravity [m/s^2]: the range near sea level for ``True``, else the stated value."""
    return ANYWHERE if stated is True else exact(stated) + sided(STATED)


def along_and_across(raw: Raw, i: int, accuracy: Range, g: Range) -> tuple[Range, Range]:
    """Gravity in the readings ahead and to starboard at a row [m/s^2]."""
    tilt = _tilt(raw, i)
    # Without an attitude the angle may be any.
    roll, pitch = (Range(-1, 1) * pi() if t is None else t + sided(accuracy) for t in tilt)
    return g * sine(pitch), -(g * (cosine(pitch) * sine(roll)))


def _tilt(raw: Raw, i: int) -> tuple[Range | None, Range | None]:
    """Roll and pitch [rad] of a row; None where they are missing."""
    roll, pitch = raw("roll", i), raw("pitch", i)
    if roll is not None and pitch is not None:
        return roll, pitch
    w, x, y, z = (raw(q, i) for q in QUATERNION)
    if w is None or x is None or y is None or z is None:
        return None, None
    norm = w.square() + x.square() + y.square() + z.square()
    if (norm - 1).magnitude > MOST_OFF_UNIT:
        return None, None
    down, side, up = (w * y - x * z) * 2, (w * x + y * z) * 2, w.square() - x.square() - y.square() + z.square()
    level = root(norm.square() - down.square())
    return direction(side, up), direction(down, level)
