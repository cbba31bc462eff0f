"""Logs that hardly turn: the yaw rate by its sensors alone, means of sway, and what is said of yaw."""

from dataclasses import replace

import numpy as np
import pytest
from tests.exam.cases import case

from diagnosis_logs import SENSORS, STRAIGHT, TRUTH, TWIN, logs_of_case, train_of
from ivsid.diagnosis.candidates.families import everything
from ivsid.diagnosis.data.channels import channels
from ivsid.diagnosis.estimation import learning
from ivsid.diagnosis.estimation.learning import determined, plain_fit, undetermined
from ivsid.diagnosis.estimation.left_out import axes_left_out
from ivsid.diagnosis.null.visibility import visibility
from ivsid.diagnosis.plant.usual_hull import usual_numbers
from ivsid.diagnosis.prediction.yaw_rate import yaw_rate
from ivsid.diagnosis.selection.adequacy import adequacy
from ivsid.diagnosis.statements.not_tested import left_out_note, not_tested
from ivsid.log import Log
from ivsid.programme.scenario import parse_scenario
from ivsid.simulation import simulate
from ivsid.vehicle import parse_vehicle

VEHICLE = parse_vehicle(TWIN + SENSORS, "twin.toml")
# A mean over 5 s at 10 Hz.
SPAN = 50


def sailed(vehicle=VEHICLE, duration=110.0, **hidden):
    truth = {**TRUTH, **{k.replace("__", "."): v for k, v in hidden.items()}}
    head = f"duration = {duration}\nrate = 10.0\n[truth]\n" + "".join(f'"{k}" = {v}\n' for k, v in truth.items())
    made = simulate(vehicle, parse_scenario(head + STRAIGHT, "s.toml"), 7)
    return channels(Log("1.csv", "0" * 64, made.t, made.columns), vehicle)


@pytest.fixture(scope="module")
def sound():
    log = sailed()
    return log, plain_fit(VEHICLE, log, everything)


