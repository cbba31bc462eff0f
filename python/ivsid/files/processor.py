"""The premise of every number that is read or printed: the processor rounds to nearest and keeps subnormal numbers.

Text becomes doubles, and doubles become text, by code of others that takes this for granted: under another mode its results are off by an ulp, silently.
The core asks the control register. This module asks the arithmetic itself, for the checker of ``ivsid verify``, which loads no core.
"""

from __future__ import annotations

import sys

from ivsid.errors import IvsidError

# Operands stand in a list, so that nothing is computed before it is asked for.
_ONE, _HALF_ULP, _LEAST_NORMAL, _LEAST = [1.0], [sys.float_info.epsilon / 2], [sys.float_info.min], [5e-324]


def rounds_to_nearest() -> bool:
    """Whether this thread's processor rounds to nearest, and neither flushes subnormal results to zero nor takes such operands for zero."""
    one, half, normal, least = _ONE[0], _HALF_ULP[0], _LEAST_NORMAL[0], _LEAST[0]
    nearest = one + half == one and one - half / 2 == one and -one - half == -one and -one + half / 2 == -one
    return nearest and normal / 2 != 0.0 and least != 0.0


def check_rounding() -> None:
    """Refuses to go on under another mode.

    Raises:
        IvsidError: the mode is changed.
    """
    if not rounds_to_nearest():
        raise IvsidError(
            "the processor does not round to nearest or flushes subnormal numbers to zero; undo the change of the floating-point mode, "
            "which another library may have made"
        )
