"""Hidden effects that the examiner reckons visible and the scores lost: the ambient force on the fitted masses, anchors beside a track, directions
of a cause beside any thrust curve, cells that are fine enough, and values between those of a grid."""

from contextlib import nullcontext
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pytest
from scipy.optimize import lsq_linear
from scipy.stats import chi2
from tests.exam.cases import case
from tests.exam.seal import seal

from diagnosis_logs import white_sensors
from ivsid.diagnosis.candidates.families import everything, score
from ivsid.diagnosis.data.channels import channels
from ivsid.diagnosis.estimation.learning import plain_fit
from ivsid.diagnosis.estimation.noise import declared_ambient
from ivsid.diagnosis.estimation.projection import Projection
from ivsid.diagnosis.null.any_curve import AnyCurve, beyond, is_declared
from ivsid.diagnosis.null.directions import Directions, as_rare, distance
from ivsid.diagnosis.null.inside_cells import FINER, inside_cells
from ivsid.diagnosis.null.round import Round
from ivsid.diagnosis.null.screening import FAINT
from ivsid.diagnosis.null.visibility import EXCITED, excitation
from ivsid.log import read_log
from ivsid.vehicle import read_vehicle


@cache
def scored(seed, *, white=False, **given):
    """Fit of the plain model to a case's first log, with the scores of all causes by id; ``white``: by sensors whose errors are noise."""
    with TemporaryDirectory() as one, TemporaryDirectory() as two:
        folder = seal(case(seed, duration=300.0, **given), Path(one), Path(two))
        vehicle = read_vehicle(folder / "vehicle.toml")
        log = channels(read_log(folder / "1.csv", vehicle.log), vehicle)
    with white_sensors() if white else nullcontext():
        fit, found = score(plain_fit(vehicle, log, everything))
    return fit, {s.id: s for s in found}


# Nightly: one of the causes that an examination missed; the gate keeps seven of them.
@pytest.mark.nightly
def test_the_declared_force_moves_the_water_along_with_the_hull():
    """With the inertia of the dry hull the ambient moment of this log was twice what was declared, and a drag of 11 standard deviations lost in it."""
    fit, found = scored(85308)
    vehicle, masses = fit.noise.predictor.vehicle, fit.h.values
    said, dry = declared_ambient(vehicle, masses), declared_ambient(vehicle)
    assert said.deviation == pytest.approx(
        (
            vehicle.ambient.force / masses["mass.surge"],
            vehicle.ambient.force / masses["mass.sway"],
            vehicle.ambient.moment / masses["inertia.yaw"],
        )
    )
    assert all(a < b for a, b in zip(said.deviation, dry.deviation, strict=True))
    # A mass that the model does not hold by its own name stays that of the hull.
    assert declared_ambient(vehicle, {}).deviation == dry.deviation
    assert found["drag.yaw.linear"].fall > 60.0


# Nightly: one of the causes that an examination missed; the gate keeps seven of them.
@pytest.mark.nightly
def test_an_anchor_beside_a_straight_track_is_found():
    """The best anchors of the grid lay ahead and pushed, because every fourth sample of the errors stood for all: aliases were summed."""
    _, found = scored(85095)
    tether = found["tether.tension"]
    assert tether.physical and tether.fall > 200.0
    pull, north, east, _ = tether.values
    assert pull == pytest.approx(110.0, rel=0.2) and np.hypot(north - 30.2, east + 2.0) < 80.0


def test_the_distance_from_all_errors_is_that_of_the_nearest_and_no_more():
    """The oracle is least squares inside a box, for errors of the demand alone."""
    fit, _ = scored(85308)
    free, rng = AnyCurve(fit), np.random.default_rng(7)
    others = ("~inflow.", "~late.", "~stop.")
    free.box[[i for i, k in enumerate(free.projection.base) if free.g.names[k].startswith(others)]] = 0.0
    for scale in (0.02, 0.1):
        moved = scale * rng.standard_normal((3, free.box.size)) / np.maximum(free.box, 1e-9)
        z = 20.0 * rng.standard_normal(3)
        nearest = np.sqrt(2.0 * lsq_linear(moved * free.box, z, bounds=(-1.0, 1.0)).cost)
        found = distance(free, moved, z)
        assert found <= nearest * (1 + 1e-9) + 1e-6 and found >= 0.97 * nearest - 1e-2
    # Errors inside their bounds are at no distance.
    inside = moved @ (free.box * rng.uniform(-1.0, 1.0, free.box.size))
    assert distance(free, moved, inside) == 0.0


