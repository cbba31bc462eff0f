"""The largest drag that the power of a log allows: a balance of energy by hand, and no drag of a simulated hull beyond it."""

from dataclasses import replace

import numpy as np
import pytest

from diagnosis_logs import STRAIGHT, TRUTH, train_of, vehicle_of
from ivsid.diagnosis.candidates.families import everything
from ivsid.diagnosis.data.channels import channels
from ivsid.diagnosis.estimation.learning import plain_fit
from ivsid.diagnosis.statements.power import largest_drag
from ivsid.effects import EFFECTS, Given

DEMANDS, THRUSTS = (-100, -60, -30, 0, 30, 60, 100), (-30.0, -14.0, -5.0, 0.0, 6.0, 18.0, 40.0)


def fitted(vehicle, **given):
    log = train_of(vehicle, **given)
    return log, plain_fit(vehicle, channels(log, vehicle), everything)


def term_of(fit, id_):
    return next(t for t in fit.h.terms if t.id == id_)


@pytest.mark.parametrize("seed", range(3))
def test_no_true_drag_is_beyond_the_power_of_its_log(seed):
    vehicle = vehicle_of()
    _, fit = fitted(vehicle, duration=120.0, seed=seed)
    for id_ in ("drag.surge.quadratic", "drag.sway.quadratic"):
        assert largest_drag(fit, term_of(fit, id_), {}) > TRUTH[id_]


def test_on_a_straight_course_the_end_is_the_drag_itself():
    """Nothing else takes power there, so that accuracies of the thrusts and the ambient force are all that it lacks."""
    vehicle = vehicle_of()
    log, fit = fitted(vehicle, segments=STRAIGHT, duration=120.0)
    term = term_of(fit, "drag.surge.quadratic")
    words = [t.words for t in vehicle.thrusters]
    none, one, ten = (largest_drag(fit, term, dict.fromkeys(words, off)) for off in (0.0, 1.0, 10.0))
    assert 1.0 < one / TRUTH["drag.surge.quadratic"] < 1.35
    # By hand: thrusts by straight lines through the table, along the readings of the log.
    u, r = (log.columns[k] for k in "ur")
    work = errors = 0.0
    for name, y in (("port", -0.28), ("starboard", 0.28)):
        thrust = np.interp(log.columns[f"demand_{name}"], DEMANDS, THRUSTS)
        bound = np.minimum(0.1 + 0.02 * np.abs(thrust), np.abs(thrust))
        work += np.sum(thrust * (u - y * r))
        errors += np.sum(bound * np.abs(u - y * r))
    taken = np.sum(np.abs(u) ** 3)
    assert one - none == pytest.approx(errors / taken, rel=0.04) and ten - one == pytest.approx(9 * (one - none))
    # Each thrust is as far off as its own curve, and both are alike here.
    assert largest_drag(fit, term, {words[0]: 10.0}) - one == pytest.approx((ten - one) / 2, rel=0.02)
    assert largest_drag(fit, term, {}) == one
    # Readings are off by 6 mm/s at most, 2 % of their cubes; the rest are the ambient force and the energy at the start.
    assert 0.96 < none / (work / taken) < 1.15


def test_what_may_drive_has_no_end_by_power():
    """A mass takes power at one moment and gives it at another."""
    vehicle = vehicle_of()
    _, fit = fitted(vehicle, duration=120.0)
    assert largest_drag(fit, term_of(fit, "mass.surge"), {}) == np.inf


def test_what_was_found_may_drive_as_well():
    """A pull from one of two far sides goes with the motion, and its work is the drag's; the other side takes nothing from the thrusters."""
    vehicle = vehicle_of()
    _, fit = fitted(vehicle, segments=STRAIGHT, duration=120.0)
    term = term_of(fit, "drag.surge.quadratic")
    bare = largest_drag(fit, term, {})
    ends = []
    for side in (1e4, -1e4):
        pulled = fit.h.with_effect(Given(EFFECTS["tether.tension"], (5.0, side, 0.0, 0.0)))
        ends.append(largest_drag(replace(fit, states=fit.states.under(pulled)), term, {}))
    along = float(np.abs(np.mean(fit.states.points.nu[0] * np.cos(fit.states.points.psi))))
    cubes = float(np.mean(np.abs(fit.states.points.nu[0]) ** 3))
    assert min(ends) == pytest.approx(bare) and max(ends) == pytest.approx(bare + 5.0 * along / cubes, rel=0.02)
