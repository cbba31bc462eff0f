"""The feasible set beside HiGHS, and in exact arithmetic; doors to wrong rows, stated signs and least squares."""

from __future__ import annotations

import tracemalloc
from fractions import Fraction
from itertools import combinations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import linprog

from ivsid import IntervalArray, IvsidError, regression


def rows(rng, m, n, radius=0.02, slack=0.5, size=5.0):
    """Bounds of rows that hold at a truth, which is returned too."""
    truth = size * rng.uniform(0.2, 1, n) * rng.choice([-1, 1], n)
    exact = rng.uniform(-1, 1, (m, n))
    shift = radius * rng.uniform(-0.9, 0.9, (m, n))
    value = exact @ truth + slack * rng.uniform(-0.9, 0.9, m)
    matrix = IntervalArray(exact + shift - radius, exact + shift + radius)
    return matrix, IntervalArray(value - slack, value + slack), truth


def half_spaces(matrix, right, signs):
    """The orthant's half-spaces ``G x <= h`` with the rows' own doubles."""
    positive = np.asarray(signs) > 0
    above = np.where(positive, matrix.lower, matrix.upper)
    below = np.where(positive, matrix.upper, matrix.lower)
    return np.concatenate([above, -below]), np.concatenate([right.upper, -right.lower])


def highs(matrix, right, signs):
    """Both ends of every parameter in one orthant by HiGHS; None where it says infeasible."""
    g, h = half_spaces(matrix, right, signs)
    n = g.shape[1]
    bounds = [(0, None) if s > 0 else (None, 0) for s in signs]
    ends = np.empty((n, 2))
    for j in range(n):
        for k, sign in enumerate((1.0, -1.0)):
            found = linprog(sign * np.eye(n)[j], A_ub=g, b_ub=h, bounds=bounds, method="highs")
            if found.status == 2:
                return None
            ends[j, k] = sign * found.fun
    return ends


def solved(matrix, right):
    """The exact solution of a square system of fractions."""
    n = len(matrix)
    work = [[*row, value] for row, value in zip(matrix, right, strict=True)]
    for p in range(n):
        pivot = next(i for i in range(p, n) if work[i][p])
        work[p], work[pivot] = work[pivot], work[p]
        work[p] = [x / work[p][p] for x in work[p]]
        for i in range(n):
            if i != p and work[i][p]:
                work[i] = [a - work[i][p] * b for a, b in zip(work[i], work[p], strict=True)]
    return [row[-1] for row in work]


def proved_end(matrix, right, signs, bound):
    """The bound that the stored rows prove, in fractions: the value of the dual solution, whose multipliers are checked."""
    n = len(signs)
    g, h = half_spaces(matrix, right, signs)
    m = len(right.lower)
    planes = [g[i + m * below] for i, below, _ in bound["rows"]]
    values = [Fraction(float(h[i + m * below])) for i, below, _ in bound["rows"]]
    for j, _ in bound["signs"]:
        planes.append(-signs[j] * np.eye(n)[j])
        values.append(Fraction(0))
    direction = -1 if bound["end"] == "upper" else 1
    transposed = [[Fraction(float(plane[r])) for plane in planes] for r in range(n)]
    target = [Fraction(-direction if r == bound["column"] else 0) for r in range(n)]
    multipliers = solved(transposed, target)
    assert all(x >= 0 for x in multipliers), "a multiplier of the wrong sign proves nothing"
    least = -sum((x * v for x, v in zip(multipliers, values, strict=True)), Fraction(0))
    return direction * least


def test_two_hundred_programs_none_unsafe():
    """The hull is that of HiGHS to 1e-9, and no end lies inside what its own rows prove exactly; HiGHS's often do."""
    rng = np.random.default_rng(7)
    unsafe = ours = programs = 0
    while programs < 200:
        matrix, right, truth = rows(rng, 60, 3)
        found = regression.feasible_set(matrix, right)
        assert found.status == "enclosed" and found.value.contains(truth).all()
        for orthant in found.certificate:
            ends = highs(matrix, right, orthant["signs"])
            if orthant["empty"]:
                assert ends is None
                continue
            for bound in orthant["bounds"]:
                exact = proved_end(matrix, right, orthant["signs"], bound)
                upper = bound["end"] == "upper"
                peer = ends[bound["column"], int(upper)]
                outward = (lambda x, e=exact: x >= e) if upper else (lambda x, e=exact: x <= e)
                ours += not outward(Fraction(bound["bound"]))
                unsafe += not outward(Fraction(float(peer)))
                assert bound["bound"] == pytest.approx(peer, rel=1e-9, abs=1e-9)
                programs += 1
    assert ours == 0
    assert unsafe > 20, "HiGHS is not expected to round outward"


