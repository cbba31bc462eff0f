"""Errors of readings inside what a vehicle file declares make no finding, those beyond it do, and their signatures are those of wrong readings."""

import re
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from tests.exam.cases import setting
from tests.exam.sensor_errors import POSITION, ROTATION

from diagnosis_logs import screened, train_of, vehicle_of
from ivsid import diagnose
from ivsid.diagnosis.candidates.families import everything
from ivsid.diagnosis.data.channels import channels
from ivsid.diagnosis.estimation.declared_errors import nuisances
from ivsid.diagnosis.estimation.learning import plain_fit
from ivsid.diagnosis.plant.declared_readings import deviations, drawn_inside, unit
from ivsid.diagnosis.selection.adequacy import adequacy
from ivsid.log import Log
from ivsid.vehicle import parse_vehicle
from ivsid.workflow.diagnosis import diagnosis_report

VESSEL = {"ambient": 1.0, "duration": 300.0, "rate": 10.0, "share": 0.5}
# Readings of a channel are moved by this much of their accuracy, which the examiner's noise fills already.
MOVED = 0.5


def scaled(reading, accuracy, t):
    return 0.004 * reading


def lessened(reading, accuracy, t):
    return -scaled(reading, accuracy, t)


def constant(reading, accuracy, t):
    return MOVED * accuracy + 0 * t


def deviation(reading, accuracy, t):
    return MOVED * accuracy * np.cos(reading - 0.7)


def wandering(reading, accuracy, t):
    return MOVED * accuracy * np.sin(2 * np.pi * 1.7 * t / t[-1] + 0.9)


def logs_of(here, truth, moves):
    """Both logs of a setting, some of whose channels are moved: by channel, the accuracy and a function of the reading, the accuracy and the time."""
    out = []
    for k, q in enumerate(here.logs(truth), 1):
        read = {name: x for name, x in q.items() if name != "t"}
        read |= {name: read[name] + move(read[name], accuracy, q["t"]) for name, (accuracy, move) in moves.items()}
        out.append(Log(f"{k}.csv", "0" * 64, q["t"], read))
    return out


def diagnosed(here, truth=None, moves=None):
    return diagnose(parse_vehicle(here.text, "vehicle.toml"), *logs_of(here, truth or {}, moves or {}))


SEEDS = range(92100, 92108)
VELOCITIES = {
    "scale": {"u": (0.006, scaled), "v": (0.006, scaled)},
    "less": {"u": (0.006, lessened), "v": (0.006, lessened)},
    "constant": {"u": (0.006, constant), "v": (-0.006, constant)},
    "wandering": {"u": (0.006, wandering), "v": (0.006, constant)},
}
PLACES = {
    "heading": {"psi": (0.015, constant)},
    "compass": {"psi": (0.015, deviation)},
    "position": {"x": (0.5, wandering), "y": (0.5, wandering)},
}
ERRORS = {**VELOCITIES, **PLACES}
NIGHT = [pytest.param(seed, name, marks=pytest.mark.nightly) for seed in SEEDS for name in ERRORS]


@pytest.mark.parametrize(
    ("seed", "name"),
    # Nightly, by seeds of their own: errors that are constant, one of the seven shapes that wander, and of the position, whose rule is that of a velocity.
    [pytest.param(42, "constant", marks=pytest.mark.nightly), (45, "wandering"), (44, "compass"), *NIGHT],
)
def test_an_error_of_readings_inside_its_accuracy_makes_no_finding(seed, name):
    here = setting(seed, **VESSEL)
    # The examiner draws a scale of its own.
    text = here.text.replace("scale_factor_error = 0.004", "scale_factor_error = 0.0")
    moves = ERRORS[name]
    if name in ("scale", "less"):
        logs = logs_of(replace(here, text=text), {}, moves)
        result = diagnose(parse_vehicle(here.text, "vehicle.toml"), *logs)
    else:
        result = diagnosed(here, moves=moves)
    assert (result.verdict, result.findings) == ("adequate", ())


# Nightly: the gate asks for the hints of a bias.
@pytest.mark.nightly
@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_hint_says_the_scale_of_the_velocity_with_its_bound(side):
    # A position that may be off by half a metre shows a scale of 0.4 % after some hundred metres.
    here = setting(40, **{**VESSEL, "duration": 600.0})
    true = replace(here, text=here.text.replace("scale_factor_error = 0.004", "scale_factor_error = 0.0"))
    assert true.text != here.text
    moves = {q: (0.0, lambda x, accuracy, t: side * scaled(x, accuracy, t)) for q in "uv"}
    result = diagnose(parse_vehicle(here.text, "vehicle.toml"), *logs_of(true, {}, moves))
    assert (result.verdict, result.findings) == ("adequate", ())
    said = [h for h in result.hints if h.startswith("velocities")]
    assert all(h.endswith("allows for 0.4 %") for h in said)
    assert said and re.search(r"([+-][\d.]+) %", said[0])[1].startswith("+" if side > 0 else "-")


