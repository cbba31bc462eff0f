"""Thrusts of demands that arrive late, against exact rationals: every delay of the stated range has its means and values inside."""

from fractions import Fraction

import numpy as np
import pytest

from ivsid.intervals import IntervalArray
from ivsid.log import Log
from ivsid.propulsion.carried import late


@pytest.mark.parametrize("ends", [(0.02, 0.07), (0.05, 0.05), (0.0, 0.13), (0.12, 0.31)])
def test_every_delay_of_a_range_has_its_thrust_inside(ends):
    rng = np.random.default_rng(11)
    t = np.round(0.1 * np.arange(60) + rng.uniform(-0.01, 0.01, 60), 3)
    thrust = np.round(rng.uniform(-40.0, 40.0, 60), 2)
    made = late(IntervalArray(thrust), Log("a.csv", "0" * 64, t, {}), np.ones(60, dtype=bool), ends)
    stamps, pushed = [Fraction(x) for x in t.tolist()], [Fraction(x) for x in thrust.tolist()]
    low, high = (Fraction(e) for e in ends)
    checked = 0
    for delay in (low, (2 * low + high) / 3, (low + high) / 2, high):
        for k in range(8, 59):
            # Pieces of the step between the moments at which demands arrive.
            moments = [s + delay for s in stamps]
            edges = [stamps[k], *(m for m in moments if stamps[k] < m < stamps[k + 1]), stamps[k + 1]]
            acting = [max(j for j, m in enumerate(moments) if m <= a) for a in edges[:-1]]
            mean = sum(pushed[j] * (b - a) for j, a, b in zip(acting, edges, edges[1:], strict=False))
            mean /= stamps[k + 1] - stamps[k]
            assert Fraction(made.over_steps.lower[k]) <= mean <= Fraction(made.over_steps.upper[k])
            assert all(made.swept.lower[k] <= thrust[j] <= made.swept.upper[k] for j in acting)
            assert made.at_rows.lower[k] <= thrust[acting[0]] <= made.at_rows.upper[k]
            assert made.present[k] and made.whole[k]
            checked += 1
    # A mean that took the whole range of the step would hold all of them, and say nothing.
    tight = (made.over_steps.width < 0.99 * made.swept.width)[8:59]
    assert checked == 4 * 51 and (tight.all() if ends[1] < 0.08 else True)
