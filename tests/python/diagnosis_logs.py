"""A vehicle, its simulated logs and what can happen to a log, for the tests of the diagnosis."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cache

import numpy as np
import pytest

from ivsid import Diagnosis, diagnose
from ivsid.diagnosis.candidates.families import everything, score
from ivsid.diagnosis.data.channels import channels
from ivsid.diagnosis.estimation.fit import Fit
from ivsid.diagnosis.estimation.kinds.candidate import Scored
from ivsid.diagnosis.estimation.learning import plain_fit
from ivsid.diagnosis.null.family_wise import Threshold
from ivsid.diagnosis.null.thresholds import calibrate
from ivsid.diagnosis.null.visibility import visibility
from ivsid.diagnosis.plant import declared_readings
from ivsid.diagnosis.selection.adequacy import adequacy
from ivsid.effects import EFFECTS
from ivsid.log import Log
from ivsid.programme.scenario import parse_scenario
from ivsid.simulation import simulate
from ivsid.vehicle import parse_vehicle

TABLE = "table = { demand = [-100, -60, -30, 0, 30, 60, 100], thrust = [-30.0, -14.0, -5.0, 0.0, 6.0, 18.0, 40.0] }"
SENSORS = """
[sensors]
confidence = 0.999
[sensors.velocity]
accuracy = 0.006
scale_factor_error = 0.004
[sensors.acceleration]
random_walk = 0.002
bias_instability = 3.0e-4
[sensors.yaw_rate]
random_walk = 1.745e-3
bias_instability = 2.0e-4
[sensors.heading]
accuracy = 0.015
[sensors.position]
accuracy = 0.5
[ambient]
force = 0.15
moment = 0.03
time = 2.0
"""
SHIPPED = frozenset(EFFECTS)


@contextmanager
def white_sensors() -> Iterator[None]:
    """Velocities, headings and positions with noise and a scale alone, and sensors that stand where they are said to."""
    with pytest.MonkeyPatch.context() as only:
        for name in ("LEAST_ARM", "LEAST_TURN"):
            only.setattr(declared_readings, name, 0)
        slow = declared_readings._of
        only.setattr(declared_readings, "_of", lambda accuracy, instability=0.0: slow(0.0, instability))
        yield


HULL = 'name = "boat"\n[hull]\nmass = 50\nlength = 1.2\n'
TWIN = HULL + "".join(
    f'[[thrusters]]\nname = "{name}"\nposition = [-0.35, {y}]\n{TABLE}\naccuracy = {{ absolute = 0.1, relative = 0.02 }}\n'
    for name, y in (("port", -0.28), ("starboard", 0.28))
)
RUDDER = (
    HULL
    + f'[[thrusters]]\nname = "screw"\nposition = [-0.5, 0.0]\n{TABLE}\naccuracy = {{ absolute = 0.1, relative = 0.02 }}\n'
    "rudder = { area = 0.02, aspect_ratio = 1.5, position = -0.55, propeller_diameter = 0.12 }\n"
)
TRUTH = {
    "mass.surge": 58.0,
    "mass.sway": 75.0,
    "inertia.yaw": 9.0,
    "drag.surge.quadratic": 28.0,
    "drag.sway.quadratic": 150.0,
}
STRAIGHT = """
[[segments]]
manoeuvre = "steps"
demand = [60.0, 30.0, 75.0, 45.0]
period = 8.0
yaw_gain = 20.0
duration = 32.0
"""
ZIGZAGS = """
[[segments]]
manoeuvre = "steps"
demand = [60.0, 30.0, 75.0, 15.0]
period = 7.0
yaw_gain = 20.0
duration = 28.0
[[segments]]
manoeuvre = "zigzag"
demand = 45.0
yaw_rate = 0.4
yaw_gain = 25.0
period = 6.0
differential_limit = 25.0
duration = 36.0
[[segments]]
manoeuvre = "coast"
duration = 20.0
[[segments]]
manoeuvre = "circle"
demand = 55.0
yaw_rate = -0.5
yaw_gain = 25.0
differential_limit = 25.0
duration = 30.0
[[segments]]
manoeuvre = "prbs"
demand = 45.0
amplitude = 20.0
differential = 6.0
period = 2.0
yaw_gain = 20.0
duration = 40.0
"""
STEERED = """
[[segments]]
manoeuvre = "prbs"
demand = 50.0
amplitude = 20.0
rudder = 0.3
period = 4.0
duration = 40.0
[[segments]]
manoeuvre = "spiral"
demand = 70.0
rudder = [0.3, 0.15, 0.0, -0.15, -0.3]
period = 8.0
duration = 40.0
[[segments]]
manoeuvre = "prbs"
demand = 70.0
amplitude = 10.0
rudder = 0.2
period = 7.0
duration = 40.0
"""


def vehicle_of(text=TWIN, extra=""):
    return parse_vehicle(text + SENSORS + extra, "boat.toml")


def logs_of(vehicle, effects=None, *, segments=ZIGZAGS, duration=240.0, rate=10.0, seed=21):
    """TRAIN and TEST of the same thrusters."""
    how = {"segments": segments, "duration": duration, "rate": rate, "thrusters": seed}
    return [_log(name, vehicle, effects, seed=number, **how) for name, number in (("train", seed), ("test", seed + 1))]


@cache
def with_a_drag() -> Diagnosis:
    """Diagnosis of a drag of 12 kg/s that is in both logs: one for all files that look at what is made of a finding."""
    vehicle = vehicle_of()
    return diagnose(vehicle, *logs_of(vehicle, {"drag.surge.linear": 12.0}, duration=160.0), null_logs=0)


def train_of(vehicle, effects=None, *, seed=21, **how):
    """TRAIN alone."""
    return _log("train", vehicle, effects, seed=seed, **how)


def logs_of_case(c):
    """TRAIN and TEST of a case of the examination."""
    return [
        Log(f"{k}.csv", str(k) * 64, q["t"], {n: x for n, x in q.items() if n != "t"}) for k, q in enumerate(c.logs, 1)
    ]


def _log(name, vehicle, effects, *, seed, segments=ZIGZAGS, duration=240.0, rate=10.0, thrusters=None):
    # A log is simulated once, unless a user's effects are registered: those may change between two tests.
    known = SHIPPED.issuperset(EFFECTS) and vehicle == parse_vehicle(vehicle.text, vehicle.source)
    how = (tuple((effects or {}).items()), segments, duration, rate, seed, seed if thrusters is None else thrusters)
    t, columns = _remembered(vehicle.text, vehicle.source, *how) if known else _simulated(vehicle, *how)
    return Log(f"{name}.csv", "0" * 64, t.copy(), {k: x.copy() for k, x in columns.items()})


def _simulated(vehicle, effects, segments, duration, rate, number, thrusters):
    head = f"duration = {duration}\nrate = {rate}\nseed = {number}\n[truth]\n"
    head += "".join(f'"{k}" = {v}\n' for k, v in TRUTH.items())
    done = simulate(vehicle, parse_scenario(head + segments, "s.toml"), number, dict(effects), thrusters=thrusters)
    return done.t, done.columns


@cache
def _remembered(text, source, *how):
    return _simulated(parse_vehicle(text, source), *how)


def with_columns(log, change):
    """The log with its columns changed by a function of name and values."""
    return Log(log.name, log.sha256, log.t, {k: change(k, x) for k, x in log.columns.items()})


def rows(log, keep):
    """The log with some of its rows."""
    return Log(log.name, log.sha256, log.t[keep], {k: x[keep] for k, x in log.columns.items()})


def names(result):
    """The causes that are named, alternatives included."""
    return [{f.effect, *f.alternatives} for f in result.findings]


def gaps(log, rng):
    """Four stretches of some seconds without any row."""
    keep = np.ones(log.t.size, dtype=bool)
    for start in rng.integers(0, log.t.size - 100, 4):
        keep[start : start + rng.integers(5, 90)] = False
    return rows(log, keep)


def losses(log, rng):
    """Each measured sample is lost with a probability of 3 %."""
    return with_columns(
        log, lambda k, x: x if k.startswith("demand") else np.where(rng.uniform(size=x.size) < 0.03, np.nan, x)
    )


def wild(log, rng):
    """Six readings of each velocity are off by 1."""

    def hit(k, x):
        if k not in ("u", "v", "r"):
            return x
        out = x.copy()
        out[rng.integers(5, x.size - 5, 6)] += rng.choice([-1.0, 1.0], 6)
        return out

    return with_columns(log, hit)


def epochs(log, rng):
    """Times since 1970."""
    del rng
    return Log(log.name, log.sha256, log.t + 1.7e9, log.columns)


@dataclass(frozen=True)
class Screened:
    """The stages before the selection: what is known of a log when the first cause is looked for.

    Attributes:
        fit: of the vehicle's own model, with the columns of every candidate.
        scores: of every candidate, the best first.
        passed: the ids of those that pass the calibrated threshold, the best first.
        quiet: whether the dictionary of the adequacy test finds no more than chance in what the model leaves.
    """

    fit: Fit
    scores: list[Scored]
    passed: list[str]
    quiet: bool

    def of(self, id_):
        """The score of a candidate."""
        return next(s for s in self.scores if s.id == id_)


def screened(vehicle, train):
    """Data, plant, prediction, estimation, candidates and null in turn; about a third of a whole diagnosis."""
    fit = plain_fit(vehicle, channels(train, vehicle), everything)
    visible = visibility(fit)
    seen = frozenset(i for i, v in visible.items() if v.tested)
    passes = Threshold(calibrate(fit, seen, 0.005, 1), visible)
    fit, scores = score(fit)
    return Screened(fit, scores, [s.id for s in passes(fit, scores).passed], adequacy(fit).quiet)
