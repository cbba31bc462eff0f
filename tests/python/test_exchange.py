"""Intervals to and from other libraries: exact or outward, held against rationals."""

from __future__ import annotations

import importlib.util
import math
import os
import subprocess
import sys
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import polars as pl
import pytest

from ivsid import Interval, IntervalArray, IvsidError, exchange

RNG = np.random.default_rng(1)


def drawn(n: int = 300) -> list[Interval]:
    """Points and intervals of all exponents, subnormal ones among them."""
    ends = RNG.integers(0, 2**64, (n, 2), dtype=np.uint64).view(np.float64)
    ends = np.where(np.isfinite(ends), ends, 0.1)
    made = [Interval(float(min(a, b)), float(max(a, b))) for a, b in ends]
    return [*made, *(Interval(float(a)) for a in ends[:, 0]), Interval(0.1, 0.3), Interval(5e-324), Interval(-0.5, 0.5)]


def test_mpmath() -> None:
    mpmath = pytest.importorskip("mpmath")
    for x in [*drawn(), Interval(1.0, math.inf), Interval.entire()]:
        there = exchange.to_mpmath(x)
        assert exchange.from_mpmath(there) == x
        assert exchange.interval_of(there) == x
    before = mpmath.iv.prec
    try:
        mpmath.iv.prec = 200
        third = mpmath.iv.mpf(1) / 3
        back = exchange.from_mpmath(third)
        assert Fraction(back.lower) < Fraction(1, 3) < Fraction(back.upper)
        assert math.nextafter(back.lower, 1) == back.upper
        huge = exchange.from_mpmath(mpmath.iv.mpf(2) ** 5000)
        assert (huge.lower, huge.upper) == (1.7976931348623157e308, math.inf)
        tiny = exchange.from_mpmath(mpmath.iv.mpf(2) ** -5000)
        assert (tiny.lower, tiny.upper) == (0.0, 5e-324)
    finally:
        mpmath.iv.prec = before
    with pytest.raises(IvsidError, match="no empty interval"):
        exchange.to_mpmath(Interval.empty_set())
    with pytest.raises(IvsidError, match="from_mpmath takes"):
        exchange.from_mpmath(1.0)


def rational(ball: Any) -> tuple[Fraction, Fraction]:
    (m, e), (n, f) = ball.mid().man_exp(), ball.rad().man_exp()
    mid, radius = int(m) * Fraction(2) ** int(e), int(n) * Fraction(2) ** int(f)
    return mid - radius, mid + radius


def test_arb() -> None:
    flint = pytest.importorskip("flint")
    for x in drawn():
        ball = exchange.to_arb(x)
        low, high = rational(ball)
        assert low <= Fraction(x.lower) and Fraction(x.upper) <= high
        width = Fraction(x.upper) - Fraction(x.lower)
        assert high - low <= width * (1 + Fraction(1, 2**25))
        back = exchange.from_arb(ball)
        assert x.subset(back)
        # The tightest: no double fits between the ends and the ball's.
        assert Fraction(back.lower) <= low if math.isfinite(back.lower) else low < -(Fraction(2) ** 1023)
        if math.isfinite(back.lower):
            after = math.nextafter(back.lower, math.inf)
            assert math.isinf(after) or Fraction(after) > low or Fraction(back.lower) == low
    assert exchange.from_arb(flint.arb(0.1)) == Interval(0.1)
    assert exchange.from_arb(exchange.to_arb(Interval(0.0, math.inf))) == Interval.entire()
    assert exchange.interval_of(flint.arb(2)) == Interval(2.0)
    with pytest.raises(IvsidError, match="NaN"):
        exchange.from_arb(flint.arb("nan"))


def pairs_of_doubles(name: str) -> None:
    there, back = getattr(exchange, f"to_{name}"), getattr(exchange, f"from_{name}")
    for x in [*drawn(), Interval(1.0, math.inf), Interval.entire(), Interval.empty_set()]:
        assert back(there(x)) == x
        assert exchange.interval_of(there(x)) == x


def test_pyinterval() -> None:
    interval = pytest.importorskip("interval")
    pairs_of_doubles("pyinterval")
    assert exchange.from_pyinterval(interval.interval([0.0, 1.0], [2.0, 3.0])) == Interval(0.0, 3.0)


CODAC = """
import ctypes, codac, pytest
from test_exchange import pairs_of_doubles
from ivsid import Interval, IvsidError
with pytest.raises(IvsidError, match="does not round to nearest"):
    Interval(0.1) + Interval(0.2)
ctypes.CDLL(None).fesetround(0)
pairs_of_doubles("codac")
"""


def test_codac() -> None:
    """In a process of its own: codac leaves the processor rounding upward, which ivsid refuses until it is undone."""
    if importlib.util.find_spec("codac") is None:
        pytest.skip("codac is not installed")
    path = os.pathsep.join([str(Path(__file__).parent), *sys.path])
    run = subprocess.run(
        [sys.executable, "-c", f"import ivsid, test_exchange\n{CODAC}"],
        env=os.environ | {"PYTHONPATH": path},
        capture_output=True,
        text=True,
        check=False,
    )
    assert run.returncode == 0, run.stderr


def test_columns_keep_every_bit(tmp_path: Path) -> None:
    bounds = [(x.lower, x.upper) for x in drawn()]
    lower, upper = np.array(bounds).T
    x = IntervalArray(lower, upper).intersection(Interval(-1.0, math.inf))
    assert x.empty.any() and not x.empty.all()
    column = exchange.to_polars(x, "drag")
    assert column.name == "drag" and column.is_null().sum() == x.empty.sum()
    pl.DataFrame([column]).write_parquet(tmp_path / "x.parquet")
    back = exchange.from_polars(pl.read_parquet(tmp_path / "x.parquet")["drag"])
    assert back.lower.tobytes() == x.lower.tobytes() and back.upper.tobytes() == x.upper.tobytes()
    with pytest.raises(IvsidError, match="structs of lower and upper"):
        exchange.from_polars(pl.Series("a", [1.0]))
    with pytest.raises(IvsidError, match="one bound"):
        exchange.from_polars(pl.Series("a", [{"lower": 1.0, "upper": None}]))
    with pytest.raises(IvsidError, match="shape"):
        exchange.to_polars(IntervalArray(np.zeros((2, 2))))


def test_libraries_that_are_missing_or_unknown_get_a_sentence(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "codac", None)
    with pytest.raises(IvsidError, match="codac is not installed; pip install codac"):
        exchange.to_codac(Interval(1.0))
    with pytest.raises(IvsidError, match="no interval of mpmath"):
        exchange.interval_of("1")
