"""Findings of a selection: which causes are named where structure is left, by falls of chi-squared alone."""

import math
from dataclasses import replace
from types import SimpleNamespace

import pytest

from diagnosis_logs import logs_of, vehicle_of
from ivsid import diagnose
from ivsid.diagnosis.candidates.intervals import Bound
from ivsid.diagnosis.estimation.kinds.step import StepCandidate
from ivsid.diagnosis.null.rule import first_refusal
from ivsid.diagnosis.selection.structure import Adequacy
from ivsid.diagnosis.statements import findings
from ivsid.diagnosis.statements.findings import Finding, findings_of
from ivsid.diagnosis.statements.rules import BOUNDS_KEPT, EXCLUDES, HELD, Held
from ivsid.effects import EFFECTS, PAPER_TERMS, PLAIN_TERMS

IDS = ("coupling.cg_y", "thruster.asymmetry", "drag.lift.yaw", "sensor.yaw_rate.scale")


@pytest.fixture(autouse=True)
def _made(monkeypatch):
    """A finding of any cause has an interval that excludes no effect."""
    bound = Bound(1.9, 2.1, "1", "")
    monkeypatch.setattr(
        findings, "finding", lambda f, *_, **__: SimpleNamespace(effect=f.id, parameters={f.id: bound}, evidence={})
    )
    monkeypatch.setattr(findings, "own_columns", lambda *_: [])
    monkeypatch.setattr(Adequacy, "beside", lambda rest, *_, **__: rest.unexplained / 10)


def candidate(id_, alone):
    """A cause of one thruster: the index of one that has its thruster among its numbers, or the name."""
    if isinstance(alone, int):
        return StepCandidate(EFFECTS[id_], (), alone)
    return SimpleNamespace(effect=EFFECTS[id_], alone=alone)


def named(
    falls,
    left,
    *,
    complete=False,
    ids=IDS,
    terms=(),
    rule="dominant",
    chance=1e-12,
    louder=False,
    imitating=(),
    strongest="u",
    alone=None,
):
    """Names of causes with these falls, where a dictionary of 100 columns finds ``left`` more than chance."""
    found = [
        SimpleNamespace(
            id=i,
            fall=f,
            rivals=[SimpleNamespace(id=i)],
            first=SimpleNamespace(boxed=0.0, shown=f, lost=f**0.5, candidate=candidate(i, alone)),
        )
        for i, f in zip(ids, falls, strict=False)
    ]
    plain = SimpleNamespace(h=SimpleNamespace(terms=terms))
    last = SimpleNamespace(noise=SimpleNamespace(predictor=SimpleNamespace(vehicle=vehicle_of())))
    others = [SimpleNamespace(fall=f) for f in imitating]
    selection = SimpleNamespace(plain=plain, found=found, last=last, leftover=[], curves={}, imitating=others)
    rest = Adequacy(100.0 + left, 100, chance, (("v", "sway", 1.0), (strongest, "surge", left)), chance, {})
    made, withdrawn = findings_of(selection, {}, rest, complete=complete, louder=louder)
    assert {f.effect for f in made} | set(withdrawn) == {f.id for f in found}
    assert rule is None or all(r.rule == rule for r in withdrawn.values())
    return [f.effect for f in made]


def test_a_cause_beside_unexplained_structure_takes_nine_times_as_much():
    assert named([910.0], 100.0) == [IDS[0]]
    assert named([890.0], 100.0) == []
    # Little is left: a tenth of it acts in the channels of the cause.
    assert named([9.0], 100.0, complete=True) == []
    assert named([11.0], 100.0, complete=True) == [IDS[0]]


def test_a_cause_beside_a_force_that_leaves_no_structure_takes_nine_times_what_counts():
    """A screw that draws air in bursts was a failure of 101 in chi-squared, and liquid in a tank a sway drag of 86, beside seas that nobody declared."""
    assert named([230.0], 0.0) == [IDS[0]]
    assert named([220.0], 0.0) == []
    assert named([101.0, 230.0], 0.0) == []


