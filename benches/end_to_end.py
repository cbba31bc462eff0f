"""From a file of a million samples to proved intervals: seconds of each stage, beside a user's own script.

The log repeats one simulated run of ten minutes (the paper's SWAN) until it has a million samples; a gap stands between two runs. The
peer reads the same CSV with Polars, makes the pointwise rows of surge and sway with NumPy in plain floats, and solves the four programs of the
two parameters by constraint generation with HiGHS: neither the rows nor the bounds are proved, and yaw is left out.

Run: python benches/end_to_end.py [ROWS]
"""

from __future__ import annotations

import sys
import tempfile
import time
from collections.abc import Callable
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np
import polars as pl
from feasible import numpy_generation

import ivsid
from ivsid.effects import terms_of
from ivsid.files.records import sealed, to_json
from ivsid.identification.method import identify_rows
from ivsid.log import read_log
from ivsid.programme.scenario import parse_scenario
from ivsid.rows import build_rows
from ivsid.sensors.bounds import bound_log
from ivsid.simulation import simulate
from ivsid.vehicle import Vehicle, parse_vehicle


def swan() -> tuple[Vehicle, dict[str, Any]]:
    """The vehicle, and ten minutes of it."""
    texts = [(files("ivsid") / "data" / f"{n}.toml").read_text() for n in ("swan", "swan_train")]
    vehicle, scenario = parse_vehicle(texts[0], "swan"), parse_scenario(texts[1], "swan_train")
    made = simulate(vehicle, scenario.model_copy(update={"duration": 600.0, "rate": 20.0}), 1)
    return vehicle, {"t": made.t, **made.columns}


def repeated(columns: dict[str, Any], rows: int) -> pl.DataFrame:
    """The run again and again, each ten seconds after the one before."""
    size = columns["t"].size
    count = -(-rows // size)
    t = np.concatenate([columns["t"] + 610.0 * k for k in range(count)])[:rows]
    return pl.DataFrame({n: t if n == "t" else np.tile(x, count)[:rows] for n, x in columns.items()})


def stage(words: str, work: Callable[[], Any], repeat: int = 3) -> tuple[float, Any]:
    """Prints the least time of a stage on the clock and of the processors."""
    walls, spents, result = [], [], None
    for _ in range(repeat):
        wall, spent = time.perf_counter(), time.process_time()
        result = work()
        walls.append(time.perf_counter() - wall)
        spents.append(time.process_time() - spent)
    print(f"  {words:52} {min(walls):6.3f} s on the clock, {min(spents):6.3f} s of the processors", flush=True)
    return min(walls), result


def by_hand(path: Path, vehicle: Vehicle) -> Any:
    """The peer."""
    frame = {column.name: column.to_numpy() for column in pl.read_csv(path)}
    table = vehicle.thrusters[0].table
    assert table is not None
    demand, thrust = np.r_[0.0, table.demand], np.r_[0.0, table.thrust]
    force = sum(np.interp(frame[f"demand_{t.name}"], demand, thrust) for t in vehicle.thrusters)
    rates = [frame["ax"], frame["ay"]]
    # Some 3 million errors at 0.999.
    k = 6.4
    radii = [(k * (w / np.sqrt(0.05) + b)) for w, b in ((0.0018, 3.0e-4), (0.002, 2.8e-4))]
    lower, upper, low, high = [], [], [], []
    for rate, radius, name, known in zip(rates, radii, ("u", "v"), (force, np.zeros_like(force)), strict=True):
        first = (frame[name] - 0.002) / 1.004, (frame[name] - 0.002) / 0.996
        second = (frame[name] + 0.002) / 1.004, (frame[name] + 0.002) / 0.996
        a, b = np.minimum(*first), np.maximum(*second)
        lower.append(np.stack([rate - radius, a * np.abs(a)], 1))
        upper.append(np.stack([rate + radius, b * np.abs(b)], 1))
        low.append(known - 1.5)
        high.append(known + 1.5)
    return numpy_generation(tuple(np.concatenate(q) for q in (lower, upper, low, high)))  # type: ignore[arg-type]


def main() -> None:
    """Prints the stages and the ratio."""
    rows = int(float(sys.argv[1])) if len(sys.argv) > 1 else 1_000_000
    vehicle, columns = swan()
    with tempfile.TemporaryDirectory() as place:
        frame = repeated(columns, rows)
        csv, parquet = Path(place) / "log.csv", Path(place) / "log.parquet"
        frame.write_csv(csv)
        frame.write_parquet(parquet)
        print(f"{rows} samples of SWAN, the paper's model:")
        slow, _ = stage("read and check the CSV", lambda: read_log(csv, vehicle.log))
        quick, log = stage("read and check the Parquet file", lambda: read_log(parquet, vehicle.log))
        bounding, bounded = stage("an interval for every reading", lambda: bound_log(log, vehicle))
        terms = terms_of(vehicle)
        for kind in ("pointwise", "integral"):
            stage(f"rows, {kind}", lambda: build_rows(bounded, vehicle, terms, kind=kind))  # noqa: B023 - called at once
        building, made = stage("rows, as identify makes them", lambda: build_rows(bounded, vehicle, terms))
        options = {"partitions": None}
        solving, fit = stage(
            "the proved set and its certificates", lambda: identify_rows(made, bounded, vehicle, "feasible", options)
        )
        writing, _ = stage("the sealed record", lambda: to_json(sealed(fit.record())))
        after = bounding + building + solving + writing
        print(f"  together: {slow + after:.3f} s from CSV, {quick + after:.3f} s from Parquet; {made.time.size} rows")
        _, result = stage("ivsid.identify, which also weighs the bias", lambda: ivsid.identify(vehicle, log))
        print(f"  {result.status}, {', '.join(f'{n} {p.width:.4g} wide' for n, p in result.parameters.items())}")
        taken, ends = stage("Polars, NumPy and HiGHS, two parameters, unproved", lambda: by_hand(csv, vehicle), 1)
        print(
            f"  widths {', '.join(f'{b - a:.4g}' for a, b in ends)}; {taken / (slow + after):.1f} x as long as from CSV above"
        )


if __name__ == "__main__":
    main()
