"""Simulate a trial of the paper's vehicle, identify it, and see whether the truth is inside.

Run: python examples/quickstart.py
"""

from importlib.resources import files

import numpy as np

import ivsid
from ivsid.log import Log
from ivsid.programme.scenario import parse_scenario
from ivsid.simulation import simulate
from ivsid.vehicle import parse_vehicle

# Intervals: text is enclosed, floats are taken as they are, every operation is rounded outward.
print(ivsid.Interval(1.0, 2.0) * ivsid.Interval("[0.1, 0.2]"))

# Interval matrices: a failed proof is a status, never an exception.
A = ivsid.IntervalArray(np.array([[2.0, 0.9], [1.0, 3.0]]), np.array([[2.1, 1.1], [1.2, 3.3]]))
for method in ("exact", "krawczyk", "published"):
    r = ivsid.linalg.inverse(A, method)
    print(f"{method:<10} {r.status:<12} guaranteed: {r.guaranteed}  {r.value}")

# A trial with a known truth. On your own vehicle: ivsid.read_vehicle("boat.toml"), ivsid.read_log("run.csv", vehicle.log).
data = files("ivsid") / "data"
vehicle = parse_vehicle((data / "swan.toml").read_text(), "swan.toml")
trial = simulate(vehicle, parse_scenario((data / "swan_train.toml").read_text(), "swan_train.toml"))
log = Log("trial.csv", "", trial.t, trial.columns)

fit = ivsid.identify(vehicle, log)
print(f"\n{fit.method}: {fit.status}, guaranteed: {fit.guaranteed}, inflation {fit.inflation:.2f}")
for name, p in fit.parameters.items():
    truth = trial.truth["parameters"][name]
    print(
        f"  {name:<22} [{p.lower:.4g}, {p.upper:.4g}] {p.unit:<7} truth {truth:g} inside: {p.lower <= truth <= p.upper}"
    )
for line in fit.assumes:
    print("  assumes:", line)
