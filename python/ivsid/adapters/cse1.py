"""CyberShip Enterprise I (NTNU, 2011): free runs by camera, and captive tests in the towing tank.

Origin: github.com/NTNU-MCS/CS_EnterpriseI_archive. Files are known by their content, in any folders: a ``.mat`` file with the matrix
cse1_data is a free run, a Catman recording (``.asc``) with a carriage speed is a towing run, and one with four gauges is a bollard pull, whose
name tells thruster and demand.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ivsid.adapters.captive import ASSUMES, Run, accuracy, drag_intervals, static_run, table
from ivsid.adapters.catman import Recording, read_catman
from ivsid.adapters.imported import Imported, Part, Table, digests, files_below, readable, runs
from ivsid.errors import IvsidError
from ivsid.intervals import IntervalArray
from ivsid.log.matlab import matlab_variables

Array = NDArray[np.float64]

TITLE: Final = "CyberShip Enterprise I (free runs as .mat, captive runs as .asc, in any folders)"
ORIGIN: Final = "github.com/NTNU-MCS/CS_EnterpriseI_archive"
# Rows of the matrix cse1_data. The demands are the set-points u1 to u5: surge and sway pitch of two Voith-Schneider propellers, and the
# bow thruster.
# Source: definition: the published set
NORTH, EAST, PSI, DEMAND, SPEED = 1, 2, 6, 7, 13
# Rows of the velocities that the set derives from its poses.
# Source: definition: the published set
RAW: Final = {"u": 14, "v": 15, "r": 19}
THRUSTERS: Final = ("vsp1_surge", "vsp1_sway", "vsp2_surge", "vsp2_sway", "bow")
# The propeller speed of the bollard pulls; at another speed a demand gives another thrust.
# Source: definition: the published set
BOLLARD_SPEED: Final = 0.4
# Towing speeds up to this one [m/s] give the slope of the slow runs, a number to compare with: nine tenths of the free runs are slower.
# Source: definition: the published set
SLOW: Final = 0.2
# Poses in a stretch shorter than this [rows] between two drop-outs are left out: in random_run1 such a pose, at 264.75 s, jumps by
# 0.19 m and 0.3 rad to the next one.
# Source: measured: make test (tests/python/test_import.py)
ISOLATED: Final = 10


# Gauges of a towing run, and of a bollard pull.
TOWING: Final = ("Fx8113", "Fx8111", "Speed_X")
BOLLARD: Final = ("F8113", "F8114", "F8116")
# A bollard pull by its name: the table, the demand in tenths and its sign, and the force from the means of the gauges. Both Voith-Schneider
# propellers push in the surge pulls: each gives half of the difference of the two surge gauges.
PULLS: Final[tuple[tuple[str, str, Callable[[dict[str, float]], float]], ...]] = (
    ("vsp_surge", r"_(\d\d)_t2_(pos|neg)", lambda m: 0.5 * (m["F8114"] - m["F8113"])),
    ("vsp_sway", r"_u2_(\d\d)_(pos|neg)", lambda m: m["F8114"] + m["F8116"]),
    ("bow_thruster", r"_u5_(\d\d)_(pos|neg)", lambda m: m["F8114"] + m["F8116"]),
)


def read_cse1(folder: Path) -> Imported:
    """Free runs as logs, bollard tables, and towing runs as a static force table with the drag that follows from it.

    A damaged file is left out, and a note names it.

    Raises:
        IvsidError: the folder is missing, or holds no run of the set; one sentence names it.
    """
    (mat, asc), notes = files_below(folder, (".mat", ".asc"), TITLE, ORIGIN)
    matlab, damaged = readable(folder, mat, _matrix)
    foreign = [p for p, data in matlab.items() if data is None]
    free, misshapen = readable(folder, [p for p in matlab if p not in foreign], lambda p: _free_run(p, matlab[p]))
    damaged += misshapen
    captive, broken = readable(folder, asc, _captive)
    if not free and not captive:
        why = f": {(damaged + broken)[0].removeprefix('left out: ')}" if damaged + broken else ""
        raise IvsidError(
            f"{folder} holds no run of the set{why}; give the folder of {TITLE}, which can be had from {ORIGIN}"
        )
    notes += [
        *damaged,
        *broken,
        "a pose of exactly 0 is a drop-out of the cameras: missing, not zero",
        "the runs have no velocity sensor: velocities are enclosed from the pose",
        "towing (least squares) and slopes go through the means of the captive runs: for comparison, not bounds",
    ]
    if foreign:
        notes.append(f"{len(foreign)} MATLAB files have no matrix cse1_data and are none of the runs")
    towed = [c for c in captive.values() if isinstance(c, Run)]
    tables = _tables([c for c in captive.values() if isinstance(c, Pull)])
    names = _names(list(free))
    facts: dict[str, object] = {
        "dropouts": {names[p]: fact for p, (_, fact) in free.items()},
        "slopes": {k: _slope(t) for k, t in tables.items()},
    }
    others = {}
    if towed:
        others["towing"] = table(towed, "u", "force_X")
        facts["towing"] = _drag(others["towing"]["u"], others["towing"]["force_X"])
        facts["captive"] = {"surge": drag_intervals(towed, "surge")}
        notes += [
            f"drag by intervals is not guaranteed, it rests on assumptions: {'; '.join(ASSUMES)}",
            "every run of the tank is straight, without drift or yaw rate: it says nothing of drag in sway and yaw",
        ]
    return Imported(
        title="CyberShip Enterprise I",
        logs={names[p]: part for p, (part, _) in free.items()},
        tables=tables,
        others=others,
        vehicle="cse1.toml",
        facts=facts,
        notes=tuple(notes),
        inputs=digests(folder, [*free, *captive]),
    )


def _names(paths: list[Path]) -> dict[Path, str]:
    """The name of each free run: that of its file, with its folder's where two files have the same."""
    bare = {p: p.stem.removeprefix("CSE1_data_") for p in paths}
    often = {n for n in bare.values() if list(bare.values()).count(n) > 1}
    return {p: f"{p.parent.name}_{n}".replace(" ", "_") if n in often else n for p, n in bare.items()}