def test_a_gyro_that_wanders_inside_its_accuracy_makes_no_finding():
    here = setting(40, **VESSEL)
    text = re.sub(r"(\[sensors.yaw_rate\]\n)[^\[]*", r"\1accuracy = 0.1\n", here.text)
    assert text != here.text
    result = diagnose(parse_vehicle(text, "vehicle.toml"), *logs_of(here, {}, {"r": (0.1, wandering)}))
    assert (result.verdict, result.findings) == ("adequate", ())


def test_a_hint_says_the_bias_of_a_velocity():
    result = diagnosed(setting(42, **VESSEL), moves=VELOCITIES["constant"])
    said = {h.split(" is about ")[0]: float(h.split()[-5]) for h in result.hints if " is about " in h}
    assert said["the bias of the velocity ahead"] == pytest.approx(0.003, abs=0.0015)
    assert said["the bias of the velocity to starboard"] == pytest.approx(-0.003, abs=0.0015)


MOUNTED = {"sensor.velocity.lever_arm": POSITION, "sensor.velocity.misalignment": ROTATION}


def mounted(seed, id_, size):
    """A setting whose vehicle file leaves room for the mounting, and an effect at a multiple of that room."""
    # On a straight line nothing shows an arm.
    here = setting(seed, sensors="mounted", style="rich", **VESSEL)
    bound = MOUNTED[id_] * (here.vessel.body.length if id_.endswith("arm") else 1.0)
    names = [f"{id_}.x", f"{id_}.y"] if id_.endswith("arm") else [id_]
    # The examiner's own errors of the mounting stand aside.
    return replace(here, sensors="white"), dict.fromkeys(names, size * bound)


@pytest.mark.parametrize(
    ("seed", "id_"),
    [
        (44, "sensor.velocity.lever_arm"),
        # Nightly: a turn of the sensor, which the same rules hold against the same bounds.
        pytest.param(42, "sensor.velocity.misalignment", marks=pytest.mark.nightly),
        *[pytest.param(seed, id_, marks=pytest.mark.nightly) for seed in SEEDS for id_ in MOUNTED],
    ],
)
def test_a_sensor_that_stands_inside_its_bounds_makes_no_finding_and_one_beyond_them_does(seed, id_):
    """Arms of 27 mm were named beside a stated 30 mm, and turns of 9 mrad beside 10."""
    here, inside = mounted(seed, id_, 0.9)
    result = diagnosed(here, inside)
    assert (result.verdict, result.findings) == ("adequate", ())
    here, beyond = mounted(seed, id_, 6.0)
    (finding, *_) = diagnosed(here, beyond).findings
    assert id_ in (finding.effect, *finding.alternatives)


@cache
def sensed(seed=44):
    here = setting(seed, sensors="mounted", **VESSEL)
    vehicle = parse_vehicle(here.text, "vehicle.toml")
    (log, _) = logs_of(here, {}, {})
    return plain_fit(vehicle, channels(log, vehicle), everything), log


def test_a_signature_is_what_a_wrong_reading_leaves_in_the_errors():
    """The filters run again over readings that an error has moved; signatures leave out what that changes of the states."""
    fit, _ = sensed()
    s = fit.signatures
    columns, predictor = nuisances(s), s.predictor
    exact, waves = predictor.exact(s.states), predictor.slow
    before = predictor.errors(predictor.settle(s.states, 4))
    names = [name for name, _ in deviations(predictor.vehicle) if name in columns.names]
    kinds = {n.split(".")[0] for n in names}
    assert len(names) > 40 and kinds == {"~bias", "~deviation", "~scale", "~arm", "~turn"}
    for name in names:
        size = columns.prior[name]
        log = moved(predictor.log, {q: size * x for q, x in unit(name, exact, waves).items()})
        again = type(predictor)(predictor.vehicle, log, predictor.ambient, axes=predictor.axes)
        left = (again.errors(again.settle(again.start(s.h), 6)) - before) / size
        column = columns.arrays[columns.names.index(name)]
        one, other = (
            fit.noise.whitening.blocks([x], fit.gram.good, fit.gram.length, unit=False)[0].ravel()
            for x in (left, column)
        )
        like = float(one @ other) / float(np.linalg.norm(one) * np.linalg.norm(other))
        assert like > 0.95, (name, like)
        assert 0.85 < float(np.linalg.norm(one) / np.linalg.norm(other)) < 1.1, name


