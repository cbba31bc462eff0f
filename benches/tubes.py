"""Widths, times and the picture of tubes on the demo's vehicle: 600 s at 20 Hz under the fit of its first trial.

Usage: python benches/tubes.py [PICTURE]
"""

from __future__ import annotations

import hashlib
import sys
import time
from importlib.resources import files
from pathlib import Path

import numpy as np

from ivsid import identify, simulation, tube
from ivsid.log import Log
from ivsid.programme.scenario import parse_scenario
from ivsid.report import figures
from ivsid.tubes.bounds import NAMES, UNITS, widths
from ivsid.vehicle import Vehicle, parse_vehicle
from ivsid.workflow.log_files import csv


def trial(vehicle: Vehicle, name: str, seconds: float) -> Log:
    """A trial of the demo, of another length."""
    text = (files("ivsid") / "data" / f"{name}.toml").read_text()
    made = simulation.simulate(
        vehicle, parse_scenario(text.replace("duration = 300.0", f"duration = {seconds}", 1), name)
    )
    return Log(f"{name}.csv", hashlib.sha256(csv(made.t, made.columns).encode()).hexdigest(), made.t, made.columns)


def main() -> None:
    """Prints the table, and draws the picture where a path is given."""
    vehicle = parse_vehicle((files("ivsid") / "data" / "swan.toml").read_text(), "swan.toml")
    fit = identify(vehicle, trial(vehicle, "swan_train", 300.0))
    long = trial(vehicle, "swan_test", 600.0)
    for channels, parts, cells in (
        ("straight", 1, 1),
        ("straight", 2, 1),
        ("surge", 1, 1),
        ("all", 1, 1),
        ("all", 1, 8),
    ):
        made = tube(fit, long, channels=channels, parts=parts, yaw_cells=cells, windows=[10.0])
        for run in made.runs:
            proved = sum(w.proved - w.first for w in run.horizon.windows)
            for k in made.components[:3]:
                w = widths(run, k)
                print(
                    f"{channels:<9} {parts} part(s), {cells} cell(s) {run.name:<6} {NAMES[k]:<2} width {w['median_width']:.4g} {UNITS[k]} median, {w['largest_width']:.4g} worst; "
                    f"outer / inner {w['median_ratio']:.4f} median, {w['largest_ratio']:.4f} worst; {proved} steps in {run.seconds:.2f} s; "
                    f"{run.outside} rows outside"
                )
    short = Log(long.name, long.sha256, long.t[:1200], {n: x[:1200] for n, x in long.columns.items()})
    begun = time.perf_counter()
    again = tube(fit, short, channels="straight", windows=[], inner=False, check=True)
    if again.checked is not None:
        seconds = time.perf_counter() - begun
        print(f"checker, straight: {again.checked.proved} of {again.checked.parts} parts proved in {seconds:.1f} s")
    if len(sys.argv) > 1:
        windows = tube(fit, short, windows=[10.0])
        Path(sys.argv[1]).write_bytes(figures.tube(windows, windows.runs[1], "tube", components=(0, 1, 2)).png)
    print(f"samples {np.size(long.t)}")


if __name__ == "__main__":
    main()
