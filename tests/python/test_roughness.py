"""The declared ambient force as a bound: a force that no cause explains may not pass for it."""

import re
from dataclasses import replace

import numpy as np
import pytest
from scipy.ndimage import uniform_filter1d
from tests.exam.cases import case

from diagnosis_logs import TRUTH, logs_of, logs_of_case, vehicle_of
from ivsid import diagnose
from ivsid.diagnosis.candidates.families import everything
from ivsid.diagnosis.data.channels import channels
from ivsid.diagnosis.estimation import roughness
from ivsid.diagnosis.estimation.learning import plain_fit
from ivsid.diagnosis.estimation.noise import declared_ambient, lightest
from ivsid.diagnosis.estimation.roughness import APART
from ivsid.diagnosis.selection.adequacy import adequacy
from ivsid.diagnosis.selection.structure import ROUGHER
from ivsid.diagnosis.statements.unknown import unknown
from ivsid.vehicle import parse_vehicle

DECLARED = "force = 0.15\nmoment = 0.03\ntime = 2.0"


def sea(factor, vehicle=None):
    """Logs of a sea that is slower and rougher than the vehicle file says."""
    vehicle = vehicle or vehicle_of()
    rough = vehicle.text.replace(DECLARED, f"force = {0.15 * factor}\nmoment = {0.03 * factor}\ntime = 8.0")
    return logs_of(parse_vehicle(rough, "rough.toml"))


@pytest.mark.parametrize("at_rest", [True, False])
@pytest.mark.parametrize("factor", [1.0, 30.0])
def test_the_least_ambient_force_lies_below_the_true_one_and_not_far(factor, at_rest):
    vehicle = vehicle_of()
    if not at_rest:
        vehicle = parse_vehicle(re.sub(r"absolute = [0-9.]+", "absolute = 0.0", vehicle.text), "relative.toml")
    shown = plain_fit(vehicle, channels(sea(factor, vehicle)[0], vehicle), everything).noise.rougher
    assert all(x < factor for x in shown[:2])
    # A log of minutes knows the variance of such a force to a third, the least counts three errors less, and thrust errors count as declared. Those of
    # thrusters at rest hide a part of the force ahead, where they push.
    assert factor == 1.0 or (shown[1] > 0.25 * factor and shown[0] > (0.08 if at_rest else 0.1) * factor)


def test_a_moment_turns_a_hull_of_little_inertia_more():
    """An azimuth boat with half the inertia of a usual hull was `unknown` in a sea inside the declared one: its moment counted on the usual inertia."""
    c = case(245234, what="none", sea="minutes", sensors="slow")
    vehicle = parse_vehicle(c.text, "v.toml")
    fit = plain_fit(vehicle, channels(logs_of_case(c)[0], vehicle), everything)
    m, length = vehicle.hull.mass, vehicle.hull.length
    assert fit.h.values["inertia.yaw"] < 0.6 * m * length**2 / 8
    assert max(fit.noise.rougher) < 1.3
    # By hand: the declared moment over the fitted inertia, and over the usual one beside larger fitted masses.
    sea, inertia = vehicle.ambient, fit.h.values["inertia.yaw"]
    said = declared_ambient(vehicle, lightest(vehicle, fit.h.values))
    assert said.deviation[2] == pytest.approx(sea.moment / inertia)
    said = declared_ambient(vehicle, lightest(vehicle, {"inertia.yaw": m * length**2, "mass.surge": 2 * m}))
    assert said.deviation == pytest.approx((sea.force / m, sea.force / m, sea.moment / (m * length**2 / 8)))


def bare():
    text = vehicle_of().text
    return parse_vehicle(text[: text.index("[ambient]")], "bare.toml")


@pytest.mark.parametrize(("factor", "rough"), [(1.0, False), (30.0, True)])
def test_without_a_declared_force_the_accuracy_of_the_thrusts_is_one(factor, rough):
    """A twin of 50 kg whose file has no [ambient]: half a newton, of which the calm sea has a third."""
    left = adequacy(plain_fit(bare(), channels(sea(factor)[0], bare()), everything))
    assert (left.roughest > ROUGHER) == rough and left.beyond_curves == (0.0, 0.0, 0.0)
    assert not rough or "where the file has no [ambient]" in unknown(left, []).description


