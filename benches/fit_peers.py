"""Parameter intervals beside those of statistical fits, on the same logs of a known truth: coverage, width, seconds.

Each twin is the paper's vehicle with its own mass, drag and inertia, 300 s at 20 Hz, with the noise of the vehicle file. Its thrusters
follow their table exactly, or with a static error inside the stated accuracy. Every tool gets the same log and the same table, and is asked
for intervals that hold with 99.9 %:

- ivsid: ``identify``, method feasible.
- NumPy: least squares on the mid-values of ivsid's rows, and the covariance of the textbook.
- statsmodels: the same, with the covariance of Newey and West, which allows for errors that are correlated in time.
- NumPy, block bootstrap: the same fit of 200 logs, drawn from blocks of 5 s.
- NumPy, Monte Carlo: 50 fits, each under a drawn scale of the velocities and a drawn offset of each thruster, inside what the vehicle file
  states; their spread beside the covariance of the textbook.
- SciPy: ``least_squares`` with the loss soft_l1, and the covariance of its Jacobian.

Run: python benches/fit_peers.py [--twins 40]. Without statsmodels its row is left out.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable
from dataclasses import replace
from importlib.resources import files
from importlib.util import find_spec

import numpy as np
import scipy
from scipy.optimize import least_squares
from scipy.stats import norm

from ivsid import identify
from ivsid.effects import terms_of
from ivsid.log import Log
from ivsid.programme.scenario import parse_scenario
from ivsid.rows import build_rows
from ivsid.sensors import bound_log
from ivsid.simulation import simulate
from ivsid.vehicle import Vehicle, parse_vehicle

# Two-sided, the confidence of the vehicle file.
LEVEL = 0.999
FACTOR = float(norm.ppf(0.5 + LEVEL / 2))
BLOCK, DRAWS, SYSTEMATIC = 5.0, 200, 50
Ends = tuple[np.ndarray, np.ndarray]
# Parameters that share equations: surge and sway, and yaw.
BLOCKS = ((0, 1), (2,))


def middle(vehicle: Vehicle, log: Log) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Mid-values of the rows and their right-hand sides, channel and time; weighted by what a first fit leaves in each channel."""
    rows = build_rows(bound_log(log, vehicle), vehicle, terms_of(vehicle))
    A, y = (rows.matrix.lower + rows.matrix.upper) / 2, (rows.right.lower + rows.right.upper) / 2
    rest = y - A @ np.linalg.lstsq(A, y, rcond=None)[0]
    weight = 1.0 / np.array([rest[rows.channel == c].std() for c in range(3)])[rows.channel]
    return A * weight[:, None], y * weight, rows.channel, rows.time


def blocks(channel: np.ndarray) -> list[tuple[np.ndarray, list[int]]]:
    """Rows and columns of each block."""
    return [(channel < 2, list(BLOCKS[0])), (channel == 2, list(BLOCKS[1]))]


def by_covariance(vehicle: Vehicle, log: Log) -> Ends:
    """Least squares with s^2 (A'A)^-1."""
    A, y, channel, _ = middle(vehicle, log)
    best, error = np.zeros(3), np.zeros(3)
    for rows, columns in blocks(channel):
        a, b = A[rows][:, columns], y[rows]
        x, rest, *_ = np.linalg.lstsq(a, b, rcond=None)
        best[columns] = x
        error[columns] = np.sqrt(np.diag(np.linalg.inv(a.T @ a)) * rest / (len(b) - len(x)))
    return best - FACTOR * error, best + FACTOR * error


def by_monte_carlo(vehicle: Vehicle, log: Log) -> Ends:
    """Fits under systematic errors that are drawn as uniform inside their stated bounds."""
    rng = np.random.default_rng(1)
    low, high = by_covariance(vehicle, log)
    assert vehicle.sensors.velocity is not None
    fits = []
    for _ in range(SYSTEMATIC):
        scale = 1.0 + vehicle.sensors.velocity.scale_factor_error * rng.uniform(-1, 1)
        columns = {k: v * scale if k in "uv" else v for k, v in log.columns.items()}
        thrusters = []
        for t in vehicle.thrusters:
            assert t.table is not None
            offset = t.accuracy.absolute * rng.uniform(-1, 1)
            table = t.table.model_copy(update={"thrust": tuple(T + offset for T in t.table.thrust)})
            thrusters.append(t.model_copy(update={"table": table}))
        lower, upper = by_covariance(
            vehicle.model_copy(update={"thrusters": tuple(thrusters)}), replace(log, columns=columns)
        )
        fits.append((lower + upper) / 2)
    best, error = (low + high) / 2, np.hypot(np.std(fits, axis=0), (high - low) / 2 / FACTOR)
    return best - FACTOR * error, best + FACTOR * error


def by_newey_west(vehicle: Vehicle, log: Log) -> Ends:
    """The same with the covariance of Newey and West, lags of up to 5 s."""
    import statsmodels.api as sm  # noqa: PLC0415 - a peer that may be missing

    A, y, channel, t = middle(vehicle, log)
    best, error = np.zeros(3), np.zeros(3)
    for rows, columns in blocks(channel):
        # In the order of time, so that lags are lags.
        order = np.argsort(t[rows], kind="stable")
        lags = round(BLOCK / 0.05) * len(set(channel[rows]))
        a, b = A[rows][:, columns][order], y[rows][order]
        fit = sm.OLS(b, a).fit(cov_type="HAC", cov_kwds={"maxlags": lags})
        best[columns], error[columns] = fit.params, fit.bse
    return best - FACTOR * error, best + FACTOR * error