def test_a_fall_far_beyond_the_smallest_chance_stays_as_large():
    """A lag of 170 standard deviations had no more than 1,370 left of 26,000, and its full fit none."""
    assert as_rare(1, 1, 30.0) == pytest.approx(30.0) and as_rare(1, 2, 30.0) == pytest.approx(
        chi2.isf(chi2.sf(30.0, 2), 1)
    )
    assert as_rare(1, 1, 30.0, 2) == pytest.approx(chi2.isf(2 * chi2.sf(30.0, 1), 1))
    assert 0.97 * 26000.0 < as_rare(1, 2, 26000.0, 2) <= 26000.0 and as_rare(2, 1, 26000.0) <= 26000.0
    grown = [as_rare(1, 2, x, 2) for x in np.linspace(1300.0, 1450.0, 40)]
    assert np.all(np.diff(grown) > -2.0) and as_rare(1, 3, 0.0) == 0.0


# Nightly: the same projection stands in the distance from all errors, above, and beside teeth, below.
@pytest.mark.nightly
@pytest.mark.parametrize(("seed", "id_"), [(83161, "thruster.reverse_loss")])
def test_a_cause_stands_by_the_direction_that_shows_it(seed, id_):
    """In the one direction of the prior the worst errors took this cause of 18 standard deviations whole.

    A current of 8 mm/s to and fro stood here as well, until a velocity might be wrong by its accuracy of 6 mm/s: nothing is left of it now.
    """
    fit, found = scored(seed)
    free, s = AnyCurve(fit), found[id_]
    g, columns = free.beside(s)
    p = Projection(g, free.projection.base)
    theta, fall = p.solve(columns)
    assert beyond(fall, float(free.worst(p.held_back(columns) @ theta))) < 12.0
    assert Directions(free).left(s) > 40.0
    # Errors without a bound leave nothing of either.
    free.box = 1e6 * free.box
    assert Directions(free).left(s) == 0.0


def test_teeth_inside_a_cell_are_no_cause_in_time():
    """On a circle, whose demands drift, a saw's teeth at their bounds were a fouling of 11 standard deviations beside usual cells.

    Beside biases of seven shapes fouling and failure keep 26 and 28 in chi-squared there, of 34 and 32 beside three; finer cells leave nothing of either.
    """
    fit, found = scored(82106, what="none", thrust="sawtooth", share=1.0)
    here = Round(fit, tuple(found.values()), 1e-4, {})
    for id_ in ("fouling.drift", "thruster.failure"):
        assert inside_cells(fit, found[id_]) and here.left(found[id_]) < 1.0
        assert Directions(AnyCurve(fit)).left(found[id_]) > 25.0
    count = [sum(n.startswith("~cell.") for n in free.g.names) for free in (here.curve, here.finer_directions.free)]
    assert count[0] < count[1] <= FINER * count[0]
    assert not inside_cells(fit, found["drag.surge.linear"])


# Nightly: one of the causes that an examination missed; the gate keeps some of them.
@pytest.mark.nightly
def test_a_failure_inside_the_accuracy_stands_beside_any_curve():
    """A curve does not change in time, so that a loss of 2 % at a moment is none of its errors."""
    fit, found = scored(85288)
    assert inside_cells(fit, found["thruster.failure"])
    assert Round(fit, tuple(found.values()), 1e-4, {}).left(found["thruster.failure"]) > 60.0