@pytest.mark.parametrize("push", [0.02, 0.25])
def test_slams_that_are_over_in_a_second_are_told_by_an_accelerometer(push):
    """A stranger's boat of 21 t, without a declared sea, slammed with 5 kN, and its model was adequate."""
    train = sea(1.0)[0]
    t, h = train.t, train.t[1] - train.t[0]
    rng = np.random.default_rng(8)
    slam = np.zeros(t.size)
    for late in np.arange(30.0, t[-1] - 5.0, 6.0):
        # One whole period: the hull is as fast after it as before.
        past = t - late - rng.uniform(-2.0, 2.0)
        slam += push * rng.uniform(0.5, 1.5) * np.where((past > 0) & (past < 1.4), np.sin(2 * np.pi * past / 1.4), 0.0)
    columns = {**train.columns, "ax": train.columns["ax"] + slam, "u": train.columns["u"] + np.cumsum(slam) * h}
    vehicle = bare()
    left = adequacy(plain_fit(vehicle, channels(replace(train, columns=columns), vehicle), everything))
    assert (left.rougher[0] > ROUGHER) == (push > 0.1)
    # At the least: the rms of the slams in newtons, over what is allowed.
    assert left.rougher[0] * 0.5 < np.std(slam) * 75.0


def pushed_sideways(train, push):
    """A log whose hull an acceleration [m/s^2] has pushed sideways, shape of its samples."""
    h = train.t[1] - train.t[0]
    columns = {**train.columns, "ay": train.columns["ay"] + push, "v": train.columns["v"] + np.cumsum(push) * h}
    return replace(train, columns=columns)


def test_velocities_tell_of_a_force_that_is_over_within_two_seconds():
    """A stranger's thruster lost a fifth of its thrust for 1.2 to 3 s at a time: two seconds later it did not, and nothing was left at the least."""
    vehicle, train = vehicle_of(), sea(1.0)[0]
    t = train.t
    lengths = np.random.default_rng(5).uniform([2.0, 1.2], [7.0, 3.0], (t.size, 2)).ravel()
    push, u = 0.04 * (np.searchsorted(np.cumsum(lengths), t - t[0]) % 2), np.zeros(t.size)
    for k in range(1, t.size):
        # The hull forgets it at about the rate of its drag.
        u[k] = u[k - 1] + (t[k] - t[k - 1]) * (push[k - 1] - push.mean() - 0.3 * u[k - 1])
    columns = {k: x + u if k == "u" else x for k, x in train.columns.items() if k not in ("ax", "ay")}
    shown = plain_fit(vehicle, channels(replace(train, columns=columns), vehicle), everything).noise.alone[0][0]
    assert ROUGHER < shown < np.std(push) / declared_ambient(vehicle, {}).deviation[0]


# Nightly: sizes that are not told, which sound logs stand for in the gate.
@pytest.mark.parametrize(
    ("spells", "size"),
    [
        pytest.param(0, 0.0, marks=pytest.mark.nightly),
        pytest.param(3, 0.02, marks=pytest.mark.nightly),
        (3, 0.05),
        pytest.param(1, 0.08, marks=pytest.mark.nightly),
    ],
)
def test_a_force_in_spells_is_no_doubt_of_its_own_size(spells, size):
    """Wakes of three ships made 3.2 times the declared force, and a third of it was at the least: spells scattered the blocks that told its error."""
    vehicle, train = vehicle_of(), sea(1.0)[0]
    t = train.t - train.t[0]
    rng = np.random.default_rng(3)
    push = np.zeros(t.size)
    for late in np.linspace(60.0, t[-1] - 60.0, spells):
        past = (t - late - rng.uniform(-10.0, 10.0)) / 15.0
        # A packet of whole swings, so that the hull is as fast after it as before.
        push += size * np.where(np.abs(past) < 1.0, np.cos(0.5 * np.pi * past) ** 2 * np.sin(2 * np.pi * 3 * past), 0.0)
    fit = plain_fit(vehicle, channels(pushed_sideways(train, push), vehicle), everything)
    shown = fit.noise.rougher
    true = np.std(push) / declared_ambient(vehicle, lightest(vehicle, fit.h.values)).deviation[1]
    assert 0.4 * true < shown[1] < np.hypot(1.0, true)
    # Of three wakes of 1.8 times the declared force the log shows half at the least, and of the others more than the limit.
    assert (shown[1] > ROUGHER) == (size > 0.02)


def test_errors_of_poor_velocities_are_no_force_that_an_accelerometer_reads():
    """A stranger's drone had an `unknown` beside its cross-flow: the model's drag at a velocity that was off lasted as a force does."""
    text = re.sub("(absolute|relative) = [0-9.]+", r"\1 = 0.0", vehicle_of().text)
    text = text.replace("accuracy = 0.006", "accuracy = 0.06").replace(
        DECLARED, "force = 0.03\nmoment = 0.006\ntime = 2.0"
    )
    vehicle = parse_vehicle(f"{text}[model]\nterms = {[*TRUTH, 'drag.sway.linear']}\n", "poor.toml")
    assert (vehicle.sensors.velocity.accuracy, vehicle.ambient.force) == (0.06, 0.03)
    train, _ = logs_of(vehicle, {"drag.sway.linear": 200.0})
    assert max(plain_fit(vehicle, channels(train, vehicle), everything).noise.rougher) < 1.0


