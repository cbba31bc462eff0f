"""Ambient forces that change over minutes, inside the declared one and beyond it."""

import re

import numpy as np
import pytest
from tests.exam.cases import case

from diagnosis_logs import logs_of, logs_of_case, train_of, vehicle_of
from ivsid import diagnose
from ivsid.diagnosis.candidates.families import everything, score
from ivsid.diagnosis.data.channels import channels
from ivsid.diagnosis.estimation.learning import plain_fit
from ivsid.diagnosis.null import leaving
from ivsid.diagnosis.null import round as screening_round
from ivsid.diagnosis.null.slow_force import HALF_WAVES, SlowForce
from ivsid.diagnosis.selection.adequacy import adequacy
from ivsid.diagnosis.statements import shallow_water
from ivsid.vehicle import parse_vehicle

SHORT = {"what": "none", "duration": 300.0, "rate": 10.0, "sensors": "white"}
# Sound logs whose sea looked like a force outside the catalogue: seeds of the examiner, found among eighty.
CASES = [(60, "minutes"), (8, "one-sided")]
# Sound logs in ten times the usual sea that had a cause by name.
NAMED = [
    (176, "minutes", "rich", screening_round, "fouling.drift"),
    (106, "minutes", "circle", shallow_water, "environment.shallow_water"),
]


def fitted(vehicle, train):
    return plain_fit(vehicle, channels(train, vehicle), everything)


def drawn(seed, sea, *, declared=1.0, **asked):
    """A sound log in a sea of the examiner's, whose vehicle file declares another multiple of its force, and both logs."""
    c = case(seed, sea=sea, **SHORT, **asked)
    text = re.sub(r"(?<=\[ambient\]\nforce = )\S+", lambda x: f"{float(x[0]) * declared:.6g}", c.text)
    text = re.sub(r"(?<=\nmoment = )\S+(?=\ntime)", lambda x: f"{float(x[0]) * declared:.6g}", text)
    return parse_vehicle(text, "v.toml"), *logs_of_case(c)


def test_falls_beside_slow_forces_are_those_of_a_fit_with_them():
    """The oracle: least squares on the base, the cause and the slow forces at once, each with its prior as a row of its own."""
    vehicle = vehicle_of()
    fit, scored = score(fitted(vehicle, train_of(vehicle)))
    slow, g = SlowForce(fit), fit.gram
    columns = g.columns(list(fit.base)).reshape(len(fit.base), -1)
    prior = g.prior[list(fit.base)]
    known = (g.prior * g.centre)[list(fit.base)]
    forces, _, _ = slow._shapes
    assert len(forces) == 5 * (HALF_WAVES + 1)

    def least(more):
        every = np.concatenate([columns, forces, more])
        held = np.r_[prior, np.ones(len(forces)), np.zeros(len(more))]
        root = np.sqrt(held)
        # A prior is a row that asks for its centre.
        A = np.concatenate([every.T, np.diag(root)])
        b = np.r_[g.y.ravel(), np.zeros(len(every))]
        at = root[: len(fit.base)] > 0
        b[g.y.size : g.y.size + len(fit.base)][at] = -(known[at] / root[: len(fit.base)][at])
        return float(np.linalg.lstsq(A, b, rcond=None)[1][0])

    nothing = least(np.zeros((0, columns.shape[1])))
    some = [s for s in scored if s.candidate.sums and not s.candidate.starts][::8]
    assert len(some) > 3
    for s in some:
        own = g.columns(s.columns).reshape(len(s.columns), -1)
        assert slow.fall(s) == pytest.approx(nothing - least(own), rel=1e-4, abs=1e-3), s.id


@pytest.mark.parametrize(("seed", "sea"), CASES)
def test_a_force_of_minutes_inside_the_declared_one_is_none_that_the_catalogue_lacks(seed, sea, monkeypatch):
    vehicle, train, _ = drawn(seed, sea)
    fit = fitted(vehicle, train)
    assert SlowForce(fit).inside and adequacy(fit).quiet
    monkeypatch.setattr(leaving, "slow_force", lambda _: None)
    assert not adequacy(fit).quiet


@pytest.mark.parametrize(("seed", "sea"), CASES)
def test_a_force_of_minutes_beyond_the_declared_one_is_told(seed, sea):
    """The same log beside a vehicle file that declares a fifth of the force."""
    vehicle, train, _ = drawn(seed, sea, declared=0.2)
    fit = fitted(vehicle, train)
    assert not SlowForce(fit).inside and not adequacy(fit).quiet


@pytest.mark.parametrize(("seed", "sea", "style", "module", "name"), NAMED)
def test_a_force_of_minutes_inside_the_declared_one_has_no_name(seed, sea, style, module, name, monkeypatch):
    vehicle, *both = drawn(seed, sea, style=style, ambient=10.0)
    assert diagnose(vehicle, *both, null_logs=0).verdict == "adequate"
    monkeypatch.setattr(module, "slow_force", lambda _: None)
    assert name in {f.effect for f in diagnose(vehicle, *both, null_logs=0).findings}


def test_a_wind_beyond_the_declared_force_keeps_its_name():
    """One of six times the declared rms stands, and one of four fifths of it is a part of that."""
    vehicle = vehicle_of()
    for newton, there in ((0.9, True), (0.12, False)):
        found = diagnose(
            vehicle, *logs_of(vehicle, {"wind.steady.north": newton, "wind.steady.east": 0.0}), null_logs=0
        )
        assert ("wind.steady" in {f.effect for f in found.findings}) == there
        assert found.verdict == ("wrong" if there else "adequate")
