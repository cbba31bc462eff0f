"""A family of causes at its best, with its fall of chi-squared."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

from scipy.stats import chi2

from ivsid.diagnosis.estimation.candidate_columns import Family

# Price of each number beyond the first, in chi-squared: dearer than the 2 of Akaike's criterion.
# Source: measured: make constants
PRICE: Final = 3.0
# Values of a search that get exact columns.
# Source: resource: a period costs four columns, an anchor two
PEAKS: Final = 3


@dataclass(frozen=True)
class Scored:
    """A family at its best.

    Attributes:
        family: the cause.
        fall: of chi-squared.
        count: numbers that are fitted for it, searched ones included.
        looks: independent values that were searched.
        columns: indices among the cross-products.
        theta: coefficients in their units.
        values: the effect's numbers, in the catalogue's order.
        physical: whether the sign is one that the cause can have.
        lost: standard deviations of the score that declared errors inside their bounds may make.
    """

    family: Family
    fall: float
    count: int
    looks: float
    columns: tuple[int, ...]
    theta: tuple[float, ...]
    values: tuple[float, ...]
    physical: bool = True
    lost: float = 0.0

    @property
    def id(self) -> str:
        """The id of its effect."""
        return self.family.id

    def share(self, mass: float) -> float:
        """The largest of its numbers in the size that is usual for a vehicle of this mass [kg]; 1 if no number has such a size."""
        effect = self.family.effect
        if self.family.kind == "claim" or effect.id == "thruster.deadband":
            return 1.0
        sizes = [
            abs(v - q.none) / abs(q.scaled(mass) - q.none)
            for q, v in zip(effect.parameters, self.values, strict=True)
            if q.draw in ("size", "north", "east") and not q.inverse and q.scaled(mass) != q.none
        ]
        return max(sizes, default=1.0)

    @property
    def merit(self) -> float:
        """The fall of chi-squared, less a price for each number beyond the first."""
        return self.fall - PRICE * (self.count - 1)

    @property
    def chance(self) -> float:
        """The probability of such a fall without the effect, over all values that were searched.

        A cause that can have one sign alone gets half of it.
        """
        one = chi2.sf(self.fall, self.count) * self.looks
        sided = (
            self.family.kind != "claim"
            and len(self.family.effect.parameters) == 1
            and not self.family.effect.parameters[0].signed
        )
        return float(min(1.0, one * (0.5 if sided else 1.0)))
