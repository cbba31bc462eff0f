"""A diagnosis for its reader: paragraphs made from its numbers, figures that show them, ranked rejections, losses as losses."""

import json
import multiprocessing
import os
import re
from copy import copy
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import pytest

from diagnosis_logs import logs_of, train_of, vehicle_of
from ivsid import diagnose
from ivsid.diagnosis import evidence, explain, grown, worth
from ivsid.diagnosis.candidates.families import everything
from ivsid.diagnosis.candidates.intervals import Bound
from ivsid.diagnosis.data.channels import channels
from ivsid.diagnosis.estimation.learning import plain_fit
from ivsid.diagnosis.plant.physics import acceleration
from ivsid.diagnosis.statements import comparison
from ivsid.diagnosis.statements.binning import binned, ordered_by
from ivsid.diagnosis.statements.evidence import own_force
from ivsid.diagnosis.statements.model_file import against
from ivsid.diagnosis.statements.prose import _verdict
from ivsid.effects import EFFECTS, Given
from ivsid.files.records import to_json
from ivsid.intervals import apart
from ivsid.report import figures
from ivsid.report.page import html
from ivsid.workflow import gain_figures
from ivsid.workflow.diagnosis import diagnosis_report
from ivsid.workflow.diagnosis_screen import best_gain, size
from ivsid.workflow.gain_figures import GainFigures
from pages import Page, faults

LINEAR = 4.0
# Demands that hold between their steps: nothing steers.
STEPS = """
[[segments]]
manoeuvre = "steps"
demand = [60.0, 20.0]
period = 30.0
duration = 120.0
"""
ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def result():
    vehicle = vehicle_of()
    return diagnose(vehicle, *logs_of(vehicle, {"drag.surge.linear": LINEAR}))


@pytest.fixture(scope="module")
def seen(result):
    return evidence(result)


def test_the_evidence_is_the_force_that_was_hidden(result, seen):
    """Without the finding the projected part of 4 kg/s times u is missing, in surge, and it goes with u; with it only the ambient force is."""
    assert [f.effect for f in result.findings] == ["drag.surge.linear"]
    (e,) = seen
    assert (e.effect, e.channel, e.unit, e.quantity) == ("drag.surge.linear", "surge", "N", "u")
    before, after, own = e.rms
    assert before > 1.4 * after and own > 1.1 * after
    # The ambient force is 0.15 N before the low-pass.
    assert 0.03 < after < 0.25
    good = result.selection.last.noise.good
    assert before == pytest.approx(float(np.sqrt(np.mean(e.before[good] ** 2))))
    u = result.selection.last.states.points.nu[0, : e.time.size][good]
    explained = (e.before - e.after)[good]
    # Drag, mass and the declared thrust errors take most of -4 u; what is left falls with u first, and the square turns it round.
    A = np.stack([u, u * np.abs(u)], axis=1)
    slope, curve = np.linalg.lstsq(A, explained, rcond=None)[0]
    assert -LINEAR < slope < -0.3 and curve > 0.3
    first, end = e.window
    assert end - first == 900 and (e.before - e.after)[first:end].std() > 0


def test_the_force_of_the_cause_is_that_of_its_number_alone(result, seen):
    """All other numbers held, a linear drag is minus its number times u, in surge and nowhere else."""
    (e,) = seen
    last = result.selection.last
    predictor = last.noise.predictor
    size = last.h.values["drag.surge.linear"]
    u = predictor.log.nu[0]
    # The low pass and the filtered velocity cost little where the motion is slow.
    np.testing.assert_allclose(
        e.own[100:-100], comparison.low(predictor, -size * u[None])[0][100:-100], atol=0.03 * size
    )
    assert e.acts and e.own_means.mean == pytest.approx(-size * e.own_means.centre, abs=0.02 * size)


def test_a_delay_does_nothing_in_a_steady_turn():
    """A refit spreads a delay over every stretch; its own force lies where the demand changes."""
    vehicle = vehicle_of()
    log = channels(train_of(vehicle, {"thruster.delay": 0.3}, segments=STEPS, duration=120.0), vehicle, None)
    plain = plain_fit(vehicle, log, everything)
    effect = EFFECTS["thruster.delay"]
    h = plain.h.with_effect(Given(effect, (0.3,)))
    predictor = plain.noise.predictor
    points = plain.states.points.under(*predictor.driving.force(h))
    states = replace(plain.states, h=h, points=points, nudot=acceleration(vehicle, h, points))
    own = own_force(predictor, plain, replace(plain, states=states), "thruster.delay")
    demand = log.demands
    changed = np.abs(np.diff(demand, axis=1)).max(axis=0) > 0
    near = np.convolve(np.r_[changed, False], np.ones(2 * round(6.0 / log.h) + 1), "same") > 0
    assert near.any() and not near.all()
    size = np.abs(own[0]).max()
    assert size > 1.0 and np.abs(own[0][~near]).max() < 0.02 * size


