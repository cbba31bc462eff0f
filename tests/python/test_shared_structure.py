"""Structure that the other log or both logs show: falls that add, what has to take them on either log, and whole logs."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import chi2
from tests.exam.cases import case
from tests.exam.seal import seal

from ivsid import diagnose
from ivsid.diagnosis.selection import shared_structure
from ivsid.diagnosis.selection.shared_structure import together, with_other
from ivsid.diagnosis.selection.structure import Adequacy
from ivsid.diagnosis.statements.unknown import unknown
from ivsid.errors import IvsidError
from ivsid.log import read_log
from ivsid.vehicle import read_vehicle

# A dictionary of 170 regressors of which two stand out.
QUIET = {f"f{k} in surge": 0.5 for k in range(168)}


def dictionary(psi, u):
    return {**QUIET, "sin 2 psi in yaw": psi, "u^2 in surge": u}


@pytest.mark.parametrize(
    ("here", "there", "found"),
    [
        # A fall of 25 over 170 regressors comes once in eight thousand logs; of 25 on both logs together it is none, and neither are 12 and 22.
        (dictionary(25.5, 1.0), dictionary(29.4, 2.0), "sin 2 psi in yaw"),
        (dictionary(-25.5, 1.0), dictionary(-29.4, 2.0), "sin 2 psi in yaw"),
        (dictionary(12.0, 1.0), dictionary(21.0, 2.0), "sin 2 psi in yaw"),
        (dictionary(12.0, 1.0), dictionary(19.0, 2.0), None),
        # The same force pushes the other way on the other log, or only one of them shows it.
        (dictionary(25.5, 1.0), dictionary(-29.4, 2.0), None),
        (dictionary(45.0, 1.0), dictionary(8.5, 2.0), None),
        # Two regressors of which each stands out of another log.
        (dictionary(25.5, 1.0), dictionary(1.0, 29.4), None),
        (dictionary(14.0, 14.0), dictionary(14.0, 14.0), None),
    ],
)
def test_a_regressor_stands_out_of_both_logs_with_one_sign(here, there, found):
    said = together(here, there)
    assert (said and said[0]) == found
    if found:
        fall = abs(here[found]) + abs(there[found])
        assert said[1:] == (pytest.approx(fall), pytest.approx(chi2.sf(fall, 2) / 2 * len(here)))


def test_a_force_with_all_its_channels_is_the_same_whatever_channel_has_most_of_it():
    """A thruster beside the keel turns a hull that is held and pushes one that is free; a force of one channel is another in each."""
    fall = "fall of the thrust of port with its heat of 60 s in {}"
    found = together({**QUIET, fall.format("yaw"): 25.5}, {**QUIET, fall.format("surge"): 29.4})
    assert found is not None and found[:2] == (fall.format("yaw"), pytest.approx(54.9))
    assert together({**QUIET, "u in yaw": 25.5}, {**QUIET, "u in surge": 29.4}) is None


def test_chance_alone_shows_no_structure():
    """Of a hundred thousand pairs of dictionaries with nothing in them about one stands out."""
    rng = np.random.default_rng(0)
    names, count, found = [f"f{k} in surge" for k in range(170)], 0, 0
    while count < 100_000:
        scores = rng.normal(size=(2, 2000, 170))
        # Pairs that cannot reach the limit need no closer look.
        near = np.flatnonzero(((scores**2).sum(axis=0) > 25.0).any(axis=1))
        for k in near:
            here, there = ({n: s * abs(s) for n, s in zip(names, q[k].tolist(), strict=True)} for q in scores)
            found += together(here, there) is not None
        count += 2000
    assert found <= 5


def adequacy(chance_of_one, chance=0.3):
    strongest = (("sin 2 psi", "yaw", 25.5), ("u^2", "surge", 3.0), ("v", "sway", 2.0))
    return Adequacy(150.0, 170, chance, strongest, chance_of_one, {})


class Fitted:
    def __init__(self):
        self.fixed = {}


NOTHING = adequacy(0.3)


def asked(monkeypatch, before, there=NOTHING, own=NOTHING, *, carried=True):
    """The adequacy beside the other log, whose own is asked for where it is needed alone, and how often each was."""
    counts = {"own": 0, "both": 0}

    def again():
        counts["own"] += 1
        return own

    def lasting(*_):
        counts["both"] += 1
        return "sin 2 psi in yaw", 54.9, 2e-10

    monkeypatch.setattr(shared_structure, "carried_to", lambda *_: ("noise", "states") if carried else None)
    monkeypatch.setattr(shared_structure, "survey", lambda *_: "there")
    monkeypatch.setattr(shared_structure, "adequacy", lambda _: there)
    monkeypatch.setattr(shared_structure, "_lasting", lasting)
    return with_other(before, Fitted(), "other", "test.csv", again), counts


@pytest.mark.parametrize(
    ("chances", "there", "carried", "shown"),
    [
        ((9e-5, 0.3), 0.3, True, True),
        # The first log shows hardly anything of it, and the other more.
        ((0.03, 0.3), 9e-5, True, True),
        ((0.03, 0.3), 0.03, True, False),
        ((9e-5, 0.3), 9e-5, False, False),
        ((1e-9, 1e-9), 9e-5, True, False),
    ],
)
def test_logs_of_which_one_is_in_doubt_are_asked_together(monkeypatch, chances, there, carried, shown):
    """Not where neither shows anything, and not where the first has structure by itself."""
    before = adequacy(*chances)
    found, counts = asked(monkeypatch, before, adequacy(there), carried=carried)
    assert (found is not before) is shown and counts["both"] == int(shown)
    assert counts["own"] == int(not carried)
    if shown:
        assert before.quiet and not found.quiet and found.shared == "test.csv" and not found.only
        assert found.strongest[0] == ("sin 2 psi", "yaw", 54.9) and found.probability == 2e-10


def rare(chance_of_one, fall, name="3.1 s swinging memory"):
    return replace(adequacy(chance_of_one), strongest=((name, "sway", fall),) * 3, alone=True)


def test_structure_that_the_other_log_alone_shows_is_structure(monkeypatch):
    """Tanks that a ferry's first manoeuvre never excites, and its second one does."""
    before = adequacy(0.9)
    found, counts = asked(monkeypatch, before, rare(1e-40, 187.0, "thrust"), rare(1e-90, 418.0))
    assert counts == {"own": 1, "both": 0} and found.only == "test.csv" and not found.shared
    assert before.quiet and not found.quiet and not found.white and found.probability == 1e-90
    # What the first log leaves stays what it was, for the share that causes may leave of it.
    assert (found.fall, found.freedom, found.chance) == (before.fall, before.freedom, before.chance)
    said = unknown(found, ())
    assert said.evidence["channel"] == "sway" and said.evidence["z"] == pytest.approx(418.0**0.5)
    assert said.evidence["chance"] == 1e-90
    assert (
        "leaves on test.csv, fitted to it," in said.description and "3.1 s swinging memory in sway" in said.description
    )
    assert "a diagnosis of test.csv as the first log asks the whole catalogue" in said.description


