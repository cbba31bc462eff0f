"""KVLCC2, a tanker of 320 m, as models sailed it for SIMMAN 2008: free runs of HSVA (7 m, by a planar carriage) and of MARIN (at full scale).

Expected at any depth of the folder: ``*.dat`` of either basin, known by their titles. Both publish the rudder positive to port, and angles in
degrees. HSVA's runs have the measured thrust of the propeller; MARIN's have its revolutions alone.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ivsid.adapters.basins import continuous, rate_of, table_of
from ivsid.adapters.imported import Imported, Part, digests, files_below, readable
from ivsid.errors import IvsidError

Array = NDArray[np.float64]
HSVA: Final = "the free runs of KVLCC2 by HSVA (HSVA_CPMC_KVLCC2_*.dat)"
MARIN: Final = "the free runs of KVLCC2 by MARIN (MARIN_FREE_KVLCC2_*.dat)"
ORIGIN: Final = (
    "the organisers of SIMMAN (simman2020.kr, data of 2008), or doi.org/10.17632/j5zdrhr9bf and the repository it names"
)
# Columns of HSVA's table: time [s], x, y [m], heading [deg], u, v [m/s], two rates [deg/s], rudder [deg], revolutions [1/s], thrust [N], torque [N m].
# Source: definition: the published files; the yaw rate is the rate that the heading follows
HSVA_COLUMNS: Final = 12
# Columns of MARIN's table: time [s], x, y [m], roll, heading [deg], u, v [m/s], two rates [deg/s], rudder [deg], revolutions a minute.
# Source: definition: the published files
MARIN_COLUMNS: Final = 11


def read_hsva(folder: Path) -> Imported:
    """HSVA's runs as logs of a model of 7 m with its measured thrust.

    Raises:
        IvsidError: the folder has no run that can be read; one sentence says so.
    """
    return _set(folder, HSVA, "KVLCC2 by HSVA, a model of 7 m", "kvlcc2.toml", _hsva)


def read_marin(folder: Path) -> Imported:
    """MARIN's runs as logs at full scale, with revolutions in the place of a thrust.

    Raises:
        IvsidError: the folder has no run that can be read; one sentence says so.
    """
    return _set(folder, MARIN, "KVLCC2 by MARIN, at full scale", None, _marin)


def _hsva(path: Path) -> Part:
    table = table_of(path, HSVA_COLUMNS, words=("HSVA", "CPMC", "KVLCC2"))
    rate = rate_of(table, 3, (6, 7))
    columns = {
        **_motion(table, x=1, y=2, psi=3, u=4, v=5, r=rate),
        "demand_propeller": table[:, 10],
        "rudder_propeller": -np.radians(table[:, 8]),
        "revolutions": table[:, 9],
        "torque": table[:, 11],
    }
    return Part(table[:, 0] - table[0, 0], columns)


def _marin(path: Path) -> Part:
    table = table_of(path, MARIN_COLUMNS, words=("MARIN", "KVLCC2"))
    rate = rate_of(table, 4, (7, 8))
    columns = {
        **_motion(table, x=1, y=2, psi=4, u=5, v=6, r=rate),
        "rudder_propeller": -np.radians(table[:, 9]),
        "revolutions": table[:, 10] / 60.0,
    }
    return Part(table[:, 0] - table[0, 0], columns)


def _motion(table: Array, *, x: int, y: int, psi: int, u: int, v: int, r: int) -> dict[str, Array]:
    return {
        "u": table[:, u],
        "v": table[:, v],
        "r": np.radians(table[:, r]),
        "psi": continuous(table[:, psi]),
        "x": table[:, x],
        "y": table[:, y],
    }


def _set(folder: Path, title: str, name: str, vehicle: str | None, read: Callable[[Path], Part]) -> Imported:
    """The runs of one basin, those of the other left aside."""
    ((files,), copies) = files_below(folder, (".dat",), title, ORIGIN)
    found, damaged = readable(folder, files, read)
    others = [n for n in damaged if "no file of the set" in n]
    if not found:
        why = f" ({damaged[0]})" if damaged and not others else ""
        raise IvsidError(
            f"{folder} has no run of the set{why}; give the folder of {title}, which can be had from {ORIGIN}"
        )
    logs = {path.stem: part for path, part in found.items()}
    pushed = (
        "demand_propeller is the thrust as it was measured [N]; what of it moves the hull, and what the rudder makes of the race, are numbers of the vehicle file"
        if vehicle
        else "no thrust was measured: revolutions [1/s] need an open-water diagram; add thrusters with their curves to a vehicle file of yours, at full scale"
    )
    return Imported(
        title=name,
        logs=logs,
        vehicle=vehicle,
        facts={n: {"samples": int(p.t.size), "duration": float(p.t[-1])} for n, p in logs.items()},
        notes=(
            *copies,
            *(n for n in damaged if n not in others),
            "the sets publish the rudder positive to port: rudder_propeller is positive to starboard",
            "velocities are those of the origin of the set, amidships; their accuracy is not stated, and no acceleration was measured",
            pushed,
        ),
        inputs=digests(folder, list(found)),
    )
