"""Seconds and memory of reading a log: 1e6 rows of 12 columns, asked 1 s; and a large CSV, asked less than four times its size.

python benches/logs.py [GB]
"""

import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
import polars as pl

import ivsid

CHANNELS = ("u", "v", "r", "ax", "ay", "psi", "x", "y", "demand_port", "demand_starboard", "extra")
ROWS = 1_000_000


def frame(rows: int, start: float = 0.0) -> pl.DataFrame:
    """Numbers of six decimals at 100 Hz, from a time on [s]."""
    rng = np.random.default_rng(0)
    columns = {"t": np.round(start + np.arange(rows) / 100, 4)}
    return pl.DataFrame({**columns, **{c: np.round(rng.standard_normal(rows), 6) for c in CHANNELS}})


def main() -> None:
    """Prints the required and the measured numbers."""
    if len(sys.argv) > 1 and sys.argv[1] == "--peak":
        ivsid.read_log(sys.argv[2])
        print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024)
        return
    size = float(sys.argv[1]) if len(sys.argv) > 1 else 1.0
    with tempfile.TemporaryDirectory() as folder:
        for ending in ("csv", "parquet"):
            path = Path(folder) / f"log.{ending}"
            getattr(frame(ROWS), f"write_{ending}")(path)
            times = []
            for _ in range(5):
                begin = time.perf_counter()
                ivsid.read_log(path)
                times.append(time.perf_counter() - begin)
            print(f"{ending:8} {ROWS} rows x 12: first {times[0]:.2f} s, best {min(times):.2f} s (asked 1 s)")
        path = Path(folder) / "large.csv"
        with path.open("wb") as file:
            for part in range(max(1, round(size * 1e9 / 111e6))):
                frame(ROWS, part * ROWS / 100).write_csv(file, include_header=part == 0)
        made = subprocess.run(
            [sys.executable, __file__, "--peak", str(path)], capture_output=True, text=True, check=True
        )
        peak, bytes_ = int(made.stdout), path.stat().st_size
        print(
            f"csv of {bytes_ / 1e9:.2f} GB: peak {peak / 1e9:.2f} GB, {peak / bytes_:.2f} of its size (asked less than 4)"
        )


if __name__ == "__main__":
    main()
