"""CyberShip Enterprise I (NTNU, 2011): free runs by camera, and captive tests in the towing tank.

Origin: github.com/NTNU-MCS/CS_EnterpriseI_archive. Expected below the folder: ``freerun/*.mat`` and ``captive/SurgeDamping``,
``captive/VSPsurge``, ``captive/VSPsway``, ``captive/BowThruster`` with their ``.asc`` files.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ivsid.adapters.imported import Imported, Part, Table, digests, files_in, runs
from ivsid.errors import IvsidError
from ivsid.log.matlab import matlab_variables

Array = NDArray[np.float64]

TITLE: Final = "CyberShip Enterprise I (freerun/ and captive/)"
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


def read_cse1(folder: Path) -> Imported:
    """Three free runs as logs, three bollard tables, and the towing runs with a least-squares fit of the hull's drag.

    Raises:
        IvsidError: a file is missing or damaged; one sentence names it.
    """
    patterns = [
        "freerun/*.mat",
        *(f"captive/{d}/*.asc" for d in ("SurgeDamping", "VSPsurge", "VSPsway", "BowThruster")),
    ]
    free, towing, surge, sway, bow = files_in(folder, patterns, TITLE, ORIGIN)
    logs, dropouts = {}, {}
    for path in free:
        name = path.stem.removeprefix("CSE1_data_")
        logs[name], dropouts[name] = _free_run(path)
    speed, force = _towing(towing)
    tables = {
        # Both propellers push: each gives half of the difference of the two surge gauges.
        "vsp_surge": _bollard(surge, r"_(\d\d)_t2_(pos|neg)", lambda m: 0.5 * (m["F8114"] - m["F8113"])),
        "vsp_sway": _bollard(sway, r"_u2_(\d\d)_(pos|neg)", lambda m: m["F8114"] + m["F8116"]),
        "bow_thruster": _bollard(bow, r"_u5_(\d\d)_(pos|neg)", lambda m: m["F8114"] + m["F8116"]),
    }
    return Imported(
        title="CyberShip Enterprise I",
        logs=logs,
        tables=tables,
        others={"towing": {"u": speed, "force_X": force}},
        vehicle="cse1.toml",
        facts={
            "dropouts": dropouts,
            "towing": _drag(speed, force),
            "slopes": {k: _slope(t) for k, t in tables.items()},
        },
        notes=(
            "a pose of exactly 0 is a drop-out of the cameras: missing, not zero",
            "the runs have no velocity sensor: velocities are enclosed from the pose",
            "drag and slopes are least squares through the means of the captive runs: for comparison, not bounds",
        ),
        inputs=digests(folder, [*free, *towing, *surge, *sway, *bow]),
    )


def _free_run(path: Path) -> tuple[Part, dict[str, object]]:
    variables = matlab_variables(path, str(path))
    data = variables.get("cse1_data")
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


def asc_means(path: Path) -> dict[str, float]:
    """The mean of every channel of a Catman recording: header lines, then rows separated by tabs.

    Raises:
        IvsidError: the file has no channel names or no samples.
    """
    lines = path.read_text(encoding="latin-1").splitlines()
    names = next((line.split("\t") for line in lines if line.startswith("Time")), None)
    rows = []
    for line in lines:
        cells = line.split("\t")
        try:
            row = [float(c) for c in cells]
        except ValueError:
            continue
        if names is not None and len(row) == len(names):
            rows.append(row)
    if names is None or len(rows) < 2:
        raise IvsidError(f"{path} is no Catman recording (a line of names that starts with Time, then rows of numbers)")
    return dict(zip(names, np.mean(rows, axis=0).tolist(), strict=True))


def _mean(path: Path, *names: str) -> dict[str, float]:
    means = asc_means(path)
    missing = [n for n in names if n not in means]
    if missing:
        raise IvsidError(f"{path} has no channel {missing[0]}; it has {', '.join(means)}")
    return means


def _towing(files: list[Path]) -> tuple[Array, Array]:
    """Speed of the carriage and force of the water on the hull, in order of speed."""
    means = [_mean(p, "Fx8113", "Fx8111", "Speed_X") for p in files]
    speed = np.array([m["Speed_X"] for m in means])
    force = np.array([m["Fx8111"] - m["Fx8113"] for m in means])
    order = np.argsort(speed, kind="stable")
    return speed[order], force[order]


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


def _bollard(files: list[Path], pattern: str, force: Callable[[dict[str, float]], float]) -> Table:
    """A bollard table: each file's name gives the demand in tenths and its sign, the means of its gauges give the force."""
    points: dict[float, float] = {}
    for path in files:
        found = re.search(pattern, path.stem)
        if found is None:
            raise IvsidError(f"{path}: its name tells no demand; give the set as it is published")
        demand = int(found.group(1)) / 10 * (1 if found.group(2) == "pos" else -1)
        points[demand + 0.0] = force(_mean(path, "F8113", "F8114", "F8116"))
    demands = sorted(points)
    return Table(np.array(demands), np.array([points[d] for d in demands]))


def _slope(table: Table) -> float:
    """Thrust at full demand of the straight line through the origin, by least squares [N]."""
    return float(table.demand @ table.thrust / (table.demand @ table.demand))
