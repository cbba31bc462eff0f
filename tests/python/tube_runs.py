"""Runs for the tests of tubes: a fit, a twin of its vehicle, and trajectories of members of the fit."""

import numpy as np
import pytest

from conftest import as_log, embedded
from ivsid import identify
from ivsid.intervals import IntervalArray
from ivsid.linear.trajectories import Model
from ivsid.programme.scenario import parse_scenario
from ivsid.simulation import simulate
from ivsid.tubes.equations import equations_of
from ivsid.tubes.given import straight
from ivsid.tubes.horizons import start_of
from ivsid.tubes.inputs import course_of
from ivsid.tubes.parameters import blocks_of
from ivsid.vehicle import parse_vehicle
from tube_oracle import integrate, shapes

SWAN = parse_vehicle(embedded("swan.toml"), "swan.toml")
REACH = 0.5


@pytest.fixture(scope="module", name="fit")
def fit_of(once):
    """A fit of SWAN to a minute and a half of its shipped trial."""

    def make(_):
        text = embedded("swan_train.toml").replace("duration = 300.0", "duration = 90.0", 1)
        made = simulate(SWAN, parse_scenario(text, "train"))
        return identify(SWAN, as_log(made), examine=False)

    return once("tube-fit", make)


@pytest.fixture(scope="module", name="twin")
def twin_of(once):
    """Another minute of the same vehicle."""

    def make(_):
        text = embedded("swan_test.toml").replace("duration = 300.0", "duration = 60.0", 1)
        return simulate(SWAN, parse_scenario(text, "test"))

    return once("tube-twin", make)


@pytest.fixture(scope="module", name="test_log")
def log_of(twin):
    """The twin's log."""
    return as_log(twin)


@pytest.fixture(scope="module", name="course")
def course_of_log(test_log):
    """Inputs and readings of the twin's log."""
    return course_of(SWAN, test_log)


def thrusts(log, rows):
    """Thrusts without errors, from the file's table by SciPy's own interpolation, over each step."""
    from scipy.interpolate import PchipInterpolator

    table = SWAN.thrusters[0].table
    curve = PchipInterpolator(table.demand, table.thrust)
    found = []
    for t in SWAN.thrusters:
        d = log.columns[f"demand_{t.name}"][rows][:-1]
        found.append(np.where(d < table.demand[0], d * table.thrust[0] / table.demand[0], curve(np.maximum(d, 15.0))))
    return np.stack(found, axis=1)


def members(rng, fit, k):
    """Parameters inside the polytope: its vertices first, then convex combinations."""
    blocks = {i: b for b in blocks_of(fit, fit.parameters) for i in b.ids}
    pair, single = blocks["mass.surge"], blocks["inertia.yaw"]
    v = np.array([[float(x) for x in p] for p in pair.vertices])
    weights = rng.dirichlet(np.full(len(v), 0.3), k)
    weights[: len(v)] = np.eye(len(v))[:k]
    m, d = (weights @ v).T
    ends = [float(p[0]) for p in single.vertices]
    share = rng.choice([0.0, 1.0, 0.5], k)
    return m, d, ends[0] + share * (ends[-1] - ends[0])


def starts(rng, box, k):
    """Starts inside a box: corners for half of the members."""
    share = np.where(rng.random((6, k)) < 0.5, rng.integers(0, 2, (6, k)), rng.random((6, k)))
    inside = box.lower[:, None] + share * (box.upper - box.lower)[:, None]
    return np.clip(inside, box.lower[:, None], box.upper[:, None])


def escapes(bounds, states):
    """Number of samples outside, of bounds of shape (n, 6) and states of shape (n, 6, k)."""
    return int(((states < bounds.lower[:, :, None]) | (states > bounds.upper[:, :, None])).sum())


def examined(rng, fit, course, first, count, k, channels="all"):
    """Bounds and states of one window."""
    alone = channels == "straight"
    equations = equations_of(fit, (True, not alone, not alone))
    given = straight(course) if alone else None
    rows = slice(first, first + count + 1)
    bounds = followed(equations.model, course, first, count, given)
    box = start_of(course, first, given)
    t = course.log.t[rows]
    states = integrate(
        starts(rng, box, k),
        *members(rng, fit, k),
        t,
        thrusts(course.log, rows),
        shapes(rng, k, t, REACH * (1 - 1e-12), 3.0),
        straight=alone,
    )
    return bounds, states


def followed(model: Model, course, first, count, given=None, force=None):
    steps = slice(first, first + count)
    return model.follow(
        start_of(course, first, given),
        course.h[steps],
        (course.force if force is None else force)[steps],
        None if given is None else given[steps],
    ).bounds


def wide(course, first):
    """A start that turns at any rate up to 4 rad/s, either way."""
    box = start_of(course, first, None)
    lower, upper = box.lower.copy(), box.upper.copy()
    lower[2], upper[2] = -4.0, 4.0
    return IntervalArray(lower, upper)
