"""Allan analysis of sensors as they are: filtered, rounded, with flicker noise, moved or warming; and in the units of data sheets."""

import math

import numpy as np
import pytest
from scipy import signal

from command_line import run
from ivsid import IvsidError, workflow
from ivsid.sensors.allan import allan_deviation
from ivsid.sensors.allan_fit import NAMES
from ivsid.sensors.recording import signs
from sampling import spaced
from simulated_sensors import Sensor, drawn


def filtered(order, cutoff, samples=60_000, dt=0.01, seed=1):
    """A gyro [deg/s] whose noise is 0.05 deg/s behind a filter, over a flicker floor of 0.0051 deg/s."""
    rng = np.random.default_rng(seed)
    raw = Sensor(n=1.0, order=order, cutoff=cutoff)
    noise = raw.record(samples, dt, rng)
    scale = 0.05 / noise.std()
    return scale, noise * scale + Sensor(flicker=0.0077).record(samples, dt, rng)


def held(curve, sensor, dt):
    """Whether the stated band holds each number that the sensor has."""
    truth = (sensor.white(dt), sensor.b, sensor.t if sensor.b else None, sensor.k)
    return {
        name: curve.bands[name][0] <= true <= curve.bands[name][1]
        for name, true in zip(NAMES, truth, strict=True)
        if true is not None
    }


@pytest.mark.parametrize(("order", "cutoff"), [(2, 10.0), pytest.param(1, 5.0, marks=pytest.mark.nightly)])
def test_a_filter_of_the_sensor_is_no_bias(order, cutoff):
    """Without the filter in mind, the fit calls its noise a bias of 0.05 deg/s with a correlation time of four samples."""
    white, values = filtered(order, cutoff)
    curve = allan_deviation("r", values, 0.01)
    low, high = curve.bands["bias_instability"]
    assert low <= 0.0077 <= high < 0.02
    assert curve.bias_time >= 1.0
    assert curve.random_walk == pytest.approx(white, rel=0.12)
    assert curve.signs.bandwidth == pytest.approx(cutoff, rel=0.2)
    assert curve.start > 1 / (2 * math.pi * cutoff)
    assert curve.signs.sinusoid is None and curve.signs.drift is None and not curve.coarse


def test_white_noise_keeps_every_averaging_time():
    curve = allan_deviation("r", np.random.default_rng(4).standard_normal(20_000), 0.1)
    assert curve.start == pytest.approx(0.1) and curve.signs.bandwidth is None
    assert not np.isnan(curve.model(curve.taus)).any()


# Nightly: the gate has the bands of each point.
@pytest.mark.nightly
@pytest.mark.sampled
def test_most_bands_hold_the_truth():
    """Sensors with every mixture of filter, steps, bias and walk; the 216 of the nightly run are counted below."""
    dt, found = 0.01, []
    for seed in spaced(range(216), 4):
        sensor = drawn(seed)
        curve = allan_deviation("x", sensor.record(20_000, dt, np.random.default_rng(seed)), dt)
        assert curve.bias_time >= 1.0 and curve.motion is None
        found += held(curve, sensor, dt).values()
    assert len(found) >= 12 and np.mean(found) >= 0.85


@pytest.mark.slow
@pytest.mark.nightly
def test_the_bands_of_95_percent_hold_93_percent_of_the_truths():
    """216 sensors, 9 of each mixture: no filter, first and second order; steps; bias, walk, both."""
    dt, found = 0.01, {name: [] for name in NAMES}
    for seed in range(216):
        sensor = drawn(seed)
        curve = allan_deviation("x", sensor.record(40_000, dt, np.random.default_rng(seed)), dt)
        for name, inside in held(curve, sensor, dt).items():
            found[name].append(inside)
    share = {name: np.mean(inside) for name, inside in found.items()}
    assert all(s >= 0.93 for s in share.values()), share