def test_the_error_of_the_yaw_rate_is_small_and_not_correlated_with_it(sound):
    rng = np.random.default_rng(3)
    log = sound[0]
    n, h = 4000, log.h
    true = 0.004 * np.convolve(rng.standard_normal(n + 30), np.hanning(30), "valid")[:n] / 2.3
    psi = np.r_[0.0, np.cumsum(0.5 * h * (true[1:] + true[:-1]))] + log.noise["psi"] * rng.standard_normal(n)
    gyro = true + log.noise["r"] * rng.standard_normal(n)

    def of(bias):
        nu = np.stack([0 * gyro, 0 * gyro, gyro + bias])
        return yaw_rate(replace(log, t=h * np.arange(n), nu=nu, psi=psi))

    found = of(0.0)
    error = true - found.rate
    # The ends do not count in a fit.
    means = lambda x: x[SPAN : n // SPAN * SPAN - SPAN].reshape(-1, SPAN).mean(axis=1)  # noqa: E731
    assert means(error).std() < 0.5 * means(true - gyro).std()
    # The error of the gyro has the correlation -0.9 with its reading.
    assert abs(np.corrcoef(error, found.rate)[0, 1]) < 0.25
    assert 0.5 < found.spread / error.std() < 2
    assert 0.5 < found.drawn(rng).std() / error.std() < 2
    # The heading holds the mean: a bias of the gyro does not enter.
    assert np.abs(of(0.01).rate - found.rate).mean() < 1e-4
    assert np.abs(found.heading - psi).mean() < 2 * log.noise["psi"]


def test_sway_counts_in_means_of_unit_variance(sound):
    log, fit = sound
    white, rng = fit.noise.whitening, np.random.default_rng(4)
    assert fit.noise.left_out == {2} and white.slow
    x = rng.standard_normal((len(fit.noise.predictor.labels), log.n))
    rows = white.blocks([x], fit.noise.good, fit.gram.length)[0].reshape(-1, len(x), fit.gram.length)
    for k in white.slow:
        assert np.ptp(rows[:, k].reshape(-1, white.span), axis=1).max() < 1e-12
    g = fit.gram
    left = (g.y - g.explained(fit.projection.base, fit.projection.coefficients)).reshape(-1, len(x), g.length)
    count = fit.noise.good.sum() / white.span
    for k in white.slow:
        assert (left[:, k] ** 2).sum() < 1.7 * count


def test_a_sound_log_shows_no_structure_and_what_acts_sideways_is_seen(sound):
    fit = sound[1]
    assert adequacy(fit).quiet
    seen = visibility(fit)
    assert seen["sensor.velocity.misalignment"].tested and seen["sensor.yaw_rate.bias"].tested
    # Moments stand beside nothing.
    assert not seen["coupling.cg_y"].tested and not seen["added_mass.munk"].tested


@pytest.mark.parametrize(("id_", "size"), [("sensor.velocity.misalignment", 0.026), ("sensor.yaw_rate.bias", 0.01)])
def test_what_acts_sideways_is_found(id_, size):
    fit = plain_fit(VEHICLE, sailed(**{id_.replace(".", "__"): size}), everything)
    k = fit.gram.index[id_]
    theta, fall = fit.projection.solve([k])
    assert fall > 100
    assert theta[0] / fit.gram.unit[k] == pytest.approx(size, rel=0.3)


def test_numbers_that_the_log_does_not_determine_are_said_to_be_a_usual_hulls(sound):
    _, fit = sound
    usual = usual_numbers(VEHICLE)
    assert fit.h.values["inertia.yaw"] == usual["inertia.yaw"]
    assert set(undetermined(fit)) <= {"mass.sway", "drag.sway.quadratic"}
    for id_ in undetermined(fit):
        assert determined(fit).values[id_] == usual[id_]
    assert "yaw is left out" in left_out_note(fit)[0] and "inertia.yaw" in left_out_note(fit)[0]
    said = {q["effect"]: q["reason"] for q in not_tested(fit, visibility(fit))}
    assert "yaw is left out" in said["coupling.cg_y"]


def test_drags_of_yaw_that_a_straight_run_leaves_open_are_those_of_a_hull():
    ids = [*TRUTH, "drag.yaw.linear", "drag.yaw.quadratic"]
    vehicle = parse_vehicle(TWIN + f"[model]\nterms = {ids}\n" + SENSORS, "twin.toml")
    fit = plain_fit(vehicle, sailed(vehicle, drag__yaw__linear=3.0, drag__yaw__quadratic=4.0), everything)
    # The fit alone leaves them anywhere, up to thousands of times a hull's. A hull of 50 kg has some N m s, and so do the field's models.
    numbers = determined(fit).values
    assert all(0.3 < numbers[i] < 10 for i in ids[-2:])
    assert all(i in left_out_note(fit)[0] for i in ids[-2:])


def test_yaw_is_left_out_where_its_turns_are_over_within_two_rows_and_their_noise_shows():
    """Beside large rudders whose moment damped 3 to 14 times a second, a sound model was told from its log by the noise of the rows alone."""
    terms = [*TRUTH, "drag.yaw.linear"]
    vehicle = parse_vehicle(f"{TWIN}{SENSORS}\n[model]\nterms = {terms}\n", "damped.toml")

    def found(rate: float, duration: float, damping: float = 2.0):
        log = train_of(vehicle, {"drag.yaw.linear": damping * TRUTH["inertia.yaw"]}, rate=rate, duration=duration)
        return plain_fit(vehicle, channels(log, vehicle), everything)

    rare, often, short = found(4.0, 1200.0), found(10.0, 240.0), found(4.0, 240.0)
    assert (rare.noise.left_out, often.noise.left_out, short.noise.left_out) == ({2}, frozenset(), frozenset())
    (note,) = left_out_note(rare)
    # It turns well enough: more rows show the damping.
    assert "damps its turns too quickly for readings of yaw every 0.25 s" in note and "hardly turns" not in note
    # Yaw was fitted first, and a usual hull's damping is 0.8 N m s: with it a simulation turns 20 times too fast.
    assert "inertia.yaw, drag.yaw.linear are those of a first model, with yaw" in note
    numbers = determined(rare).values
    assert [numbers[i] for i in ("inertia.yaw", "drag.yaw.linear")] == pytest.approx([9.0, 18.0], rel=0.2)
    # What the noise of few rows does to the damping is less than what they tell of it.
    assert [fit.h.values["drag.yaw.linear"] for fit in (often, short)] == pytest.approx([18.0, 18.0], rel=0.1)
    # However good the readings are, no model follows turns that are over within a row.
    assert found(3.0, 120.0, 4.0).noise.left_out == {2}


def test_a_number_that_no_motion_of_a_log_with_turns_excites_is_that_of_a_hull(monkeypatch):
    """A sound ROV that never went astern had a drag astern of 25,000 kg/m in its models."""
    # Four drags ahead lie on a ridge, on which none is known alone.
    ahead = ["drag.surge.linear", "drag.surge.cubic", "friction.coulomb"]
    terms = [*TRUTH, *ahead, "drag.surge.astern", "drag.yaw.linear", "drag.yaw.quadratic"]
    vehicle = parse_vehicle(f"{TWIN}{SENSORS}\n[model]\nterms = {terms}\n", "twin.toml")
    true = {**dict.fromkeys(ahead, 0.5), "drag.surge.astern": 3.0, "drag.yaw.linear": 3.0, "drag.yaw.quadratic": 4.0}
    log = train_of(vehicle, true)
    assert log.columns["u"].min() > -0.1
    fit = plain_fit(vehicle, channels(log, vehicle), everything)
    assert not fit.noise.left_out and set(undetermined(fit)) == {"drag.surge.astern"}
    assert determined(fit).values == fit.h.values | {"drag.surge.astern": undetermined(fit)["drag.surge.astern"]}
    assert 0.1 < determined(fit).values["drag.surge.astern"] < 100
    # None of the drags ahead is known to a tenth alone, and beside the others each is.
    monkeypatch.setattr(learning, "HULLS_DIFFER", 0.1)
    (note,) = left_out_note(fit)
    assert "does not determine drag.surge.astern:" in note and "usual hull" in note


def test_a_vessel_that_hardly_turns_is_not_said_to_damp_its_turns():
    """An azimuth boat on a straight course in heavy seas: by the filters of its last fit it turned, and the note took the other reason."""
    c = case(260073, duration=200.0, rate=10.0)
    vehicle = parse_vehicle(c.text, "v.toml")
    fit = plain_fit(vehicle, channels(logs_of_case(c)[0], vehicle), everything)
    assert fit.noise.left_out == {2} and not axes_left_out(fit.noise.predictor)
    assert left_out_note(fit)[0].startswith("the vehicle hardly turns")