def holds(lower, upper, low, high, x):
    """Whether some member of every row holds at x, exactly (Oettli-Prager)."""
    for l, u, p, q in zip(lower.tolist(), upper.tolist(), low.tolist(), high.tolist(), strict=True):  # noqa: E741
        ends = [sorted((Fraction(a) * v, Fraction(b) * v)) for a, b, v in zip(l, u, x, strict=True)]
        if sum(e[0] for e in ends) > Fraction(q) or sum(e[1] for e in ends) < Fraction(p):
            return False
    return True


def test_degenerate_rows_in_fractions():
    """Ties, zeros, equalities, wide scales, contradictions by 2^-50: no consistent parameter is lost, no end exceeds its proof."""
    rng = np.random.default_rng(9)
    held = checked = 0
    for case in range(240):
        n, kind = int(rng.integers(1, 6)), case % 4
        m = int(rng.integers(n, 30))
        exact = rng.integers(-2, 3, (m, n)).astype(float) if kind < 2 else rng.uniform(-1, 1, (m, n))
        radius = rng.choice([0.0, 0.125, 0.25, 0.02]) * (rng.random((m, n)) < 0.6)
        truth = rng.integers(-3, 4, n).astype(float)
        low = exact @ truth - rng.choice([0.0, 0.25, 0.5, 1.0])
        high = 2 * (exact @ truth) - low
        lower, upper = exact - radius, exact + radius
        if kind == 3:
            scale = 2.0 ** rng.integers(-40, 40, n)
            lower, upper, truth = lower * scale, upper * scale, truth / scale
        if kind == 1:
            low[rng.integers(0, m)] += rng.choice([0, 2.0**-50, 0.5])
            high = np.maximum(low, high)
        matrix, right = IntervalArray(lower, upper), IntervalArray(low, high)
        found = regression.feasible_set(matrix, right)
        if holds(lower, upper, low, high, [Fraction(v) for v in truth]):
            held += 1
            assert found.status != "empty" and found.value.contains(truth).all(), case
        for orthant in found.certificate:
            signs = [s or 1 for s in orthant["signs"]]
            for bound in orthant.get("bounds", ()):
                if np.isfinite(bound["bound"]) and len(bound["rows"]) + len(bound["signs"]) == n:
                    proved, end = proved_end(matrix, right, signs, bound), Fraction(bound["bound"])
                    assert end >= proved if bound["end"] == "upper" else end <= proved, case
                    checked += 1
    assert held > 100 and checked > 1500, (held, checked)


@pytest.mark.parametrize("n", [2, 5, 7])
def test_the_hull_is_the_union_over_all_orthants(n):
    rng = np.random.default_rng(n)
    matrix, right, truth = rows(rng, 80, n, radius=0.01, slack=1.5, size=2.0)
    found = regression.feasible_set(matrix, right)
    assert found.status == "enclosed" and found.value.contains(truth).all()
    whole = np.array([[np.inf, -np.inf]] * n)
    for bits in range(1 << n):
        signs = [1 if bits >> j & 1 else -1 for j in range(n)]
        ends = highs(matrix, right, signs)
        if ends is not None:
            whole = np.stack([np.minimum(whole[:, 0], ends[:, 0]), np.maximum(whole[:, 1], ends[:, 1])], 1)
    ours = np.stack([found.value.lower, found.value.upper], 1)
    assert ours == pytest.approx(whole, rel=1e-9, abs=1e-9)


def test_wrong_rows_are_named():
    rng = np.random.default_rng(3)
    matrix, right, truth = rows(rng, 200, 2)
    shift = np.zeros(200)
    shift[[17, 150]] = 30.0
    spoilt = right + IntervalArray(shift)
    assert regression.feasible_set(matrix, spoilt).status == "empty"
    one = regression.feasible_set(matrix, spoilt, outliers=1)
    assert one.status == "empty" and one.fewest_outliers is None and one.outliers == ()
    two = regression.feasible_set(matrix, spoilt, outliers=2)
    assert two.status == "enclosed" and two.fewest_outliers == 2 and two.outliers == ((17, 150),)
    assert two.value.contains(truth).all()
    clean = regression.feasible_set(matrix, right, outliers=1)
    assert clean.fewest_outliers == 0 and clean.outliers == ((),)
    plain = regression.feasible_set(matrix, right)
    assert plain.value.subset(clean.value).all() and (clean.value.width > plain.value.width).any()


def test_one_wrong_row_is_the_union_of_all_that_may_be():
    rng = np.random.default_rng(4)
    matrix, right, _ = rows(rng, 8, 2)
    found = regression.feasible_set(matrix, right, outliers=1).value
    parts = []
    for keep in combinations(range(8), 7):
        part = regression.feasible_set(matrix[list(keep)], right[list(keep)])
        if part.value is not None:
            parts.append(part.value)
    assert found.lower == pytest.approx(np.min([p.lower for p in parts], 0), rel=1e-12)
    assert found.upper == pytest.approx(np.max([p.upper for p in parts], 0), rel=1e-12)


