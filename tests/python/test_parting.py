"""Readings that follow from one another part by no more than their stated accuracies allow: a filter follows a reading that is wrong for a while."""

from dataclasses import replace

import numpy as np
import pytest

from diagnosis_logs import train_of, vehicle_of
from ivsid.diagnosis.candidates.families import everything
from ivsid.diagnosis.data.channels import channels
from ivsid.diagnosis.estimation import parting
from ivsid.diagnosis.estimation.learning import plain_fit
from ivsid.diagnosis.estimation.noise import declared_ambient
from ivsid.diagnosis.estimation.parting import HEADING, PLACE, parted
from ivsid.diagnosis.plant.physics import Hypothesis
from ivsid.diagnosis.prediction.innovations import Predictor
from ivsid.diagnosis.selection.adequacy import adequacy
from ivsid.diagnosis.selection.structure import PARTED
from ivsid.diagnosis.statements.unknown import unknown
from ivsid.effects import terms_of
from ivsid.vehicle import parse_vehicle

# Accuracies of the heading and the position, and the slow error and the noise of the gyro, of the file of these logs.
PSI, XY, SLOW, WALK = 0.015, 0.5, 3 * 2e-4, 3 * 1.745e-3


def spells(t, rise=2.0):
    """Between 0 and 1: on for half a minute at a time, with soft edges."""
    return np.clip(np.minimum(t % 75.0 - 30.0, 62.0 - t % 75.0) / rise, 0.0, 1.0)


def wrong(channel, size):
    """A log whose channel is off in spells, or whose velocities keep their values in them."""
    train = train_of(vehicle_of())
    t, columns = train.t - train.t[0], dict(train.columns)
    if channel == "uv":
        lost = spells(t) > 0
        last = np.maximum.accumulate(np.where(lost, 0, np.arange(t.size)))
        columns |= {q: columns[q][last] for q in "uv"}
    else:
        columns[channel] = columns[channel] + size * spells(t)
    return replace(train, columns=columns)


@pytest.mark.parametrize(
    ("channel", "size", "told"),
    [
        ("psi", 10 * PSI, HEADING),
        ("psi", 0.5 * PSI, ""),
        # Nightly: the other sensors.
        pytest.param("x", 10 * XY, PLACE, marks=pytest.mark.nightly),
        pytest.param("uv", None, PLACE, marks=pytest.mark.nightly),
        pytest.param("x", 0.5 * XY, "", marks=pytest.mark.nightly),
    ],
)
def test_readings_that_are_wrong_for_a_while_are_told(channel, size, told):
    """A stranger's compass was off by 10 degrees near steel for half a minute, at an accuracy of half a degree, and its model was adequate."""
    vehicle = vehicle_of()
    left = adequacy(plain_fit(vehicle, channels(wrong(channel, size), vehicle), everything))
    name, times = left.parted
    assert (times > PARTED) == bool(told)
    if told:
        assert name == told and not left.quiet and "part by" in unknown(left, []).description
    else:
        assert left.quiet and times < 1.0


def parted_of(log):
    """How far readings of a log part by the plain model."""
    vehicle = vehicle_of()
    predictor = Predictor(vehicle, channels(log, vehicle), declared_ambient(vehicle))
    terms = terms_of(vehicle)
    return parted(predictor, predictor.start(Hypothesis(terms, {t.id: 50.0 for t in terms})))


def exact(jump=0.0, at=50.0, lost=()):
    """Readings without errors on a circle, with a heading that jumps, and rows that are lost."""
    t = 0.1 * np.arange(1200)
    psi, u, r = 0.2 * t, 0.8, 0.2
    columns = {"u": 0 * t + u, "v": 0 * t, "r": 0 * t + r, "psi": psi + jump * (t >= at), "x": u / r * np.sin(psi)}
    columns |= {"y": u / r * (1 - np.cos(psi)), "demand_port": 0 * t + 30.0, "demand_starboard": 0 * t + 20.0}
    keep = ~np.isin(np.arange(t.size), lost)
    return replace(train_of(vehicle_of()), t=t[keep], columns={k: x[keep] for k, x in columns.items()})


def test_the_number_is_what_is_allowed_by_hand():
    """Over five seconds twice the heading's accuracy, the gyro's slow error times them and its noise times their root."""
    assert max(parted_of(exact()).values()) < 0.01
    allowed = 2 * PSI + 5 * SLOW + np.sqrt(5) * WALK
    assert parted_of(exact(0.3))[HEADING] == pytest.approx(0.3 / allowed, rel=1e-3)
    # Nothing is said over a gap, in which a vehicle may turn by anything.
    assert parted_of(exact(0.3, 50.0, range(480, 520)))[HEADING] == pytest.approx(0.0, abs=0.01)


def test_a_gyro_that_drifts_as_it_warms_parts_over_minutes():
    """A stranger's gyro whose bias followed its warming was adequate: over twenty seconds its noise allows as much."""
    log = exact()
    drift = 1e-3 * (1.0 - 2.2 * np.exp(-log.t / 157.0))
    wrong = replace(log, columns={**log.columns, "r": log.columns["r"] + drift})
    by_hand = np.abs(np.cumsum(0.1 * drift)[600:] - np.cumsum(0.1 * drift)[:-600]).max()
    minute = by_hand / (2 * PSI + 60 * SLOW + np.sqrt(60) * WALK)
    assert parted_of(wrong)[HEADING] == pytest.approx(minute, rel=0.05)
    assert parted_of(exact())[HEADING] < 0.01


def test_a_rate_that_jumps_inside_the_steps_of_a_rare_clock_is_no_heading_that_parts(monkeypatch):
    """Velocities of every third row set the clock: a sum over it misses up to a step of each jump, and sound logs of strangers were `unknown`."""
    t = 0.1 * np.arange(1200)
    r = np.repeat(np.random.default_rng(3).uniform(-0.6, 0.6, 200), 6)[: t.size]
    psi = np.r_[0.0, np.cumsum(0.1 * r)[:-1]]
    log = exact()
    columns = (
        log.columns | {"r": r, "psi": psi} | {k: np.where(np.arange(t.size) % 3, np.nan, log.columns[k]) for k in "uv"}
    )
    rare = replace(log, columns={k: x for k, x in columns.items() if k not in "xy"})
    assert parted_of(rare)[HEADING] < 0.8
    monkeypatch.setattr(parting, "_missed", lambda rate, h: np.zeros_like(rate))
    assert parted_of(rare)[HEADING] > PARTED


def test_a_gyro_that_states_nothing_may_scatter_by_anything():
    text = vehicle_of().text.replace("random_walk = 1.745e-3\nbias_instability = 2.0e-4", "")
    vehicle = parse_vehicle(text, "bare.toml")
    assert vehicle.sensors.yaw_rate.random_walk == 0.0
    predictor = Predictor(vehicle, channels(exact(0.3), vehicle), declared_ambient(vehicle))
    terms = terms_of(vehicle)
    assert HEADING not in parted(predictor, predictor.start(Hypothesis(terms, {t.id: 50.0 for t in terms})))