def moved(log, added):
    """Channels with additions to some readings."""
    nu = np.stack([x + added.get(q, 0.0) for q, x in zip("uvr", log.nu, strict=True)])
    acceleration = tuple(
        None if a is None else a + added.get(q, 0.0)
        for q, a in zip(("ax", "ay", "rdot"), log.acceleration, strict=True)
    )
    place = np.stack([x + added.get(q, 0.0) for q, x in zip("xy", log.place, strict=True)])
    return replace(log, nu=nu, acceleration=acceleration, psi=log.psi + added.get("psi", 0.0), place=place)


def test_null_logs_draw_errors_of_readings_inside_their_bounds():
    """Normal errors of the same scatter left their bounds, and three of four null logs had more structure than chance."""
    vehicle = parse_vehicle(setting(44, sensors="mounted", **VESSEL).text, "vehicle.toml")
    rng, n = np.random.default_rng(3), 700
    t = (np.arange(n) + 0.5) / n
    middle = [slice(50 + 100 * k, 51 + 100 * k) for k in range(7)]
    drawn = [drawn_inside(vehicle, rng) for _ in range(400)]
    for channel, accuracy in (("u", 0.006), ("psi", 0.015), ("x", 0.5)):
        errors = [sum(x[f"~bias.{channel}.{j}"] * np.cos(np.pi * j * t) for j in range(7)) for x in drawn]
        there = np.array([[e[k].mean() for k in middle] for e in errors]) / accuracy
        assert np.abs(there).max() <= 1.02 and there.std() == pytest.approx(3**-0.5, rel=0.05)
    psi = np.linspace(0.0, 2.0 * np.pi, 361)
    swung = [
        sum(
            x[f"~deviation.psi.{q}"] * f(k * psi)
            for q, k, f in zip("BCDE", (1, 1, 2, 2), (np.sin, np.cos) * 2, strict=True)
        )
        for x in drawn
    ]
    assert 1.0 < np.abs(swung).max() / 0.015 < 1.8 and np.std(swung) / 0.015 == pytest.approx((4 / 15) ** 0.5, rel=0.05)
    turns = np.array([x["~turn.velocity"] for x in drawn]) / ROTATION
    assert np.abs(turns).max() <= 1.0 and turns.std() == pytest.approx(3**-0.5, rel=0.1)


ACCURACY = {"u": 0.006, "psi": 0.015}


@pytest.mark.parametrize(
    ("name", "error", "said"),
    [
        # Nightly: constants, whose rule is that of the compass.
        pytest.param("u", lambda x, t: 3.0, "velocity ahead", marks=pytest.mark.nightly),
        # A stranger's compass, 13 times as wrong as declared, was a gyro with a wrong scale.
        ("psi", lambda x, t: 4.0 * np.sin(2 * x + 0.3), "deviation of the compass"),
        pytest.param("psi", lambda x, t: 4.0, "bias of the heading", marks=pytest.mark.nightly),
    ],
)
def test_an_error_of_readings_beyond_its_bound_is_unknown_and_its_size_is_said(name, error, said):
    """Soft priors took a velocity that reads ten times its accuracy too much, and the verdict was adequate."""
    times = 3.0 if name == "u" else 4.0
    moves = {name: (ACCURACY[name], lambda x, bound, t: bound * error(x, t))}
    result = diagnosed(setting(41, **VESSEL), moves=moves)
    (finding,) = result.findings
    assert result.verdict == finding.effect == "unknown" and said in finding.description
    stated = float(re.search(r"to be ([\d.]+) times", finding.description)[1])
    assert stated == pytest.approx(times, abs=1.0)
    assert f"    {finding.description}" in diagnosis_report(result).lines
    assert any(said in h and h.endswith("more than its specification allows for") for h in result.hints)


