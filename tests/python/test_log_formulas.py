"""Units in headers and arithmetic on columns, against exact rational numbers."""

import math
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from ivsid import IvsidError, read_log
from ivsid.log.arithmetic import formula
from log_files import log_map

HEAD = "t,surge_dot,sway_dot,gyr.z,odd name"


def written(path, head=HEAD, rows=20):
    n = head.count(",")
    lines = [",".join([f"{0.1 * k:.1f}", *(f"{math.sin(k + j):.4f}" for j in range(n))]) for k in range(rows)]
    path.write_text(head + "\n" + "\n".join(lines) + "\n")
    return path


def exactly(text, cells):
    """The value of a formula in rational numbers, from decimals."""
    names = {n: f"x{k}" for k, n in enumerate(cells)}
    for name, short in names.items():
        text = text.replace(f"`{name}`", short).replace(name, short)
    import re

    text = re.sub(r"(?<![\w.])(\d+\.?\d*(?:e[+-]?\d+)?)", r"Fraction('\1')", text)
    return eval(text, {"Fraction": Fraction, **{names[n]: Fraction(v) for n, v in cells.items()}})


NUMBERS = st.decimals(-1000, 1000, places=4, allow_nan=False).map(str)
LEAVES = st.sampled_from(["a", "b.c", "`d e`", "0.02", "3", "1.5e-3", "9007199254740993"])
FORMULAS = st.recursive(
    LEAVES,
    lambda inner: st.tuples(inner, st.sampled_from("+-*/"), inner).map(lambda p: f"({p[0]} {p[1]} {p[2]})"),
    max_leaves=6,
)


@settings(max_examples=300, deadline=None)
@given(FORMULAS, NUMBERS, NUMBERS, NUMBERS)
def test_a_formula_holds_its_exact_value(text, a, b, d):
    made = formula(text)
    assume(made is not None)
    cells = {"a": a, "b.c": b, "d e": d}
    try:
        truth = exactly(text, cells)
    except ZeroDivisionError:
        truth = None
    middle, reach = made.value({n: np.array([float(v), np.nan]) for n, v in cells.items()})
    assert np.isnan(middle[1]) and reach[1] == 0.0
    if truth is None:
        # Nothing is said where a divisor is or may be zero.
        assert np.isnan(middle[0])
    elif not np.isnan(middle[0]):
        assert abs(Fraction(float(middle[0])) - truth) <= Fraction(float(reach[0]))
        # A dozen roundings, unless terms cancel or a divisor is near zero.
        assert reach[0] >= 0.0


def test_formulas_are_as_narrow_as_their_roundings():
    made = formula("(a - 0.02) * 1.5 / b")
    middle, reach = made.value({"a": np.array([1.25, -0.3]), "b": np.array([3.5, 0.7])})
    np.testing.assert_allclose(middle, [(1.25 - 0.02) * 1.5 / 3.5, (-0.3 - 0.02) * 1.5 / 0.7], rtol=1e-15)
    assert (reach < 1e-15).all() and (reach > 0).all()


def test_a_channel_from_a_formula(tmp_path):
    log = read_log(
        written(tmp_path / "log.csv"),
        log_map(
            columns={
                "u": "surge_dot - 0.02",
                "v": {"from": "-(sway_dot + surge_dot) / 2", "scale": 2.0},
                "r": {"from": "gyr.z * 1", "unit": "deg/s"},
                "udot": "`odd name` + 0",
            }
        ),
    )
    k = np.arange(20)
    surge, sway, gyro = (np.round(np.sin(k + j), 4) for j in range(3))
    np.testing.assert_allclose(log.columns["u"], surge - 0.02, atol=1e-15)
    np.testing.assert_allclose(log.columns["v"], -(sway + surge), atol=1e-15)
    np.testing.assert_allclose(log.columns["r"], np.deg2rad(gyro), atol=1e-16)
    assert (log.rounding["u"] > 0).all() and log.ignored == ()
    for at in range(20):
        truth = Fraction(f"{math.sin(at):.4f}") - Fraction("0.02")
        assert abs(Fraction(float(log.columns["u"][at])) - truth) <= Fraction(float(log.rounding["u"][at]))


