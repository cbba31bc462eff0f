"""Numbers of the paper that can be computed again, with the corrections of the reading notes."""

import numpy as np
import pytest

from ivsid import Interval, IntervalArray, linalg
from ivsid.files.units import random_walk_from_deg_per_sqrt_hour
from ivsid.propulsion.bollard import PUBLISHED_CUBIC, TABLE_III, examine
from ivsid.sensors.doppler import doppler_drift, doppler_paper
from ivsid.sensors.noise import sigma_published

Q = IntervalArray([[2, -2], [-1.5, -2]], [[4, 2], [4.5, 3.5]])


def test_norm_midpoint_and_corrected_radius_of_section_iv_a():
    assert linalg.norm(Q) == 8.0
    assert Q.midpoint.tolist() == [[3.0, 0.0], [1.5, 0.75]]
    assert Q.radius.tolist() == [[1.0, 2.0], [3.0, 2.75]]


def test_doppler_drift_is_28_8_metres_an_hour():
    assert doppler_drift(0.004, 2.0, 3600.0) == pytest.approx(28.8, abs=1e-12)


def test_inverse_of_one_two_is_exact_and_eq_11_is_improper():
    one = IntervalArray([[1.0]], [[2.0]])
    exact = linalg.inverse(one, "exact")
    assert (exact.value.lower.item(), exact.value.upper.item()) == (0.5, 1.0)
    hull = linalg.inverse(one, "published-hull", 10)
    assert (hull.value.lower.item(), hull.value.upper.item()) == (0.5, 1.0)
    assert not hull.guaranteed
    literal = linalg.inverse(one, "published", 10)
    d = 0.05
    assert literal.value.lower.item() == pytest.approx(1 / (1.5 - d), rel=1e-14)
    assert literal.value.upper.item() == pytest.approx(1 / (1.5 + d), rel=1e-14)
    assert literal.value.improper.all()
    assert literal.status == "not_proved" and not literal.guaranteed


def test_misses_of_the_printed_cubic_and_the_least_squares_one():
    demand, thrust = (np.array(c) for c in TABLE_III)
    table = examine(demand, thrust, PUBLISHED_CUBIC)
    printed = dict(zip(demand, table.fits[0].residual, strict=True))
    assert [round(printed[d], 1) for d in (15.0, 50.0, 85.0)] == [0.9, 9.4, 46.9]
    cubic = next(f for f in table.fits if f.name == "least-squares polynomial of degree 3")
    assert cubic.rms == pytest.approx(2.09, abs=0.005)
    assert cubic.largest == pytest.approx(4.63, abs=0.005)
    assert cubic.coefficients == pytest.approx((7.669e-5, 6.460e-3, -0.22884, 7.752), rel=1e-3)
    assert table.recommended.name == "monotone table (PCHIP)"
    assert table.recommended.largest < 1e-12


def test_bounds_of_eq_15_with_table_ii():
    assert sigma_published(0.0018, 3.0e-4, 0.05, 670.0) == pytest.approx(8.052e-3, abs=5e-7)
    assert sigma_published(0.002, 2.8e-4, 0.05, 100.0) == pytest.approx(8.951e-3, abs=5e-7)
    # Table II prints deg/s where the data-sheet class is deg/sqrt(h): 6.0 is 0.1 deg/sqrt(s).
    assert random_walk_from_deg_per_sqrt_hour(6.0) == pytest.approx(np.radians(0.1), rel=1e-15)


def test_bounds_of_eq_16_and_17_corrected():
    u = doppler_paper(np.array([2.0, -1.0]), 0.002, 0.004)
    assert u.contains([2.0 / 0.996, -1.0 / 0.996]).all()
    assert u.lower == pytest.approx([(2.0 - 0.002) / 0.996, (-1.0 - 0.002) / 0.996], rel=1e-14)
    assert u.upper == pytest.approx([(2.0 + 0.002) / 0.996, (-1.0 + 0.002) / 0.996], rel=1e-14)


def test_eq_14_with_an_improper_entry_takes_the_extreme_products():
    from ivsid import regression

    rows = IntervalArray(np.array([[1.0], [1.0]]), np.array([[1.2], [1.2]]))
    right = IntervalArray(np.array([2.0, 2.0]), np.array([2.1, 2.1]))
    found = regression.normal_equations(rows, right, "published", 100)
    assert found.improper == 1 and found.status == "not_proved"
    low, high = found.inverse.value.lower.item(), found.inverse.value.upper.item()
    assert low > high
    products = Interval(high, low) * Interval(4.0, 5.04)
    assert found.value.lower.item() == pytest.approx(products.lower, rel=1e-12)
    assert found.value.upper.item() == pytest.approx(products.upper, rel=1e-12)