# Nightly: the gate holds teeth against usual cells, above.
@pytest.mark.nightly
def test_a_failure_beyond_the_accuracy_stands_beside_usual_cells():
    """On a straight run the finer cells of a demand that hardly changes would take it.

    The loss is 7 % of the thrust. One of 5 % is estimated below twice the accuracy of 2 %, and is held against these finer cells by that rule.
    """
    fit, found = scored(85286, size=0.6)
    failure = found["thruster.failure"]
    left = Round(fit, tuple(found.values()), 1e-4, {}).left(failure)
    # Of 41 without plays among the errors 33 are left.
    assert not inside_cells(fit, failure) and left > 30.0
    assert left > 2.0 * Directions(AnyCurve(fit, finer=FINER)).left(failure)


# Nightly: one of the causes that an examination missed; the gate keeps some of them.
@pytest.mark.nightly
def test_a_dead_band_between_two_values_of_its_grid_has_its_whole_fall():
    """At the nearest value of the grid a fifth of the fall was left, which a curve inside its accuracy takes."""
    fit, found = scored(85214)
    band = found["thruster.deadband"]
    assert band.values[0] == pytest.approx(5.392, rel=0.03) and band.fall > 280.0
    assert Round(fit, tuple(found.values()), 1e-4, {}).left(band) > 12.0
    assert band.looks > 1.0 + 0.3 * len(band.candidate.variants)


# Nightly: one of the causes that an examination missed; the gate keeps some of them.
@pytest.mark.nightly
def test_teeth_that_jump_are_no_dead_band():
    fit, found = scored(82105, what="none", thrust="sawtooth", share=1.0)
    assert Round(fit, tuple(found.values()), 1e-4, {}).left(found["thruster.deadband"]) < 1.0


# Nightly: the gate has the curves of one velocity in test_speed_curves.py.
@pytest.mark.nightly
def test_a_cubic_drag_is_seen_by_what_other_drags_leave_of_its_error():
    """Beside r and r|r| little is left of the slope of r^3, so that a drag of 12 standard deviations is no sensor's noise."""
    # Errors of heading and velocities inside their accuracies take a third of its fall.
    for white, least in ((True, 100.0), (False, 80.0)):
        fit, found = scored(132142, white=white)
        assert found["drag.yaw.cubic"].fall > least and excitation(fit)["drag.yaw.cubic"] > 2.0 * EXCITED
    # On a straight line the yaw rate is the gyro's noise, whatever stands beside it.
    fit, _ = scored(140010, what="one")
    assert excitation(fit)["drag.cross_flow"] < EXCITED


# Nightly: one of the causes that an examination missed; the gate keeps seven of them.
@pytest.mark.nightly
def test_a_scale_beyond_its_bound_is_held_against_the_bound():
    """Its prior, a third of the bound, took a scale of 1.7 bounds and 8.6 standard deviations down to a fall of 24."""
    fit, found = scored(132096, white=True)
    s = found["sensor.velocity.scale"]
    here = Round(fit, tuple(found.values()), 1e-4, {})
    assert is_declared(here.fit, s) and s.fall < FAINT and here.in_box(s).boxed > 3.0 * FAINT
    # A position that may be off by its accuracy leaves 5 of that on this circle, and enough of a scale of 4 bounds.
    fit, found = scored(132096, size=0.8)
    s = found["sensor.velocity.scale"]
    here = Round(fit, tuple(found.values()), 1e-4, {})
    assert is_declared(here.fit, s) and here.in_box(s).boxed > max(1.8 * s.fall, 3.0 * FAINT)
    # Sensors may stand elsewhere by a thousandth of the hull's length, too.
    mounted = {"sensor.velocity.lever_arm", "sensor.velocity.misalignment", "sensor.acceleration.lever_arm"}
    others = [q for q in found.values() if not q.candidate.effect.acts.at_thruster and q.id != s.id]
    assert {q.id for q in others if is_declared(here.fit, q)} == mounted
    # A bound that holds the scale leaves nothing of it.
    wide = AnyCurve(fit)
    wide.box = np.where([wide.g.names[k].startswith("~scale.") for k in wide.projection.base], 5.0, 1.0) * wide.box
    assert Directions(wide).left(s) < 4.0
