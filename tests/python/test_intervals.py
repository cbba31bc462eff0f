"""Interval arrays: containment against exact rationals, memory layouts, the NumPy protocol, refusals."""

import math
import pickle
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from ivsid import Interval, IntervalArray, IvsidError
from ivsid.intervals import outward_decimal

finite = st.floats(allow_nan=False, allow_infinity=False)
OPERATIONS = {"+": lambda x, y: x + y, "-": lambda x, y: x - y, "*": lambda x, y: x * y, "/": lambda x, y: x / y}


@st.composite
def intervals(draw):
    a, b = sorted((draw(finite), draw(finite)))
    return Interval(a, b)


def holds(x: Interval, exact: Fraction) -> bool:
    above = x.lower == -np.inf or Fraction(x.lower) <= exact
    return above and (x.upper == np.inf or exact <= Fraction(x.upper))


@given(intervals(), intervals(), st.sampled_from(sorted(OPERATIONS)))
def test_every_end_point_result_is_enclosed(x, y, name):
    operation = OPERATIONS[name]
    if name == "/" and y.lower == y.upper == 0:
        assert (x / y).empty
        return
    result = operation(x, y)
    for a in (x.lower, x.upper):
        for b in (y.lower, y.upper):
            if name != "/" or b != 0:
                assert holds(result, operation(Fraction(a), Fraction(b)))


@given(finite, finite, st.sampled_from("+-*"))
def test_point_results_are_tightest(a, b, name):
    exact = OPERATIONS[name](Fraction(a), Fraction(b))
    result = OPERATIONS[name](Interval(a), Interval(b))
    assert holds(result, exact)
    # Nothing narrower encloses: the ends are equal, or neighbours with the exact result strictly between them.
    if result.lower != result.upper:
        assert math.nextafter(result.lower, math.inf) == result.upper
        assert result.lower == -np.inf or Fraction(result.lower) < exact
        assert result.upper == np.inf or exact < Fraction(result.upper)


@given(finite, st.booleans())
def test_printed_bounds_are_outward_and_round_trip(x, up):
    text = outward_decimal(x, up=up)
    assert float(text) == x
    assert Fraction(text) >= Fraction(x) if up else Fraction(text) <= Fraction(x)


@given(intervals())
def test_repr_round_trips_and_text_encloses(x):
    assert eval(repr(x), {"Interval": Interval}) == x
    assert x.subset(Interval(str(x)))


def test_text_is_enclosed():
    x = Interval("[0.1, 0.2]")
    assert Fraction(x.lower) <= Fraction(1, 10) and Fraction(2, 10) <= Fraction(x.upper)
    assert Interval("0.1").width > 0


LAYOUTS = {
    "c": np.ascontiguousarray,
    "fortran": np.asfortranarray,
    "strided": lambda a: np.repeat(np.repeat(a, 2, 0), 2, 1)[::2, ::2],
    "reversed": lambda a: np.ascontiguousarray(a[::-1, ::-1])[::-1, ::-1],
    "transposed": lambda a: np.ascontiguousarray(a.T).T,
    "readonly": lambda a: np.lib.stride_tricks.as_strided(a, writeable=False),
}


@pytest.mark.parametrize("layout", LAYOUTS)
def test_memory_layouts_mean_the_same(layout):
    from ivsid import linalg

    lower, upper = np.array([[4.0, 1.0], [2.0, 3.0]]), np.array([[4.5, 1.25], [2.0, 3.5]])
    plain = IntervalArray(lower, upper)
    other = IntervalArray(LAYOUTS[layout](lower), LAYOUTS[layout](upper))
    assert (other + other == plain + plain).all()
    assert (other @ other == plain @ plain).all()
    assert (linalg.inverse(other).value == linalg.inverse(plain).value).all()
    assert (other.midpoint == plain.midpoint).all()


def test_types_and_shapes():
    assert IntervalArray(np.arange(3)).upper.dtype == np.float64
    assert (IntervalArray(np.float32([0.1])).lower == np.float64(np.float32(0.1))).all()
    assert IntervalArray(np.zeros((0, 3))).shape == (0, 3)
    assert IntervalArray(np.float64(2.0)).shape == ()
    assert isinstance(IntervalArray([1.0, 2.0])[0], Interval)
    with pytest.raises(IvsidError, match="2\\*\\*53"):
        IntervalArray(np.array([2**53 + 1]))


def test_no_copy_in_or_out():
    lower, upper = np.zeros(5), np.ones(5)
    x = IntervalArray(lower, upper)
    assert np.shares_memory(x.lower, lower) and np.shares_memory(x.upper, upper)
    assert lower.flags.writeable and not x.lower.flags.writeable


def test_numpy_functions_and_operands():
    x = IntervalArray([1.0, -2.0], [2.0, 3.0])
    assert (np.add(x, 1.0) == x + 1.0).all()
    assert (np.float64(2.0) * x == x * 2.0).all()
    assert (np.array([1.0, 2.0]) - x == -(x - np.array([1.0, 2.0]))).all()
    assert (np.square(x).lower == [1.0, 0.0]).all()
    assert (np.absolute(x).upper == [2.0, 3.0]).all()
    assert np.minimum(x, 0.0).upper.tolist() == [0.0, 0.0]
    with pytest.raises(TypeError, match="not defined for intervals"):
        np.logaddexp(x, x)


def test_pickling():
    x = IntervalArray([1.0, -2.0], [2.0, 3.0])
    assert (pickle.loads(pickle.dumps(x)) == x).all()
    assert pickle.loads(pickle.dumps(Interval(1.0, 2.0))) == Interval(1.0, 2.0)


def test_sets():
    x, y = IntervalArray([0.0, 0.0], [1.0, 1.0]), IntervalArray([0.5, 2.0], [2.0, 3.0])
    common = x.intersection(y)
    assert common.empty.tolist() == [False, True]
    assert (common + 1.0).empty.tolist() == [False, True]
    assert x.hull(y).upper.tolist() == [2.0, 3.0]
    assert x.subset(x.hull(y)).all()
    assert x.contains([0.5, np.nan]).tolist() == [True, False]


@pytest.mark.parametrize(
    ("bounds", "sentence"),
    [
        (([1.0], [0.0]), "exceeds the upper bound"),
        (([np.nan], [1.0]), "is NaN"),
        (([np.inf], [np.inf]), "no finite point"),
        (([1.0], [1.0, 2.0]), "must be equal"),
        ((["a"], ["b"]), "give float64 numbers"),
    ],
)
def test_refusals(bounds, sentence):
    with pytest.raises(IvsidError, match=sentence):
        IntervalArray(*bounds)


def test_shapes_that_do_not_fit():
    x = IntervalArray(np.zeros((2, 3)))
    with pytest.raises(IvsidError, match="do not fit"):
        x + np.zeros(2)
    with pytest.raises(IvsidError, match="inner sizes differ"):
        x @ x
    with pytest.raises(IvsidError, match="not an interval"):
        Interval("[1, two]")
