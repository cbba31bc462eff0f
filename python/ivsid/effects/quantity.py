"""The values that the physics is evaluated on."""

from __future__ import annotations

from typing import Any, TypeAlias

# A float, a NumPy array, an interval array, a value with its rate of change, or a symbol of the simulator. They share the
# arithmetic operators, ``abs`` and the functions of ``ivsid.effects.functions``. No static type covers all of them: NumPy's own
# types name neither intervals nor symbols as operands.
Quantity: TypeAlias = Any
