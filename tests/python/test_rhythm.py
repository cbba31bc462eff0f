"""A force that repeats with the way through the water: the examiner's boat sheds vortices, whose phase comes from a run without them."""

import numpy as np
import pytest
from tests.exam import physics
from tests.exam.cases import case

from diagnosis_logs import logs_of_case
from ivsid import diagnose
from ivsid.diagnosis.candidates.families import everything
from ivsid.diagnosis.data.channels import channels
from ivsid.diagnosis.estimation.learning import plain_fit
from ivsid.diagnosis.null import rhythm as module
from ivsid.diagnosis.null.rhythm import rhythm
from ivsid.diagnosis.null.rule import first_refusal
from ivsid.diagnosis.selection.adequacy import adequacy
from ivsid.diagnosis.selection.structure import REPEATS
from ivsid.diagnosis.selection.verdict import OF_THE_WAY, VERDICT, Left
from ivsid.diagnosis.statements.unknown import unknown
from ivsid.vehicle import parse_vehicle
from test_curves_together import with_log
from test_own_past import with_errors

HOW = {"kind": "vectored", "style": "rich", "duration": 300.0, "rate": 10.0, "ambient": 1.0, "share": 0.5}
SEED, LENGTH = 270001, 1.3


def made(force=None, **how):
    """A vehicle with its logs, and a force Y of the time and the speed ahead in both."""
    how = {**HOW, **how}
    patch = pytest.MonkeyPatch()
    try:
        if force is None:
            c = case(SEED, what="none", **how)
        else:
            patch.setitem(physics.PLACE, "x.house", lambda _, t, u, psi, x, y: (0.0, force(t, u), 0.0))
            c = case(SEED, what="outside", effect="x.house", size=1.0, **how)
    finally:
        patch.undo()
    return parse_vehicle(c.text, "v.toml"), *logs_of_case(c)


def fitted(vehicle, log):
    return plain_fit(vehicle, channels(log, vehicle), everything)


@pytest.fixture(scope="module")
def sound():
    return made()


def shed(sound, share):
    """Vortices whose force is a share of the declared one in the mean square, by the way of the sound log."""
    vehicle, train, _ = sound
    u, v, t = train.columns["u"], train.columns["v"], train.t
    way = np.concatenate([[0.0], np.cumsum(np.hypot(u, v)[:-1] * np.diff(t))])
    size = np.sqrt(2.0) * share * vehicle.ambient.force / np.sqrt(np.mean(u**4))
    return lambda at, ahead: size * ahead**2 * float(np.sin(2 * np.pi * np.interp(at, t, way) / LENGTH))


def test_vortices_are_a_line_over_the_way(sound):
    vehicle, train, _ = made(shed(sound, 0.7))
    found = adequacy(fitted(vehicle, train))
    assert found.rhythm.channel == "sway" and found.rhythm.length == pytest.approx(LENGTH, rel=0.02)
    assert found.rhythm.chance < REPEATS and not found.quiet
    assert "m of the way through the water" in unknown(found, []).description
    assert first_refusal(VERDICT, Left(found, found, 0)).rule == OF_THE_WAY.name
    # Nothing else says so: over time it is a force inside the declared one.
    assert found.white and found.in_bounds and found.roughest < 1.0


def test_a_sound_log_and_a_swell_have_none(sound):
    vehicle, train, _ = sound
    found = adequacy(fitted(vehicle, train))
    assert found.quiet and found.rhythm.chance == 1.0
    size = np.sqrt(2.0) * vehicle.ambient.force
    swell = made(lambda t, _: float(size * np.sin(2 * np.pi * t / 4.0)))
    assert rhythm(fitted(swell[0], swell[1])).chance == 1.0


def test_a_swell_at_a_steady_speed_is_a_line_over_time_first(sound, monkeypatch):
    """White errors with a sine of 2 s in one row, of a boat that makes 0.5 m/s all the time."""
    fit = fitted(sound[0], sound[1])
    rows, h = len(fit.noise.predictor.labels), fit.noise.predictor.log.h
    y = np.random.default_rng(1).standard_normal((rows, fit.gram.y.size // rows))
    y[0] += 0.3 * np.sin(2 * np.pi * h * np.arange(y.shape[1]) / 2.0)
    none = np.zeros(2 * y.shape[1])
    monkeypatch.setattr(module, "through_water", lambda _: (none + 0.5, none, none))
    made = with_errors(fit, y)
    assert rhythm(made).chance == 1.0
    monkeypatch.setattr(module, "FARTHER", 0.0)
    found = rhythm(made)
    assert found.chance < REPEATS and found.length == pytest.approx(1.0, rel=0.01)


# Nightly: a whole diagnosis; the gate has the adequacy of the same log above, which decides.
@pytest.mark.nightly
def test_vortices_are_unknown_and_said(sound):
    found = diagnose(*made(shed(sound, 0.7)), null_logs=0)
    (one,) = found.findings
    assert found.verdict == "unknown" and one.effect == "unknown"
    assert (
        "repeats every 1.3 m of the way through the water" in one.description or "repeats every 1.2" in one.description
    )


def test_white_errors_are_as_rarely_a_line_as_said(sound):
    """Three hundred draws of white errors in place of the log's: the chance is at most what it says."""
    fit = fitted(sound[0], sound[1])
    shape = fit.gram.y.shape
    found = [rhythm(with_log(fit, np.random.default_rng(k).standard_normal(shape))).chance for k in range(300)]
    assert sum(q < 0.05 for q in found) <= 20 and min(found) > 1e-5
