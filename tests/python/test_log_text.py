"""Text tables as programs of several countries write them: semicolons, tabs, blanks, decimal commas."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ivsid import IvsidError, read_log


def table(separator, comma, values, head=("t", "u", "r")):
    rows = [separator.join(head)]
    for k, row in enumerate(values):
        cells = [repr(k / 8), *(repr(float(x)) for x in row)]
        rows.append(separator.join(c.replace(".", ",") if comma else c for c in cells))
    return "\n".join(rows) + "\n"


@settings(max_examples=60, deadline=None)
@given(
    st.sampled_from([(";", True), (";", False), ("\t", True), ("\t", False), (" ", False), (" ", True), (",", False)]),
    st.lists(st.tuples(st.floats(-1e6, 1e6), st.floats(-1e-6, 1e-6)), min_size=3, max_size=20),
)
def test_every_separator_gives_the_same_doubles(tmp_path_factory, form, values):
    path = tmp_path_factory.mktemp("log") / "log.csv"
    path.write_text(table(*form, values))
    log = read_log(path)
    np.testing.assert_array_equal(log.t, np.arange(len(values)) / 8)
    # A channel of equal values is held by a slower sensor; it keeps the first.
    for k, name in enumerate("ur"):
        got, want = log.columns[name], np.array([v[k] for v in values])
        there = ~np.isnan(got)
        np.testing.assert_array_equal(got[there], want[there])


def test_dates_with_commas_and_padded_numbers(tmp_path):
    path = tmp_path / "log.txt"
    path.write_text("t;u;note\n" + "".join(f"31.05.2024 10:00:0{k},5; {k},25 ;a, b\n" for k in range(8)))
    log = read_log(path)
    np.testing.assert_allclose(log.t, np.arange(8.0))
    np.testing.assert_array_equal(log.columns["u"], np.arange(8) + 0.25)
    assert log.ignored == ("note",)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("t;u\n0;1\n1;2;3\n2;3\n", "not a readable CSV"),
        ("t;u\n0,0;1.234,5\n1,0;2,5\n", "column u holds '1.234,5' in row 2"),
        # Thousands, or decimals of another program.
        ("t;u\n0,0;1,5\n1,0;1.234\n", "column u has 1.234 in row 3, where other numbers have decimal commas"),
        ("t;u;v\n0,0;1,0;1\n1,0;2", "breaks off in its last row, after 2 of 3 cells"),
        ("time;u\n0;1\n1;2\n", "no column t for the time; it has time, u"),
    ],
)
def test_faults_are_said(tmp_path, text, words):
    path = tmp_path / "log.csv"
    path.write_text(text)
    with pytest.raises(IvsidError, match=words):
        read_log(path)


def test_names_may_hold_blanks_and_semicolons(tmp_path):
    path = tmp_path / "log.csv"
    path.write_text("t,u,water depth; mean\n" + "".join(f"{k},{k}.5,2\n" for k in range(6)))
    assert read_log(path).ignored == ("water depth; mean",)
