"""Figures of the gain on the other log, drawn by other processes while the diagnosis still makes its statements."""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

from ivsid.diagnosis.statements.comparison import Gain
from ivsid.intervals.apart import Apart, Prepared
from ivsid.report import figures
from ivsid.report.figures import Drawing

# What is drawn of a gain, in the order of the report.
DRAWN: Final[tuple[Callable[[Gain], Drawing], ...]] = (
    figures.net_force,
    figures.gain,
    figures.force_residual,
)


class GainFigures:
    """Forces, gain and missing forces on the other log.

    Called with the gain of a model, it begins to draw that one's. Its processes load their fonts while the model is fitted.
    """

    def __init__(self) -> None:
        self._gain: Gain | None = None
        self._drawers: list[Prepared[Gain, Drawing]] = [Prepared(draw, figures.warm) for draw in DRAWN]

    def __call__(self, gain: Gain) -> None:
        """Begins to draw a gain, while this process goes on; what was drawn of another one is lost."""
        if self._gain is not None:
            self.end()
            self._drawers = [Prepared(draw, tuple) for draw in DRAWN]
        self._gain = gain
        for drawer in self._drawers:
            drawer.begin(gain)

    def of(self, gain: Gain) -> tuple[Drawing, ...]:
        """The figures of a gain."""
        if self._gain is not gain:
            self(gain)
        return tuple(drawer.result() for drawer in self._drawers)

    def end(self) -> None:
        """Ends what is still drawn."""
        for drawer in self._drawers:
            drawer.end()


def drawn_beside(gain: Gain) -> Callable[[], tuple[Drawing, ...]]:
    """Begins to draw a gain: all figures but the last in another process, and the last one where they are asked for."""
    beside = Apart(lambda: [draw(gain) for draw in DRAWN[:-1]])

    def drawn() -> tuple[Drawing, ...]:
        last = DRAWN[-1](gain)
        return *beside.result(), last

    return drawn
