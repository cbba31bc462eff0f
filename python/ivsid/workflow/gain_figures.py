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

# What is drawn of a gain, in the order of the report, by process: each loads the fonts anew, and the statements need a processor as well.
DRAWN: Final[tuple[tuple[Callable[[Gain], Drawing], ...], ...]] = (
    (figures.net_force, figures.gain),
    (figures.force_residual,),
)


class GainFigures:
    """Forces, gain and missing forces on the other log.

    Called with the gain of a model, it begins to draw that one's. Its processes load their fonts while the model is fitted.
    """

    def __init__(self) -> None:
        self._gain: Gain | None = None
        self._drawers = [Prepared(partial(_all, draws), figures.warm) for draws in DRAWN]

    def __call__(self, gain: Gain) -> None:
        """Begins to draw a gain, while this process goes on; what was drawn of another one is lost."""
        if self._gain is not None:
            self.end()
            self._drawers = [Prepared(partial(_all, draws), tuple) for draws in DRAWN]
        self._gain = gain
        for drawer in self._drawers:
            drawer.begin(gain)

    def of(self, gain: Gain) -> tuple[Drawing, ...]:
        """The figures of a gain."""
        if self._gain is not gain:
            self(gain)
        return tuple(chain.from_iterable(drawer.result() for drawer in self._drawers))

    def end(self) -> None:
        """Ends what is still drawn."""
        for drawer in self._drawers:
            drawer.end()


def drawn_beside(gain: Gain) -> Callable[[], tuple[Drawing, ...]]:
    """Begins to draw a gain: the last figures where they are asked for, and all others in another process."""
    beside = Apart(lambda: [_all(draws, gain) for draws in DRAWN[:-1]])

    def drawn() -> tuple[Drawing, ...]:
        last = _all(DRAWN[-1], gain)
        return *chain.from_iterable(beside.result()), *last

    return drawn


def _all(draws: Sequence[Callable[[Gain], Drawing]], gain: Gain) -> tuple[Drawing, ...]:
    return tuple(draw(gain) for draw in draws)
