"""Results in a terminal and a notebook: short texts, escaped tables, data frames and plots."""

import re
from dataclasses import replace
from fractions import Fraction
from html.parser import HTMLParser

import numpy as np
import polars as pl
import pytest
from matplotlib import pyplot as plt
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import ivsid
from conftest import as_log, embedded
from ivsid import Interval, IntervalArray, IvsidError
from ivsid.display import table
from ivsid.identification import read_identification
from ivsid.intervals import shown
from ivsid.log import Log
from ivsid.vehicle import parse_vehicle

SHORT = 1000


@pytest.fixture(autouse=True)
def _closed():
    yield
    plt.close("all")


@pytest.fixture(scope="module")
def fit(fits):
    return read_identification(fits[0]["pointwise"])


@pytest.fixture(scope="module")
def check(fit, twin):
    return ivsid.validate(fit, as_log(twin))


class Cells(HTMLParser):
    """Cells of a table and the tags that were opened; no browser, but strict about what is left open."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.open, self.tags, self.cells, self.styles = [], set(), [], []
        self.feed(text)
        assert not self.open

    def handle_starttag(self, tag, attrs):
        self.open.append(tag)
        self.tags.add(tag)
        assert {k for k, _ in attrs} <= {"style"}
        self.styles += [v for _, v in attrs]

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        self.cells.append(data)


def wild(name: str):
    """A log with a name and channels that are HTML."""
    t = np.arange(50) * 0.1
    return Log(name, "", t, {f"<b>{k}</b>": t * k for k in range(40)})


def everything(fit, check, twin):
    vehicle = parse_vehicle(
        embedded("swan.toml").replace('name = "SWAN"', 'name = "<script>alert(1)</script>"'), "s.toml"
    )
    wide = IntervalArray(np.arange(400.0).reshape(20, 20) / 3, np.arange(400.0).reshape(20, 20) / 3 + 1)
    return [
        fit,
        check,
        as_log(twin),
        wild("<img src=x>" * 100),
        vehicle,
        wide,
        IntervalArray(np.ones(7), np.full(7, np.inf)),
        IntervalArray(np.ones((3, 4, 5))),
        IntervalArray(1.0),
        IntervalArray(np.zeros(0)),
    ]


def test_texts_are_short_and_tables_escaped_and_the_same_again(fit, check, twin):
    for value in everything(fit, check, twin):
        text, html = repr(value), value._repr_html_()
        assert 0 < len(text) <= SHORT and type(value).__name__ in text, text
        seen = Cells(html)
        assert seen.tags <= {"div", "table", "thead", "tbody", "tr", "th", "td"}
        # Light or dark is the page's affair: nothing here has a colour of its own.
        assert not re.search(r"#[0-9a-f]{3}|rgb|white|black", " ".join(seen.styles))
        assert "color: inherit" in html or "<table" not in html
        assert html == value._repr_html_() and str(value) == repr(value) == text


def test_the_text_of_a_fit_names_all_that_matters(fit):
    text = repr(fit)
    assert text.startswith("Identification of SWAN by feasible on log.csv: enclosed, guaranteed\n")
    for name, p in fit.parameters.items():
        line = next(x for x in text.splitlines() if x.startswith(f"  {name} "))
        low, high = re.search(r"\[(.*), (.*)\]", line).groups()
        assert Fraction(low) <= Fraction(p.lower) and Fraction(high) >= Fraction(p.upper) and line.endswith(p.unit)


def test_intervals_in_words_are_rounded_outward():
    rng = np.random.default_rng(3)
    for x in [*rng.standard_normal(300), *10.0 ** rng.uniform(-300, 300, 300), 5e-324, -5e-324, 1.7e308, 0.1, 100000.0]:
        low, high = map(Fraction, shown(x, x)[1:-1].split(", "))
        assert low <= Fraction(x) <= high
        assert high - low <= abs(Fraction(x)) / 10**5
    assert shown(-np.inf, 2.0) == "[no bound, 2]" and shown(0.0, 1e6) == "[0, 1e+06]"
    assert shown(1.0000001, 1.5) == "[1, 1.5]" and shown(1.5, 1.5000001) == "[1.5, 1.50001]"


def test_long_tables_say_what_they_leave_out():
    cells = {"name": [f"row {k}" for k in range(500)], "value": [float(k) for k in range(500)]}
    text = table.text("many", cells)
    said = text.splitlines()
    assert len(text) <= SHORT and re.fullmatch(r"  and \d+ more rows", said[-1])
    assert len(said) - 3 + int(said[-1].split()[1]) == 500
    html = table.html("many", cells)
    assert html.count("<tr>") == table.MOST_ROWS + 1 and f"and {500 - table.MOST_ROWS} more rows" in html
    assert table.text("few", {"a": [1, None], "b": [True, 0.123456789]}) == "few\n  a  b\n  1  yes\n  –  0.123457"
    assert table.text("none", {"a": []}) == "none"


def test_one_interval_stands_in_few_digits_and_in_all_of_them():
    found = Cells(Interval(0.1, 2 / 3)._repr_html_())
    assert found.tags <= {"div", "table", "thead", "tbody", "tr", "th", "td"}
    heading, name, digits = found.cells
    assert (heading, name) == ("Interval [0.1, 0.666667]", "with all digits")
    low, high = digits[1:-1].split(", ")
    assert (float(low), float(high)) == (0.1, 2 / 3)
    assert Fraction(low) <= Fraction(0.1) and Fraction(2 / 3) <= Fraction(high)
    assert Cells(Interval(0.0, np.inf)._repr_html_()).cells[0] == "Interval [0, no bound]"
    assert Cells(Interval.empty_set()._repr_html_()).cells == ["Interval [empty]"]


def test_matrices_stand_as_they_are():
    a = IntervalArray(np.array([[1.0, 2.0], [3.0, 4.0]]), np.array([[1.5, 2.5], [3.5, 4.5]]))
    found = Cells(a._repr_html_()).cells
    assert found == [
        "IntervalArray of shape (2, 2)", "row", "column 0", "column 1", "0", "[1, 1.5]", "[2, 2.5]", "1", "[3, 3.5]", "[4, 4.5]",
    ]  # fmt: skip
    assert repr(a) == "IntervalArray([[[1, 1.5], [2, 2.5]], [[3, 3.5], [4, 4.5]]])"
    assert repr(IntervalArray(np.arange(30.0))).endswith("...], shape (30,))")
    assert len(repr(Interval(1.0, 2.0))) < 40


def test_numbers_go_into_data_frames(fit, check, twin):
    frame = fit.to_polars()
    assert frame["parameter"].to_list() == list(fit.parameters)
    assert frame["lower"].to_list() == [p.lower for p in fit.parameters.values()]
    assert frame["upper"].to_list() == [p.upper for p in fit.parameters.values()]
    assert check.to_polars().select("channel", "sigma").rows() == [(f.channel, f.sigma) for f in check.forces]
    log = as_log(twin)
    read = log.to_polars()
    assert read.columns == ["t", *log.columns] and read.height == log.t.size
    assert np.array_equal(read["u"].to_numpy(), log.columns["u"])


def test_pandas_is_asked_for_by_name_and_never_needed(fit, monkeypatch):
    import sys
    import types

    monkeypatch.setitem(sys.modules, "pandas", None)
    with pytest.raises(
        IvsidError, match=r"pandas, which is not installed; run pip install 'ivsid\[pandas\]', or use to_polars"
    ):
        fit.to_pandas()
    monkeypatch.setitem(sys.modules, "pandas", types.SimpleNamespace(DataFrame=pl.DataFrame))
    assert fit.to_pandas().equals(fit.to_polars())


def lines_of(axes: Axes) -> list[np.ndarray]:
    return [np.asarray(line.get_ydata()) for line in axes.lines]


def test_plots_are_axes_with_the_numbers(fit, check, twin):
    panels = fit.plot()
    assert [a.get_xlabel().split(" [")[0] for a in panels] == list(fit.parameters)
    for axes, p in zip(panels, fit.parameters.values(), strict=True):
        assert list(axes.lines[0].get_xdata()) == [p.lower, p.upper]
    assert panels[0].figure in map(plt.figure, plt.get_fignums())
    forces = check.plot()
    assert len(forces) == len(check.forces)
    assert np.array_equal(lines_of(forces[0])[0][:5], check.forces[0].measured.midpoint[:5])
    own = Figure()
    log = as_log(twin)
    drawn = log.plot(own)
    assert all(a.figure is own for a in drawn) and any(np.array_equal(x, log.columns["u"]) for x in lines_of(drawn[1]))


def test_a_diagnosis_shows_its_causes_and_draws_its_residuals():
    """The class alone, on numbers of a diagnosis: one of a log takes minutes."""
    from types import SimpleNamespace as Made

    from ivsid.diagnosis import Bound, Diagnosis, Finding
    from ivsid.report.figures.plots import plot

    bound = Bound(1.0, 2.0, "kg/s", "X_u")
    like = Made(probability=0.9)
    named = Finding("drag.surge.linear", 0.8, ("thruster.loss",), "coast", {"drag.surge.linear": bound}, {}, like=like)
    bare = Finding("unknown", 1.0, (), "", {}, {}, like=None)
    gain = Made(residual=np.arange(60.0).reshape(2, 3, 10), time=np.arange(10.0))
    shape = dict.fromkeys(Diagnosis.__dataclass_fields__)
    made = Diagnosis(
        **shape
        | {
            "verdict": "wrong",
            "findings": (named, bare),
            "vehicle": Made(name="OTTER"),
            "inputs": (("v.toml", ""), ("a.csv", ""), ("b.csv", "")),
            "gain": gain,
            "setup": (),
        }
    )
    text = repr(made)
    assert text.startswith("Diagnosis of OTTER on a.csv and b.csv: wrong, 2 findings\n") and len(text) < SHORT
    assert "drag.surge.linear [1, 2] kg/s" in text and "thruster.loss" in text
    assert "drag.surge.linear" in Cells(made._repr_html_()).cells
    rows = made.to_polars().rows(named=True)
    assert [r["cause"] for r in rows] == ["drag.surge.linear", "unknown"]
    assert rows[0]["lower"] == 1.0 and rows[1]["parameter"] is None and rows[0]["probability"] == 0.9
    panels = plot(made, None)
    assert len(panels) == 3
    for k, axes in enumerate(panels):
        for j in range(2):
            assert np.array_equal(lines_of(axes)[j], gain.residual[j, k])


def test_results_with_no_bounds_are_shown_too(fit, twin):
    empty = replace(fit, parameters={}, estimate={}, status="empty")
    assert repr(empty) == "Identification of SWAN by feasible on log.csv: empty, guaranteed"
    assert "<table" not in empty._repr_html_() and empty.to_polars().height == 0
    wrong = replace(fit, parameters={}, status="empty")
    assert "mass.surge  " in repr(wrong) and f"{fit.estimate['mass.surge']:.6g}" in wrong._repr_html_()
    open_ended = replace(fit, parameters={k: replace(p, upper=np.inf) for k, p in fit.parameters.items()})
    assert "no bound" in repr(open_ended) and "no bound" in open_ended._repr_html_()
    lost = replace(as_log(twin), columns={"u": np.full(twin.t.size, np.nan)})
    assert "–" in repr(lost)


def test_completion_offers_public_names_alone():
    import inspect

    assert dir(ivsid) == sorted(ivsid.__all__)
    for name in ("identify", "validate", "diagnose", "verify", "read_log", "read_vehicle"):
        words = inspect.getdoc(getattr(ivsid, name))
        assert "Args:" in words and "Raises:" in words, name
