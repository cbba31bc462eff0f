"""Causes that one force explains on both logs together: falls against dense least squares, the rules, and a whole pair of logs."""

import re
from dataclasses import replace

import numpy as np
import pytest
from tests.exam.cases import case
from tests.exam.seal import seal

from ivsid import diagnose
from ivsid.diagnosis.estimation.two_logs import Changes, changes, one_log
from ivsid.diagnosis.selection import both_logs, select
from ivsid.diagnosis.selection.in_their_place import InPlace
from ivsid.diagnosis.selection.one_force import Forces, by_one_force, imitating_on_both, sets_of
from ivsid.log import read_log
from ivsid.vehicle import read_vehicle
from test_one_force import CAUSES, FORCES, MODEL, gram_of, least

NAMES = ("f", "g", "h")


def asked(x, y, names=NAMES):
    """Two causes with three forces."""
    return Forces({"a": [2], "b": [3]}, np.zeros(4), gram_of(x, y), names, (), (), {})


@pytest.mark.parametrize("seed", range(10))
def test_falls_on_both_logs_are_those_of_least_squares_with_numbers_of_each(seed):
    rng = np.random.default_rng(seed)
    logs = [(rng.normal(size=(n, 7)), rng.normal(size=n)) for n in (60, 90)]
    # The second log knows two of the forces, in another order.
    first, second = logs[0], (logs[1][0][:, [0, 1, 2, 3, 6, 4]], logs[1][1])
    both = asked(*first).in_place(("a", "b")).beside(asked(*second, ("h", "f")).in_place(("a", "b")))

    def fall(*at):
        return sum(least(x, y, [*MODEL]) - least(x, y, [*MODEL, *at]) for x, y in logs)

    assert both.fall == pytest.approx(fall(*CAUSES), rel=1e-5)
    assert both.alone.keys() == {"f", "h"}
    for name, k in (("f", FORCES[0]), ("h", FORCES[2])):
        assert both.alone[name] == pytest.approx(fall(k), rel=1e-5, abs=1e-6)
        assert both.kept[name] == pytest.approx(fall(k, *CAUSES) - fall(k), rel=1e-5, abs=1e-6)
    assert both.own["a"][0] == pytest.approx(fall(CAUSES[0]), rel=1e-5, abs=1e-6)
    least_of = sum(min(least(x, y, [*MODEL, k]) - least(x, y, [*MODEL, *CAUSES]) for k in CAUSES) for x, y in logs)
    assert both.least == pytest.approx(least_of, rel=1e-5, abs=1e-6)


def log_of(rng, truth, apart):
    """A log on which a cause and a force differ by so much, and one of them acts: columns and errors."""
    x = rng.normal(size=(400, 7))
    x[:, 2] = x[:, 4] + apart * rng.normal(size=400)
    return x, 3.0 * x[:, truth] + rng.normal(size=400)


@pytest.mark.parametrize("seed", range(10))
@pytest.mark.parametrize(("truth", "apart", "refused"), [(4, 1.5, True), (2, 1.5, False), (4, 0.02, False)])
def test_a_cause_that_one_log_leaves_is_refused_by_both(seed, truth, apart, refused):
    """The first log does not tell the cause from the force, and the second does where its manoeuvres set them apart."""
    rng = np.random.default_rng(seed)
    here, there = asked(*log_of(rng, truth, 0.02)), asked(*log_of(rng, truth, apart))
    assert here.refusal(("a",), ()) is None
    found = by_one_force(here.in_place(("a",)).beside(there.in_place(("a",))), ["b"])
    assert (found is not None) is refused
    if found is not None:
        assert found.rule == "better force" and "on both logs together" in found.sentence and found.beside == ("b",)


def test_a_log_without_the_cause_leaves_it():
    """A failure after the other run: that log holds nothing of it, and no force either."""
    rng = np.random.default_rng(3)
    x, y = log_of(rng, 2, 0.6)
    quiet = asked(x, rng.normal(size=400)).in_place(("a",))
    assert by_one_force(asked(x, y).in_place(("a",)).beside(quiet), []) is None


def test_a_force_that_leaves_no_hull_on_one_log_stands_on_neither():
    one = InPlace(50.0, 50.0, {"a": (50.0,)}, {"f": 90.0, "g": 60.0}, {"f": 0.0, "g": 0.0}, frozenset())
    other = InPlace(50.0, 50.0, {"a": (50.0,)}, {"f": 90.0, "g": 60.0}, {"f": 0.0, "g": 0.0}, frozenset({"f"}))
    assert one.best.force == one.beside(one).best.force == "f"
    assert one.beside(other).best.force == "g"


def test_a_force_with_all_its_channels_is_the_same_on_both_logs():
    """The channel in which most of a thrust's fall is may differ between the logs."""
    fall = "fall of the thrust of port with its heat of 60 s in {}"

    def explained(channel, causes, alone, kept):
        forces = fall.format(channel), f"u in {channel}"
        own = {"a": (causes,)}
        return InPlace(
            causes,
            causes,
            own,
            dict(zip(forces, alone, strict=True)),
            dict(zip(forces, kept, strict=True)),
            frozenset(),
        )

    here, other = explained("yaw", 50.0, (60.0, 9.0), (1.0, 0.0)), explained("surge", 30.0, (40.0, 9.0), (2.0, 0.0))
    both = here.beside(other)
    assert (both.alone, both.kept) == ({fall.format("yaw"): 100.0}, {fall.format("yaw"): 3.0})
    assert here.beside(replace(other, odd=frozenset({fall.format("surge")}))).best.alone == 0.0


