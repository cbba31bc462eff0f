"""Figures of the gain on the other log, drawn by other processes while the diagnosis still makes its statements."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from itertools import chain
from typing import Final

from ivsid.diagnosis.statements.comparison import Gain
from ivsid.intervals.apart import Apart, Prepared
from ivsid.report import figures
from ivsid.report.figures import Drawing

# What is drawn of a gain, in the order of the report, by process: the first loads Matplotlib and its fonts, the second is a copy of it, and the statements need a processor as well.
DRAWN: Final[tuple[tuple[Callable[[Gain], Drawing], ...], ...]] = (
    (figures.net_force, figures.gain),
    (figures.force_residual,),
)


class GainFigures:
    """Forces, gain and missing forces on the other log.

    Called with the gain of a model, it begins to draw that one's. Its processes are ready when the model is fitted: the first loads Matplotlib and its fonts, and the others are copies of it.
    """

    def __init__(self) -> None:
        self._gain: Gain | None = None
        self._parts: list[Callable[[], tuple[Drawing, ...]]] = []
        self._drawers = Prepared.some(len(DRAWN), drawn_in_turn, figures.warm)

    def __call__(self, gain: Gain) -> None:
        """Begins to draw a gain, while this process goes on; what was drawn of another one is lost."""
        self._gain = gain
        self._parts = [
            drawer.begin([partial(draw, gain) for draw in draws])
            for drawer, draws in zip(self._drawers, DRAWN, strict=True)
        ]

    def of(self, gain: Gain) -> tuple[Drawing, ...]:
        """The figures of a gain."""
        if self._gain is not gain:
            self(gain)
        return tuple(chain.from_iterable(drawn() for drawn in self._parts))

    def beside(self, draws: Sequence[Callable[[], Drawing]]) -> Callable[[], tuple[Drawing, ...]]:
        """Begins to draw other figures, where fewer of the gain's are drawn."""
        return self._drawers[-1].begin(draws)

    def end(self) -> None:
        """Ends what is still drawn."""
        for drawer in self._drawers:
            drawer.end()


def drawn_beside(gain: Gain) -> Callable[[], tuple[Drawing, ...]]:
    """Begins to draw a gain: the last figures where they are asked for, and all others in another process."""
    *first, last = ([partial(draw, gain) for draw in draws] for draws in DRAWN)
    beside = Apart(lambda: [drawn_in_turn(draws) for draws in first])
    return lambda: (*chain.from_iterable(beside.result()), *drawn_in_turn(last))


def drawn_in_turn(draws: Sequence[Callable[[], Drawing]]) -> tuple[Drawing, ...]:
    """The drawings, in their order."""
    return tuple(draw() for draw in draws)
