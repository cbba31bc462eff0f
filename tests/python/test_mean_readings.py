"""Readings of a quick log are averaged over the steps of the diagnosis' clock, and its demands are looked up inside them."""

from dataclasses import replace

import numpy as np
import pytest

from diagnosis_logs import SENSORS, TRUTH, TWIN, ZIGZAGS, vehicle_of
from ivsid.diagnosis.data import clock
from ivsid.diagnosis.data.channels import channels
from ivsid.diagnosis.estimation.noise import declared_ambient
from ivsid.diagnosis.plant.physics import Hypothesis
from ivsid.diagnosis.prediction.innovations import Predictor
from ivsid.effects import EFFECTS, Given, terms_of
from ivsid.log import Log
from ivsid.programme.scenario import parse_scenario
from ivsid.simulation import simulate
from ivsid.vehicle import parse_vehicle


def made(segments=ZIGZAGS, rate=20.0, extra="", exact=True, **hidden):
    vehicle = vehicle_of(TWIN, extra)
    head = f"duration = 120\nrate = {rate}\nseed = 5\n[truth]\n"
    head += "".join(f'"{k}" = {v}\n' for k, v in {**TRUTH, **hidden}.items())
    done = simulate(vehicle, parse_scenario(head + segments, "s.toml"), 5)
    kept = {k: done.exact[k] for k in done.columns if k in done.exact and exact}
    return vehicle, Log("a.csv", "0" * 64, done.t, {**done.columns, **kept})


def off(vehicle, log, noise, given=()):
    """Errors of the true model's predictions without noise, in the sensors' noise, by row."""
    predictor = Predictor(vehicle, replace(channels(log, vehicle), noise=noise), declared_ambient(vehicle))
    h = Hypothesis(terms_of(vehicle), dict(TRUTH), tuple(Given(EFFECTS[i], (x,)) for i, x in given))
    errors = predictor.errors(predictor.settle(predictor.start(h), 6))[:, 40:]
    return np.sqrt(np.mean(errors**2, axis=1)) / [noise[name] for _, name in predictor.labels]


def test_readings_are_means_of_two_and_the_clock_stands_between_them():
    vehicle, log = made(exact=False)
    data = channels(log, vehicle)
    assert 1 / data.h == pytest.approx(10.0) and 1 / data.h <= clock.HIGHEST_MEAN_RATE
    assert data.t[0] == pytest.approx(0.025)
    for k, name in enumerate(("u", "v", "r")):
        pairs = log.columns[name][: 2 * data.n].reshape(data.n, 2).mean(axis=1)
        np.testing.assert_allclose(data.nu[k], pairs, atol=1e-12)
    assert any("means of 2 readings are used: 10 a second" in n for n in data.notes)
    # White noise of a mean of two: its standard deviation falls by the root of two.
    slow = channels(replace(log, t=log.t * 4), vehicle)
    assert slow.n == log.t.size and data.noise["u"] == pytest.approx(slow.noise["u"] / np.sqrt(2), rel=0.1)


@pytest.mark.parametrize(("rate", "count"), [(12.5, 1), (13.0, 1), (19.0, 1), (20.0, 2), (26.0, 2), (30.0, 3)])
def test_means_are_over_a_tenth_of_a_second_at_most(rate, count):
    """A log of 13 Hz in means of two had a step of 0.15 s, in which a light hull forgets what its thrusters did."""
    vehicle, log = made(exact=False)
    data = channels(replace(log, t=log.t * (20.0 / rate)), vehicle)
    assert 1 / data.h == pytest.approx(rate / count, rel=1e-3)


@pytest.mark.parametrize("cause", [(), ("thruster.lag", 0.3), ("thruster.delay", 0.13), ("thruster.shaft_lag", 0.2)])
def test_means_add_no_error_to_predictions(cause, monkeypatch):
    """Wherever in a step demands jump, the true model's predictions are off by what they are off by on the log's own clock.

    The noise of a mean is smaller by the root of two. A thrust that jumps between two readings, as behind a delay, bends the velocity there.
    """
    given = (cause,) if cause else ()
    vehicle, log = made(**dict(given))
    noisy = made(exact=False)[1]
    found = off(vehicle, log, channels(noisy, vehicle).noise, given)
    monkeypatch.setattr(clock, "HIGHEST_MEAN_RATE", 25.0)
    own = off(vehicle, log, channels(noisy, vehicle).noise, given)
    assert (found < 1.7 * own + 0.01).all()
    assert found.max() < 0.5