@pytest.mark.parametrize(("own", "shown"), [(1e-90, True), (3e-5, False)])
def test_a_log_of_another_clock_is_asked_by_its_own_noise(monkeypatch, own, shown):
    """The noise of the first log says nothing of rows of another length."""
    there = rare(own, 418.0) if shown else adequacy(own)
    found, counts = asked(monkeypatch, adequacy(0.9), own=there, carried=False)
    assert (found.only == "test.csv") is shown and not found.shared and counts["own"] >= 1 and not counts["both"]


@pytest.mark.parametrize(("carried", "own"), [(1e-40, 0.02), (1e-40, 3e-5), (2e-5, 1e-40)])
def test_what_the_noise_of_another_day_makes_is_no_structure(monkeypatch, carried, own):
    """It stands out beside the noise of the first log, and not beside its own, or not beyond doubt beside either."""
    there = rare(carried, 187.0) if carried < 1e-5 else adequacy(carried)
    its_own = rare(own, 418.0) if own < 1e-5 else adequacy(own)
    found, counts = asked(monkeypatch, adequacy(0.9), there, its_own)
    assert not found.only and counts["own"] == int(carried < 1e-5)


def test_a_log_that_determines_nothing_says_nothing(monkeypatch):
    def fails(*_):
        raise np.linalg.LinAlgError

    before = adequacy(9e-5)
    monkeypatch.setattr(shared_structure, "carried_to", fails)
    assert with_other(before, Fitted(), "other", "test.csv", fails) is before


