"""Inverses, regularity and systems from Python: batches, certificates, sweeps that report and stop."""

import copy
import dataclasses
import json
import pickle
import signal
import threading
import time
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ivsid import IntervalArray, IvsidError, linalg, regression
from ivsid.linear.certificates import Certificate

PROVING = ("exact", "partitioned", "hansen-bliek-rohn", "krawczyk", "cramer", "kuttler", "neumaier")


def around(centre, radius):
    return IntervalArray(centre - radius, centre + radius)


def dominant(n, relative=0.01, seed=0, k=None):
    rng = np.random.default_rng(seed)
    centre = rng.uniform(-1, 1, (n, n) if k is None else (k, n, n)) + n * np.eye(n)
    return around(centre, relative * np.abs(centre))


def exact_inverse(matrix):
    """By fractions, row by row."""
    n = len(matrix)
    m = [[Fraction(float(x)) for x in row] + [Fraction(int(i == j)) for j in range(n)] for i, row in enumerate(matrix)]
    for p in range(n):
        pivot = next(i for i in range(p, n) if m[i][p])
        m[p], m[pivot] = m[pivot], m[p]
        m[p] = [x / m[p][p] for x in m[p]]
        for i in range(n):
            if i != p:
                m[i] = [a - m[i][p] * b for a, b in zip(m[i], m[p], strict=True)]
    return [row[n:] for row in m]


@pytest.mark.parametrize("method", PROVING)
@pytest.mark.parametrize("n", [1, 2, 3, 5, 8])
def test_members_lie_inside_and_certificates_hold(method, n):
    matrix = dominant(n, seed=n)
    result = linalg.inverse(matrix, method)
    if method == "kuttler" and result.status == "not_applicable":
        assert result.value is None and result.reason
        return
    assert result.status == "enclosed" and result.guaranteed
    assert isinstance(result.certificate, Certificate) and result.certificate.verify()
    rng = np.random.default_rng(5)
    for _ in range(3):
        member = np.where(rng.random((n, n)) < 0.5, matrix.lower, matrix.upper)
        for i, row in enumerate(exact_inverse(member)):
            for j, x in enumerate(row):
                assert Fraction(float(result.value.lower[i, j])) <= x <= Fraction(float(result.value.upper[i, j]))


def test_exact_is_inside_every_other_enclosure():
    matrix = dominant(6, 0.05)
    hull = linalg.inverse(matrix).value
    for method in ("partitioned", "hansen-bliek-rohn", "krawczyk", "neumaier", "cramer"):
        value = linalg.inverse(matrix, method).value
        slack = 1e-15 * np.abs(hull.upper)
        assert (value.lower <= hull.lower + slack).all() and (hull.upper <= value.upper + slack).all()


@pytest.mark.parametrize("method", ["exact", "hansen-bliek-rohn", "partitioned", "published", "cramer"])
@pytest.mark.parametrize("n", [2, 3, 4])
def test_a_batch_equals_its_matrices_one_by_one(method, n):
    batch = dominant(n, 0.3, k=20)
    found = linalg.inverse(batch, method, 7)
    assert len(found) == 20 and found.lower.shape == (20, n, n)
    for k, one in enumerate(found):
        single = linalg.inverse(IntervalArray(batch.lower[k], batch.upper[k]), method, 7)
        assert single.status == one.status == found.status[k]
        assert found.guaranteed[k] == single.guaranteed
        if single.value is None:
            assert np.isnan(found.lower[k]).all()
        else:
            np.testing.assert_array_equal(found.lower[k], single.value.lower)
            np.testing.assert_array_equal(found.upper[k], single.value.upper)
    assert [r.status for r in found[2:5]] == list(found.status[2:5])
    assert found[-1].status == found.status[-1]
    assert found.statuses == tuple(one.status for one in found)
    with pytest.raises(IndexError):
        found[20]


def test_arrays_of_any_layout_are_read_the_same():
    matrix = dominant(4)
    expected = linalg.inverse(matrix).value
    fortran = IntervalArray(np.asfortranarray(matrix.lower), np.asfortranarray(matrix.upper))
    turned = IntervalArray(matrix.lower.T.copy().T, matrix.upper.T.copy().T)
    for other in (fortran, turned):
        np.testing.assert_array_equal(linalg.inverse(other).value.lower, expected.lower)
    points = linalg.inverse(np.array([[2, 0], [0, 4]])).value
    np.testing.assert_array_equal(points.lower, [[0.5, 0], [0, 0.25]])