def _matrix(path: Path) -> object:
    """The variable cse1_data of a MATLAB file, or None where it has none."""
    return matlab_variables(path, str(path)).get("cse1_data")


def _free_run(path: Path, data: object) -> tuple[Part, dict[str, object]]:
    if not isinstance(data, np.ndarray) or data.ndim != 2 or data.shape[0] <= SPEED or data.shape[1] < 2:
        raise IvsidError(
            f"{path} has no matrix cse1_data of at least {SPEED + 1} rows; give the set as it is published"
        )
    t = data[0].astype(np.float64)
    if not (np.isfinite(t).all() and (np.diff(t) > 0).all()):
        raise IvsidError(f"{path}: the times in row 0 of cse1_data do not increase; give the set as it is published")
    lost = (data[NORTH] == 0) & (data[EAST] == 0) & (data[PSI] == 0)
    isolated = _isolated(lost)
    gone = lost | isolated
    columns = {n: np.where(gone, np.nan, data[k]) for n, k in (("x", NORTH), ("y", EAST), ("psi", PSI))}
    notes = [f"{int(lost.sum())} poses in {runs(lost).size} drop-outs are missing"]
    if isolated.any():
        notes.append(
            f"{int(isolated.sum())} poses that stand alone between two drop-outs, for less than {ISOLATED} rows, are left out: there the "
            "cameras can take something else for the model"
        )
    if data.shape[0] > max(RAW.values()):
        # Each velocity is a difference to the row before: it is wrong where either pose is missing.
        touched = gone | np.r_[True, gone[:-1]]
        columns |= {f"raw_{n}": np.where(touched, np.nan, data[k]) for n, k in RAW.items()}
        notes.append(
            f"raw_u, raw_v, raw_r are differences of the pose over one sample, no measurements of their own: kept to compare with, "
            f"missing at {int(touched.sum())} rows whose difference touches a missing pose"
        )
    at_speed = data[SPEED] == BOLLARD_SPEED
    if at_speed.mean() >= 0.5:
        columns |= {f"demand_{n}": np.where(at_speed, data[DEMAND + k], np.nan) for k, n in enumerate(THRUSTERS)}
        notes.append(
            f"demands count only where the propellers turn at {BOLLARD_SPEED}, as in the bollard pulls: "
            f"{int((~at_speed).sum())} rows are missing"
        )
    else:
        values, counts = np.unique(data[SPEED], return_counts=True)
        usual = float(values[np.argmax(counts)])
        notes.append(
            f"the propellers turned at {usual:g}, but the bollard pulls were taken at {BOLLARD_SPEED}: no thrust is known for "
            "this run, and its demands are left out"
        )
    stretches = runs(lost)
    step = float(np.median(np.diff(t)))
    facts: dict[str, object] = {
        "samples": int(t.size),
        "period": step,
        "missing": int(lost.sum()),
        "left_out": int(isolated.sum()),
        "dropouts": int(stretches.size),
        "longest": float(stretches.max(initial=0) * step),
        "propeller_speed": float(np.median(data[SPEED])),
    }
    return Part(t, columns, tuple(notes)), facts


