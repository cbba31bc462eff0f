"""Stamps of spreadsheets and MATLAB: days since their zero, told from seconds by the size of the stamps and of their steps."""

from __future__ import annotations

from dataclasses import dataclass
from decimal import Decimal
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ivsid.files import units

# Days of 1970-01-01 since the zero of each program.
# Source: definition: 1899-12-30 for Excel, LibreOffice and Google Sheets, the year 0 for MATLAB's datenum
ZEROS: Final = {"a spreadsheet": 25569, "MATLAB": 719529}
# Largest step of stamps that are days. As seconds it would be 10 kHz, on a clock that has run for nine hours or more.
# Source: definition: samples are less than 8.64 s apart
STEP: Final = 1e-4


@dataclass(frozen=True)
class Days:
    """A calendar of days: whose it is, and its number of 1970-01-01."""

    program: str
    zero: int

    @property
    def seconds(self) -> Decimal:
        """What 1970-01-01 is in seconds."""
        return Decimal(self.zero) * Decimal(repr(units.TIME["d"]))


def days_of(stamps: NDArray[np.float64], years: tuple[float, float]) -> Days | None:
    """The calendar whose days the stamps count, or None.

    Args:
        stamps: shape (n,); NaN is missing.
        years: in which a log may begin [s since 1970].
    """
    known = stamps[np.isfinite(stamps)]
    if known.size < 2:
        return None
    middle = float(np.median(known))
    steps = np.abs(np.diff(known))
    step = float(np.median(steps[steps > 0])) if (steps > 0).any() else 0.0
    if not 0 < step <= STEP:
        return None
    for program, zero in ZEROS.items():
        if years[0] <= (middle - zero) * units.TIME["d"] <= years[1]:
            return Days(program, zero)
    return None


def coarse(stamps: NDArray[np.float64], source: str, name: str) -> str:
    """The sentence on days that were written with too few decimals, so that most of them repeat; or nothing."""
    steps = np.diff(stamps[np.isfinite(stamps)])
    if (steps == 0).sum() * 2 < steps.size or (steps < 0).any():
        return ""
    step = float(np.min(steps[steps > 0])) * units.TIME["d"]
    return (
        f"{source}: column {name} counts days with so few decimals that its stamps stand {step:.3g} s apart and repeat; give the column nine decimals "
        "or the format yyyy-mm-dd hh:mm:ss.000 in the spreadsheet, and save the sheet again"
    )
