"""Scalars made by the core, NumPy's functions of interval arrays, and what is refused."""

import copy
import pickle
import subprocess
import sys
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import ivsid
from ivsid import Interval, IntervalArray, IvsidError

numbers = st.floats(allow_nan=False, allow_infinity=False, width=64)


def array(*pairs):
    lower, upper = zip(*pairs, strict=True)
    return IntervalArray(np.array(lower), np.array(upper))


@given(numbers, numbers, numbers, numbers)
def test_scalars_and_arrays_agree(a, b, c, d):
    x, y = Interval(min(a, b), max(a, b)), Interval(min(c, d), max(c, d))
    xs, ys = array((x.lower, x.upper)), array((y.lower, y.upper))
    for scalar, entry in (
        (x + y, xs + ys),
        (x - y, xs - ys),
        (x * y, xs * ys),
        (x / y, xs / ys),
        (x**3, xs**3),
        (x**y, xs**ys),
        (x.sin(), np.sin(xs)),
        (x.exp(), np.exp(xs)),
        (x.log(), np.log(xs)),
        (x.arctan2(y), np.arctan2(xs, ys)),
        (abs(x), abs(xs)),
        (-x, -xs),
        (x.hull(y), xs.hull(ys)),
        (x.intersection(y), xs.intersection(ys)),
    ):
        assert scalar == entry[0]


def test_operands_of_an_interval():
    x = Interval(1.0, 2.0)
    assert 1 + x == x + 1.0 == Interval(2.0, 3.0)
    assert 3 - x == Interval(1, 2)
    assert 2 / x == Interval(1, 2)
    assert 2**x == Interval(2, 4)
    assert x**0.5 == x.sqrt() == Interval(4.0, 4.0) ** 0 * x.sqrt()
    assert np.float32(0.5) * x == Interval(0.5, 1.0)
    assert np.int64(3) + x == Interval(4, 5)
    assert isinstance(x * np.array([1.0, 2.0]), IntervalArray)
    assert isinstance(np.array([1.0, 2.0]) - x, IntervalArray)
    assert (x * [1.0, 2.0])[1] == Interval(2, 4)
    assert np.exp(x) == x.exp()
    assert isinstance(np.add(x, array((0.0, 1.0))), IntervalArray)
    assert x != 1.0
    assert x in {Interval(1, 2)}
    assert 1.5 in x
    for bad in ("1", None, object()):
        with pytest.raises((TypeError, IvsidError)):
            x + bad
    with pytest.raises(IvsidError, match="NaN"):
        x * float("nan")
    with pytest.raises(IvsidError, match="exact double"):
        x + (2**60 + 1)
    assert x + 2**60 == Interval(2.0**60, np.nextafter(2.0**60, np.inf))


def test_construction():
    assert Interval("[1/3]").lower < 1 / 3 < Interval("[1/3]").upper or Interval("[1/3]").contains(1 / 3)
    assert Interval("3.56?1e2") == Interval(355, 357)
    assert Interval("[0x1.8p1, inf]").lower == 3.0
    assert Interval(np.float32(0.5)) == Interval(0.5)
    assert Interval.empty_set().empty and Interval.entire().width == np.inf
    with pytest.raises(IvsidError, match="exceeds"):
        Interval(2.0, 1.0)
    with pytest.raises(IvsidError, match="not an interval"):
        Interval("[1, 2")
    with pytest.raises(IvsidError, match="either text or two bounds"):
        Interval("[1, 2]", 3.0)
    with pytest.raises(IvsidError, match="one number a side"):
        Interval(np.array([1.0, 2.0]))
    with pytest.raises(IvsidError, match="exact double"):
        Interval(2**53 + 1)
    with pytest.raises(IvsidError):
        Interval([])
    with pytest.raises(AttributeError):
        Interval(1.0).lower = 2.0


@pytest.mark.parametrize("x", [Interval(0.1, 0.3), Interval.empty_set(), Interval.entire(), Interval(-5e-324, 1e308)])
def test_round_trips(x):
    for twin in (pickle.loads(pickle.dumps(x)), copy.deepcopy(x), Interval(x.to_exact())):
        assert twin == x or (twin.empty and x.empty)
        assert hash(twin) == hash(x)
    assert eval(repr(x), {"Interval": Interval}) == x or x.empty
    read = Interval(str(x))
    assert x.subset(read)


