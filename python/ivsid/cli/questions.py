"""Questions of ``ivsid init`` on a terminal: what no log states. An empty answer leaves the key to the file."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import typer

from ivsid.cli.terminal import say

if TYPE_CHECKING:
    from ivsid.proposal import Answers, Proposal


def answers(proposal: Proposal) -> Answers:
    """Asks for unknown units, for the mass of the hull, and for the place and the bollard pull of each thruster."""
    from ivsid.proposal import Answers, si_unit  # noqa: PLC0415 - loads libraries that the help does not need

    say("Enter alone leaves a question to the file.")
    scales = {}
    for name, f in proposal.unread.items():
        one = _numbers(f"{f.match.column}: how many {si_unit(name)} is one {f.unread}", 1)
        if one is not None:
            scales[name] = one[0]
    mass = _numbers("mass of the hull with all on board [kg]", 1, above=0.0)
    positions, thrusts = {}, {}
    for d in proposal.demands:
        place = _numbers(f"thruster {d.name}: x forward, y to starboard of the body origin [m], as -0.35, -0.30", 2)
        if place is not None:
            positions[d.name] = (place[0], place[1])
        pull = _numbers(f"thruster {d.name}: bollard pull at the demand {d.neutral + d.span:g} [N]", 1, above=0.0)
        if pull is not None:
            thrusts[d.name] = pull[0]
    return Answers(None if mass is None else mass[0], positions, thrusts, scales)


def _numbers(question: str, count: int, above: float = -math.inf) -> tuple[float, ...] | None:
    """The answer as so many numbers; asked again until it is one, None where it is empty."""
    while True:
        text = typer.prompt(question, default="", show_default=False).strip().strip("[]")
        if not text:
            return None
        try:
            numbers = tuple(float(part) for part in text.split(","))
        except ValueError:
            numbers = ()
        if len(numbers) == count and all(math.isfinite(x) and x > above for x in numbers):
            return numbers
        say(
            f"  {text} is not understood; write {'a positive number' if count == 1 else 'two numbers, parted by a comma'}"
        )
