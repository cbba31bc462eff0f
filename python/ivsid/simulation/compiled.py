"""Functions compiled from a tape: the equations of motion, and whole Runge-Kutta steps of them."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Final, NamedTuple

import numpy as np

from ivsid.effects.functions import after, astern_square, cross_flow_array, cross_flow_both
from ivsid.effects.quantity import Quantity
from ivsid.simulation.symbols import Line, Symbol, Tape, text

_SCALAR: Final[dict[str, Callable[..., Quantity]]] = {
    "cos": math.cos,
    "sin": math.sin,
    "tanh": math.tanh,
    "sqrt": math.sqrt,
    "arctan2": math.atan2,
    "after": after,
    "astern_square": astern_square,
    "cross_flow": cross_flow_both,
}
_ARRAY: Final[dict[str, Callable[..., Quantity]]] = {
    "cos": np.cos,
    "sin": np.sin,
    "tanh": np.tanh,
    "sqrt": np.sqrt,
    "arctan2": np.arctan2,
    "after": after,
    "astern_square": astern_square,
    "cross_flow": lambda v, r, half: (cross_flow_array(v, r, half, 0), cross_flow_array(v, r, half, 1)),
}

# Moments of a step at which the thrusts may differ.
_MOMENTS: Final = ("first", "middle", "last")


class Steps(NamedTuple):
    """Runge-Kutta steps of a motion.

    Attributes:
        held: from the numbers that hold between samples (zero-order hold) to the further arguments of ``steady``.
        steady: a step under thrusts that hold: from the time, its length, the state and the result of ``held`` to the new state.
        varied: a step whose thrusts differ at its start, middle and end: from the time, its length, the state, the other held
            numbers, and the thrusts of each moment to the new state.
    """

    held: Callable[..., tuple[float, ...]]
    steady: Callable[..., Quantity]
    varied: Callable[..., Quantity]


def function(
    tape: Tape, arguments: Sequence[str], results: Sequence[Quantity], *, arrays: bool = False
) -> Callable[..., tuple[Quantity, ...]]:
    """The function of the named arguments that gives the results: of floats, or of NumPy arrays of one shape."""
    return _of_lines(tape, arguments, tape.needed(results), [text(r) for r in results], arrays=arrays)


def runge_kutta(
    tape: Tape,
    state: Sequence[str],
    held: Sequence[str],
    varying: Sequence[str],
    results: Sequence[Quantity],
    inside: float,
) -> Steps:
    """One step of the classical Runge-Kutta method, written out.

    Args:
        tape: the operations.
        state: names of the state; the time t is one more argument.
        held: names of the numbers that hold over a step.
        varying: those of them that may differ at its start, its middle and its end.
        results: rates of the state, in its order.
        inside: share of the step by which its ends are evaluated from inside.
    """
    lines = tape.needed(results)
    fixed, first, rest = set(held), [], []
    for line in lines:
        if set(line.operands) <= fixed:
            fixed.add(line.name)
            first.append(line)
        else:
            rest.append(line)
    used = {q for line in rest for q in line.operands} | {r.name for r in results if isinstance(r, Symbol)}
    passed = [q for q in (*held, *(line.name for line in first)) if q in used]
    texts = [text(r) for r in results]
    return Steps(
        _of_lines(tape, held, first, passed, arrays=False),
        _made(tape, ["at", "h", *state, *passed], _step(state, (), rest, texts, inside), arrays=False),
        _made(
            tape,
            [
                *("at", "h", *state, *(q for q in held if q not in varying)),
                *(f"{q}_{moment}" for moment in _MOMENTS for q in varying),
            ],
            _step(state, varying, lines, texts, inside),
            arrays=False,
        ),
    )


def _of_lines(
    tape: Tape, arguments: Sequence[str], lines: Sequence[Line], results: Sequence[str], *, arrays: bool
) -> Callable[..., tuple[Quantity, ...]]:
    body = [*(f"{line.name} = {line.expression}" for line in lines), f"return ({', '.join([*results, ''])})"]
    return _made(tape, arguments, body, arrays=arrays)


def _made(
    tape: Tape, arguments: Sequence[str], body: Sequence[str], *, arrays: bool
) -> Callable[..., tuple[Quantity, ...]]:
    source = "\n    ".join([f"def function({', '.join(arguments)}):", *body])
    space: dict[str, Callable[..., Quantity]] = {**(_ARRAY if arrays else _SCALAR), **tape.provided}
    # The text holds only names and numbers that this module made: nothing of a user's file reaches it.
    exec(compile(source, "<equations of motion>", "exec"), space)
    return space["function"]


def _step(
    state: Sequence[str],
    varying: Sequence[str],
    lines: Sequence[Line],
    rates: Sequence[str],
    inside: float,
) -> list[str]:
    """The body of a step: the lines of each of the four stages, without those whose operands have not changed."""
    used = {q for line in lines for q in line.operands} | set(rates)
    body = ["half = 0.5 * h", *(f"from_{q} = {q}" for q in state)]
    times = (f"at + {inside!r} * h", "at + half", None, f"at + h - {inside!r} * h")
    for stage, (time, moment) in enumerate(zip(times, (*_MOMENTS[:2], None, _MOMENTS[2]), strict=True)):
        changed: set[str] = set()
        if time is not None:
            body.append(f"t = {time}")
            changed.add("t")
        if stage:
            far = "h" if stage == 3 else "half"
            moved = [(k, q) for k, q in enumerate(state) if q in used]
            body += [f"{q} = from_{q} + {far} * k{stage - 1}_{k}" for k, q in moved]
            changed.update(q for _, q in moved)
        if moment is not None:
            body += [f"{q} = {q}_{moment}" for q in varying]
            changed.update(varying)
        for name, expression, operands in lines:
            if not stage or changed & set(operands):
                body.append(f"{name} = {expression}")
                changed.add(name)
        body += [f"k{stage}_{k} = {rate}" for k, rate in enumerate(rates)]
    sums = (f"from_{q} + sixth * (k0_{k} + 2.0 * (k1_{k} + k2_{k}) + k3_{k})" for k, q in enumerate(state))
    return [*body, "sixth = h / 6.0", f"return ({', '.join([*sums, ''])})"]
