"""The report page without a browser: one file that loads nothing, whose names cannot break out, and whose figures keep every peak."""

import base64
import hashlib
import json
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from ivsid import workflow
from ivsid.diagnosis import Bound, Claim, Evidence, Finding
from ivsid.diagnosis.statements.binning import Binned
from ivsid.diagnosis.statements.shallow_water import Change
from ivsid.report import drawn, page, series
from ivsid.report.drawn import Bar, Bars, Dots
from ivsid.report.page import Card, First, Report, Section
from ivsid.report.scaling import narrow_axis, robust_range, ticks
from ivsid.report.series import Line, Mark, Panel
from ivsid.workflow.diagnosis_series import change_bars, claim_bars, finding_parts, row_links
from ivsid.workflow.log_files import distinct_names
from pages import Page, faults

ROOT = Path(__file__).parents[2]
HOSTILE = "</script><script>alert(1)</script><img src=http://evil.example/x onerror=alert(1)>\"'&{{ 7*7 }}"


def motion(n=400, name="log"):
    t = 0.1 * np.arange(n)
    spiky = np.sin(t)
    spiky[0] = -30.0
    gap = np.where(np.arange(n) % 50 == 7, np.nan, np.cos(t))
    panels = (
        Panel("surge velocity u [m/s]", (Line("measured", "measured", np.sin(t), 0.1), Line("plain", "before", gap))),
        Panel(
            "missing force X [N]", (Line("plain", "before", spiky), Line("extended", "after", 0.1 * spiky)), robust=True
        ),
    )
    return series.series(name, "A log", "As measured.", t, panels, [Mark("a stretch", 10.0, 20.0)])


def report(words="boat", **more):
    first = First("Wrong", "bad", words, (Card(words, words, ((words, words),), "finding-1"),), (words,), (words,))
    x = np.linspace(-1, 1, 9)
    parts = (
        page.heading(words, "finding-1"),
        page.text(words),
        page.bullets([words]),
        page.code(words),
        page.table([words, "number"], [[words, 1.23456789], [True, None]], words),
        page.table(["none"], []),
        page.details(words, [page.table(["a"], [[1]])]),
        page.jump(words, [(words, "log", 1.0, 2.0)]),
        drawn.bars(
            words,
            [
                Bars(
                    words,
                    (Bar(words, 1.0, 2.0, words), Bar("wide", -1500.0, np.inf, words)),
                    ((words, 1.5), ("far", 99.0)),
                )
            ],
        ),
        drawn.curve(
            words, words, words, words, [Dots(words, "before", x, x, 0.1 + 0 * x), Dots(words, "cause", x, -x)]
        ),
        motion(),
    )
    record = {"inputs": [{"name": words, "sha256": "0" * 64}]}
    return Report(
        words,
        words,
        record,
        (Section(words, parts), Section(words, (page.text("again"),)), Section("Empty", ())),
        first=first,
        **more,
    )


def test_the_page_is_whole_loads_nothing_and_every_link_leads_somewhere():
    made = page.html(report())
    assert faults(made) == []
    read = Page(made)
    assert "default-src 'none'" in made and "1.235" in read.text and "1.23456789" not in read.text
    assert "Empty" not in read.text and "None." in read.text
    assert {"result", "boat", "boat1", "finding-1", "log", "about"} <= set(read.ids)
    assert page.html(report()) == made


@pytest.mark.parametrize(
    ("change", "fault"),
    [
        (lambda s: s.replace('<h2 id="boat-title">', '<h2 id="result">'), "id result twice"),
        (lambda s: s.replace("<main>", '<main><img alt="x" src="https://evil.example/x.png">'), "loads https"),
        (lambda s: s.replace("<main>", "<main><h4>deep</h4>"), "not one first heading"),
        (lambda s: s.replace('href="#boat"', 'href="#gone"'), "leads nowhere: #gone"),
        (lambda s: s.replace("<main>", "<main><table></table>"), "an empty table"),
        (lambda s: s.replace("<main>", "<main><svg></svg>"), "a figure without words"),
        (lambda s: s.replace("</nav>", ""), "is not closed"),
        (lambda s: s.replace("</style>", "@import 'x'</style>", 1), "@import"),
        (lambda s: s + " " * 3_000_000, "bytes"),
    ],
)
def test_a_page_with_a_fault_is_refused(change, fault):
    assert any(fault in f for f in faults(change(page.html(report()))))


def test_names_from_files_stay_text():
    made = page.html(report(HOSTILE))
    assert faults(made) == []
    read = Page(made)
    assert not read.handlers and "evil.example" in read.text and "{{ 7*7 }}" in read.text
    assert made.count("<script") == page.html(report()).count("<script")
    hostile = Line(HOSTILE, "measured", np.arange(9.0))
    part = series.series(
        "log", HOSTILE, HOSTILE, np.arange(9.0), [Panel(HOSTILE, (hostile,))], [Mark(HOSTILE, 0.0, 1.0)]
    )
    made = page.html(Report("x", "", {}, (Section("Log", (part,)),)))
    assert faults(made) == []
    (data,) = Page(made).script_data
    assert json.loads(data)["panels"][0]["lines"][0]["label"] == HOSTILE and "<" not in data