def test_a_log_that_no_model_follows_by_itself_says_nothing(monkeypatch):
    """Under the noise of the first log it shows structure, and refuses a noise of its own."""

    def refused():
        raise IvsidError("too short")

    before = adequacy(0.9)
    monkeypatch.setattr(shared_structure, "carried_to", lambda *_: ("noise", "states"))
    monkeypatch.setattr(shared_structure, "survey", lambda *_: "there")
    monkeypatch.setattr(shared_structure, "adequacy", lambda _: rare(1e-40, 187.0))
    assert with_other(before, Fitted(), "other", "test.csv", refused) is before


@pytest.mark.parametrize(
    ("long", "found"), [((25.5, 20.0, 15.0), True), ((25.5, 20.0, 5.0), False), ((25.5, 5.0), False)]
)
def test_structure_lasts_beside_all_that_may_take_it_on_either_log(monkeypatch, long, found):
    """The other log has one step, and its last fall stands beside each of this one's; what leaves nothing ends the work."""
    asked = []

    def standing(fit):
        for psi in long if fit == "here" else (40.0,):
            asked.append(fit)
            yield dictionary(psi, 1.0)

    monkeypatch.setattr(shared_structure, "_standing", standing)
    said = shared_structure._lasting("here", "there")
    assert (said is not None) is found
    assert not found or said[1] == pytest.approx(40.0 + long[-1])
    assert asked.count("here") == len(long) and asked.count("there") == 1


# Nightly: whole diagnoses. Wind that turns a tug, of z 12 on a log of five minutes in ten times the usual sea, was adequate; the mean of a one-sided
# sea, in which both logs are, is an ambient force.
@pytest.mark.nightly
@pytest.mark.parametrize(
    ("seed", "what", "verdict", "words"),
    [
        # Its second log is asked by itself first since 30 November, and shows the wind without the other.
        (300504, "outside", "unknown", "on 2.csv, fitted to it"),
        (300533, "outside", "unknown", "together"),
        (300779, "outside", "unknown", "together"),
        (280516, "none", "adequate", ""),
    ],
)
def test_structure_of_both_logs_is_unknown_and_a_sea_s_mean_is_not(seed, what, verdict, words, tmp_path):
    folder = seal(case(seed, what=what, sea="any", sensors="any"), tmp_path, tmp_path / "answers")
    vehicle = read_vehicle(folder / "vehicle.toml")
    train, test = (read_log(folder / f"{k}.csv", vehicle.log) for k in (1, 2))
    said = diagnose(vehicle, train, test, null_logs=0)
    assert said.verdict == verdict
    assert not words or words in said.findings[0].description


# Nightly: whole diagnoses. A tank and a torque of a screw whose first log is a straight line or a circle; both were adequate.
@pytest.mark.nightly
@pytest.mark.parametrize("seed", [300758, 300777])
def test_what_the_other_manoeuvre_alone_excites_is_unknown(seed, tmp_path):
    folder = seal(case(seed, what="outside", sea="any", sensors="any"), tmp_path, tmp_path / "answers")
    vehicle = read_vehicle(folder / "vehicle.toml")
    train, test = (read_log(folder / f"{k}.csv", vehicle.log) for k in (1, 2))
    said = diagnose(vehicle, train, test, null_logs=0)
    assert said.verdict == "unknown" and len(said.findings) == 1
    assert "as the first log" in said.findings[0].description
