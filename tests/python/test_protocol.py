"""NumPy's whole protocol on intervals: what is not defined is refused, and nothing becomes plain numbers by the way."""

import copy
import pickle
import warnings

import numpy as np
import pytest

from ivsid import Interval, IntervalArray, IvsidError

X = IntervalArray([1.0, 2.0, 3.0], [1.5, 2.5, 3.5])
Y = IntervalArray([0.1, 0.2, 0.3], [0.2, 0.3, 0.4])
ONE = Interval(1.0, 2.0)
TRUTH = np.array([True, False, True])
# Functions that read or write files, or set NumPy itself.
APART = {
    *("save", "savez", "savez_compressed", "savetxt", "load", "loadtxt", "fromfile", "genfromtxt", "fromregex", "memmap", "info", "test", "open_memmap"),
    *("show_config", "show_runtime", "set_printoptions", "seterr", "seterrcall", "setbufsize"),
}  # fmt: skip
ARGUMENTS = {
    "array": (X,), "two": (X, Y), "list": ([X, Y],), "array and number": (X, 1), "number and array": (1.0, X), "mask": (TRUTH, X), "mask of arrays": (TRUTH, X, Y),
    "interval": (ONE,), "interval and array": (ONE, X), "intervals as mask": (X, 1.0, 2.0), "array and objects": (X, np.array([ONE, ONE, ONE])),
}  # fmt: skip
# Questions about the truth, the shape or the place of entries, whose answers are no bounds.
QUESTIONS = "biu"


def functions():
    for module in (np, np.linalg, np.fft, np.ma):
        for name in sorted(dir(module)):
            function = getattr(module, name)
            if name.startswith("_") or name in APART or not callable(function) or isinstance(function, type):
                continue
            yield f"{module.__name__}.{name}", function


def numbers(value):
    """The plain floating-point numbers in a result."""
    if isinstance(value, np.ndarray | np.generic):
        return [] if value.dtype.kind in QUESTIONS + "OUS" else [value]
    if isinstance(value, float | complex):
        return [value]
    if isinstance(value, list | tuple):
        return [n for v in value for n in numbers(v)]
    return []


def test_no_function_of_numpy_makes_numbers_of_intervals():
    """Every function with every kind of argument: intervals, truth values, places, or a refusal; no endless recursion."""
    tried, found = 0, []
    # The second argument is a flag or a tolerance there.
    flags = {
        "angle",
        "real_if_close",
        "nan_to_num",
        "unique",
        "bmat",
        "atleast_1d",
        "atleast_2d",
        "atleast_3d",
        "fix_invalid",
        "filled",
        "getdata",
        "masked_invalid",
    }
    for name, function in functions():
        for kind, arguments in ARGUMENTS.items():
            tried += 1
            try:
                with warnings.catch_warnings():
                    warnings.simplefilter("ignore")
                    result = function(*arguments)
            except RecursionError:
                found.append((name, kind, "recursion"))
            except Exception:
                continue
            else:
                # Masked arrays ask any object for its truth, and know no protocol.
                asked_by_truth = name == "numpy.ma.where" and kind == "intervals as mask"
                if numbers(result) and name.rpartition(".")[2] not in flags and not asked_by_truth:
                    found.append((name, kind, repr(result)[:60]))
    assert tried > 4000 and not found


@pytest.mark.parametrize(
    "option",
    [
        {"where": TRUTH},
        {"dtype": np.float32},
        {"casting": "unsafe"},
        {"order": "F"},
        {"subok": False},
        {"out": np.zeros(3)},
    ],
)
def test_options_of_ufuncs_are_refused(option):
    for call in (np.add, np.multiply, np.minimum, np.arctan2):
        with pytest.raises(TypeError, match="takes no"):
            call(X, Y, **option)
    for method in ("reduce", "accumulate", "outer", "reduceat", "at"):
        with pytest.raises(TypeError):
            getattr(np.add, method)(X, *{"outer": (Y,), "reduceat": ([0, 1],), "at": ([0], 1.0)}.get(method, ()))


def test_arrays_of_numbers_are_no_place_for_intervals():
    numbers = np.array([1.0, 2.0, 3.0])
    for call in (np.ndarray.__iadd__, np.ndarray.__imul__, np.ndarray.__isub__, np.ndarray.__itruediv__):
        for operand in (X, ONE):
            with pytest.raises(TypeError, match="takes no out"):
                call(numbers, operand)
    with pytest.raises((TypeError, ValueError)):
        numbers[0] = ONE
    with pytest.raises((TypeError, ValueError)):
        numbers[:] = X
    np.testing.assert_array_equal(numbers, [1.0, 2.0, 3.0])
    with pytest.raises(TypeError):
        np.asarray(X, dtype=float)


def test_in_place_operators_leave_what_they_were_given():
    before, z = X.lower.copy(), X
    z += Y
    assert z is not X
    np.testing.assert_array_equal(X.lower, before)
    with pytest.raises(TypeError):
        X[0] = ONE


@pytest.mark.parametrize(
    "make",
    [
        IntervalArray,
        lambda a: X * a,
        lambda a: a * X,
        X.contains,
        lambda a: IntervalArray.around(X.lower, a),
        lambda a: Interval(1.0) + a,
    ],
)
def test_masked_arrays_and_matrices_are_refused(make):
    """A masked entry is missing, and its number means nothing; a matrix multiplies as a matrix."""
    masked = np.ma.masked_array([1.0, 2.0, 3.0], mask=[True, False, False])
    try:
        found = make(masked)
    except IvsidError as refusal:
        assert "masked array" in str(refusal)
    else:
        # NumPy's own masked array asked first, and kept its mask.
        assert isinstance(found, np.ma.MaskedArray) and found.mask[0]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        with pytest.raises(IvsidError, match="matrix of NumPy"):
            make(np.matrix([[1.0, 2.0, 3.0]]))


