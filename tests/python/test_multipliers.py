"""Multipliers of the checker, on systems that a hand solves."""

from fractions import Fraction

from ivsid.verification.multipliers import HalfSpace, contradict, least

ONE, ZERO = Fraction(1), Fraction(0)


def at_most(g, h):
    return HalfSpace([Fraction(g)], [Fraction(g)], Fraction(h))


def test_no_row_is_used_against_its_side():
    """x <= 1 with the multiplier -1 would read x >= 1."""
    assert least([ONE], [at_most(1, 1)], [0], set()) is None
    assert least([-ONE], [at_most(1, 1)], [0], set()) == (-ONE, {0})
    assert least([ONE], [at_most(-1, -3)], [0], set()) == (Fraction(3), {0})


def test_a_contradiction_needs_rows_that_contradict():
    assert contradict([at_most(1, 1), at_most(1, -1)], [0], [1.0, 1.0]) is None
    assert contradict([at_most(1, 1), at_most(-1, -2)], [0], [1.0, 1.0]) == {0, 1}
    # x <= 1 and x >= 1 meet in a point, and nothing is negative.
    assert contradict([at_most(1, 1), at_most(-1, -1)], [0], [1.0, 1.0]) is None


def test_rounded_multipliers_propose_and_prove_nothing():
    """Exact multipliers beside nearly dependent columns come out negative: 0, 0 and x = 0 keep all three rows."""
    e = Fraction(1, 10**12)
    rows = [
        HalfSpace([ONE, ONE], [ONE, ONE], ZERO),
        HalfSpace([-ONE, -ONE + e], [-ONE, -ONE + e], ZERO),
        HalfSpace([ONE, 2 * ONE], [ONE, 2 * ONE], ONE),
    ]
    assert contradict(rows, [0, 0], [1.0, 1.0, 1e-12]) is None