class Asks:
    """A cause whose errors are sums of columns, or not, of a thruster, or not, at a time, or not."""

    def __init__(self, sums=False, thruster=False, timed=False):
        self.first = self.candidate = self.effect = self.acts = self
        self.form, self.rough = self, False
        self.id, self.sums, self.at_thruster, self.in_time = "x2", sums, thruster, timed


class Fitted:
    """A fit whose errors hold no more what it found."""

    def __init__(self, rng, number, found):
        x = rng.normal(size=(20_000, 7))
        self.gram = gram_of(x, x[:, 2] * (number - found) + rng.normal(size=20_000))
        self.base, self.held = (0, 1, 2), {"x2": found}


@pytest.mark.parametrize(
    ("cause", "carried", "said"),
    [
        ({"sums": True}, True, True),
        ({"thruster": True}, True, True),
        ({"thruster": True, "timed": True}, True, False),
        ({"sums": True}, False, False),
    ],
)
def test_the_other_log_is_asked_of_sums_and_of_causes_of_thrusters(monkeypatch, cause, carried, said):
    last = type("F", (), {"fixed": {}})()
    forces = asked(*log_of(np.random.default_rng(0), 4, 1.5))
    monkeypatch.setattr(both_logs, "carried_to", lambda *_: ("noise", "states") if carried else None)
    monkeypatch.setattr(both_logs, "survey", lambda noise, states, fixed, only: ("there", only))
    monkeypatch.setattr(Forces, "of", classmethod(lambda *_, curves_too: None if curves_too else forces))
    monkeypatch.setattr(both_logs, "changed", lambda here, there, _: {"x2": there})
    found = both_logs.on_other_log(last, (Asks(**cause),), "other")
    assert found.changed == ({"x2": ("there", frozenset())} if said else {})
    assert set(found.in_place) == ({("a", "b"), ("a",), ("b",)} if said else set())


def test_a_log_that_determines_nothing_says_nothing(monkeypatch):
    def fails(*_):
        raise np.linalg.LinAlgError

    monkeypatch.setattr(both_logs, "carried_to", fails)
    assert both_logs.on_other_log(None, (Asks(sums=True),), "other") == both_logs.OtherLog({}, {})


class Now:
    """A task that is done when its result is asked for."""

    def __init__(self, task):
        self.result = task

    def end(self):
        self.result = None


@pytest.mark.parametrize("times", [(1.5, 1.0), (1.0, 1.5)])
def test_of_several_numbers_the_one_that_changes_farthest_counts(monkeypatch, times):
    """Whatever their order, and where the other log lacks one of them the other is asked."""
    rng = np.random.default_rng(4)

    def fitted(numbers, base=(0, 1, 2, 3)):
        fit = Fitted(rng, 2.0, 2.0)
        x = rng.normal(size=(20_000, 7))
        fit.gram = replace(
            gram_of(x, x[:, 2:4] @ (np.array(numbers) - 2.0) + rng.normal(size=20_000)),
            names=("x0", "x1", "x2.a", "x2.b", "x4", "x5", "x6"),
        )
        fit.base, fit.held = base, {"x2.a": 2.0, "x2.b": 2.0}
        return fit

    monkeypatch.setattr(both_logs, "held_numbers", lambda fit: fit.held)
    monkeypatch.setattr(both_logs, "adequacy", lambda _: type("A", (), {"white": True})())
    monkeypatch.setattr(
        both_logs,
        "beside_curves",
        lambda one, other, before, after, ratio: changes(
            one_log(one.gram, one.base, before), one_log(other.gram, other.base, after), ratio
        ),
    )
    here, there = fitted((2.0, 2.0)), fitted([2.0 * k for k in times])
    assert both_logs.changed(here, there, [Asks(thruster=True)]).keys() == {"x2"}
    bare = fitted((2.0 * times[0], 2.0), base=(0, 1, 2))
    assert (both_logs.changed(here, bare, [Asks(thruster=True)]).keys() == {"x2"}) is (times[0] != 1.0)