def test_flicker_noise_is_said_and_bounded():
    """The bound takes the standard deviation of flicker noise over the record, which is above its coefficient."""
    rng = np.random.default_rng(2)
    values = Sensor(n=1e-3, flicker=5e-3).record(60_000, 0.1, rng)
    curve = allan_deviation("r", values, 0.1)
    assert curve.flicker and curve.resolved
    low, high = curve.bands["bias_instability"]
    assert low <= 5e-3 <= high < 1.3 * low
    assert curve.floor == pytest.approx(5e-3, rel=0.15)
    assert 0.8 * values.std() < curve.bias_bound < 4 * values.std()


# Nightly: other sensors stand in the gate.
@pytest.mark.nightly
def test_noise_of_increments_counts_in_full_at_a_sample():
    """Angles rounded to steps of 1e-3 and then differentiated: the noise at a sample is far above N / sqrt(dt)."""
    rng = np.random.default_rng(5)
    dt = 0.01
    angle = np.cumsum(rng.standard_normal(40_001) * 2e-3 * np.sqrt(dt))
    rates = np.diff(np.round(angle / 1e-3) * 1e-3) / dt
    curve = allan_deviation("r", rates, dt)
    assert curve.short > 0
    assert curve.white_bound / np.sqrt(dt) > 0.9 * rates.std() > 1.5 * curve.random_walk / np.sqrt(dt)


def test_a_sinusoid_is_found_and_noise_has_none():
    rng = np.random.default_rng(6)
    t = np.arange(50_000) * 0.02
    noise = rng.standard_normal(t.size) * 0.1 + np.cumsum(rng.standard_normal(t.size)) * 1e-3
    assert signs(noise, 0.02, 1e-2).sinusoid is None
    frequency, amplitude = signs(noise + 0.02 * np.sin(2 * np.pi * 0.37 * t), 0.02, 1e-2).sinusoid
    assert frequency == pytest.approx(0.37, abs=2e-3)
    assert amplitude == pytest.approx(0.02, rel=0.25)


def test_swell_is_named_by_its_frequency_and_noise_has_none():
    """A deck that swells at 0.1 Hz, in no single line; without swell the same noise has no hump."""
    rng = np.random.default_rng(11)
    dt = 0.1
    swell = signal.sosfilt(signal.butter(2, [0.08, 0.12], "band", fs=1 / dt, output="sos"), rng.standard_normal(8_000))
    noise = Sensor(n=1e-3, b=1e-3, t=8.0, k=1e-5).record(swell.size, dt, rng)
    assert allan_deviation("r", noise, dt).motion is None
    moved = allan_deviation("r", noise + 0.02 * swell / swell.std(), dt)
    assert moved.motion == pytest.approx(0.1, rel=0.3) and moved.signs.sinusoid is None


def test_a_warming_sensor_drifts_and_a_random_walk_does_not():
    rng = np.random.default_rng(7)
    t = np.linspace(0, 1, 20_000)
    noise = rng.standard_normal(t.size)
    for seed in range(50):
        walk = np.cumsum(np.random.default_rng(seed).standard_normal(t.size))
        assert signs(noise + walk, 0.1, 1.0).drift is None, seed
    warming = signs(noise + 10 * (1 - np.exp(-4 * t)), 0.1, 1.0).drift
    assert warming == pytest.approx(10 * (1 - np.exp(-4)), rel=0.15)


def test_steps_of_the_readings_are_seen():
    rng = np.random.default_rng(8)
    values = rng.standard_normal(5000) * 0.3
    assert signs(values, 0.1, 0.009).step is None
    assert signs(np.round(values / 0.05) * 0.05 + 3.2, 0.1, 0.009).step == pytest.approx(0.05)


@pytest.fixture(scope="module")
def recording(tmp_path_factory):
    """A gyro in deg/s and an accelerometer in g, both white, with a coarse temperature-like column beside them."""
    rng = np.random.default_rng(9)
    t = np.arange(6000) * 0.02
    gyro, x = rng.standard_normal(t.size) * 0.05, rng.standard_normal(t.size) * 2e-3
    path = tmp_path_factory.mktemp("units") / "still.csv"
    rows = "".join(f"{a:.2f},{b:.9f},{c:.9f}\n" for a, b, c in zip(t, gyro, x, strict=True))
    path.write_text("t,gyr_z,acc_x\n" + rows)
    return path


