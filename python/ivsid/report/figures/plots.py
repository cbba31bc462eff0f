"""Results drawn on demand, for ``result.plot()``: the same drawings as on the pages, in a figure of pyplot or of the caller."""

from __future__ import annotations

from functools import singledispatch

import matplotlib.pyplot as plt
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ivsid.diagnosis import Diagnosis
from ivsid.display.shown import Result
from ivsid.identification import Following, Identification
from ivsid.log import Log
from ivsid.report.figures.diagnosis import RESIDUAL_SIZE, draw_residual
from ivsid.report.figures.fits import draw_bounds, draw_intervals, intervals_size
from ivsid.report.figures.following import draw_narrowing, narrowing_size
from ivsid.report.figures.measurements import channels_size, draw_channels
from ivsid.report.figures.tubes import draw_tube, tube_size
from ivsid.tubes import Tube
from ivsid.validation import Validation


def plot(result: Result, figure: Figure | None) -> tuple[Axes, ...]:
    """Draws a result into a figure, by default a new one of pyplot, which notebooks show.

    A fit is drawn as its intervals, a validation as bounds of the forces against the measured ones, a diagnosis as the missing force before and after, a
    log as its channels, tubes as those of the shortest windows, a following as its intervals over time.
    """
    return tuple(_drawn(result, figure).axes)


@singledispatch
def _drawn(result: Result, figure: Figure | None) -> Figure:
    raise TypeError(f"a {type(result).__name__} has no plot")


@_drawn.register
def _(result: Identification, figure: Figure | None) -> Figure:
    figure = figure or plt.figure(figsize=intervals_size([result]), layout="constrained")
    draw_intervals(figure, [result])
    return figure


@_drawn.register
def _(result: Following, figure: Figure | None) -> Figure:
    figure = figure or plt.figure(figsize=narrowing_size(result), layout="constrained")
    draw_narrowing(figure, result)
    return figure


@_drawn.register
def _(result: Validation, figure: Figure | None) -> Figure:
    rows = max(len(result.forces), 1)
    figure = figure or plt.figure(figsize=(8.5, 2.4 * rows + 0.8), layout="constrained")
    for axes, check in zip(figure.subplots(rows, 1, squeeze=False)[:, 0], result.forces, strict=False):
        draw_bounds(axes, check)
    return figure


@_drawn.register
def _(result: Diagnosis, figure: Figure | None) -> Figure:
    figure = figure or plt.figure(figsize=RESIDUAL_SIZE, layout="constrained")
    draw_residual(figure, result.gain)
    return figure


@_drawn.register
def _(result: Log, figure: Figure | None) -> Figure:
    figure = figure or plt.figure(figsize=channels_size(result), layout="constrained")
    draw_channels(figure, result)
    return figure


@_drawn.register
def _(result: Tube, figure: Figure | None) -> Figure:
    figure = figure or plt.figure(figsize=tube_size(len(result.components)), layout="constrained")
    run = result.runs[1] if len(result.runs) > 1 else result.runs[0]
    draw_tube(figure, result, run, result.components)
    return figure
