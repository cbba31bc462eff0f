"""Drags with the cube of a velocity: their ranges over intervals, and the drags that a narrow range of rates does not tell from them."""

from fractions import Fraction

import numpy as np
import pytest

from diagnosis_logs import logs_of, vehicle_of
from ivsid import diagnose
from ivsid.effects.functions import cube
from ivsid.intervals import Interval, IntervalArray
from ivsid.verification.rational import Range

# Circles both ways at four speeds and one rate.
ONE_RATE = "".join(
    f'[[segments]]\nmanoeuvre = "circle"\nduration = 40\ndemand = {demand}\nyaw_rate = {rate}\nyaw_gain = 30.0\n'
    "differential_limit = 40.0\n"
    for demand, rate in ((40, 0.45), (60, -0.45), (50, 0.45), (30, -0.45))
)


def test_the_range_of_a_cube_is_exact_where_an_interval_holds_both_signs():
    """A product of three intervals would be wider: its square is not known to be one of the same number."""
    ends = [(-1.0, 2.0), (0.1, 0.3), (-2.0, -0.5), (-0.7, 0.0)]
    found = cube(IntervalArray(*map(np.array, zip(*ends, strict=True))))
    for k, (a, b) in enumerate(ends):
        exact = Fraction(a) ** 3, Fraction(b) ** 3
        (low, high), checked = (found.lower[k], found.upper[k]), Range(Fraction(a)).hull(Range(Fraction(b))).cube()
        assert Fraction(float(low)) <= exact[0] and exact[1] <= Fraction(float(high))
        assert (low, high) == pytest.approx((a**3, b**3), rel=1e-15, abs=0.0)
        assert checked.lower <= exact[0] and exact[1] <= checked.upper
        assert (float(checked.lower), float(checked.upper)) == pytest.approx((a**3, b**3), rel=1e-12, abs=1e-15)
        assert cube(Interval(a, b)) == found[k]
    assert cube(-0.5) == -0.125 and cube(np.array([-2.0, 3.0])).tolist() == [-8.0, 27.0]


# Nightly: a whole diagnosis; that turns of many rates name it alone is held by test_exam_effects.py.
@pytest.mark.slow
@pytest.mark.nightly
def test_turns_of_one_rate_name_a_cubic_drag_in_a_set():
    vehicle = vehicle_of()
    logs = logs_of(vehicle, {"drag.yaw.cubic": 3.0}, segments=ONE_RATE, duration=160.0)
    (found,) = diagnose(vehicle, *logs, null_logs=0).findings
    assert {found.effect, *found.alternatives} >= {"drag.yaw.cubic", "drag.yaw.quadratic"}
