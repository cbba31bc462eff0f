"""Stamps out of order: rows that are in order whatever the others are, against all subsequences; and the gaps in their place."""

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ivsid import IvsidError, read_log
from ivsid.log.disorder import MANY, in_order, sure_rows
from ivsid.log.record import GAP


def by_enumeration(stamps):
    """Rows that stand in every longest strictly increasing subsequence, by trying all of them."""
    rows = [k for k, t in enumerate(stamps) if t == t]
    for size in range(len(rows), 0, -1):
        longest = [
            set(c)
            for c in itertools.combinations(rows, size)
            if all(stamps[a] < stamps[b] for a, b in itertools.pairwise(c))
        ]
        if longest:
            return set.intersection(*longest)
    return set()


@settings(max_examples=300, deadline=None)
@given(st.lists(st.sampled_from([0.0, 1.0, 2.0, 3.0, 4.0, float("nan")]), max_size=9))
def test_sure_rows_are_those_of_all_longest_orders(stamps):
    assert set(np.flatnonzero(sure_rows(np.array(stamps, dtype=float)))) == by_enumeration(stamps)


@pytest.mark.parametrize(
    ("changes", "wrong"),
    [
        ({30: 28.0}, [30]),
        ({30: 400.0}, [30]),
        ({30: np.nan}, [30]),
        # Of two equal stamps either is wrong.
        ({30: 29.0}, [29, 30]),
        ({30: 28.5}, [29, 30]),
    ],
)
def test_rows_in_doubt_are_left_out_as_a_gap(changes, wrong):
    t = np.arange(200.0)
    for k, value in changes.items():
        t[k] = value
    order = in_order(t)
    assert order.wrong.tolist() == wrong
    kept = t[order.kept]
    assert (np.diff(kept) > 0).all() and kept.size + len(wrong) + order.beside == 200
    assert np.diff(kept).max() > GAP and (np.diff(kept) > 1).sum() == 1 and order.beside <= 2


@pytest.mark.parametrize("slow", range(9, 16))
def test_every_hole_is_a_gap_whatever_the_steps(slow):
    """Half of a log is slower: the rows beside a hole are left out, and the median step of the others is another one."""
    steps = np.r_[np.full(slow, 1.0), np.full(25 - slow, 0.2)]
    t = np.cumsum(steps)
    t[slow + 3] = np.nan
    order = in_order(t)
    kept, apart = t[order.kept], np.diff(order.kept) > 1
    assert apart.any() and (np.diff(kept)[apart] > GAP * np.median(np.diff(kept))).all()


def test_many_stamps_out_of_order_are_another_fault():
    t = np.arange(400.0)
    assert in_order(np.r_[t, t]) is None and in_order(t[::-1]) is None and in_order(np.repeat(t, 2)) is None
    t[[50, 100, 150, 200]] -= 10.0
    assert in_order(t).wrong.tolist() == [50, 100, 150, 200]
    t[250] -= 10.0
    assert in_order(t) is None
    assert in_order(np.r_[np.arange(MANY - 1.0), 0.0][1:]) is None


def test_a_demand_in_a_row_that_is_left_out_is_not_bridged(tmp_path):
    """A demand that came with a doubtful stamp acted for an unknown time: no window goes over it."""
    from ivsid.log.record import Log

    t, demand = 0.1 * np.arange(300), np.zeros(300)
    demand[150] = 80.0
    stamps = [f"{x:.1f}" for x in t]
    stamps[150] = stamps[149]
    path = tmp_path / "log.csv"
    path.write_text(
        "t,u,demand_a\n" + "".join(f"{s},{np.sin(x):.6f},{d}\n" for s, x, d in zip(stamps, t, demand, strict=True))
    )
    log = read_log(path)
    assert isinstance(log, Log) and 80.0 not in log.columns["demand_a"]
    at = int(np.argmax(np.diff(log.t)))
    assert log.t[at] < 14.9 < log.t[at + 1] and np.diff(log.t)[at] > GAP * 0.1
    assert any("rows 151, 152: 4 of 300 rows" in n or "are left out, as gaps" in n for n in log.notes)


def test_too_many_missing_stamps_are_said(tmp_path):
    path = tmp_path / "log.csv"
    path.write_text("t,u\n" + "".join(f"{'' if k % 9 == 5 else k},{k % 7}\n" for k in range(200)))
    with pytest.raises(IvsidError, match="the time is missing in row 7"):
        read_log(path)
