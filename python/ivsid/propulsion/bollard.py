"""Bollard-pull tables: candidates for a thrust curve, and the residuals of each (paper eq. 18, Table III)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ivsid.errors import IvsidError
from ivsid.propulsion.thrust import ROUNDING, table_curve

# Demand [%] and average thrust [N] of the paper's bollard pull.
# Source: paper: Table III.
TABLE_III: Final = (
    (15.0, 20.0, 25.0, 30.0, 35.0, 40.0, 45.0, 50.0, 55.0, 60.0, 65.0, 70.0, 75.0, 80.0, 85.0),
    (
        4.654,
        6.297,
        8.204,
        10.407,
        12.325,
        14.463,
        17.347,
        19.526,
        24.024,
        33.221,
        40.725,
        54.319,
        59.243,
        72.768,
        78.924,
    ),
)
# Coefficients printed for that table, highest power first; they do not fit it.
# Source: paper: eq. 18.
PUBLISHED_CUBIC: Final = (0.0003, -0.015, 0.6008, -1.0902)


# Residuals below this share of the largest thrust are roundings of a curve that goes through its points.
# Source: definition: far above a rounding of doubles, far below a gauge
ROUNDINGS: Final = 1e-12


@dataclass(frozen=True)
class Fit:
    """One candidate for a bollard-pull table.

    Attributes:
        name: for tables and reports.
        coefficients: of a polynomial, highest power first; empty for the table and the quadratic.
        predicted: thrust [N] at the table's demands, shape (n,).
        residual: model minus table [N], shape (n,).
        quadratic: k ahead and astern of T = k n|n|; None for other candidates.
        neutral: the demand from which the curve counts.
    """

    name: str
    coefficients: tuple[float, ...]
    predicted: NDArray[np.float64]
    residual: NDArray[np.float64]
    quadratic: tuple[float, float] | None = None
    neutral: float = 0.0

    @property
    def band(self) -> float:
        """The least accuracy [N] that covers every point of the table, rounded up."""
        return float(np.nextafter(self.largest * (1 + ROUNDING), np.inf)) if self.largest else 0.0

    @property
    def rms(self) -> float:
        """Root of the mean squared residual [N]."""
        return float(np.sqrt(np.mean(self.residual**2)))

    @property
    def largest(self) -> float:
        """Largest absolute residual [N]."""
        return float(np.abs(self.residual).max())

    @property
    def passes(self) -> bool:
        """Whether the curve goes through every point: its residuals are roundings."""
        return self.largest <= ROUNDINGS * float(np.abs(self.predicted).max())


@dataclass(frozen=True)
class Bollard:
    """A bollard-pull table with its candidate models.

    Attributes:
        demand: in the thruster's unit, shape (n,).
        thrust: at these demands [N], shape (n,).
        fits: the candidates.
        dead_band: first and last demand without thrust; None for at most one.
        monotone: whether the thrust never falls with the demand.
    """

    demand: NDArray[np.float64]
    thrust: NDArray[np.float64]
    fits: tuple[Fit, ...]
    dead_band: tuple[float, float] | None
    monotone: bool

    @property
    def recommended(self) -> Fit:
        """The least-squares polynomial of lowest degree that misses by at most 1 % of the largest thrust, else the table."""
        limit = 0.01 * float(np.abs(self.thrust).max())
        polynomials = sorted(
            (f for f in self.fits if f.coefficients and "least" in f.name), key=lambda f: len(f.coefficients)
        )
        good = [f for f in polynomials if f.largest <= limit]
        return good[0] if good else next(f for f in self.fits if not f.coefficients and f.quadratic is None)


def _quadratic(demand: NDArray[np.float64], thrust: NDArray[np.float64]) -> Fit:
    """Least squares of T = k n|n| with one k ahead and one astern; n counts from the middle of the dead band, or from 0."""
    zero = demand[np.abs(thrust) <= 1e-9 * np.abs(thrust).max()]
    neutral = 0.5 * float(zero[0] + zero[-1]) if zero.size > 1 and not zero[0] <= 0 <= zero[-1] else 0.0
    n = demand - neutral
    square = n * np.abs(n)
    k = []
    for side in (n > 0, n < 0):
        energy = float(np.sum(square[side] ** 2))
        k.append(max(float(np.sum(square[side] * thrust[side])) / energy, 0.0) if energy else 0.0)
    predicted = np.where(n < 0, k[1], k[0]) * square
    return Fit("quadratic n|n|, ahead and astern", (), predicted, predicted - thrust, (k[0], k[1]), neutral)


def examine(
    demand: NDArray[np.float64], thrust: NDArray[np.float64], published: tuple[float, ...] | None = None
) -> Bollard:
    """Fits the published cubic (if given), least-squares polynomials of degree 1 to 5, the quadratic n|n|, and the monotone table.

    Residuals are model minus table, positive where the model overstates the thrust.

    Args:
        demand: increasing, shape (n,).
        thrust: at these demands [N], shape (n,).
        published: coefficients of a published cubic, highest power first.

    Raises:
        IvsidError: a table without thrust.
    """
    if not np.abs(thrust).max() > 0:
        raise IvsidError("the table has no thrust at all; look at its thrust column and unit")
    fits = []
    if published is not None:
        predicted = np.asarray(np.polyval(published, demand), dtype=np.float64)
        fits.append(Fit("published cubic", tuple(published), predicted, predicted - thrust))
    for degree in range(1, min(6, len(demand))):
        polynomial = np.polynomial.Polynomial.fit(demand, thrust, degree).convert()
        predicted = np.asarray(polynomial(demand), dtype=np.float64)
        name = f"least-squares polynomial of degree {degree}"
        fits.append(Fit(name, tuple(float(c) for c in polynomial.coef[::-1]), predicted, predicted - thrust))
    fits.append(_quadratic(demand, thrust))
    predicted = table_curve(demand, thrust)(demand)
    fits.append(Fit("monotone table (PCHIP)", (), predicted, predicted - thrust))
    zero = np.flatnonzero(np.abs(thrust) <= 1e-9 * np.abs(thrust).max())
    band = (float(demand[zero[0]]), float(demand[zero[-1]])) if zero.size > 1 else None
    return Bollard(demand, thrust, tuple(fits), band, bool((np.diff(thrust) >= 0).all()))