def test_stated_signs():
    a, y = IntervalArray([[-1.0], [1.0]], [[1.0], [1.0]]), IntervalArray([1.0, -2.0], [1.0, 2.0])
    assert regression.feasible_set(a, y, signs=[1]).value.lower.item() == 1.0
    assert regression.feasible_set(a, y, signs=[-1]).value.upper.item() == -1.0
    with pytest.raises(IvsidError, match="signs"):
        regression.feasible_set(a, y, signs=[2])
    with pytest.raises(IvsidError, match="signs"):
        regression.feasible_set(a, y, signs=[1, 1])
    with pytest.raises(IvsidError, match="outliers"):
        regression.feasible_set(a, y, outliers=-1)


def test_rows_are_used_where_they_lie(tmp_path):
    """Memory-mapped bounds give the same result, and no array of their size is made."""
    rng = np.random.default_rng(5)
    matrix, right, truth = rows(rng, 200_000, 3)
    names = ("lower", "upper", "low", "high")
    for name, values in zip(names, (matrix.lower, matrix.upper, right.lower, right.upper), strict=True):
        np.save(tmp_path / f"{name}.npy", values)
    lower, upper, low, high = (np.load(tmp_path / f"{name}.npy", mmap_mode="r") for name in names)
    tracemalloc.start()
    found = regression.feasible_set(IntervalArray(lower, upper), IntervalArray(low, high))
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 0.1 * lower.nbytes, peak
    plain = regression.feasible_set(matrix, right)
    assert found.status == "enclosed" and found.value.contains(truth).all()
    assert np.array_equal(found.value.lower, plain.value.lower) and np.array_equal(found.value.upper, plain.value.upper)


def test_open_directions_are_a_basis_of_the_null_space():
    rng = np.random.default_rng(6)
    factor = rng.integers(-3, 4, (500, 2)).astype(float)
    mix = np.array([[1.0, 0.0, 2.0, 0.0], [0.0, 1.0, 0.0, -1.0]])
    a = factor @ mix
    truth = np.array([1.0, 2.0, 3.0, 4.0])
    found = regression.feasible_set(a, IntervalArray(a @ truth - 0.5, a @ truth + 0.5))
    assert found.status == "unbounded" and len(found.directions) == 2
    for direction in found.directions:
        assert np.abs(direction).max() == 1.0 and np.abs(a @ direction).max() < 1e-12
    assert sorted(int((d == 0).sum()) for d in found.directions) == [2, 2]


@settings(max_examples=40, deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(1, 5), st.sampled_from([0.0, 1e-3, 0.05]))
def test_more_rows_never_widen_and_order_does_not_matter(seed, n, radius):
    rng = np.random.default_rng(seed)
    matrix, right, truth = rows(rng, 40, n, radius)
    whole = regression.feasible_set(matrix, right)
    assert whole.value.contains(truth).all()
    slack = 1e-12 * (1 + whole.value.magnitude)
    order = rng.permutation(40)
    again = regression.feasible_set(matrix[order], right[order])
    assert (np.abs(again.value.lower - whole.value.lower) <= slack).all()
    assert (np.abs(again.value.upper - whole.value.upper) <= slack).all()
    fewer = regression.feasible_set(matrix[:30], right[:30])
    wider = regression.feasible_set(matrix, right + IntervalArray(-rng.uniform(0, 1, 40), np.zeros(40)))
    for other in (fewer, wider):
        assert (other.value.lower <= whole.value.lower + slack).all()
        assert (other.value.upper >= whole.value.upper - slack).all()


def test_least_squares_by_both_methods():
    rng = np.random.default_rng(8)
    matrix, right, truth = rows(rng, 60, 3, radius=1e-4, slack=1e-3)
    qr = regression.least_squares(matrix, right)
    wide = regression.least_squares(matrix, right, method="augmented")
    assert qr.guaranteed and wide.guaranteed and (qr.method, wide.method) == ("qr", "augmented")
    # A consistent parameter solves its own member without a residual.
    assert qr.value.contains(truth).all() and wide.value.contains(truth).all()
    assert qr.value.contains(np.linalg.lstsq(matrix.midpoint, right.midpoint, rcond=None)[0]).all()
    assert (qr.value.width <= wide.value.width * 1.001).all()
    eq14 = regression.normal_equations(matrix, right, "exact")
    assert (qr.value.width < 0.5 * eq14.value.width).all()
    singular = regression.least_squares(np.ones((4, 2)), np.ones(4))
    assert singular.status == "not_proved" and singular.value is None and "dependent" in singular.reason
    with pytest.raises(IvsidError, match="choose one of qr, augmented"):
        regression.least_squares(matrix, right, method="best")
