"""Captive runs: bounds of each run in exact arithmetic, and drag as intervals that nothing calls guaranteed."""

import json
from fractions import Fraction

import numpy as np
import pytest
from scipy.optimize import linprog

from command_line import run
from ivsid.adapters.captive import Run, accuracy, drag_intervals, static_run
from ivsid.intervals import IntervalArray


def test_bounds_of_a_captive_run_hold_in_fractions():
    """Every end is on the outer side of the exact sum, mean and product, whose doubles fall to either side."""
    rng = np.random.default_rng(11)
    for _ in range(40):
        n, nominal = int(rng.integers(4, 60)), float(rng.uniform(1, 90))
        one, two, speed = rng.normal(3, 1, (3, n))
        made = static_run(speed, IntervalArray(one) - two, accuracy(nominal), accuracy(nominal) + accuracy(nominal))
        force = [Fraction(a) - Fraction(b) for a, b in zip(one.tolist(), two.tolist(), strict=True)]
        quarters = [[force[k] for k in part] for part in np.array_split(np.arange(n), 4)]
        middle, error = sum(force) / n, Fraction(nominal) / 1000
        drift = max(abs(sum(q) / len(q) - middle) for q in quarters)
        assert Fraction(made.force[1]) <= middle - drift - 2 * error and middle + drift + 2 * error <= Fraction(
            made.force[2]
        )
        assert Fraction(made.speed[1]) <= Fraction(float(speed.min())) - error
        assert Fraction(float(speed.max())) + error <= Fraction(made.speed[2])
        assert made.force[2] - made.force[1] <= float(2 * drift + 4 * error) * (1 + 1e-12) + 1e-12


def test_cse1_towing_runs_bound_the_drag_in_surge(real, tmp_path):
    """The intervals hold the least squares of the tank, every run of the table has its bounds, and nothing of it is called guaranteed."""
    out = tmp_path / "cse1"
    made = run("import", "cse1", real("cse1"), "--out", out)
    assert made.returncode == 0, made.stderr
    assert made.stdout.count("captive runs, enclosed, not guaranteed") == 2
    record = json.loads((out / "result.json").read_text())
    found, tank = record["facts"]["captive"]["surge"], record["facts"]["towing"]
    assert (
        found["status"] == "enclosed"
        and found["guaranteed"] is False
        and found["runs"] == 54
        and 0 < found["inflation"] < 1
    )
    for name in ("linear", "quadratic"):
        low, high = found["coefficients"][f"drag.surge.{name}"]
        assert low < -tank[name] < high
    assert found["coefficients"]["drag.surge.quadratic"][0] > 1
    table = np.genfromtxt(out / "towing.csv", delimiter=",", names=True)
    assert len(table) == 54
    for name in ("u", "force_X"):
        assert (table[f"{name}_lower"] < table[name]).all() and (table[name] < table[f"{name}_upper"]).all()
    # Two gauges of 77.02 and 55.3 N, and a carriage of 3.125 m/s, at 0.1 % of these.
    assert (table["force_X_upper"] - table["force_X"] >= 0.13232 - 1e-9).all()
    assert ((table["u_upper"] - table["u_lower"]) >= 2 * 0.003125 - 1e-9).all()
    for words in (
        "an accuracy class that the set does not state",
        "seen and not proved",
        "linear and quadratic in the speed",
    ):
        assert any(words in sentence for sentence in found["assumes"])
        assert any("not guaranteed, it rests on assumptions" in n and words in n for n in record["notes"])
    assert any("nothing of drag in sway and yaw" in n for n in record["notes"])
    page = (out / "report.html").read_text()
    assert "no, it rests on assumptions" in page and "guaranteed under" not in page


@pytest.mark.parametrize("axis", ["surge", "yaw"])
def test_drag_intervals_are_those_of_linear_programs(axis):
    """Bounds of speed of width 0 make the set a polytope, whose extent HiGHS gives apart."""
    rng = np.random.default_rng(3)
    speed = np.linspace(-0.6, 0.6, 14)
    force = -(0.4 * speed + 2.5 * speed * np.abs(speed)) + rng.uniform(-0.05, 0.05, speed.size)
    runs_ = [Run((u, u, u), (f, f - 0.06, f + 0.06)) for u, f in zip(speed, force, strict=True)]
    found = drag_intervals(runs_, axis)
    matrix = np.c_[speed, speed * np.abs(speed)]
    walls = np.r_[matrix, -matrix], np.r_[-force + 0.06, force + 0.06]
    for k, name in enumerate(("linear", "quadratic")):
        ends = [
            sign * linprog(sign * np.eye(2)[k], *walls, bounds=[(None, None)] * 2, method="highs").fun
            for sign in (1, -1)
        ]
        given = found["coefficients"][f"drag.{axis}.{name}"]
        assert given == pytest.approx(ends, abs=1e-6)
        assert given[0] <= ends[0] + 1e-9 and given[1] >= ends[1] - 1e-9
    # Forces that no such drag explains: said, without a number.
    wrong = [*runs_, Run((0.3, 0.3, 0.3), (5.0, 4.9, 5.1))]
    empty = drag_intervals(wrong, axis)
    assert empty["status"] == "empty" and empty["coefficients"] == {} and empty["inflation"] > 1
    one = drag_intervals(runs_[:1], axis)
    assert one["status"] == "unbounded" and one["coefficients"] == {}
    assert all(f["guaranteed"] is False and f["assumes"] for f in (found, empty, one))
