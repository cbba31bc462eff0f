"""Blue Robotics T200: the maker's bollard pulls at 10 to 20 V, thrust by pulse width.

Expected in the folder: ``T200_10V.csv`` and so on, with the columns PWM [us] and Force [kgf].
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import Final

import numpy as np

from ivsid.adapters.imported import Imported, Table, digests, files_in
from ivsid.errors import IvsidError
from ivsid.files import units
from ivsid.log import open_source

TITLE: Final = "the T200 tables (T200_10V.csv to T200_20V.csv)"
ORIGIN: Final = "the maker's performance data, one CSV a sheet"


def read_t200(folder: Path) -> Imported:
    """One bollard table for each voltage, thrust [N] by pulse width [us].

    Raises:
        IvsidError: a file is missing or damaged; one sentence names it.
    """
    (files,) = files_in(folder, ["T200_*V.csv"], TITLE, ORIGIN)
    tables, facts = {}, {}
    for path in sorted(files, key=_voltage):
        table = _table(path)
        name = f"t200_{_voltage(path)}V"
        tables[name] = table
        idle = table.demand[table.thrust == 0]
        record: dict[str, object] = {
            "points": int(table.demand.size),
            "forward": float(table.thrust.max()),
            "reverse": float(table.thrust.min()),
            "dead_band": [float(idle.min()), float(idle.max())] if idle.size else None,
        }
        facts[name] = record
    return Imported(
        title="T200 thruster",
        tables=tables,
        facts={"tables": facts},
        notes=(
            "bollard pull: at speed a propeller gives less",
            "demands are pulse widths [us]; ivsid thrust turns each table into a thruster with its neutral",
        ),
        inputs=digests(folder, files),
    )


def _voltage(path: Path) -> int:
    found = re.fullmatch(r"T200_(\d+)V", path.stem)
    if found is None:
        raise IvsidError(f"{path}: its name tells no voltage; T200_16V.csv is expected")
    return int(found.group(1))


def _table(path: Path) -> Table:
    with open_source(path) as source:
        pwm = next((c for c in source.columns if c.startswith("PWM")), None)
        force = next((c for c in source.columns if c.startswith("Force")), None)
        if pwm is None or force is None:
            raise IvsidError(f"{path} lacks a column PWM or Force; it has {', '.join(source.columns)}")
        cells = source.numeric([pwm, force])
    there = np.isfinite(cells[pwm]) & np.isfinite(cells[force])
    if there.sum() < 3 or not (np.diff(cells[pwm][there]) > 0).all():
        raise IvsidError(f"{path}: the pulse widths do not increase, or fewer than 3 rows are complete")
    return Table(cells[pwm][there], cells[force][there] * units.FORCE["kgf"], "demand (us)")
