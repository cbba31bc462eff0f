"""Recordings of HBM Catman as text: header lines, a line of channel names, then rows separated by tabs."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ivsid.errors import IvsidError

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Recording:
    """A recording.

    Attributes:
        channels: readings by channel, shape (n,) each, in the unit of the header; the time is none of them.
        nominal: nominal value of the gauge of each channel that states one, in the channel's unit.
    """

    channels: Mapping[str, Array]
    nominal: Mapping[str, float]

    @property
    def means(self) -> dict[str, float]:
        """The mean of every channel."""
        return {name: float(values.mean()) for name, values in self.channels.items()}


def read_catman(path: Path) -> Recording:
    """Reads a recording.

    Raises:
        IvsidError: the file has no channel names or no samples.
    """
    lines = path.read_text(encoding="latin-1").splitlines()
    names = next((line.split("\t") for line in lines if line.startswith("Time")), None)
    rows = []
    for line in lines:
        try:
            row = [float(c) for c in line.split("\t")]
        except ValueError:
            continue
        if names is not None and len(row) == len(names):
            rows.append(row)
    if names is None or len(rows) < 2:
        raise IvsidError(f"{path} is no Catman recording (a line of names that starts with Time, then rows of numbers)")
    stated = next((line.split("\t") for line in lines if line.rstrip().endswith("Nominal value")), [])
    nominal = {}
    for name, cell in zip(names, stated, strict=False):
        found = re.match(r"\s*(-?[\d.]+(?:[eE][-+]?\d+)?) \S+ Nominal value", cell)
        if found:
            nominal[name] = abs(float(found.group(1)))
    columns = np.array(rows).T
    return Recording(dict(zip(names[1:], columns[1:], strict=True)), nominal)