@pytest.mark.parametrize("delay", [0.0, 0.0125, 0.035, 0.13])
def test_a_mean_of_readings_is_no_velocity_at_their_middle(delay):
    """Thrusts jump between the readings, and drag bends the velocity: the oracle is a hull on a straight line, at 400 points a second."""
    vehicle, log = made(exact=False)
    rng, fine, rate = np.random.default_rng(8), 400, 20
    # Entries of the thrust table, and the thrust of both thrusters there [N].
    entries, pushes = np.array([30.0, 60.0, 100.0]), np.array([12.0, 36.0, 80.0])
    demand = np.repeat(rng.choice(entries, 400), rng.integers(3, 15, 400))[: log.t.size]
    late = np.roll(np.repeat(demand, fine // rate), round(delay * fine))
    late[: round(delay * fine)] = demand[0]
    force = pushes[np.searchsorted(entries, late)]

    def rate_of(u, f):
        return (f - TRUTH["drag.surge.quadratic"] * u * abs(u)) / TRUTH["mass.surge"]

    u = np.empty(late.size)
    u[0] = 0.8
    for i, f in enumerate(force[:-1]):
        k1 = rate_of(u[i], f)
        k2 = rate_of(u[i] + 0.5 / fine * k1, f)
        u[i + 1] = u[i] + k2 / fine
    still = dict.fromkeys(("v", "r", "ay", "rdot", "psi", "y"), np.zeros(log.t.size))
    read = {
        "u": u[:: fine // rate],
        "ax": rate_of(u, force)[:: fine // rate],
        "x": np.cumsum(u)[:: fine // rate] / fine,
    }
    columns = {k: {**read, **still}.get(k, demand) for k in log.columns}
    data = replace(channels(replace(log, columns=columns), vehicle), noise=channels(log, vehicle).noise)
    predictor = Predictor(vehicle, data, declared_ambient(vehicle))
    given = (Given(EFFECTS["thruster.delay"], (delay,)),) if delay else ()
    states = predictor.settle(predictor.start(Hypothesis(terms_of(vehicle), dict(TRUTH), given)), 4)
    there = np.round(data.t * fine).astype(int)
    expected = data.nu[0] - u[there]
    found = predictor.from_samples(states)
    inside = slice(20, -5)
    wrong, nothing = (np.sqrt(np.mean(x[inside] ** 2)) for x in (found[0] - expected, expected))
    # Without the part of the thrusts 1.5e-3 and more are left where they are late, without that of the drag 1.5e-4.
    assert nothing > 1.5e-4 and wrong < 5e-5
    assert np.abs(found[1:]).max() < 1e-12


def test_an_averaging_accelerometer_keeps_the_mean_over_the_step_before():
    extra = '\n[sensors.acceleration]\nrandom_walk = 0.002\nsampling = "averaged"\n'
    text = (TWIN + SENSORS).replace("[sensors.acceleration]\nrandom_walk = 0.002", extra)
    vehicle = parse_vehicle(text, "twin.toml")
    _, log = made(exact=False)
    data = channels(log, vehicle)
    # The step before 0.125 s: half of the reading at 0.05 s, which is the mean from 0 on, that at 0.1 s, and half of that at 0.15 s.
    read = log.columns["ax"]
    assert data.averaged and data.acceleration[0][1] == pytest.approx(0.25 * read[1] + 0.5 * read[2] + 0.25 * read[3])


def test_a_log_keeps_its_clock_where_a_mean_says_less():
    """Thrusters that turn, demands on straight lines, and a hull that turns by a tenth of a radian within a step."""
    vehicle, log = made()
    assert channels(log, vehicle).h == pytest.approx(0.1)
    turning = parse_vehicle(
        vehicle.text.replace("[[thrusters]]", '[[thrusters]]\nsteering = "azimuth"', 1), "twin.toml"
    )
    turned = {**log.columns, f"azimuth_{vehicle.thrusters[0].name}": 0.0 * log.t}
    assert channels(replace(log, columns=turned), turning).h == pytest.approx(0.05)
    lines = vehicle.model_copy(update={"log": vehicle.log.model_copy(update={"demand": "linear"})})
    assert channels(log, lines).h == pytest.approx(0.05)
    whirling = {**log.columns, "r": 4.0 * log.columns["r"] / np.quantile(np.abs(log.columns["r"]), 0.9)}
    assert channels(replace(log, columns=whirling), vehicle).h == pytest.approx(0.05)