def number(toml, section, key):
    lines = toml.split(f"[sensors.{section}]")[1].splitlines()
    return float(next(line for line in lines if line.startswith(key)).split("=")[1])


def test_units_of_the_recording_become_si_in_the_vehicle_file(recording, tmp_path):
    made = run("allan", recording, "--unit", "deg/s,g", "--out", tmp_path / "out")
    assert made.returncode == 0, made.stderr
    assert "[deg/s] N 0.007" in made.stdout and "µg/√Hz" in made.stdout
    toml = (tmp_path / "out" / "sensors.toml").read_text()
    walk = 0.05 * math.sqrt(0.02)
    assert number(toml, "yaw_rate", "random_walk") == pytest.approx(math.radians(walk), rel=0.06)
    assert number(toml, "acceleration", "random_walk") == pytest.approx(2e-3 * 9.80665 * math.sqrt(0.02), rel=0.06)
    # 1 deg/sqrt(s) is 60 deg/sqrt(h)
    sheet = float(made.stdout.split("gyr_z      as data sheets give it: N ")[1].split()[0])
    assert sheet == pytest.approx(60 * walk, rel=0.06)


# Nightly: the gate states units by the option.
@pytest.mark.nightly
def test_a_header_states_its_unit(recording, tmp_path):
    text = recording.read_text().replace("gyr_z", "gyr_z [deg/s]", 1).replace("acc_x", "acc_x (g)", 1)
    (tmp_path / "labelled.csv").write_text(text)
    by_header = workflow.allan(tmp_path / "labelled.csv").record
    by_option = workflow.allan(recording, unit=["deg/s", "g"]).record
    assert by_header["toml"].replace(" [deg/s]", "").replace(" (g)", "") == by_option["toml"]


@pytest.mark.parametrize(
    ("unit", "columns", "sentence"),
    [
        (["furlong"], [], "unit 'furlong' is none of a rate or an acceleration"),
        (["deg/s", "rad/s"], [], "gives both deg/s and rad/s for the yaw rate"),
        (["g"], ["gyr_z"], "--unit g fits none of the channels gyr_z"),
    ],
)
def test_units_that_do_not_fit(recording, unit, columns, sentence):
    with pytest.raises(IvsidError, match=sentence):
        workflow.allan(recording, unit=unit, columns=columns)


# Nightly: eleven seconds; the gate names swell and units.
@pytest.mark.nightly
def test_the_signs_reach_the_reader(tmp_path):
    """Filter, sinusoid, drift and coarse steps stand in the notes of the command and of its page."""
    rng = np.random.default_rng(10)
    t = np.arange(20_000) * 0.01
    moved = (
        Sensor(n=5e-3, order=2, cutoff=8.0).record(t.size, 0.01, rng) + 0.02 * np.sin(2 * np.pi * 1.5 * t) + t * 2e-3
    )
    # Of a reading that moves, nothing is guessed of a filter.
    filtered = Sensor(n=5e-3, order=2, cutoff=8.0).record(t.size, 0.01, rng)
    coarse = np.round((rng.standard_normal(t.size) * 0.2 + 0.3) / 1.0)
    rows = "".join(f"{a:.2f},{b:.7f},{f:.7f},{c:g}\n" for a, b, f, c in zip(t, moved, filtered, coarse, strict=True))
    (tmp_path / "moved.csv").write_text("t,r,q,ax\n" + rows)
    made = run("allan", tmp_path / "moved.csv", "--unit", "deg/s", "--out", tmp_path / "out")
    assert made.returncode == 0, made.stderr
    for words in (
        "halves the power at about",
        "a sinusoid of 1.5 Hz",
        "half a step counts as accuracy",
    ):
        assert words in made.stdout, words
        assert words in (tmp_path / "out" / "report.html").read_text(), words
    assert float(made.stdout.split("drifts by ")[1].split()[0]) == pytest.approx(0.4, rel=0.1)
    assert number((tmp_path / "out" / "sensors.toml").read_text().split("# half")[0], "acceleration", "accuracy") == 0.5