def test_numpy_functions_of_arrays():
    a = IntervalArray(np.arange(6.0).reshape(2, 3), np.arange(6.0).reshape(2, 3) + 0.5)
    assert np.concatenate([a, a]).shape == (4, 3)
    assert np.stack([a, a]).shape == (2, 2, 3)
    assert np.vstack([a, a]).shape == (4, 3) and np.hstack([a, a]).shape == (2, 6)
    assert np.transpose(a).shape == (3, 2) and np.ravel(a).shape == (6,)
    assert np.sum(a) == a.sum() == Interval(15.0, 18.0)
    assert (np.sum(a, axis=0) == a.sum(0)).all()
    assert np.where([[True], [False]], a, 0.0)[1, 2] == Interval(0.0)
    assert np.broadcast_to(a[0], (4, 3)).shape == (4, 3)
    assert (np.dot(a, a.T) == a @ a.T).all()
    assert np.power(a, 2)[1, 2] == Interval(25.0, 30.25)
    assert np.rint(a)[0, 1] == Interval(1.0, 2.0)
    assert (np.equal(a, a)).all() and not np.not_equal(a, a).any()
    assert np.sqrt(a - 10)[0, 0].empty
    for refused in (np.linalg.inv, np.median, np.fft.fft):
        with pytest.raises(TypeError, match="not defined for intervals"):
            refused(a)
    with pytest.raises(TypeError, match="reduce is not defined"):
        np.add.reduce(a)
    with pytest.raises(TypeError, match="takes no where"):
        np.add(a, a, where=np.ones((2, 3), bool))


def test_bounds_that_change_behind_the_array_are_noticed():
    lower, upper = np.zeros(100), np.ones(100)
    x = IntervalArray(lower, upper)
    lower[57] = np.nan
    with pytest.raises(IvsidError, match="57"):
        x * x
    lower[57] = 2.0
    with pytest.raises(IvsidError, match="exceeds the upper bound at entry 57"):
        np.exp(x)


@pytest.mark.skipif(
    not sys.platform.startswith("linux"), reason="changes the rounding mode through the C library of Linux"
)
def test_a_changed_rounding_mode_is_refused():
    program = """
import ctypes, numpy as np, ivsid
x, a = ivsid.Interval(1.0, 2.0), ivsid.IntervalArray([1.0, 2.0])
libm = ctypes.CDLL("libm.so.6")
upward = {"x86_64": 0x800, "aarch64": 0x400000}[__import__("platform").machine()]
assert libm.fesetround(upward) == 0
refused = 0
for work in (lambda: x * x, lambda: x + 1.0, lambda: a * a, lambda: np.exp(a), lambda: a @ a, lambda: ivsid.Interval(1.0),
             lambda: x.sqrt(), lambda: x**2, lambda: x.width, lambda: x.fma(x, x), lambda: a.radius, lambda: x**0.5):
    try:
        work()
    except ivsid.IvsidError as refusal:
        refused += "round to nearest" in str(refusal)
libm.fesetround(0)
print(refused, (x * x).upper)
"""
    run = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert run.stdout.split() == ["12", "4.0"], run.stderr
    program = "import ctypes; ctypes.CDLL('libm.so.6').fesetround(0x800); import ivsid"
    run = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False)
    assert run.returncode != 0
    assert "round to nearest" in run.stderr


def test_a_million_entries_need_no_loop_of_python():
    x = IntervalArray(np.linspace(-3, 3, 1_000_000))
    assert np.sin(x).contains(np.sin(np.linspace(-3, 3, 1_000_000))).mean() > 0.4
    assert (x * x).subset(x.square().hull(x * x)).all()
    assert ivsid.IntervalArray.concatenate([x, x]).size == 2_000_000


@pytest.mark.parametrize("n", [0, 1, 2, 3, 7, 64, 1001])
def test_sums_along_an_axis_hold_the_exact_sums(n):
    x = np.random.default_rng(n).uniform(-1, 1, (n, 3)) * np.array([1.0, 1e-8, 1e8])
    y = x + 0.25
    total = IntervalArray(x, y).sum(axis=0)
    for column in range(3):
        least, most = (sum(map(Fraction, v[:, column].tolist()), Fraction()) for v in (x, y))
        assert Fraction(float(total.lower[column])) <= least
        assert Fraction(float(total.upper[column])) >= most
    assert np.sum(IntervalArray(x), axis=1).shape == (n,)