def test_a_marker_of_missing_cells_in_a_formula(tmp_path):
    path = tmp_path / "log.csv"
    path.write_text("t,a\n" + "".join(f"{k},{-99 if k == 3 else k * k}\n" for k in range(9)))
    log = read_log(path, log_map(columns={"u": {"from": "a / 10", "missing": -99}}))
    assert np.flatnonzero(np.isnan(log.columns["u"])).tolist() == [3]


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("__import__('os').system('true') + 1", "it may have columns, numbers"),
        ("surge_dot ** 2", "it may have columns, numbers"),
        ("(surge_dot - sway_dot).real", "it may have columns, numbers"),
        ("surge_dot - True", "it may have columns, numbers"),
        ("surge_dot + 1e999", "it may have columns, numbers"),
        ("surge_dot + 1" + "0" * 400, "it may have columns, numbers"),
        ("surge_dot - 'a'", "it may have columns, numbers"),
        ("-" * 60 + "surge_dot", "it may have columns, numbers"),
        ("surge - 1", "no column surge, which .log. columns has in 'surge - 1'"),
        ("surge_dot -", "no column surge_dot -, which .log. maps to u"),
        ("odd name * 2", "no column odd name"),
    ],
)
def test_formulas_that_are_none(tmp_path, text, words):
    with pytest.raises(IvsidError, match=words):
        read_log(written(tmp_path / "log.csv"), log_map(columns={"u": text}))


def test_a_column_whose_name_looks_like_a_formula_is_that_column(tmp_path):
    path = written(tmp_path / "log.csv", "t,a-b,a,b")
    log = read_log(path, log_map(columns={"u": "a-b", "v": "a - b"}))
    assert log.rounding.get("u") is None or not log.rounding["u"].any()
    assert not np.array_equal(log.columns["u"], log.columns["v"])


@pytest.mark.parametrize(
    ("head", "factor", "unit"),
    [
        ("r [deg/s]", math.pi / 180, "deg/s"),
        ("r (°/s)", math.pi / 180, "deg/s"),
        ("r[rad/s]", 1.0, "rad/s"),
    ],
)
def test_units_in_headers(tmp_path, head, factor, unit):
    path = written(tmp_path / "log.csv", f"t [s],{head},demand_port [kN],x(1),x(2)")
    log = read_log(path)
    k = np.arange(20)
    np.testing.assert_allclose(log.t, 0.1 * k)
    np.testing.assert_allclose(log.columns["r"], factor * np.round(np.sin(k), 4), atol=1e-15)
    np.testing.assert_allclose(log.columns["demand_port"], 1e3 * np.round(np.sin(k + 1), 4), atol=1e-9)
    said = f"columns are read in the units that their headers say: {head} in {unit}; demand_port [kN] in kN"
    assert said in log.notes and log.ignored == ("x(1)", "x(2)")
    # A scale that the map states stands in the place of the header's unit, that of one as well.
    stated = read_log(path, log_map(columns={"r": {"from": head, "scale": 1.0}}))
    np.testing.assert_allclose(stated.columns["r"], np.round(np.sin(k), 4), atol=1e-15)
    # A scale that the map states is the whole conversion.
    own = read_log(path, log_map(columns={"r": {"from": head, "scale": 2.0}}))
    np.testing.assert_allclose(own.columns["r"], 2 * np.round(np.sin(k), 4), atol=1e-15)


def test_units_of_stamps_and_unknown_units(tmp_path):
    path = tmp_path / "log.csv"
    path.write_text("t (ms),u [furlong/h]\n" + "".join(f"{100 * k},{k % 7}\n" for k in range(20)))
    with pytest.raises(IvsidError, match=r"states the unit 'furlong/h', which is none of"):
        read_log(path)
    log = read_log(path, log_map(columns={"u": {"from": "u", "scale": 5.6e-5}}))
    np.testing.assert_allclose(log.t, 0.1 * np.arange(20))


def test_one_note_names_all_headers_with_units(tmp_path):
    path = tmp_path / "log.csv"
    path.write_text("t,u [kn],v [kn],r [deg/s]\n" + "".join(f"{k / 10},{k},0,1\n" for k in range(30)))
    (note,) = [n for n in read_log(path).notes if "header" in n]
    assert (
        note == "columns are read in the units that their headers say: u [kn] in kn; v [kn] in kn; r [deg/s] in deg/s"
    )
