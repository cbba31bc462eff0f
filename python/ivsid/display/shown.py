"""Bases of the classes that show themselves in terminals and notebooks."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from importlib import import_module
from typing import TYPE_CHECKING, ClassVar

from ivsid.display.table import Cells, html, text
from ivsid.errors import IvsidError

if TYPE_CHECKING:
    import polars as pl
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


class Shown(ABC):
    """A value with a short text in terminals, and a table in notebooks."""

    @abstractmethod
    def _heading(self) -> str:
        """What it is, in a line."""

    @abstractmethod
    def _cells(self) -> Cells:
        """The rows that a reader looks at first."""

    def __repr__(self) -> str:
        return text(f"{type(self).__name__} {self._heading()}", self._cells())

    # Pydantic prints all fields otherwise.
    __str__ = __repr__

    def _repr_html_(self) -> str:
        return html(f"{type(self).__name__} {self._heading()}", self._cells())


class Result(Shown):
    """A value that is drawn and tabulated, too.

    Attributes:
        drawn_by: draws a result into a figure, or a new one of pyplot. Set once by the root of the package: drawings belong to a chapter that this
            one may not import.
    """

    drawn_by: ClassVar[Callable[[Result, Figure | None], tuple[Axes, ...]]]

    @abstractmethod
    def _columns(self) -> Mapping[str, object]:
        """Its numbers as columns of one length."""

    def plot(self, figure: Figure | None = None) -> tuple[Axes, ...]:
        """Draws the result with Matplotlib.

        Args:
            figure: to draw into; a new one of ``matplotlib.pyplot`` by default, which a notebook shows.

        Returns:
            The axes, from top left to bottom right.
        """
        return type(self).drawn_by(self, figure)

    def to_polars(self) -> pl.DataFrame:
        """The numbers as a Polars data frame."""
        import polars as pl  # noqa: PLC0415 - slow to import

        return pl.DataFrame(dict(self._columns()))

    def to_pandas(self) -> object:
        """The numbers as a pandas data frame.

        Raises:
            IvsidError: pandas is not installed.
        """
        try:
            pandas = import_module("pandas")
        except ImportError:
            raise IvsidError(
                "to_pandas needs pandas, which is not installed; run pip install 'ivsid[pandas]', or use to_polars()"
            ) from None
        return pandas.DataFrame(dict(self._columns()))
