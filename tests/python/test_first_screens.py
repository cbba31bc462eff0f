"""First screens and tables of pages: each sentence once, no table of nothing, open ends in words, samples to look at."""

import math
import re
from dataclasses import replace
from functools import cache
from importlib.resources import files
from types import SimpleNamespace

import pytest

from ivsid import identify, simulation, validate
from ivsid.log import Log
from ivsid.plans.narrowing import OPEN
from ivsid.programme.scenario import parse_scenario
from ivsid.report import page
from ivsid.vehicle import parse_vehicle
from ivsid.workflow import trial_plan, verification
from ivsid.workflow.first_screens import analysed, identified, validated
from ivsid.workflow.identification import identification_report
from ivsid.workflow.parameters import MEANING, bounded, brief, parameter_bars
from ivsid.workflow.validation import validation_summary
from pages import Page

DATA = files("ivsid") / "data"
VEHICLE = parse_vehicle((DATA / "swan.toml").read_text(), "swan.toml")


@cache
def run(scenario, **effects):
    text = (DATA / f"{scenario}.toml").read_text().replace("duration = 300.0", "duration = 60.0", 1)
    made = simulation.simulate(VEHICLE, parse_scenario(text, scenario), 4, dict(effects))
    return Log(f"{scenario}.csv", f"{len(effects):064d}", made.t, made.columns)


@cache
def fit(kind):
    """A fit of a sound log, of one that contradicts its model, or with a parameter that is left open."""
    found = identify(VEHICLE, run("swan_train", **({"thruster.delay": 2.0} if kind == "empty" else {})), examine=False)
    if kind == "open":
        free = {"inertia.yaw": replace(found.parameters["inertia.yaw"], lower=-math.inf, upper=math.inf)}
        return replace(
            found, status="unbounded", parameters={**found.parameters, **free}, directions=[{"inertia.yaw": 1.0}]
        )
    return found


def sentences(text):
    return [s.strip() for s in re.split(r"(?<=[.:;])\s", text) if len(s) > 25]


@pytest.mark.parametrize("kind", ["sound", "empty", "open"])
def test_a_first_screen_does_not_say_again_what_its_summary_says(kind):
    found = fit(kind)
    assert found.status == {"sound": "enclosed", "empty": "empty", "open": "unbounded"}[kind]
    first = identified(found)
    assert MEANING[found.status] not in first.words and "guaranteed" not in first.words.lower()
    said = sentences(f"{MEANING[found.status]}. {first.words} {' '.join(first.following)}")
    assert said and len(said) == len(set(said))


def test_an_empty_set_has_no_table_of_nothing_and_names_its_samples():
    found = fit("empty")
    report = identification_report(found, run("swan_train"))
    parts = {s.title: s.parts for s in report.sections}
    assert [p["kind"] for p in parts["Parameters"]] == ["text", "list"]
    words, links, samples, *_ = parts["Why no parameter fits"]
    rows = {(r["channel"], r["time"], r["side"]) for c in found.falsifying for r in c["rows"]}
    listed = {(r[0]["text"], float(r[1]["text"]), r[3]["text"]) for r in samples["rows"]}
    assert listed and all(
        any(c == k and s == w and math.isclose(t, x, rel_tol=1e-5) for c, x, s in rows) for k, t, w in listed
    )
    assert {q["to"] for q in links["links"]} == {"log"} and "look at" in words["text"]
    seen = Page(page.html(report))
    assert not re.search(r"<td[^>]*>–</td>\s*<td[^>]*></td>", page.html(report)) and seen


def test_open_ends_are_words():
    assert brief(-math.inf, math.inf) == "no bound" and brief(-math.inf, 2.0).startswith("[")
    facts = dict(identified(fit("open")).cards[0].facts)
    assert facts["inertia.yaw"] == "no bound" and facts["mass.surge"].endswith("] kg")
    (bars,) = [n for n in parameter_bars([fit("open")])["numbers"] if n["number"].startswith("inertia.yaw")]
    assert bars["rows"][0]["bar"] == {"left": 0.0, "width": 100.0, "less": True, "more": True} and bars["axis"] == []


def test_rows_that_agree_prove_half_where_no_motion_can_be_simulated():
    made = validate(fit("sound"), run("swan_test"), tubes=False)
    assert validated(made).tone == "good" and "hold" in validated(made).verdict
    moved = replace(made, motion=replace(made.motion, reason="the simulated motion grows without bound", rms={}))
    first = validated(moved)
    assert first.tone == "open" and first.verdict == "No row of the other log contradicts the parameters"
    assert not set(sentences(validation_summary(moved))) & set(sentences(first.words))


def test_what_a_plan_reaches_is_said_in_the_same_words_everywhere():
    """Open intervals are counted beside a number, and were a million in the card of the first screen."""
    values = SimpleNamespace(median=15.9 + 4 * OPEN, least=14.7 + 4 * OPEN, most=18.2 + 4 * OPEN)
    made = SimpleNamespace(
        purpose="narrow",
        quantity="widest relative interval",
        predicted=values,
        before=3.42 + 4 * OPEN,
        best_rival=("turns on the spot", 1.88 + 4 * OPEN),
        rivals={"turns on the spot": 1.88 + 4 * OPEN},
        scenario=SimpleNamespace(duration=60.0),
        fence=SimpleNamespace(radius=math.inf),
        gain=lambda value: value / values.median,
    )
    first, summary = trial_plan._first(made), trial_plan.summary_of(made)
    card = dict(first.cards[0].facts)
    assert card["widest relative interval"].startswith("1590 % beside 4 open ones (1470 %")
    assert "to 1590 % beside 4 open ones" in summary and "e+0" not in f"{summary} {card}"
    assert first.words == "" and trial_plan._library(made)["rows"][1][1]["text"] == "188 % beside 4 open ones"


def test_a_fleet_gives_no_unit_to_what_has_no_bound():
    assert bounded(-math.inf, math.inf, "kg") == "no bound" and bounded(1.0, 2.0, "kg") == "[1, 2] kg"


@pytest.mark.parametrize(
    ("unit", "walk"),
    [("rad/s", "rad/√s"), ("deg/s", "deg/√s"), ("m/s^2", "m/s/√s"), ("mg", "mg·√s"), ("deg/h", "deg/h·√s")],
)
def test_coefficients_of_noise_have_units(unit, walk):
    curve = SimpleNamespace(
        bands={"random_walk": (0.9, 1.1)}, bias_instability=0.25, resolved=True, random_walk=1.0, channel="r"
    )
    (fact,) = analysed({"r": curve}, {"r": 3.0}, {"r": unit}, 600.0).cards[0].facts
    assert fact == ("r", f"N 1 {walk} (0.9 to 1.1); B 0.25 {unit}; half-width 3 {unit}")


@pytest.mark.parametrize(
    ("status", "tone", "words"),
    [
        ("proved", "good", "is proved"),
        ("not_checked", "open", "cannot be checked"),
        ("failed", "bad", "does not follow"),
    ],
)
def test_a_verification_has_a_first_screen(status, tone, words):
    verdict = SimpleNamespace(status=status, certificates=12, rows=30, failures=("one",) if status == "failed" else ())
    first = verification._first(verdict)
    assert first.tone == tone and words in first.verdict and first.following
    assert dict(first.cards[0].facts)["checks that failed"] == str(len(verdict.failures))