def test_a_page_without_a_first_screen_or_series_is_a_page_all_the_same():
    made = page.html(replace(report(), first=None, sections=(Section("Text", (page.text("one"),)),)))
    assert faults(made) == [] and "uPlot" not in made and len(made) < 40_000


def values(part, level=0):
    return [np.frombuffer(base64.b64decode(v), "<f4") for v in part["data"]["levels"][level]["values"]]


def test_a_short_log_is_kept_sample_by_sample_and_a_long_one_keeps_every_peak():
    part = motion()
    first = values(part)
    assert part["data"]["levels"][0]["bucket"] == 1 and first[0].size == 400
    np.testing.assert_allclose(first[0], np.sin(0.1 * np.arange(400)), atol=1e-6)
    assert np.isnan(first[1][7]) and part["data"]["panels"][1]["cut"] == 2
    n = 1_000_000
    t = 0.01 * np.arange(n)
    x = np.zeros(n)
    peaks = np.array([5, 333_333, n - 1])
    x[peaks] = [1.0, -2.0, 3.0]
    part = series.series(
        "long", "Long", "", t, [Panel("x", (Line("x", "measured", x),))], [Mark("here", 3333.0, 3334.0)]
    )
    whole, fine = part["data"]["levels"]
    (kept,) = values(part)
    assert kept.size * 4 <= series.MOST * 2 and whole["bucket"] > 1
    assert sorted(kept[kept != 0]) == [-2.0, 1.0, 3.0]
    at = whole["start"] + np.frombuffer(base64.b64decode(whole["time"]), "<f4")[kept != 0]
    assert np.abs(at - t[peaks]).max() <= whole["bucket"] * 0.01
    assert fine["bucket"] == 1 and fine["start"] == pytest.approx(3333.0) and -2.0 in values(part, 1)[0]
    made = page.html(Report("x", "", {}, (Section("Log", (part,)),)))
    assert faults(made) == [] and len(made) < 2_000_000


def test_a_clock_with_a_gap_keeps_its_times():
    t = np.r_[np.arange(50.0), 100.0 + np.arange(50.0)]
    part = series.series("gap", "Gap", "", t, [Panel("x", (Line("x", "measured", t),))])
    level = part["data"]["levels"][0]
    assert "step" not in level
    np.testing.assert_allclose(np.frombuffer(base64.b64decode(level["time"]), "<f4"), t)


def test_an_edge_spike_does_not_set_the_axis_of_a_residual():
    x = np.sin(0.1 * np.arange(5000))
    assert robust_range([np.r_[-30.0, x, 25.0]]) == pytest.approx(robust_range([x]), abs=1.2)
    low, high = robust_range([np.r_[-30.0, x, 25.0]])
    assert -2.5 < low < -1 and 1 < high < 2.5
    # Without spikes nothing is cut, and gaps and constants have an axis.
    low, high = robust_range([x])
    assert low < x.min() and high > x.max() and high - low < 2.5
    assert robust_range([np.full(9, np.nan)]) is None and robust_range([]) is None
    low, high = robust_range([np.full(9, 2.0)])
    assert low < 2.0 < high


def test_narrow_intervals_set_an_axis_and_wide_ones_run_off():
    low, high = narrow_axis([(56.9, 64.1), (-1500.0, 1500.0)], [60.0, 1e9])
    assert 50 < low < 56.9 and 64.1 < high < 70
    assert narrow_axis([(1.0, 2.0), (0.0, 8.0)]) == pytest.approx((-0.48, 8.48))
    assert narrow_axis([(-np.inf, np.inf)]) is None
    part = drawn.bars(
        "", [Bars("m [kg]", (Bar("narrow", 56.9, 64.1, ""), Bar("wide", -1500.0, 1500.0, "")), (("claimed", 1e9),))]
    )
    (number,) = part["numbers"]
    narrow, wide = (r["bar"] for r in number["rows"])
    assert narrow["width"] > 80 and not narrow["less"] and not narrow["more"]
    assert wide == {"left": 0.0, "width": 100.0, "less": True, "more": True}
    assert number["points"][0]["more"] and number["points"][0]["at"] == 100.0


@pytest.mark.parametrize(("low", "high"), [(-1.0, 1.0), (0.0966, 0.1004), (-3.2e7, 5e8), (1e-9, 2e-9)])
def test_marks_of_an_axis_are_round_and_inside(low, high):
    found = ticks(low, high)
    assert 2 <= len(found) <= 6 and all(low <= x <= high for x in found)
    step = np.diff(found)
    assert np.allclose(step, step[0]) and f"{step[0]:.6e}"[0] in "125"


