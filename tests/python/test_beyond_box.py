"""Causes at thrusters beside errors that keep their bounds: the direction beyond the box, its level, and causes that soft priors hide."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import lsq_linear
from scipy.stats import binom, chi2
from tests.exam import cases

from diagnosis_logs import logs_of_case, screened, white_sensors
from ivsid.diagnosis import diagnose
from ivsid.diagnosis.null.any_curve import AnyCurve
from ivsid.diagnosis.null.beyond_box import BeyondBox
from ivsid.diagnosis.null.directions import Directions
from ivsid.diagnosis.null.round import Round
from ivsid.diagnosis.null.screening import chance
from ivsid.diagnosis.null.visibility import visibility
from ivsid.vehicle import parse_vehicle
from test_thrust_errors import calm, log_of


@pytest.fixture(scope="module", params=[(955, "two_waves"), pytest.param((950, "hump"), marks=pytest.mark.nightly)])
def wrong(request):
    """A log whose thrust errors are three times their accuracy."""
    c = calm(*request.param, 3.0, duration=300.0, train_alone=True)
    return screened(c.vehicle, log_of(c.train))


@pytest.fixture(scope="module")
def white():
    """The same by sensors whose errors are noise."""
    with white_sensors():
        c = calm(955, "two_waves", 3.0, duration=300.0, train_alone=True)
        return screened(c.vehicle, log_of(c.train))


def standing(free, total, prior, D):
    """Standard deviations by which a cause at a size stands beyond the worst errors in a direction, and the deviation of its noise."""
    base = free.projection.base
    moved = total[base] @ D
    names = [free.g.names[k] for k in base]
    knots = np.array([n.startswith(("~thrust.", "~hysteresis.")) for n in names])
    soft = (free.box == 0) & ~knots & (prior[base] > 0)
    return float(free.worst(moved)), float(np.sqrt(D @ total @ D + np.sum(moved[soft] ** 2 / prior[base][soft])))


@pytest.mark.parametrize(
    ("name", "amount"), [("thruster.asymmetry", 500.0), ("thruster.curve", 500.0), ("thruster.curve", 1000.0)]
)
def test_the_direction_beyond_the_box_parts_a_cause_from_all_errors_inside_it(wrong, white, name, amount):
    """Its standing is at most the distance from the box by a general solver, which is the best of any direction, and hardly less."""
    parts_from_all_errors(white.fit, name, amount, 0.85)
    # Slow errors of readings, which have no box, follow the cause as well: 0.84 of the distance is left.
    parts_from_all_errors(wrong.fit, name, amount, 0.83)


def parts_from_all_errors(fit, name, amount, share):
    """What the direction of one cause shows, at least as a share of what the best of all directions does."""
    free = AnyCurve(fit)
    g = free.joined([name])
    total, base = g.total, np.array(free.projection.base)
    size = np.zeros(len(g.names))
    size[-1] = amount
    D = BeyondBox(free).of(total, size)
    worst, noise = standing(free, total, g.prior, D)
    shown = (D @ total @ size - worst) / noise
    free_ones = base[(g.prior[base] == 0) & (free.box == 0)]
    assert np.abs(total[free_ones] @ D).max() < 1e-6 * noise
    # The oracle: errors by the demand alone inside the box, all at once, with the numbers of the model and soft errors free.
    names = [g.names[k] for k in base]
    at = [
        i for i, n in enumerate(names) if not n.startswith(("~thrust.", "~hysteresis.", "~inflow.", "~late.", "~stop."))
    ]
    cols = base[at]
    N = total[np.ix_(cols, cols)] + np.diag(np.where(free.box[at] > 0, 1e-9, g.prior[cols] + 1e-9))
    root = np.linalg.cholesky(N)
    target = np.linalg.solve(root, total[cols] @ size)
    bound = np.where(free.box[at] > 0, np.maximum(free.box[at], 1e-12), np.inf)
    left = 2 * lsq_linear(root.T, target, (-bound, bound)).cost + size @ total @ size - target @ target
    assert 0 < shown <= np.sqrt(left) * (1 + 1e-3)
    # It shows nearly all of that, and more than the directions of weighted priors by which a change of a curve is asked for.
    assert shown >= share * np.sqrt(left)
    for weight in (10.0, 1.0):
        other = Directions(free).direction(total, [len(g.names) - 1], weight)[:, 0]
        most, deviation = standing(free, total, g.prior, other)
        assert shown > 1.5 * (other @ total @ size - most) / deviation
    # Where no error stands at its bound there is no direction.
    free.box = 1e6 * free.box
    assert not np.any(BeyondBox(free).of(total, size))


@pytest.mark.nightly
@pytest.mark.parametrize("name", ["thruster.asymmetry", "thruster.curve"])
def test_the_worst_errors_stand_beyond_the_box_as_rarely_as_stated(wrong, name):
    """The size is estimated from the same log. Errors at their ends that are the worst for the cause, and noise, by draws of all scores."""
    fit = wrong.fit
    free = AnyCurve(fit)
    g = free.joined([name])
    total, base = g.total, np.array(free.projection.base)
    values, vectors = np.linalg.eigh(total)
    root = vectors * np.sqrt(np.maximum(values, 0.0))
    first, last = np.zeros(len(g.names)), len(g.names) - 1
    first[last] = 500.0
    p = np.r_[base, last]
    normal = total[np.ix_(p, p)] + np.diag(g.prior[p] + 1e-9)
    moved = total[base] @ BeyondBox(free).of(total, first)
    worst_ones = np.zeros(len(g.names))
    worst_ones[base] = free.worst_errors(moved)
    candidates = [worst_ones]
    # Of errors of one kind at their ends, those that look most like the cause: soft priors hand the worst of all to the plays, and none to the cause.
    of_thrusts = np.array([g.names[k].startswith(("~cell.", "~inflow.", "~late.", "~stop.")) for k in base])
    for kind in ("~cell.", "~inflow."):
        own = ~of_thrusts | np.array([g.names[k].startswith(kind) for k in base])
        errors = np.zeros(len(g.names))
        errors[base] = np.where(own, np.sign(moved) * free.box, 0.0)
        candidates.append(errors)
    ends = max(candidates, key=lambda e: abs(np.linalg.solve(normal, (total @ e)[p])[-1]))
    rng = np.random.default_rng(3)
    stood, draws, asked = 0, 300, 0
    for _ in range(draws):
        score = total @ ends + root @ rng.standard_normal(len(values))
        size = np.zeros(len(g.names))
        size[last] = np.linalg.solve(normal, score[p])[-1]
        D = BeyondBox(free).of(total, size)
        if not np.any(D):
            continue
        asked += 1
        worst, noise = standing(free, total, g.prior, D)
        stood += (D @ score - worst) / noise > chi2.isf(0.05, 1) ** 0.5
    # Two-sided five per cent, of which the worst errors leave one side.
    assert asked > draws / 2 and stood <= binom.ppf(0.999, draws, 0.05)


def test_a_fall_beside_errors_that_keep_their_bounds_is_tested_where_it_is_the_larger(wrong):
    """A thrust error three times its accuracy leaves the log no curve, so that causes at thrusters are asked for in the box."""
    here = Round(wrong.fit, wrong.scores, 1e-4, visibility(wrong.fit))
    s = replace(wrong.of("thruster.curve"), fall=10.0, boxed=0.0, physical=True)
    held = here.in_box(s)
    assert held.boxed == here.reached.of(s) and held.shown == max(10.0, held.boxed)
    assert chance(replace(s, boxed=50.0)) == chance(replace(s, fall=50.0)) < chance(s)
    # No question where a cause hardly stands out, has an impossible sign, or does not act at a thruster.
    assert here.in_box(replace(s, fall=4.0)).boxed == 0.0 == here.in_box(replace(s, physical=False)).boxed
    assert here.in_box(replace(wrong.of("drag.surge.linear"), fall=10.0, physical=True)).boxed == 0.0


# Nightly: whole diagnoses of logs of 300 s.
@pytest.mark.nightly
@pytest.mark.parametrize(
    ("seed", "drawn"),
    [
        (96090, {}),
        # The catalogue has grown since three further seeds drew a gain and two asymmetries: these are drawn by name.
        (96090, {"effect": "thruster.gain", "z": 15.0}),
        (96090, {"effect": "thruster.asymmetry", "z": 15.0}),
        (89036, {"effect": "thruster.asymmetry", "z": 15.0}),
    ],
)
def test_a_gain_and_an_asymmetry_little_beyond_the_accuracy_are_named(seed, drawn):
    """Each was `adequate` or `unknown` while the errors had soft priors alone; the accuracy is 2 %, and the examiner's z is 10 to 24."""
    c = cases.case(seed, duration=300.0, **drawn)
    vehicle = parse_vehicle(c.text, "vehicle.toml")
    (found,) = diagnose(vehicle, *logs_of_case(c)).findings
    assert {*c.hidden} <= {found.effect, *found.alternatives}