def test_singular_matrices_come_with_a_member():
    matrix = IntervalArray(np.ones((5, 5)), 2 * np.ones((5, 5)))
    verdict = linalg.regularity(matrix)
    assert verdict.status == "singular" and verdict.certificate.verify()
    member = verdict.certificate.member()
    x = [Fraction(v) for v in verdict.certificate["vector"].tolist()]
    assert any(x) and all(sum(a * b for a, b in zip(row, x, strict=True)) == 0 for row in member)
    assert all(1 <= entry <= 2 for row in member for entry in row)
    for method in ("exact", "partitioned"):
        result = linalg.inverse(matrix, method)
        assert result.status == "singular" and result.value is None and result.guaranteed


def tampered(certificate, **changes):
    return Certificate({**certificate, **changes}, certificate._lower, certificate._upper)


def test_a_certificate_is_not_believed_for_another_matrix():
    good = linalg.regularity(dominant(3)).certificate
    assert good["kind"] == "contraction" and good.verify()
    wide = dominant(3, 2.0)
    assert not Certificate(dict(good), wide.lower, wide.upper).verify()
    assert not tampered(good, approximate_inverse=np.zeros((3, 3))).verify()
    assert not tampered(good, kind="null_vector", vector=np.ones(3)).verify()
    assert not tampered(good, kind="unheard of").verify()
    assert not tampered(good, kind="scaled_contraction", vector=np.array([1.0, -1.0, 1.0])).verify()
    for broken in (np.full((3, 3), np.nan), np.zeros((2, 3)), np.zeros(3), np.full((3, 3), np.inf), None, "text"):
        assert not tampered(good, approximate_inverse=broken).verify()
    for norm in (0.0, 7.0, np.nan, -1.0):
        assert not tampered(good, norm=norm).verify()
    assert not tampered(good, kind="vertex_determinants", sign=np.inf).verify()
    assert not tampered(good, kind="null_vector", vector=np.ones(2)).verify()
    determinant = linalg.inverse(dominant(3), "cramer").certificate
    assert determinant.verify() and not tampered(determinant, determinant=(1e6, 1e7)).verify()


def test_certificates_of_matrices_that_are_not_strongly_regular():
    # Orthogonal columns: regular by the norm of the radii, though no contraction is found.
    n = 8
    i, j = np.indices((n, n))
    cosine = np.cos(np.pi * (i + 0.5) * (j + 0.5) / n)
    verdict = linalg.regularity(around(cosine, np.full((n, n), 0.24)))
    assert verdict.status == "regular" and verdict.certificate["kind"] == "positive_definite"
    assert verdict.certificate.verify()
    assert not tampered(verdict.certificate, shift=0.0).verify()
    # Two entries whose product stays below 1: by cells.
    matrix = np.eye(5)
    radius = np.zeros((5, 5))
    radius[0, 1], radius[1, 0] = 0.85, 1.15
    verdict = linalg.regularity(around(matrix, radius))
    assert verdict.status == "regular" and verdict.certificate.verify(), verdict


@settings(max_examples=60, deadline=None)
@given(st.integers(1, 3), st.integers(0, 2**32 - 1), st.sampled_from([0.0, 0.05, 0.3, 1.0]))
def test_verdicts_verify(n, seed, radius):
    rng = np.random.default_rng(seed)
    matrix = around(np.round(rng.uniform(-2, 2, (n, n)), 1), np.full((n, n), radius))
    verdict = linalg.regularity(matrix)
    assert verdict.status in ("regular", "singular") and verdict.certificate.verify()
    result = linalg.inverse(matrix)
    assert (result.status == "enclosed") == (verdict.status == "regular")


@pytest.mark.parametrize("method", linalg.SOLVE_METHODS)
def test_systems(method):
    matrix, right = dominant(4), IntervalArray([1.0, -2.0, 0.5, 3.0], [1.1, -1.9, 0.6, 3.1])
    result = linalg.solve(matrix, right, method)
    assert result.status == "enclosed" and result.certificate.verify()
    hull = linalg.solve(matrix, right, "exact").value
    assert (result.value.lower <= hull.lower + 1e-15).all() and (hull.upper <= result.value.upper + 1e-15).all()
    x = np.linalg.solve(matrix.midpoint, right.midpoint)
    assert ((result.value.lower <= x) & (x <= result.value.upper)).all()