@pytest.mark.parametrize("first", [True, False])
@pytest.mark.parametrize(("changed", "one_force"), [({"x2": "another"}, {}), ({}, {"x2": "a force"}), ({}, {})])
def test_a_selection_keeps_no_cause_that_the_other_log_refuses(monkeypatch, first, changed, one_force):
    """Whether or not this log has refused one before, after which the others are asked beside what is left."""
    causes = (Asks(sums=True), Asks(sums=True))
    causes[1].id, causes[0].slewed, causes[1].slewed = "x3", None, None
    chosen = select.Selection(None, "whole", causes, ())
    monkeypatch.setattr(select, "Apart", Now)
    monkeypatch.setattr(Forces, "of", classmethod(lambda _, fit, found, known=None: (fit, [f.id for f in found])))
    monkeypatch.setattr(select, "imitating", lambda *_: {"x3": "a force here"} if first else {})
    monkeypatch.setattr(select, "regressors", lambda fit: f"those of the {fit}")
    monkeypatch.setattr(select, "adequacy", lambda fit, known: (fit, known))
    monkeypatch.setattr(select, "AnyCurve", lambda _: type("C", (), {"reach": lambda _: {}})())
    monkeypatch.setattr(
        select,
        "_without",
        lambda s, said, _: replace(s, last="less", found=tuple(f for f in s.found if f.id not in said)),
    )
    here = ("less", ["x2"]) if first else ("whole", ["x2", "x3"])
    monkeypatch.setattr(
        select,
        "on_other_log",
        lambda last, found, other: both_logs.OtherLog((last, [f.id for f in found]), changed),
    )
    monkeypatch.setattr(
        select, "imitating_on_both", lambda asked, _, there: one_force if asked == there == here else {"wrong": ""}
    )
    screened = type("Q", (), {"round": type("R", (), {"curve": None})()})()
    kept = select._kept(chosen, screened, 0.01, "other")
    left = {f.id for f in kept.found}
    # What the last fit leaves is known where the fit is the one that was asked.
    assert first or changed or one_force or kept.after == ("whole", "those of the whole")
    assert left == {"x2", "x3"} - ({"x3"} if first else set()) - changed.keys() - one_force.keys()


@pytest.mark.parametrize(
    ("times", "white", "cause", "worst", "refused"),
    [
        (1.0, True, {"thruster": True}, 0.0, False),
        (1.5, True, {"thruster": True}, 0.0, True),
        (0.5, True, {"thruster": True}, 0.0, True),
        # Beside what the model lacks on the other log, and inside what curves explain, the number says nothing.
        (1.5, False, {"thruster": True}, 0.0, False),
        (1.5, True, {"thruster": True}, 0.48, False),
        # Equations are not exact to what a log of ten minutes determines.
        (1.08, True, {"thruster": True}, 0.0, False),
        # Water, loads and sensors are others on another day, and what starts at a time may have started since.
        (1.5, True, {}, 0.0, False),
        (1.5, True, {"thruster": True, "timed": True}, 0.0, False),
    ],
)
def test_a_thruster_s_number_is_the_same_on_both_logs(monkeypatch, times, white, cause, worst, refused):
    rng = np.random.default_rng(4)
    here, there = Fitted(rng, 2.0, 2.0), Fitted(rng, 2.0 * times, 2.0)

    def beside(one, other, before, after, ratio):
        bare = changes(one_log(one.gram, one.base, before), one_log(other.gram, other.base, after), ratio)
        return Changes(bare.mean, bare.covariance, bare.noise, np.array([[worst]]))

    monkeypatch.setattr(both_logs, "held_numbers", lambda fit: fit.held)
    monkeypatch.setattr(both_logs, "adequacy", lambda _: type("A", (), {"white": white})())
    monkeypatch.setattr(both_logs, "beside_curves", beside)
    found = both_logs.changed(here, there, [Asks(**cause)])
    assert set(found) == ({"x2"} if refused else set())
    if refused:
        said = re.search(r"number is (\S+) times as large", found["x2"].sentence)
        assert found["x2"].rule == "same number" and float(said[1]) == pytest.approx(times, abs=0.05)


# Nightly: a whole diagnosis; the rules alone stand in the gate.
@pytest.mark.nightly
@pytest.mark.parametrize(("seed", "effect"), [(300373, "x.tunnel"), (300356, "x.gyro"), (300500, "x.warm")])
def test_a_force_that_the_other_log_shows_has_no_name(seed, effect, tmp_path):
    """A tunnel loss of a thruster that pushes ahead was a loss by the inflow, and a gyro that feels accelerations a scale."""
    drawn = case(seed, what="outside", sea="any", sensors="any")
    assert list(drawn.z) == [effect]
    folder = seal(drawn, tmp_path, tmp_path / "answers")
    vehicle = read_vehicle(folder / "vehicle.toml")
    train, test = (read_log(folder / f"{k}.csv", vehicle.log) for k in (1, 2))
    assert [f.effect for f in diagnose(vehicle, train, test, null_logs=0).findings] == ["unknown"]


def test_sets_that_the_other_log_lacks_are_not_asked_of_it():
    """Without their columns there, nothing is refused; the others are, the largest set first."""
    here = asked(*log_of(np.random.default_rng(0), 4, 0.02))
    there = asked(*log_of(np.random.default_rng(1), 4, 1.5)).in_place(("a",))
    causes = (Asks(), Asks())
    causes[0].id, causes[1].id = "a", "b"
    assert imitating_on_both(here, causes, {}) == imitating_on_both(None, causes, {("a",): there}) == {}
    refused = imitating_on_both(here, causes, {("a",): there})
    assert refused.keys() == {"a"} and refused["a"].beside == ("b",)
    assert list(sets_of("ab")) == [("a", "b"), ("a",), ("b",)]
