"""What a cause, structure or a declared error may have to stand beside, taken out of the cross-products of a fit."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ivsid.diagnosis.estimation.cross_products import Gram
from ivsid.diagnosis.estimation.fit import Fit
from ivsid.diagnosis.estimation.kinds.candidate import Scored
from ivsid.diagnosis.estimation.projection import Projection
from ivsid.diagnosis.null.any_curve import with_family
from ivsid.diagnosis.null.frequencies import Spectrum

Array = NDArray[np.float64]


class Beside(ABC):
    """The base of a fit beside something that all causes share.

    Args:
        fit: of the model without causes.
    """

    def __init__(self, fit: Fit) -> None:
        self.fit = fit

    @abstractmethod
    def beside(self, g: Gram) -> Gram:
        """Cross-products over the whole log, of what it leaves of columns and of the log.

        Args:
            g: cross-products whose first columns are those of the base.
        """

    def under(self, g: Gram, base: Sequence[int], known: Array) -> Beside:
        """The same where some columns have known coefficients; what takes the same of any log is itself.

        Args:
            g: cross-products whose first columns are those of the base.
            base: indices of the columns that are free.
            known: coefficients by column, 0 for those that are free, shape (columns,).
        """
        del g, base, known
        return self

    def spectrum(self, g: Gram) -> Spectrum | None:
        """Spectrum of the noise beside it; None where what it takes is the colour of the noise itself.

        Args:
            g: cross-products of the base and of further columns.
        """
        del g
        return None

    @cached_property
    def base(self) -> Gram:
        """The same of the base alone."""
        return self.beside(self.fit.bare)

    def fall(self, s: Scored) -> float:
        """Fall of chi-squared of a cause beside the base and this.

        Args:
            s: the cause with its score.
        """
        g, at = with_family(self.fit.bare, self.fit, s)
        return Projection(self.beside(g), range(len(self.fit.base))).solve(at)[1]

    def moved(self, s: Scored) -> Array:
        """What it moves coefficients of a cause by, beside the base, shape (columns,).

        Args:
            s: the cause with its score.
        """
        g, at = with_family(self.fit.bare, self.fit, s)
        whole = range(len(g.names))
        return np.asarray((Projection(self.beside(g), whole).coefficients - Projection(g, whole).coefficients)[at])