def test_a_cause_beside_causes_that_are_none_takes_nine_times_what_they_do():
    """Pods that lose thrust in oblique inflow were a sideslip of 108 and a cross-flow drag of 36, which one force beats and which was no finding."""
    assert named([321.0], 0.0, chance=0.5, imitating=[36.0]) == []
    assert named([327.0], 0.0, chance=0.5, imitating=[36.0]) == [IDS[0]]
    assert named([327.0], 0.0, chance=0.5, imitating=[30.0, 36.0]) == []
    # Little is left beside causes that are enough for a verdict.
    assert named([108.0], 0.0, chance=0.5, complete=True, imitating=[36.0]) == [IDS[0]]


def test_a_cause_takes_three_times_what_a_weaker_one_does_that_is_refused(monkeypatch):
    """A clutch that slipped was a gain of 376 of its thruster beside a failure of 236, whose loss may be none, with nothing left."""
    made = findings.finding

    def finding(f, *args, **how):
        one = made(f, *args, **how)
        if f.id == IDS[1]:
            one.parameters = {f.id: Bound(-0.1, 2.1, "1", "")}
        return one

    monkeypatch.setattr(findings, "finding", finding)
    for falls, left in ([376.0, 236.0], []), ([709.0, 236.0], [IDS[0]]), ([2.0, 236.0], [IDS[0]]):
        assert named(falls, 0.0, chance=0.5, complete=True, rule=None) == left


@pytest.mark.parametrize(
    ("id_", "alone", "strongest", "kept"),
    [
        ("thruster.advance_loss", None, "fall of every thrust with its heat of 60 s", False),
        ("thruster.advance_loss", None, "fall of the thrust of port with its heat of 60 s", True),
        ("thruster.advance_loss", "port", "fall of the thrust of port with its heat of 60 s", False),
        ("thruster.advance_loss", "port", "fall of the thrust of starboard with its heat of 60 s", True),
        ("thruster.advance_loss", "port", "thrust of port", True),
        ("thruster.advance_loss", "port", "fall of the thrust of port_aft with its heat of 60 s", True),
        ("thruster.failure", 0, "fall of the thrust of port with its heat of 60 s", False),
        ("thruster.failure", 1, "fall of the thrust of port with its heat of 60 s", True),
        ("drag.lift.yaw", None, "fall of every thrust with its heat of 60 s", True),
    ],
)
def test_a_thrust_that_goes_on_changing_is_known_by_no_name(id_, alone, strongest, kept):
    """Weed that wound on a screw ahead and off again astern was a failure from its first turn on, beside 60 in chi-squared of the same screw."""

    def said(left, **how):
        return named([9e5], left, ids=[id_], alone=alone, strongest=strongest, rule="steady thrust", **how)

    assert said(60.0) == ([id_] if kept else [])
    assert said(24.0) == [id_] and said(60.0, complete=True) == [id_]


def test_a_single_thruster_is_all_of_them():
    main = SimpleNamespace(name="main", words="the thrust of main")
    last = SimpleNamespace(noise=SimpleNamespace(predictor=SimpleNamespace(vehicle=SimpleNamespace(thrusters=(main,)))))
    found = SimpleNamespace(first=SimpleNamespace(candidate=candidate("thruster.advance_loss", None)))
    rest = SimpleNamespace(strongest=(("fall of the thrust of main with its heat of 60 s", "surge", 40.0),))
    assert findings._varying(last, found, rest) == 40.0


def test_a_cause_beside_what_noise_of_few_frequencies_may_make_takes_three_times_as_much():
    """A tenth of what is left acts in the channels of the cause."""
    assert named([9.0], 100.0, complete=True, chance=0.1) == [IDS[0]]
    assert named([31.0], 100.0, complete=True, chance=0.1, louder=True) == [IDS[0]]
    assert named([29.0], 100.0, complete=True, chance=0.1, louder=True) == []


def test_memories_count_beside_noise_of_few_frequencies_alone(monkeypatch):
    """Of the shared log of a pitching hull they explain half of what is left in yaw, and the damping there was named by no finding."""
    monkeypatch.setattr(Adequacy, "beside", lambda rest, *_, memory: rest.unexplained / (10 if memory else 20))
    assert named([6.0], 100.0, complete=True) == [IDS[0]]
    assert named([4.0], 100.0, complete=True) == []
    assert named([29.0], 100.0, complete=True, chance=0.1, louder=True) == []