def test_every_paragraph_is_made_of_the_numbers(result, seen):
    (paragraphs,) = explain(result, seen)
    what, much, sure, other, changed, following = paragraphs
    bound = result.findings[0].parameters["drag.surge.linear"]
    assert what.startswith("drag.surge.linear: laminar skin friction")
    low, high = map(float, re.search(r"lies between (\S+) and (\S+) kg/s \(statistical, not proved", much).groups())
    # Rounded outward, and by no more than four digits ask for.
    assert bound.lower - 1e-3 <= low <= bound.lower and bound.upper <= high <= bound.upper + 1e-3
    assert f"{seen[0].rms[0]:.3g} N are missing" in much and "It goes with u." in much
    assert f"by {result.findings[0].evidence['z']:.0f} standard deviations" in sure and "0.5 %" in sure
    numbers = re.findall(r"explains (\d+) % of the fall", other)
    assert result.findings[0].alternatives or (numbers and 0 <= int(numbers[0]) <= 100) or "comes near" in other
    assert "ivsid identify" in following
    f = result.findings[0]
    assert f"by less than {f.evidence['z'] - 3 * 2**0.5:.0f} standard deviations" in changed
    assert f.record()["refuted_below"] == pytest.approx(f.evidence["z"] - 3 * 2**0.5)
    # A set is taken for the finding, and the manoeuvre that would decide stands there.
    made = explain(_with_alternatives(result), seen)[0]
    assert "does not tell it from friction.coulomb" in made[3] and "coast" in made[4] and "coast" in made[5]
    assert "that of the first name without the others" in made[3]
    # What a log does not tell of a cause stands before the causes that it does not tell from it.
    several = _with_alternatives(result)
    untold = replace(
        several, findings=(replace(several.findings[0], description="a start may be a change over minutes"),)
    )
    said = explain(untold, seen)[0][3]
    assert said.index("a start may be a change over minutes; the log does not tell it from friction.coulomb") > 0


def _with_alternatives(result):
    from dataclasses import replace

    f = replace(result.findings[0], alternatives=("friction.coulomb",), separate_by="coast to rest", confidence=0.6)
    return replace(result, findings=(f,))


def test_every_candidate_is_found_in_a_set_or_rejected_with_a_reason(result):
    record = json.loads(to_json(result.record()))
    rejected = {q["effect"]: q for q in record["rejected"]}
    held = {i for f in result.findings for i in (f.effect, *f.alternatives)}
    assert set(rejected) | held == {s.id for s in result.selection.screened} and not set(rejected) & held
    assert all(len(q["reason"]) > 20 for q in rejected.values())
    gains = {s.id: s.fall for s in result.selection.screened}
    for id_, q in rejected.items():
        assert q["gain"] == pytest.approx(gains[id_])
        # The rule that fired is held against numbers that stand elsewhere in the result.
        if q["rule"] == "faint" and "beside" not in q["reason"]:
            assert q["gain"] < 25
        if q["rule"] == "faint" and "beside" in q["reason"]:
            assert q["gain"] >= 25 and q["beside_findings"] < 25
        if q["rule"] == "visible":
            assert result.visible[id_].z < 8
        if q["rule"] == "rival":
            assert q["full_fit"][1] - q["full_fit"][0] > 9
        assert f"{q['rule']} |" in (ROOT / "docs" / "rules.md").read_text()
    # The nearest neighbour explains a great deal by itself and nothing beside the finding.
    near = rejected.get("friction.coulomb") or rejected["thruster.advance_loss"]
    assert near["gain"] > 25 and near["beside_findings"] < 0.2 * near["gain"]


