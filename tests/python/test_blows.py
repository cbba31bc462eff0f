"""Forces that are short and seldom, and accelerometers that are shaken: struck through the examiner's simulator, or added to its readings."""

from dataclasses import replace

import numpy as np
import pytest
from tests.exam.cases import case

from diagnosis_logs import logs_of_case
from ivsid import diagnose
from ivsid.diagnosis.null import blows as module
from ivsid.diagnosis.null.blows import BLOWS, blow
from ivsid.diagnosis.null.leaving import Others
from ivsid.diagnosis.null.rule import first_refusal
from ivsid.diagnosis.selection.adequacy import adequacy
from ivsid.diagnosis.selection.verdict import OF_BLOWS, VERDICT, Left
from ivsid.diagnosis.statements.unknown import unknown
from ivsid.vehicle import parse_vehicle
from test_own_past import with_errors
from test_rhythm import fitted, made

TIMES = (71.3, 118.6, 207.9)


# A sea that the accelerometer shows within a fifth of a second.
SEA = {"ambient": 10.0}


@pytest.fixture(scope="module")
def sound():
    return made(**SEA)


def struck(load, length=0.4):
    """A force of half a sine at each time [N], and none between."""

    def force(t, _):
        past = min((t - q for q in TIMES if t >= q), default=length)
        return load * float(np.sin(np.pi * past / length)) if past < length else 0.0

    return force


def test_blows_of_the_declared_mean_square_are_unknown_and_said(sound):
    # Half a sine for four seconds in a thousand: sixteen times the declared force at its height is 0.7 of it rms.
    load = 16.0 * sound[0].ambient.force
    vehicle, train, _ = made(struck(load), **SEA)
    left = adequacy(fitted(vehicle, train))
    one = unknown(left, [])
    assert first_refusal(VERDICT, Left(left, left, 0)).rule == OF_BLOWS.name and one.evidence["channel"] == "sway"
    # Nothing else says so.
    assert left.white and left.in_bounds and left.roughest < 1.0 and left.rhythm.chance == 1.0
    assert 0.5 * load < left.blow.load < 1.1 * load and 2 <= left.blow.count <= 2 * len(TIMES)
    assert min(abs(left.blow.time - q) for q in TIMES) < 1.0
    assert "comes in blows of a second or less" in one.description


# Nightly: a whole diagnosis; the gate has the adequacy of the same log above, which decides.
@pytest.mark.nightly
def test_a_struck_boat_is_unknown(sound):
    found = diagnose(*made(struck(16.0 * sound[0].ambient.force), **SEA), null_logs=0)
    assert [f.effect for f in found.findings] == ["unknown"]


@pytest.mark.parametrize("size", [0.0, 2.0])
def test_a_sound_log_and_short_forces_of_a_few_deviations_are_none(sound, size):
    vehicle, train, _ = made(struck(size * sound[0].ambient.force), **SEA) if size else sound
    found = adequacy(fitted(vehicle, train))
    assert found.quiet and found.blow.times < BLOWS


def test_white_errors_hold_no_blow(sound, monkeypatch):
    """White errors in place of the log's, all of them asked: the largest is that of as many normal ones."""
    fit = fitted(sound[0], sound[1])
    rows = len(fit.noise.predictor.labels)
    monkeypatch.setattr(module, "SEEN", 0.0)
    for seed in range(20):
        white = np.random.default_rng(seed).standard_normal((rows, fit.gram.y.size // rows))
        assert 0.0 < blow(Others(with_errors(fit, white))).times < BLOWS - 1.0


def test_sensors_that_are_noisy_now_and_then_as_they_are_specified_hold_none(monkeypatch):
    """White errors of a calm sea, of a third of the log's size but for five seconds in fifty: the noise of the sensors scatters as they are specified."""
    vehicle, train, _ = made(ambient=0.1)
    fit = fitted(vehicle, train)
    rows, h = len(fit.noise.predictor.labels), fit.noise.predictor.log.h
    monkeypatch.setattr(module, "SEEN", 0.0)
    count = fit.gram.y.size // rows
    size = np.where(h * np.arange(count) % 50.0 < 5.0, 1.0, 0.3)
    for seed in range(10):
        found = blow(Others(with_errors(fit, size * np.random.default_rng(seed).standard_normal((rows, count)))))
        assert 0.0 < found.times < BLOWS


def test_fitted_errors_beyond_their_bounds_make_no_blow():
    """Errors of thrusts were fitted at four times their accuracy, and what that left was a blow of eleven deviations: errors inside their bounds fit as well."""
    c = case(271341, what="none", sea="any", sensors="any")
    vehicle = parse_vehicle(c.text, "v.toml")
    assert adequacy(fitted(vehicle, logs_of_case(c)[0])).blow.times < 0.5 * BLOWS


@pytest.mark.parametrize(("readings", "struck"), [(1, False), (4, True)])
def test_one_wrong_reading_of_an_accelerometer_is_no_force(sound, readings, struck):
    vehicle, train, _ = sound
    read = train.columns["ay"].copy()
    read[1500 : 1500 + readings] += 20.0 * vehicle.ambient.force / vehicle.hull.mass
    log = replace(train, columns={**train.columns, "ay": read})
    assert (blow(Others(fitted(vehicle, log))).times > BLOWS) == struck


def test_what_errors_of_thrusts_and_readings_may_make_is_no_blow():
    rng = np.random.default_rng(5)
    x = rng.standard_normal(5000)
    x[2000] = 12.0
    free, bound = np.zeros(5000), np.full(5000, 7.0)
    times, i, beyond = module._strongest(x, 1.0, free)
    assert i == 2000 and 11.0 < times < 13.0 and beyond.sum() == 1
    assert module._strongest(x, 1.0, bound)[0] < BLOWS
    # Of a declared force of three times what the log shows it is four times, and none of a log that scatters as much.
    assert module._strongest(x, 3.0, free)[0] == pytest.approx(4.0, rel=0.05)
    assert module._strongest(4.0 * rng.standard_normal(5000), 0.1, free)[0] < BLOWS


def test_an_accelerometer_that_is_shaken_near_one_demand_is_unknown(sound):
    """An offset that its mounting makes near a third of the largest demand of each thruster, as of a bracket that swings."""
    vehicle, train, _ = sound
    from_neutral = [np.abs(train.columns[f"demand_{t.name}"]) for t in vehicle.thrusters]
    near = sum(np.exp(-((np.abs(x / x.max() - 0.35) / 0.06) ** 2)) for x in from_neutral)
    offset = 0.03 * near
    read = replace(train, columns={**train.columns, "ax": train.columns["ax"] + offset})
    left = adequacy(fitted(vehicle, read))
    assert not left.white and "acceleration read wrong with demands near" in left.strongest[0][0]
    assert "a bracket that swings" in unknown(left, []).description
    assert adequacy(fitted(vehicle, train)).white