def test_what_refused_causes_take_stays_unexplained_beside_stronger_ones():
    assert named([3750.0], 380.0) == [IDS[0]]
    assert named([3750.0, 440.0, 300.0, 350.0], 380.0) == []
    # The order in which they were found does not matter, and a cause that is named takes its share away.
    assert named([300.0, 3750.0, 440.0], 380.0) == []
    assert named([1000.0, 9000.0], 100.0) == [IDS[0], IDS[1]]
    assert named([1000.0, 12000.0, 20.0], 100.0) == [IDS[1]]


def test_a_number_of_two_axes_is_not_parted_beside_structure():
    """A wrong thrust curve moves the drag ahead alone, and with it the paper's drag of both axes."""
    parts = [i for i, e in EFFECTS.items() if e.shares]
    assert "drag.sway.quadratic" in parts
    for id_ in parts:
        assert named([1e6], 100.0, ids=[id_], terms=PAPER_TERMS, rule="parted number") == []
        # With little structure left, and in a model that shares no number, it is a cause as any other.
        assert named([1e6], 100.0, ids=[id_], terms=PAPER_TERMS, complete=True) == [id_]
        assert named([1e6], 100.0, ids=[id_], terms=PLAIN_TERMS) == [id_]


@pytest.mark.parametrize(
    ("lower", "upper", "within", "quiet", "named"),
    [
        (0.1, 2.1, None, True, True),
        (-0.1, 2.1, None, True, False),
        # What is known of the thrust counts where nothing unknown is left.
        (-0.1, 2.1, (1.9, 2.1), True, False),
        # What is unknown widens all intervals, and the cause is asked beside it.
        (-0.1, 2.1, (1.9, 2.1), False, True),
        (-0.1, 2.1, (-0.1, 2.1), False, False),
    ],
)
def test_a_number_that_may_be_none_names_nothing(lower, upper, within, quiet, named):
    effect = EFFECTS["drag.yaw.linear"]
    bounds = {effect.id: Bound(lower, upper, "1", "", within=within)}
    held = Held(effect, 40.0, 0.0, bounds, True, quiet)
    assert (EXCLUDES.refuses(held) is None) == named
    # Where declared errors would have to leave their bounds, the interval by their priors decides nothing in a quiet model.
    assert (EXCLUDES.refuses(replace(held, boxed=True)) is None) == (named or quiet)


@pytest.mark.parametrize(
    ("id_", "bounds", "named"),
    [
        # A hump whose speed is told is there, although its height goes with its width and with the drag below it.
        ("drag.surge.hump", {"height": (0.0, 39.4), "speed": (1.09, 1.40), "width": (0.26, 0.57)}, True),
        ("drag.surge.hump", {"height": (0.0, 209.0), "speed": (0.0, 2.8), "width": (0.0, 3.0)}, False),
        ("drag.surge.hump", {"height": (4.0, 20.0), "speed": (0.0, 2.8), "width": (0.0, 3.0)}, True),
        ("payload.step", {"mass": (-51900.0, 10200.0), "time": (20.0, 30.0)}, False),
        ("drag.surge.hump", {"height": (0.0, math.inf), "speed": (0.0, 2.8), "width": (0.0, 3.0)}, False),
        # An end that the log leaves open is no reason beyond the other one.
        ("wind.steady", {"north": (-math.inf, math.inf), "east": (-0.1, 0.2)}, False),
        ("wind.steady", {"north": (-math.inf, math.inf), "east": (0.1, math.inf)}, True),
        # Of two components one alone may be told.
        ("current.steady", {"north": (-0.1, 0.2), "east": (0.1, 0.2)}, True),
        ("sensor.velocity.lever_arm", {"x": (-0.2, -0.1), "y": (-0.2, 0.1)}, True),
        # Places that a pull has are told beside any pull, and its arm is a size.
        (
            "tether.tension",
            {"force": (-1.0, 2.0), "anchor_north": (3.0, 4.0), "anchor_east": (1.0, 2.0), "arm": (-0.1, 0.1)},
            False,
        ),
    ],
)
def test_numbers_that_may_all_be_none_name_nothing(id_, bounds, named):
    held = Held(EFFECTS[id_], 40.0, 0.0, {f"{id_}.{k}": Bound(*b, "1", "") for k, b in bounds.items()}, True, True)
    assert (EXCLUDES.refuses(held) is None) == named