def test_a_model_whose_error_grows_by_a_quarter_is_handed_out_nowhere(result):
    """One that put the position five times as far off was written: its windows differed so much that no loss was told."""
    gain = result.gain
    assert gain.grown == () and grown(gain) == "" and best_gain(result)
    before, _ = gain.position_rms
    for factor, counts in ((1.24, False), (1.26, True)):
        other = replace(gain, position_rms=(before, factor * before), losses={})
        worse = replace(result, gain=other)
        assert (other.grown == ("position",)) == counts
        assert ("simulated position" in grown(other)) == counts == (not best_gain(worse))
        reasons = "; ".join(against(worse.vehicle, worse.model, worse.selection.last.states.points, other))
        assert ("grows by a quarter" in reasons) == counts
    # What diverges has no error that could grow, and a loss that is told stands elsewhere.
    assert replace(gain, position_rms=(before, 9 * before), diverges=(None, 3.0)).grown == ()
    assert grown(replace(gain, position_rms=(before, 9 * before), losses={"position": 1e-6})) == ""


def test_a_thruster_is_named_and_not_numbered():
    bound = Bound(1.0, 1.0, "1", "", stands_for="starboard")
    assert bound.record()["thruster"] == "starboard" and "thruster" not in Bound(1.0, 1.0, "1", "").record()
    assert size(bound) == "starboard" and size(replace(bound, stands_for="")) != "starboard"


def test_gains_have_intervals_and_losses_are_said(result):
    gain = result.gain
    assert set(gain.interval) == {"u", "v", "r", "position", "X", "Y", "N"}
    for low, high in gain.interval.values():
        assert 0 < low <= high
    rows = {what: (before, after, interval, said) for what, _, before, after, interval, said in worth(gain)}
    assert len(rows) == 7
    force = next(v for k, v in rows.items() if k.startswith("missing force X"))
    assert force[1] < force[0] and force[3].startswith("better, by a factor of")
    assert force[2][0] <= force[0] / force[1] <= force[2][1]
    assert _verdict(1.0, 1.6, (0.5, 0.8)) == "WORSE, by a factor of 1.25 to 2"
    assert _verdict(1.0, 0.9, (0.8, 1.4)) == "no change that this log can tell"
    assert _verdict(1.0, 1.0, (1.0, 1.0)) == "unchanged"
    # Mass times acceleration: what was measured, less what each model says of it, is the force that is missing.
    left = gain.net[0] - gain.net[2]
    size = np.sqrt(np.mean(left[:, 50:-50] ** 2, axis=1))
    for k, name in enumerate("XYN"):
        assert size[k] == pytest.approx(gain.force_rms[name][1], rel=0.1)


# Nightly: the gate compares two models of which one is wrong in test_diagnosis_stages.py.
@pytest.mark.nightly
def test_a_model_that_is_made_worse_is_reported_as_worse(result):
    """TEST without the effect: the extended model is wrong there, and the report says so."""
    vehicle = vehicle_of()
    train = train_of(vehicle, {"drag.surge.linear": 3 * LINEAR})
    _, test = logs_of(vehicle)
    made = diagnose(vehicle, train, test)
    assert made.findings
    said = {what: words for what, *_, words in worth(made.gain)}
    assert any(words.startswith("WORSE") for words in said.values()), said
    # The first lines say so, too.
    assert made.gain.losses and any("worse than the one before it" in line for line in diagnosis_report(made).lines)


@pytest.mark.figures
def test_the_page_shows_each_finding_and_both_models_on_the_other_log(result):
    page = diagnosis_report(result)
    names = [d.name for d in page.drawings]
    assert names == ["signature_1", "net_force", "gain", "force_residual"]
    assert all(d.png[:4] == b"\x89PNG" and d.svg.startswith(b"<?xml") and d.caption for d in page.drawings)
    assert [d.png for d in diagnosis_report(result).drawings] == [d.png for d in page.drawings]
    titles = [s.title for s in page.sections]
    written = html(page)
    assert faults(written) == [] and html(diagnosis_report(result)) == written
    screen = Page(written).text.split("What next")[0]
    bound = result.findings[0].parameters["drag.surge.linear"]
    low_end, high_end = map(float, re.search(r"size (\S+) to (\S+) kg/s \(statistical\)", screen).groups())
    assert low_end <= bound.lower < bound.upper <= high_end < bound.upper + 1e-2
    like = result.findings[0].like
    assert f"probability {like.probability:.2f}: {like.right} of {like.of}" in screen and "chi" not in screen
    assert "The simulation is wrong: drag.surge.linear" in screen and "after 60 s" in screen
    assert "drag.surge.linear" in page.summary and "better by a factor of" in page.summary
    assert "Candidates that are no findings" in titles and "Gain of the extended model" in titles
    assert any("missing" in line or "simulated" in line for line in page.lines)


def drawn_somewhere(_, name):
    """A drawing whose caption is its process."""
    return figures.Drawing(name, "", str(os.getpid()), b"", b"")