def test_logs_of_one_name_are_told_apart_by_their_folders(tmp_path):
    a, b = tmp_path / "calm" / "log.csv", tmp_path / "waves" / "log.csv"
    assert distinct_names((a, b)) == ["calm/log.csv", "waves/log.csv"]
    assert distinct_names((a, tmp_path / "two.csv")) == ["log.csv", "two.csv"]
    assert distinct_names((a, a)) == ["log.csv", "log.csv"]
    assert distinct_names((tmp_path / "1/x/log.csv", tmp_path / "2/x/log.csv")) == ["1/x/log.csv", "2/x/log.csv"]


def test_the_plotting_library_is_the_one_that_the_design_names():
    folder = ROOT / "python" / "ivsid" / "data" / "report" / "uplot"
    design = (ROOT / "DESIGN.md").read_text()
    for name in ("uPlot.iife.min.js", "uPlot.min.css"):
        assert hashlib.sha256((folder / name).read_bytes()).hexdigest() in design, name
    # A copy in a page keeps its licence.
    assert "Permission is hereby granted, free of charge" in page.html(report())


def test_a_table_and_a_recording_give_pages_that_say_what_to_do(tmp_path):
    demand = np.linspace(-100, 100, 21)
    rows = "\n".join(f"{d},{0.004 * d * abs(d)}" for d in demand)
    (tmp_path / "pull.csv").write_text(f"demand [%],thrust [N]\n{rows}\n")
    made = workflow.thrust(tmp_path / "pull.csv")
    assert faults(page.html(made)) == []
    said = Page(page.html(made)).text
    assert f"Use the {made.record['recommended']}" in said and "-40 to 40 N" in said and "Copy thruster.toml" in said
    rng = np.random.default_rng(0)
    rows = "\n".join(f"{0.05 * k:.2f},{x:.9f}" for k, x in enumerate(1e-3 * rng.standard_normal(4000)))
    (tmp_path / "still.csv").write_text(f"t,ax\n{rows}\n")
    made = workflow.allan(tmp_path / "still.csv")
    assert faults(page.html(made)) == []
    a = made.record["channels"]["ax"]
    said = Page(page.html(made)).text
    assert f"N {a['random_walk']:.3g} m/s/√s (" in said and ("not resolved" in said) == (not a["bias_resolved"])


def test_a_cause_that_pushes_nothing_has_no_figure_of_forces():
    t = 0.1 * np.arange(900)
    means = Binned(np.arange(3.0), np.zeros(3), np.ones(3))
    given = (t, np.sin(t), np.cos(t), (0, 600), "u", (means,) * 3, (1.0, 1.0, 1.0))
    still = Evidence("sensor.attitude_leak", "yaw", *given, 1e-9 * np.sin(t), means)
    acting = Evidence("drag.yaw.linear", "yaw", *given, np.sin(t), means)
    f = Finding("x", 1.0, (), "", {}, {})
    assert not still.acts and [p["kind"] for p in finding_parts(f, still)] == ["text"]
    jump, curve = finding_parts(f, acting)
    assert acting.acts and curve["kind"] == "curve" and curve["title"] == "drag.yaw.linear in yaw"
    # The largest forces first, each at its time, and no two of one peak.
    times = [0.5 * (q["start"] + q["end"]) for q in jump["links"][1:]]
    assert all(abs(np.sin(x)) > 0.98 for x in times)
    assert min(abs(a - b) for k, a in enumerate(times) for b in times[:k]) >= 5.0


def test_claims_changes_and_rows_stand_in_the_page_where_they_belong():
    beside, alone = Bound(58.0, 62.0, "kg", "m"), Bound(-900.0, 1500.0, "kg", "m")
    claims = [
        Claim("mass.surge", 70.0, "kg", True, 9.0, beside, alone),
        Claim("drag.x", 1.0, "kg/m", False, reason="no signature"),
    ]
    (number,) = claim_bars(claims)["numbers"]
    narrow, wide = (r["bar"] for r in number["rows"])
    (claimed,) = number["points"]
    # The claim lies right of the interval that contradicts it, and the wide interval runs off both ends.
    assert number["number"] == "mass.surge [kg]" and narrow["left"] + narrow["width"] < claimed["at"] < 100
    assert wide["less"] and wide["more"] and not claimed["more"]
    assert change_bars(SimpleNamespace(change=None)) == []
    (part,) = change_bars(SimpleNamespace(change=Change({"mass.surge": (1.2, 0.01), "inertia.yaw": (1.0, 0.01)}, None)))
    heavier, same = part["numbers"]
    assert heavier["points"][0]["at"] < heavier["rows"][0]["bar"]["left"]
    inside = same["rows"][0]["bar"]
    assert inside["left"] < same["points"][0]["at"] < inside["left"] + inside["width"]
    (link,) = row_links([{"channel": "surge", "time": 487.5, "duration": 2.0}])["links"]
    assert link["text"] == "surge at 487.5 s" and link["start"] < 487.5 < 489.5 < link["end"]