@pytest.mark.parametrize("id_", ["wind.steady", "current.steady", "sensor.velocity.lever_arm"])
@pytest.mark.parametrize(("beside", "quiet", "named"), [(5.4, True, False), (8.1, True, True), (8.1, False, False)])
def test_a_sum_of_components_is_told_where_it_is_as_visible_as_a_cause(id_, beside, quiet, named):
    """Gusts that push and turn at once made a wind of 5.4 standard deviations, of which neither component was told; of 32 true causes of several
    sizes each told one at least, and on a straight course a sum alone can be."""
    bounds = {name: Bound(-0.1, 0.2, "1", "") for name in EFFECTS[id_].parts}
    held = Held(EFFECTS[id_], 40.0, 0.0, bounds, True, quiet, beside=beside)
    assert (EXCLUDES.refuses(held) is None) == named


@pytest.mark.parametrize(
    ("outside", "boxed", "fall", "named"),
    [
        (0.0, True, 10.0, True),
        (1.9, True, 10.0, True),
        (2.4, True, 10.0, False),
        (2.4, False, 10.0, True),
        # A limit of 140 in chi-squared beside the priors, and of 149 in the box, left 1.4 times the bound.
        (2.4, True, 140.0, True),
    ],
)
def test_a_cause_whose_evidence_is_that_errors_leave_their_bounds_brings_them_back(outside, boxed, fall, named):
    bounds = {"thruster.asymmetry": Bound(0.01, 0.05, "1", "")}
    held = Held(EFFECTS["thruster.asymmetry"], fall, 0.0, bounds, True, True, boxed=boxed, outside=outside)
    assert (BOUNDS_KEPT.refuses(held) is None) == named
    assert (first_refusal(HELD, held, []) is None) == named


@pytest.mark.parametrize(
    ("id_", "parts", "beside", "quiet", "named"),
    [
        ("drag.yaw.quadratic", [""], 5.1, True, True),
        ("drag.yaw.quadratic", [""], 4.9, True, False),
        ("drag.yaw.quadratic", [""], 5.1, False, False),
        ("drag.surge.hump", ["height", "speed", "width"], 5.1, True, False),
    ],
)
def test_a_cause_that_no_declared_errors_make_is_there_whatever_its_interval(id_, parts, beside, quiet, named):
    bounds = {".".join([id_, *filter(None, [k])]): Bound(-1.0, 200.0, "1", "") for k in parts}
    held = Held(EFFECTS[id_], 700.0, 0.0, bounds, True, quiet, beside=beside)
    assert (EXCLUDES.refuses(held) is None) == named


@pytest.mark.parametrize(
    ("lower", "upper", "fitted", "cut"),
    [
        (-56.0, 3693.0, 700.0, (0.0, 3693.0)),
        (-90.0, 20.0, -40.0, (-90.0, 0.0)),
        # The estimate decides, and not the middle: the worst errors move it farther to one side.
        (-300.0, 200.0, 50.0, (0.0, 200.0)),
        (-math.inf, 200.0, 50.0, (0.0, 200.0)),
        (-math.inf, math.inf, -1.0, (-math.inf, 0.0)),
    ],
)
def test_the_number_of_a_cause_that_is_there_lies_on_its_side_of_none(lower, upper, fitted, cut):
    name = "drag.yaw.quadratic"
    f = Finding(name, 1.0, (), "", {name: Bound(lower, upper, "kg m^2", "")}, {})
    h = SimpleNamespace(given=(), values={name: fitted})
    bound = findings.one_sided(f, h).parameters[name]
    assert (bound.lower, bound.upper) == cut


def test_a_model_without_its_refused_cause_is_not_called_adequate(monkeypatch):
    """The verdict is on the model that is handed out: what a refused cause took is left in it."""
    monkeypatch.undo()
    vehicle = vehicle_of()
    train, test = logs_of(vehicle, {"drag.yaw.linear": 2.5}, duration=120.0)
    monkeypatch.setattr(Held, "distance", -1.0)
    monkeypatch.setattr(Held, "there", False)
    result = diagnose(vehicle, train, test, null_logs=0)
    assert result.withdrawn["drag.yaw.linear"].rule == EXCLUDES.name
    assert result.verdict == "unknown" and "drag.yaw.linear" in result.findings[-1].description
    assert not result.adequacy[1].quiet and result.adequacy[1].fall == pytest.approx(result.adequacy[0].fall)
