"""The doors to the feasible set and to interval least squares; the mathematics is tested in Rust."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ivsid import IntervalArray, IvsidError, linalg, regression


def consistent(seed: int, m: int = 40, n: int = 3) -> tuple[IntervalArray, IntervalArray, np.ndarray]:
    """Rows that hold at a known parameter: the truth stands anywhere inside every interval."""
    rng = np.random.default_rng(seed)
    truth = rng.uniform(-5, 5, n)
    exact = rng.standard_normal((m, n))
    radius = rng.uniform(0, 0.05, (m, n))
    matrix = IntervalArray(exact - radius * rng.uniform(0, 1, (m, n)), exact + radius * rng.uniform(0, 1, (m, n)))
    right = IntervalArray(exact) @ IntervalArray(truth)
    slack = rng.uniform(0, 0.1, m)
    return matrix, right + IntervalArray(-slack * rng.uniform(0, 1, m), slack * rng.uniform(0, 1, m)), truth


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_the_truth_is_always_inside(seed):
    matrix, right, truth = consistent(seed)
    found = regression.feasible_set(matrix, right)
    assert found.status == "enclosed" and found.guaranteed
    assert found.value.contains(truth).all()
    assert found.inflation <= 1.0 + 1e-9
    for method in ("exact", "hansen-bliek-rohn", "krawczyk", "cramer"):
        fit = regression.normal_equations(matrix, right, method)
        if fit.guaranteed:
            assert fit.value.contains(truth).all()


def test_a_contradiction_is_proved_and_names_its_rows():
    a = IntervalArray(np.ones((5, 1)), np.ones((5, 1)) * 1.01)
    y = IntervalArray([0.0, 0.0, 5.0, 0.0, 0.0], [1.0, 1.0, 6.0, 1.0, 1.0])
    found = regression.feasible_set(a, y)
    assert found.status == "empty" and found.guaranteed and found.value is None
    assert found.inflation > 1
    rows = {r[0] for c in found.certificate for r in c["rows"]}
    assert 2 in rows and len(rows) <= 4


def test_open_directions_have_no_bound():
    a = IntervalArray(np.array([[1.0, 1.0], [2.0, 2.0]]))
    found = regression.feasible_set(a, IntervalArray([1.0, 2.0], [1.1, 2.2]))
    assert found.status == "unbounded"
    assert np.isinf(found.value.lower).all() and np.isinf(found.value.upper).all()
    assert any(abs(d[0] + d[1]) < 1e-9 for d in found.directions)


def test_a_set_in_two_pieces():
    a = IntervalArray(np.array([[-1.0], [1.0]]), np.array([[1.0], [1.0]]))
    found = regression.feasible_set(a, IntervalArray([1.0, -2.0], [1.0, 2.0]))
    assert (found.value.lower.item(), found.value.upper.item()) == pytest.approx((-2.0, 2.0))


def test_refusals():
    with pytest.raises(IvsidError, match="shape \\(m, n\\)"):
        regression.feasible_set(IntervalArray([1.0]), IntervalArray([1.0]))
    with pytest.raises(IvsidError, match="is needed"):
        regression.feasible_set(IntervalArray(np.eye(2)), IntervalArray([1.0]))
    with pytest.raises(IvsidError, match="NaN"):
        regression.feasible_set(np.array([[np.nan]]), np.array([1.0]))


def test_linalg_statuses_and_batches():
    singular = IntervalArray([[0.9, 0.9], [0.9, 0.9]], [[1.1, 1.1], [1.1, 1.1]])
    for method in linalg.INVERSE_METHODS:
        result = linalg.inverse(singular, method)
        assert result.status != "enclosed"
        assert result.reason
    assert linalg.inverse(singular).status == "singular"
    assert linalg.regularity(singular).status == "singular"
    batch = IntervalArray(np.stack([np.eye(2), 2 * np.eye(2)]))
    assert [r.value.upper[0, 0] for r in linalg.inverse(batch, "krawczyk")] == pytest.approx([1.0, 0.5])
    x = linalg.solve(IntervalArray([[2.0, 1.0], [1.0, 3.0]]), IntervalArray([3.0, 5.0]), "cramer")
    assert x.value.contains([0.8, 1.4]).all()
    for call, sentence in (
        (lambda: linalg.inverse(np.ones((2, 3))), "is needed"),
        (lambda: linalg.inverse(np.eye(2), "magic"), "not available"),
        (lambda: linalg.inverse(np.eye(2), "published", 0), "at least 1"),
        (lambda: linalg.solve(np.eye(2), [1.0, 2.0, 3.0]), "right-hand side"),
    ):
        with pytest.raises(IvsidError, match=sentence):
            call()


def test_regular_but_not_strongly_regular_gets_its_hull():
    a = IntervalArray([[0.5, -1.5], [0.5, 0.5]], [[1.5, -0.5], [1.5, 1.5]])
    assert linalg.inverse(a, "krawczyk").status == "not_applicable"
    result = linalg.inverse(a, "exact")
    assert result.status == "enclosed"
    rng = np.random.default_rng(0)
    for _ in range(200):
        member = rng.uniform(a.lower, a.upper)
        assert (
            (result.value.lower <= np.linalg.inv(member) + 1e-12)
            & (np.linalg.inv(member) - 1e-12 <= result.value.upper)
        ).all()
