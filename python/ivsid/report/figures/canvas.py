"""Colours, sizes and files of all figures."""

from __future__ import annotations

import io
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

if TYPE_CHECKING:
    from matplotlib.figure import Figure

# Blue, orange, green, vermilion, purple, black of Okabe and Ito: told apart by colour-blind readers.
COLOURS = ("#0072B2", "#E69F00", "#009E73", "#D55E00", "#CC79A7", "#000000")
# Left, right, upper and lower margin of panels over one axis of time [in]: a label beside seven digits, and a row of names above.
# Source: geometry: seven digits of 10 points and the name of a quantity are 0.9 in wide
MARGINS = (0.95, 0.1, 0.3, 0.5)
FORCE_LABEL = {"surge": "force X [N]", "sway": "force Y [N]", "yaw": "moment N [N m]"}


@dataclass(frozen=True)
class Drawing:
    """A finished figure: file name without ending, title, caption, and the bytes of its two files."""

    name: str
    title: str
    caption: str
    png: bytes
    svg: bytes


def blank(size: tuple[float, float], layout: Literal["constrained"] | None = None) -> Figure:
    """An empty figure [in].

    The first one loads Matplotlib, for which a process that leaves its figures to another has no use.
    """
    from matplotlib.figure import Figure  # noqa: PLC0415

    return Figure(figsize=size, layout=layout)


def finish(name: str, title: str, caption: str, figure: Figure) -> Drawing:
    """The drawing with its two files."""
    import matplotlib as mpl  # noqa: PLC0415 - it is loaded with the figure
    from matplotlib.backends.backend_agg import FigureCanvasAgg  # noqa: PLC0415

    FigureCanvasAgg(figure)
    files = []
    # No date and a fixed salt: the same input gives the same bytes.
    with mpl.rc_context({"svg.hashsalt": "ivsid", "path.simplify_threshold": 0.5}):
        engine = figure.get_layout_engine()
        if engine is not None:
            # One layout serves both files; each file would else lay the figure out twice.
            engine.execute(figure)
            figure.set_layout_engine(None)
        for kind in ("png", "svg"):
            buffer = io.BytesIO()
            metadata: dict[str, str | None] = {"Date": None} if kind == "svg" else {"Software": None}
            figure.savefig(buffer, format=kind, dpi=110, metadata=metadata)
            files.append(buffer.getvalue())
    return Drawing(name, title, caption, files[0], files[1])


def warm() -> Drawing:
    """A drawing that nobody sees: it loads the fonts and the writers of files that others need."""
    figure = blank((2.0, 2.0), layout="constrained")
    axes = figure.add_subplot()
    axes.plot([0.0, 1.0], [0.0, 1.0], label="0123456789 −.eE")
    axes.set_xlabel("XYNmrads[]/")
    figure.legend(fontsize=8, loc="outside upper left", frameon=False)
    return finish("", "", "", figure)


def fixed(figure: Figure) -> Figure:
    """The figure with panels at fixed margins and labels: to measure every label takes as long as to draw it.

    Its legend stands right of the place above a panel where a power of ten may stand.
    """
    (width, height), (left, right, top, bottom) = figure.get_size_inches(), MARGINS
    figure.subplots_adjust(left / width, bottom / height, 1.0 - right / width, 1.0 - top / height, hspace=0.2)
    for axes in figure.axes:
        axes.yaxis.set_label_coords(0.3 / width, float(axes.get_position().intervaly.mean()), figure.transFigure)
    figure.axes[-1].xaxis.set_label_coords(0.5, 0.22 / height, figure.transFigure)
    return figure


def thin(n: int, most: int = 3000) -> slice:
    """A stride that leaves about ``most`` samples in a figure."""
    return slice(None, None, max(1, n // most))