def by_bootstrap(vehicle: Vehicle, log: Log) -> Ends:
    """The spread of fits of logs that are drawn from blocks of the log."""
    A, y, channel, t = middle(vehicle, log)
    rng = np.random.default_rng(1)
    number = (t // BLOCK).astype(int)
    best, error = np.zeros(3), np.zeros(3)
    for rows, columns in blocks(channel):
        a, b, k = A[rows][:, columns], y[rows], number[rows]
        n = len(columns)
        squares, sides = np.zeros((k.max() + 1, n, n)), np.zeros((k.max() + 1, n))
        np.add.at(squares, k, a[:, :, None] * a[:, None, :])
        np.add.at(sides, k, a * b[:, None])
        best[columns] = np.linalg.solve(squares.sum(0), sides.sum(0))
        drawn = rng.integers(0, len(squares), (DRAWS, len(squares)))
        fits = [np.linalg.solve(squares[d].sum(0), sides[d].sum(0)) for d in drawn]
        error[columns] = np.std(fits, axis=0)
    return best - FACTOR * error, best + FACTOR * error


def by_robust_loss(vehicle: Vehicle, log: Log) -> Ends:
    """Least squares with a loss that grows linearly for large errors, and the covariance of its Jacobian."""
    A, y, channel, _ = middle(vehicle, log)
    best, error = np.zeros(3), np.zeros(3)
    for rows, columns in blocks(channel):
        a, b = A[rows][:, columns], y[rows]
        start = np.linalg.lstsq(a, b, rcond=None)[0]
        found = least_squares(lambda x, a=a, b=b: a @ x - b, start, jac=lambda x, a=a: a, loss="soft_l1", x_scale="jac")
        best[columns] = found.x
        spread = 2 * found.cost / (len(b) - len(start))
        error[columns] = np.sqrt(np.diag(np.linalg.inv(found.jac.T @ found.jac)) * spread)
    return best - FACTOR * error, best + FACTOR * error


def by_ivsid(vehicle: Vehicle, log: Log) -> Ends:
    """Every consistent parameter."""
    fit = identify(vehicle, log)
    return np.array([p.lower for p in fit.parameters.values()]), np.array([p.upper for p in fit.parameters.values()])


def peers() -> dict[str, Callable[[Vehicle, Log], Ends]]:
    """All tools that are installed."""
    found = {
        "ivsid, feasible set (proved)": by_ivsid,
        f"NumPy {np.__version__}, least squares": by_covariance,
    }
    if find_spec("statsmodels"):
        import statsmodels  # noqa: PLC0415 - a peer that may be missing

        found[f"statsmodels {statsmodels.__version__}, Newey-West"] = by_newey_west
    found["NumPy, block bootstrap"] = by_bootstrap
    found["NumPy, Monte Carlo of stated errors"] = by_monte_carlo
    found[f"SciPy {scipy.__version__}, soft_l1"] = by_robust_loss
    return found


def main() -> None:
    """Simulates, fits by every tool, counts."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--twins", type=int, default=40)
    chosen = parser.parse_args()
    data = files("ivsid") / "data"
    text = (data / "swan.toml").read_text()
    vehicle = parse_vehicle(text, "swan.toml")
    exact = parse_vehicle(text.replace("absolute = 0.5", "absolute = 0.0"), "swan.toml")
    scenario = parse_scenario((data / "swan_train.toml").read_text(), "swan_train.toml")
    for title, true in (("thrust as in the table", exact), ("thrust error inside the accuracy", vehicle)):
        tools = peers()
        inside: dict[str, list[np.ndarray]] = {k: [] for k in tools}
        widths: dict[str, list[np.ndarray]] = {k: [] for k in tools}
        missed: dict[str, list[np.ndarray]] = {k: [] for k in tools}
        spent: dict[str, list[float]] = {k: [] for k in tools}
        for seed in range(chosen.twins):
            rng = np.random.default_rng(50_000 + seed)
            truth = {
                "mass.surge": float(rng.uniform(55, 90)),
                "drag.surge.quadratic": float(rng.uniform(150, 400)),
                "inertia.yaw": float(rng.uniform(7, 20)),
            }
            made = simulate(true, scenario.model_copy(update={"truth": truth, "noise": "gaussian"}), seed)
            log = Log("twin.csv", "", made.t, made.columns)
            for name, tool in tools.items():
                begin = time.process_time()
                low, high = tool(vehicle, log)
                spent[name].append(time.process_time() - begin)
                value = np.array(list(truth.values()))
                inside[name].append((low <= value) & (value <= high))
                widths[name].append(high - low)
                missed[name].append(np.abs((low + high) / 2 - value))
        print(f"\n{title}, {chosen.twins} twins\n")
        print(
            "| tool | all three | mass | drag | inertia | median width: mass [kg], drag [kg/m], inertia [kg m²] | median error of the middle | processor s |"
        )
        print("|---|---|---|---|---|---|---|---|")
        for name in tools:
            held, width = np.array(inside[name]), np.median(widths[name], axis=0)
            each = " | ".join(str(int(n)) for n in held.sum(axis=0))
            shown = ", ".join(f"{w:.3g}" for w in width)
            error = ", ".join(f"{e:.2g}" for e in np.median(missed[name], axis=0))
            print(
                f"| {name} | {int(held.all(axis=1).sum())} | {each} | {shown} | {error} | {np.median(spent[name]):.2g} |",
                flush=True,
            )


if __name__ == "__main__":
    main()