@pytest.mark.parametrize("method", linalg.SOLVE_METHODS)
def test_a_batch_of_systems_equals_them_one_by_one(method):
    batch = dominant(3, 0.3, k=12)
    rng = np.random.default_rng(3)
    centre = rng.uniform(-1, 1, (12, 3))
    right = around(centre, np.full((12, 3), 0.1))
    found = linalg.solve(batch, right, method)
    common = linalg.solve(batch, IntervalArray(right.lower[0], right.upper[0]), method)
    assert len(found) == 12 and found.lower.shape == (12, 3)
    for k, one in enumerate(found):
        single = linalg.solve(
            IntervalArray(batch.lower[k], batch.upper[k]), IntervalArray(right.lower[k], right.upper[k]), method
        )
        assert single.status == one.status == found.status[k]
        if single.value is None:
            assert np.isnan(found.lower[k]).all()
        else:
            np.testing.assert_array_equal(found.lower[k], single.value.lower)
            np.testing.assert_array_equal(found.upper[k], single.value.upper)
    np.testing.assert_array_equal(common.lower[0], found.lower[0])


def test_a_batch_of_verdicts():
    batch = dominant(3, 0.8, k=30)
    found = linalg.regularity(batch)
    assert set(found.status) == {"regular", "singular"}
    for k, one in enumerate(found):
        assert one.status == found.status[k] and one.certificate.verify()
    assert found[-1].status == found.status[-1] and len(found[3:6]) == 3


def test_the_short_way_gives_the_sweep():
    matrix = dominant(5, 0.2)
    for method in ("published", "published-hull"):
        sweep = linalg.inverse(matrix, method, 5000)
        short = linalg.inverse(matrix, method, 5000, sweep="extrema")
        np.testing.assert_allclose(short.value.lower, sweep.value.lower, rtol=1e-13)
        np.testing.assert_allclose(short.value.upper, sweep.value.upper, rtol=1e-13)
        assert not short.guaranteed and "not an enclosure" in short.reason
        hull = linalg.inverse(matrix).value
        assert not sweep.value.holds(hull).all() and (method == "published-hull") == (not sweep.value.improper.any())


def test_a_long_sweep_reports_its_progress():
    seen = []
    result = linalg.inverse(
        dominant(6), "published", 3_000_000, progress=lambda done, total: seen.append((done, total))
    )
    assert result.value is not None
    assert seen and all(total == 3_000_000 and 0 <= done <= total for done, total in seen)
    assert [d for d, _ in seen] == sorted(d for d, _ in seen)


def test_an_interrupt_ends_a_sweep_at_once():
    """Ctrl-C: the signal comes while the sweep runs, KeyboardInterrupt follows within 0.2 s."""
    sent = []

    def interrupt():
        time.sleep(0.4)
        sent.append(time.perf_counter())
        signal.raise_signal(signal.SIGINT)

    threading.Thread(target=interrupt).start()
    with pytest.raises(KeyboardInterrupt):
        linalg.inverse(dominant(8), "published", 10**12)
    assert time.perf_counter() - sent[0] < 0.2 + 0.3  # the second term is for a loaded machine


def test_an_error_of_the_callback_ends_the_sweep():
    def fail(done, total):
        raise RuntimeError("enough")

    with pytest.raises(RuntimeError, match="enough"):
        linalg.inverse(dominant(8), "published", 10**12, progress=fail)


def test_statuses_are_those_of_the_core():
    for kind, names in (
        (linalg.Status, linalg.STATUSES),
        (linalg.Verdict, linalg.VERDICTS),
        (regression.FeasibleStatus, regression.FEASIBLE_STATUSES),
        (regression.LeastSquaresStatus, regression.LEAST_SQUARES_STATUSES),
    ):
        assert tuple(kind) == names and all(type(name) is str for name in names)
    result = linalg.inverse(dominant(3))
    assert result.status is linalg.Status.ENCLOSED and json.dumps(result.status) == '"enclosed"'
    assert f"{result.status}" == str(result.status) == "enclosed"


def test_methods_are_those_of_the_core():
    assert (*PROVING, "published", "published-hull") == linalg.INVERSE_METHODS
    assert linalg.SOLVE_METHODS == ("hansen-bliek-rohn", "exact", "krawczyk", "gauss-seidel", "cramer")
    assert linalg.SWEEPS == ("members", "extrema") and regression.LEAST_SQUARES_METHODS == ("qr", "augmented")
    assert (linalg.DEFAULT_PARTITIONS, linalg.DEFAULT_CELLS) == (1000, 4096)


