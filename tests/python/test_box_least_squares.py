"""Least squares inside a box against SciPy's active set, by their conditions, and where pivoting does not end."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import lsq_linear

from ivsid.diagnosis.null import box_least_squares
from ivsid.diagnosis.null.box_least_squares import inside_box


def problem(seed, rows, columns, tight):
    rng = np.random.default_rng(seed)
    root = rng.normal(size=(rows, columns)) * 10.0 ** rng.uniform(-1, 1, columns)
    bound = 10.0 ** rng.uniform(-1, 1, columns)
    return root, root @ (bound * rng.normal(size=columns)) / tight + rng.normal(size=rows), bound


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 10**6), st.integers(1, 40), st.sampled_from([0.1, 0.5, 2.0, 10.0]), st.booleans())
def test_the_residual_is_that_of_an_active_set(seed, columns, tight, few):
    """Fewer rows than columns leave the point open, and its residual is one all the same."""
    root, target, bound = problem(seed, max(columns // 2, 1) if few else columns + 3, columns, tight)
    x = inside_box(root, target, bound)
    assert (np.abs(x) <= bound).all()
    least = lsq_linear(root, target, bounds=(-bound, bound), method="bvls", tol=1e-14).cost
    mine = 0.5 * float(np.sum((root @ x - target) ** 2))
    assert mine <= least * (1 + 1e-8) + 1e-9 * float(target @ target)


def test_a_target_inside_the_box_is_met_and_a_far_one_stands_in_its_corner():
    root, _, bound = problem(1, 12, 9, 1.0)
    inside = 0.9 * bound * np.linspace(-1, 1, 9)
    np.testing.assert_allclose(inside_box(root, root @ inside, bound), inside, atol=1e-8)
    corner = bound * np.where(np.arange(9) % 2, 1.0, -1.0)
    np.testing.assert_array_equal(inside_box(np.eye(9), 5.0 * corner, bound), corner)


@pytest.mark.parametrize("steps", [0, 1])
def test_where_pivoting_does_not_end_the_point_is_that_of_scipy(steps, monkeypatch):
    root, target, bound = problem(3, 20, 15, 0.2)
    full = inside_box(root, target, bound)
    monkeypatch.setattr(box_least_squares, "STEPS", steps)
    assert box_least_squares._pivoted(root.T @ root, root.T @ target, bound) is None
    np.testing.assert_allclose(inside_box(root, target, bound), full, atol=1e-5)
    np.testing.assert_array_equal(inside_box(root, target, bound), lsq_linear(root, target, bounds=(-bound, bound)).x)