# Nightly: that the log shows it without.
@pytest.mark.parametrize(
    ("stated", "named"),
    [(0.002, set()), pytest.param(1e-5, {"sensor.acceleration.bias"}, marks=pytest.mark.nightly)],
)
def test_an_attitude_inside_its_accuracy_leaves_no_bias(stated, named):
    """Roll and pitch are 1.5 mrad off, so that 0.015 m/s^2 of gravity stays in the accelerations: no cause where the file states that accuracy."""
    text = vehicle_of().text.replace("[sensors.acceleration]\n", "[sensors.acceleration]\ngravity = true\n")
    vehicle = parse_vehicle(f"{text}[sensors.attitude]\naccuracy = {stated}\n", "v.toml")
    level = train_of(vehicle_of())
    tilt = {"roll": 0.0015 + 0 * level.t, "pitch": -0.0015 + 0 * level.t}
    log = Log(level.name, level.sha256, level.t, {**level.columns, **tilt})
    found = screened(vehicle, log)
    assert named == set(found.passed[:1]) and found.quiet == (not named)


def test_errors_of_a_velocity_in_earth_axes_are_those_of_its_projection():
    """Oracle: north and east velocities with small errors, brought to the hull by a heading with one."""
    rng = np.random.default_rng(3)
    u, v, psi = rng.standard_normal((3, 50))
    north, east = u * np.cos(psi) - v * np.sin(psi), u * np.sin(psi) + v * np.cos(psi)
    c = {"u": u, "v": v, "psi": psi}
    size, shape = 1e-6, rng.standard_normal(50)
    slow = [shape] * 7
    moves = {"~bias.north.1": (size, 0, 0), "~bias.east.2": (0, size, 0), "~bias.psi.3": (0, 0, size)}
    for name, (n, e, p) in moves.items():
        turned = psi + p * shape
        read = {
            "u": (north + n * shape) * np.cos(turned) + (east + e * shape) * np.sin(turned),
            "v": (east + e * shape) * np.cos(turned) - (north + n * shape) * np.sin(turned),
        }
        added = unit(name, c, slow, earth=True)
        for q, x in read.items():
            np.testing.assert_allclose(size * added[q], x - c[q], atol=1e-11)
    np.testing.assert_array_equal(unit("~bias.psi.3", c, slow, earth=True)["psi"], shape)
    assert set(unit("~bias.psi.3", c, slow)) == {"psi"}


@pytest.mark.parametrize("earth", [True, False])
def test_a_velocity_that_wanders_in_the_axes_in_which_it_is_read_is_inside_its_accuracy(earth):
    """Over ground it wanders with the place, not with the hull: read as the hull's own it is more than it may be."""
    here = setting(45, **VESSEL)
    text = here.text.replace("accuracy = 0.006", "accuracy = 0.018")
    assert text != here.text
    log = logs_of(here, {}, {})[0]
    c, t = dict(log.columns), log.t
    north, east = (0.8 * 0.018 * np.sin(2 * np.pi * q * t / t[-1] + 0.9) for q in (1.7, 0.6))
    cos, sin = np.cos(c["psi"]), np.sin(c["psi"])
    c |= {"u": c["u"] + north * cos + east * sin, "v": c["v"] - north * sin + east * cos}
    derived = dict.fromkeys("uv", ("velocity_north", "velocity_east", "psi")) if earth else {}
    vehicle = parse_vehicle(text, "vehicle.toml")
    fit = plain_fit(vehicle, channels(Log(log.name, log.sha256, t, c, derived=derived), vehicle), everything)
    assert adequacy(fit).sensed == earth
    names = {n.rsplit(".", 1)[0] for n in fit.gram.names if n.startswith("~bias.")}
    assert ("~bias.north" in names, "~bias.u" in names) == (earth, not earth)


# Nightly: another vessel.
@pytest.mark.parametrize("seed", [46, pytest.param(40, marks=pytest.mark.nightly)])
def test_rates_of_velocities_know_nothing_of_a_gyro_that_wanders(seed):
    """Brought to specific forces by its readings they were wrong by u r, and the heading had to leave its bound."""
    here = setting(seed, **VESSEL)
    text = re.sub(r"(\[sensors.yaw_rate\]\n)[^\[]*", r"\1accuracy = 0.06\n", here.text)
    assert text != here.text
    log = logs_of(here, {}, {})[0]
    c = dict(log.columns)
    c |= {"udot": c.pop("ax") + c["v"] * c["r"], "vdot": c.pop("ay") - c["u"] * c["r"]}
    c["r"] = c["r"] + 0.6 * 0.06 * np.sin(2 * np.pi * 1.7 * log.t / log.t[-1] + 0.9)
    vehicle = parse_vehicle(text, "vehicle.toml")
    data = channels(Log(log.name, log.sha256, log.t, c), vehicle)
    assert data.rates == (True, True)
    assert adequacy(plain_fit(vehicle, data, everything)).quiet