@pytest.mark.figures
@pytest.mark.skipif(
    "fork" not in multiprocessing.get_all_start_methods(), reason="figures are drawn in forked processes"
)
def test_figures_are_drawn_while_the_tables_are_made_and_are_the_same(result, seen, monkeypatch):
    """A third of the time of a diagnosis was one processor's, which drew while the other waited."""
    monkeypatch.setattr(apart, "processors", lambda: 2)
    beside = diagnosis_report(result).drawings
    monkeypatch.setattr(apart, "processors", lambda: 1)
    alone = diagnosis_report(result).drawings
    assert [(d.name, d.png, d.svg) for d in beside] == [(d.name, d.png, d.svg) for d in alone]

    names = ("net_force", "gain", "force_residual")
    assert [[f.__name__ for f in group] for group in gain_figures.DRAWN] == [list(names[:2]), [names[2]]]
    first, second, third = (partial(drawn_somewhere, name=name) for name in names)
    monkeypatch.setattr(gain_figures, "DRAWN", ((first, second), (third,)))
    monkeypatch.setattr(apart, "processors", lambda: 2)
    drawers = [d.caption for d in diagnosis_report(result).drawings if d.name != "signature_1"]
    here = str(os.getpid())
    assert drawers[0] == drawers[1] != here and drawers[2] == here
    # Beside a diagnosis none is drawn by this process; a second gain is drawn in place of the first.
    early = GainFigures()
    early(copy(result.gain))
    early(result.gain)
    made = diagnosis_report(result, early).drawings
    early.end()
    assert [(d.name, d.png, d.svg) for d in made if d.name == "signature_1"] == [
        (d.name, d.png, d.svg) for d in alone if d.name == "signature_1"
    ]
    drawers = [d.caption for d in made if d.name != "signature_1"]
    assert drawers[0] == drawers[1] and len({*drawers, here}) == 3
    # A gain that nobody told of is drawn when it is asked for, where nothing can be forked as well.
    monkeypatch.setattr(apart, "processors", lambda: 1)
    assert [d.caption for d in GainFigures().of(result.gain)] == [here] * 3


def test_what_is_adequate_draws_no_finding_and_claims_no_gain():
    vehicle = vehicle_of()
    made = diagnose(vehicle, *logs_of(vehicle, duration=120.0))
    assert made.verdict == "adequate" and evidence(made) == () and explain(made) == []
    assert {said for *_, said in worth(made.gain)} == {"unchanged"}
    page = diagnosis_report(made)
    assert [d.name for d in page.drawings] == ["net_force", "gain", "force_residual"]


def test_what_orders_a_force_is_found():
    rng = np.random.default_rng(0)
    u, r, t = rng.uniform(-1, 1, 4000), rng.uniform(-1, 1, 4000), np.arange(4000.0)
    for name, values in (("u", u**2), ("r", np.tanh(9 * r)), ("time", np.sin(t / 700))):
        assert ordered_by(values + 0.2 * rng.standard_normal(4000), {"u": u, "r": r, "time": t}) == name
    # A constant quantity orders nothing, and an earlier quantity is preferred to its double.
    assert ordered_by(u, {"still": np.ones(4000), "u": u, "twice": 2 * u}) == "u"
    b = binned(3 * u, u, 0.1)
    np.testing.assert_allclose(b.mean, 3 * b.centre)
    assert (np.diff(b.centre) > 0).all() and (b.error > 0).all()


@pytest.mark.figures
# Nightly: a second pair of logs; the gate draws another finding.
@pytest.mark.nightly
def test_shallow_water_is_drawn_as_the_ratios_of_two_logs():
    """It has no signature in one log: its figure shows each mass and drag of TEST over that of TRAIN."""
    vehicle = vehicle_of()
    train = train_of(vehicle)
    _, test = logs_of(vehicle, {"environment.shallow_water": 1.4})
    result = diagnose(vehicle, train, test, null_logs=0)
    (f,) = result.findings
    assert f.effect == "environment.shallow_water" and set(f.evidence["ratio_deviation"]) == set(f.evidence["ratio"])
    bound = f.parameters["environment.shallow_water"]
    assert bound.lower <= 1.4 <= bound.upper
    drawn = figures.ratios(f)
    words = drawn.svg.decode()
    # Text of the figures is text in their SVG.
    for id_ in f.evidence["ratio"]:
        assert id_ in words
    assert f"{bound.lower:.4g} to {bound.upper:.4g}" in drawn.caption
    report = diagnosis_report(result)
    assert "ratios" in {d.name for d in report.drawings} and not evidence(result)