def test_one_matrix_and_a_batch_have_doors_of_their_own():
    one, batch, right = dominant(3), dominant(3, k=4), np.ones(3)
    assert isinstance(linalg.inverse_one(one), linalg.Result)
    assert isinstance(linalg.solve_one(one, right), linalg.Result)
    assert isinstance(linalg.regularity_one(one), linalg.Regularity)
    assert isinstance(linalg.inverse_batch(batch), linalg.ResultBatch) and len(linalg.inverse_batch(batch)) == 4
    assert isinstance(linalg.solve_batch(batch, right), linalg.ResultBatch)
    assert isinstance(linalg.regularity_batch(batch), linalg.Batch)
    verdicts = linalg.regularity_batch(batch)
    assert verdicts.statuses == tuple(one.status for one in verdicts)
    assert all(isinstance(status, linalg.Verdict) for status in verdicts.statuses)
    for door, matrix in ((linalg.inverse_one, batch), (linalg.inverse_batch, one), (linalg.regularity_batch, one)):
        with pytest.raises(IvsidError, match="is needed"):
            door(matrix)


def test_bad_input_is_said_in_one_sentence():
    good = dominant(3)
    for call in (
        lambda: linalg.inverse(np.ones((2, 3))),
        lambda: linalg.inverse(np.array([[np.nan]])),
        lambda: linalg.inverse(good, "guess"),
        lambda: linalg.inverse(good, "published", 0),
        lambda: linalg.inverse(good, "published", 2**53),
        lambda: linalg.inverse(good, "published", True),
        lambda: linalg.inverse(good, "published", sweep="none"),
        lambda: linalg.inverse(good, "partitioned", -1),
        lambda: linalg.solve(good, np.ones(2)),
        lambda: linalg.solve(dominant(3, k=2), np.ones((3, 3))),
        lambda: linalg.solve(dominant(3, k=2), np.full((2, 3), np.nan)),
        lambda: linalg.regularity(np.ones((2, 3, 4))),
    ):
        with pytest.raises(IvsidError) as refusal:
            call()
        assert "\n" not in str(refusal.value)
    assert linalg.inverse(np.array([[1.0, np.inf], [0.0, 1.0]]).clip(max=1e308)).status in linalg.STATUSES
    assert linalg.inverse(IntervalArray([[1.0]], [[np.inf]])).status == "not_applicable"


def test_threads_of_other_code_go_on():
    """The interpreter lock is released."""
    ticks = []
    stop = threading.Event()

    def tick():
        while not stop.is_set():
            ticks.append(time.perf_counter())
            time.sleep(0.002)

    thread = threading.Thread(target=tick)
    thread.start()
    begin = time.perf_counter()
    linalg.inverse(dominant(8, 0.2, k=400), "exact")
    linalg.inverse(dominant(11, 0.05), "exact")
    end = time.perf_counter()
    stop.set()
    thread.join()
    if end - begin > 0.1:
        assert sum(begin < t < end for t in ticks) > 5


def test_a_result_is_one_value_however_late_its_parts_are_made():
    a = IntervalArray(np.array([[4.0, 1.0], [0.0, 2.0]]), np.array([[5.0, 1.5], [0.5, 3.0]]))
    late, whole = linalg.inverse(a), linalg.inverse(a)
    assert late.value is late.value and late.certificate.verify() and whole.reason is None
    again = pickle.loads(pickle.dumps(linalg.inverse(a)))
    for other in (copy.copy(late), again, dataclasses.replace(late)):
        assert (other.method, other.status, other.reason, other.gap) == ("exact", linalg.Status.ENCLOSED, None, None)
        assert np.array_equal(other.value.lower, late.value.lower) and other.guaranteed
        assert dict(other.certificate)["kind"] == late.certificate["kind"]
    assert "status=<Status.ENCLOSED" in repr(linalg.inverse(a)) and not hasattr(late, "unknown")
    # Any layout of the bounds: a transpose is no copy.
    turned = linalg.inverse(a.T)
    assert np.array_equal(turned.value.lower, late.value.lower.T)
    with pytest.raises(IvsidError, match="method '"):
        linalg.inverse(a, "exacts")
    with pytest.raises(IvsidError, match="method .* choose one of exact"):
        linalg.inverse(a, ["exact"])