def test_a_condition_is_no_interval():
    for condition in (X, ONE):
        with pytest.raises(TypeError, match="condition of np.where"):
            np.where(condition, X, Y)


def test_comparisons_with_numbers_are_entrywise():
    point = IntervalArray([1.0, 2.0])
    for one in (1, 1.0, np.float64(1.0), np.int64(1), np.float32(1.0), True):
        np.testing.assert_array_equal(point == one, [True, False])
        np.testing.assert_array_equal(point != one, [False, True])
        np.testing.assert_array_equal(one == point, [True, False])
    np.testing.assert_array_equal(point == np.array([1.0, 3.0]), [True, False])
    np.testing.assert_array_equal(np.array([1.0, 3.0]) == point, [True, False])
    assert (point == "1") is False and (point == None) is False  # noqa: E711 - the comparison is asked, not the identity
    with pytest.raises(IvsidError):
        _ = point == 2**53 + 1


def test_membership_in_an_array_is_asked_of_each_entry():
    """The array's entries are intervals: 1.25 in it is neither true nor false."""
    for asked in (1.25, Interval(1.0, 1.5), "a"):
        with pytest.raises(TypeError, match="use contains"):
            _ = asked in X


def test_layouts_of_memory_change_no_bit():
    """Negative strides, every other entry, Fortran order, broadcast views and arrays that are not aligned."""
    rng = np.random.default_rng(3)
    a = rng.normal(size=(6, 8))
    bytes_ = b"\0" + a.tobytes()
    unaligned = np.frombuffer(bytes_, dtype=np.uint8)[1:].view(np.float64).reshape(a.shape)
    assert not unaligned.flags.aligned
    plain = IntervalArray(a)
    views = {
        "reversed": (IntervalArray(a[::-1, ::-1]), plain[::-1, ::-1]),
        "strided": (IntervalArray(a[::2, ::3]), plain[::2, ::3]),
        "fortran": (IntervalArray(np.asfortranarray(a)), plain),
        "unaligned": (IntervalArray(unaligned), plain),
        "transposed": (IntervalArray(a.T), plain.T),
        "broadcast": (IntervalArray(np.broadcast_to(a[0], (4, 8))), np.broadcast_to(plain[0], (4, 8))),
    }
    for name, (one, other) in views.items():
        copied = IntervalArray(one.lower.copy(), one.upper.copy())
        for f in (
            lambda x: x * x + 0.1,
            np.exp,
            lambda x: x.sum(0),
            lambda x: x.midpoint,
            lambda x: x @ x.T,
            lambda x: x**3,
            lambda x: x.contains(0.5),
        ):
            results = [f(x) for x in (one, other, copied)]
            for r in results[1:]:
                assert (np.asarray(r == results[0])).all(), name


def test_results_share_no_memory_with_operands_that_may_change():
    a = np.array([1.0, 2.0])
    x = IntervalArray(a.copy(), a + 1.0)
    for made in (x + 0.0, -x, x * 1.0, x.hull(x), np.concatenate([x, x]), np.exp(x)):
        assert (
            not np.shares_memory(made.lower, x.lower)
            and not made.lower.flags.writeable
            and not made.upper.flags.writeable
        )
    for view in (x, x[::-1], x.T, np.ravel(x), x.reshape(2, 1), np.broadcast_to(x, (2, 2))):
        assert not view.lower.flags.writeable


@pytest.mark.parametrize(
    "x",
    [
        X,
        Y[:0],
        X.intersection(Y),
        IntervalArray([-np.inf], [np.inf]),
        IntervalArray(5e-324),
        IntervalArray(np.zeros((0, 3))),
    ],
)
def test_copies_and_pickles_are_the_same(x):
    for made in (
        copy.copy(x),
        copy.deepcopy(x),
        *(pickle.loads(pickle.dumps(x, k)) for k in range(pickle.HIGHEST_PROTOCOL + 1)),
    ):
        assert (
            made.lower.tobytes() == x.lower.tobytes()
            and made.upper.tobytes() == x.upper.tobytes()
            and made.shape == x.shape
        )


@pytest.mark.parametrize(
    "state",
    [
        ([2.0], [1.0]),
        ([np.nan], [1.0]),
        ([1.0, 2.0], [3.0]),
        ([np.inf], [np.inf]),
        (["a"], ["b"]),
        (np.array([2**53 + 1]), [1.0]),
    ],
)
def test_forged_states_are_refused(state):
    with pytest.raises(IvsidError):
        IntervalArray.__new__(IntervalArray).__setstate__(state)


def test_empty_arrays_have_every_operation():
    none = IntervalArray(np.zeros((0, 3)))
    assert (
        none.sum() == Interval(0.0) and (none.sum(0) == IntervalArray(np.zeros(3))).all() and none.sum(1).shape == (0,)
    )
    for made in (none + none, none * 2.0, np.exp(none), none**3, none.hull(none), none.square(), -none):
        assert made.shape == (0, 3)
    assert (
        (none @ np.ones((3, 2))).shape == (0, 2)
        and none.midpoint.shape == (0, 3)
        and none.contains(1.0).shape == (0, 3)
    )


def test_rows_of_different_lengths_get_a_sentence():
    with pytest.raises(IvsidError, match="rows of different lengths"):
        IntervalArray([[1.0], [1.0, 2.0]])