# Nightly: the null logs, ten seconds of the gate for the same verdict.
@pytest.mark.parametrize("null_logs", [0, pytest.param(400, marks=pytest.mark.nightly)])
def test_a_sea_rougher_than_declared_is_not_adequate_and_is_said(null_logs):
    made = diagnose(vehicle_of(), *sea(30.0), null_logs=null_logs)
    assert made.verdict == "unknown" and [f.effect for f in made.findings] == ["unknown"]
    assert max(made.adequacy[1].rougher) > ROUGHER
    said = made.findings[0].description
    assert "times what [ambient] and the thrusters' accuracy allow" in said


@pytest.mark.parametrize(("factor", "rough"), [(1.0, False), (8.0, True)])
def test_a_sea_that_hides_in_the_accuracy_of_the_thrusts_is_not_adequate(factor, rough):
    """Two thrusters that may be off by ten times the declared ambient force make no force of the time."""
    text = vehicle_of().text
    loose = parse_vehicle(re.sub(r"absolute = [0-9.]+", "absolute = 1.5", text), "loose.toml")
    fit = plain_fit(loose, channels(sea(factor)[0], loose), everything)
    # Both push ahead alone: nothing hides in sway.
    assert fit.noise.rougher[0] < ROUGHER
    fit = replace(fit, noise=replace(fit.noise, rougher=(fit.noise.rougher[0], 0.0, 0.0)))
    found = adequacy(fit)
    assert (found.beyond_curves[0] > ROUGHER) == rough
    assert found.quiet == (not rough)
    assert found.beyond_curves[0] < factor
    assert not rough or "whatever thrust curve inside its accuracy" in unknown(found, []).description


@pytest.mark.parametrize("ambient", [0.3, pytest.param(0.2, marks=pytest.mark.nightly)])
def test_errors_of_thrusts_that_come_in_spells_are_no_force(ambient):
    """A sound ROV whose thrusts jump between levels, at 34 and 51 times its declared force: its blocks scatter with the demands.

    What curves in cells of the demand leave of these errors is up to eleven times the declared force, and up to five times it lasts.
    """
    c = case(256035, what="none", sea="any", sensors="any", ambient=ambient, share=0.98)
    assert (c.stratum["kind"], c.stratum["family"]) == ("rov", "levels")
    vehicle = parse_vehicle(c.text, "v.toml")
    fit = plain_fit(vehicle, channels(logs_of_case(c)[0], vehicle), everything)
    left = adequacy(fit)
    assert max(fit.noise.alone[1]) > 2 * ROUGHER
    assert left.quiet and 0.0 < max(left.beyond_curves) < ROUGHER


@pytest.mark.parametrize("time", APART)
def test_noise_of_readings_alone_is_no_force(time):
    """A ship whose declared force is a hundredth of its noise was 2.5 times as rough as declared: a few dozen blocks scattered by half of their error."""
    h, n, q = 0.25, 2800, 2
    found, errors, of_all = [], [], []
    for seed in range(300):
        mean = uniform_filter1d(np.random.default_rng(seed).standard_normal(n), q)
        slope = (mean[2 * q :] - mean[: -2 * q]) / (2 * q * h)
        lag = round(time / h)
        of_all.append(float(slope[lag:] @ slope[:-lag]) / slope.size)
        errors.append(roughness._of_noise(slope, lag, slope.size))
        found.append(roughness._lasting(slope, np.ones(slope.size, dtype=bool), time, h)[0] > 0)
    # The error of one series is that of a covariance over all of them; a second apart, slopes share noise that adds to it.
    assert (0.75 if time < 2.0 else 0.85) < np.mean(errors) / np.std(of_all) < 1.1
    assert not any(found)


def test_the_scatter_of_blocks_counts_where_it_is_the_larger():
    each = np.array([1.0, 1.2, 0.8, 1.1, 0.9, 1.0, 1.3, 0.7, 9.0])
    of_most, of_all = roughness.at_the_least(each)
    assert of_all < of_most < each.mean()
    assert roughness.at_the_least(each, 1e-6).tolist() == [of_most, of_all]
    assert roughness.at_the_least(each, 10.0).tolist() == [pytest.approx(each.mean() - 30.0)] * 2