def _isolated(lost: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Poses in short stretches with a drop-out on both sides."""
    edges = np.flatnonzero(np.diff(np.r_[0, (~lost).astype(np.int8), 0]))
    short = np.zeros(lost.shape, dtype=bool)
    for begin, end in zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True):
        if begin > 0 and end < lost.size and end - begin < ISOLATED:
            short[begin:end] = True
    return short


@dataclass(frozen=True)
class Pull:
    """A bollard pull: its table, demand and mean force [N]."""

    table: str
    demand: float
    force: float


def _captive(path: Path) -> Run | Pull:
    """A Catman recording as what its gauges tell that it is."""
    recording = read_catman(path)
    if set(TOWING) <= set(recording.channels):
        return _towing(path, recording)
    if not set(BOLLARD) <= set(recording.channels):
        raise IvsidError(
            f"{path} has neither the channels {', '.join(TOWING)} of a towing run nor {', '.join(BOLLARD)} of a bollard pull; "
            f"it has {', '.join(recording.channels)}"
        )
    for name, pattern, force in PULLS:
        found = re.search(pattern, path.stem)
        if found:
            demand = int(found.group(1)) / 10 * (1 if found.group(2) == "pos" else -1)
            return Pull(name, demand + 0.0, force(recording.means))
    raise IvsidError(f"{path}: its name tells no demand; give the set as it is published")


def _towing(path: Path, recording: Recording) -> Run:
    """A towing run: two gauges hold the hull against the water at the speed of the carriage."""
    silent = [n for n in TOWING if n not in recording.nominal]
    if silent:
        raise IvsidError(f"{path} states no nominal value of {silent[0]}, from which its accuracy follows")
    c = recording.channels
    front, rear, carriage = (accuracy(recording.nominal[n]) for n in TOWING)
    return static_run(c["Speed_X"], IntervalArray(c["Fx8111"]) - c["Fx8113"], carriage, front + rear)


def _tables(pulls: list[Pull]) -> dict[str, Table]:
    """Bollard tables in order of demand."""
    made = {}
    for name, *_ in PULLS:
        found = [p for p in pulls if p.table == name]
        demands = sorted({p.demand for p in found})
        if demands:
            # Several pulls at one demand count with their mean.
            means = [np.mean([p.force for p in found if p.demand == d]) for d in demands]
            made[name] = Table(np.array(demands), np.array(means))
    return made


def _drag(u: Array, force: Array) -> dict[str, float]:
    """Coefficients of force = linear u + quadratic u|u| by least squares, and the slope of a line through the slow runs."""
    matrix = np.c_[u, u * np.abs(u)]
    (linear, quadratic), *_ = np.linalg.lstsq(matrix, force, rcond=None)
    residual = force - matrix @ np.array([linear, quadratic])
    slow = np.abs(u) <= SLOW
    return {
        "runs": int(u.size),
        "linear": float(linear),
        "quadratic": float(quadratic),
        "rms": float(np.sqrt(np.mean(residual**2))),
        "largest": float(np.abs(residual).max()),
        "slow_slope": float(u[slow] @ force[slow] / (u[slow] @ u[slow])),
    }


def _slope(table: Table) -> float:
    """Thrust at full demand of the straight line through the origin, by least squares [N]."""
    return float(table.demand @ table.thrust / (table.demand @ table.demand))
