"""Known forces of a vehicle without thrusters: their stated accuracy is one of any error that follows any of them."""

from dataclasses import replace

import numpy as np
import pytest

from diagnosis_logs import HULL, SENSORS, TWIN, logs_of, screened, train_of, vehicle_of
from ivsid import diagnose
from ivsid.diagnosis.data.channels import channels
from ivsid.diagnosis.estimation.noise import absolute_force, declared_ambient
from ivsid.diagnosis.plant.physics import Hypothesis
from ivsid.diagnosis.prediction.innovations import Predictor
from ivsid.diagnosis.selection.adequacy import adequacy
from ivsid.diagnosis.statements.diagnosis import extended_vehicle
from ivsid.diagnosis.statements.unknown import unknown
from ivsid.effects import EFFECTS, terms_of
from ivsid.vehicle import parse_vehicle, with_known_forces

ARM = 0.28
DEMAND, THRUST = (-100, -60, -30, 0, 30, 60, 100), (-30.0, -14.0, -5.0, 0.0, 6.0, 18.0, 40.0)


def pushed(absolute=0.1, relative=0.02):
    """The boat without its thrusters, whose thrusts are off by so much each; by nothing that the file states if both are none."""
    force = 2 * (absolute + relative * max(THRUST))
    stated = f"[sensors.force]\naccuracy = {force}\n[sensors.moment]\naccuracy = {ARM * force}\n" if force else ""
    return parse_vehicle(HULL + SENSORS + stated, "pushed.toml")


def known(log):
    """The log with the forces of its thrust tables in the place of its demands, whose thrusts were off inside their accuracy."""
    columns = {k: x for k, x in log.columns.items() if not k.startswith("demand")}
    port, starboard = (np.interp(log.columns[f"demand_{name}"], DEMAND, THRUST) for name in ("port", "starboard"))
    forces = {"force_X": port + starboard, "force_Y": 0.0 * port, "moment_N": ARM * (port - starboard)}
    return replace(log, columns={**columns, **forces})


def test_a_known_force_pushes_as_it_is_logged():
    """Oracle: the logged force over the steps, to the rounding of its arm."""
    vehicle, log = pushed(), known(train_of(vehicle_of(), duration=70.0))
    data = channels(log, vehicle)
    predictor = Predictor(with_known_forces(vehicle), data, declared_ambient(vehicle))
    _, force = predictor.driving.force(Hypothesis(terms_of(vehicle), {t.id: 1.0 for t in terms_of(vehicle)}))
    rows = slice(10, data.n)
    for k, name in enumerate(("force_X", "force_Y", "moment_N")):
        logged = np.interp(data.t, log.t - log.t[0], log.columns[name])
        np.testing.assert_allclose(force[k, : data.n][rows], logged[rows], atol=1e-4)


def test_errors_inside_the_stated_accuracy_make_no_finding():
    """A moment that follows the thrust ahead, as of two unlike thrusters, was a centre of gravity to the side."""
    found = screened(pushed(), known(train_of(vehicle_of())))
    assert found.passed == [] and found.quiet
    assert not any(EFFECTS[s.id].acts.at_thruster for s in found.scores)


@pytest.mark.nightly
def test_forces_that_are_exact_by_the_file_show_their_errors():
    """Twice the errors of the test above: beside 160 regressors a single one has to stand out farther than beside 130."""
    twin = vehicle_of(TWIN.replace("absolute = 0.1, relative = 0.02", "absolute = 0.2, relative = 0.04"))
    found = screened(pushed(0.0, 0.0), known(train_of(twin)))
    assert found.passed or not found.quiet


# The whole diagnosis, with the file of the extended model.
@pytest.mark.slow
def test_a_cause_is_named_beside_known_forces():
    hidden = {"drag.yaw.linear": 6.0}
    twin = vehicle_of(TWIN.replace("absolute = 0.1, relative = 0.02", "absolute = 0.03, relative = 0.005"))
    result = diagnose(pushed(0.03, 0.005), *(known(log) for log in logs_of(twin, hidden)), null_logs=0)
    (one,) = result.findings
    assert one.effect == "drag.yaw.linear"
    (bound,) = one.parameters.values()
    assert bound.lower < 6.0 < bound.upper
    assert result.vehicle.thrusters == () and parse_vehicle(extended_vehicle(result), "e.toml").thrusters == ()


def test_a_known_force_is_as_accurate_as_it_is_stated_once():
    """Nine parts of errors are three forces, and a moment at a long arm is none."""
    whole = pushed()
    assert absolute_force(with_known_forces(whole)) == pytest.approx(2 * whole.sensors.force.accuracy)
    turned = parse_vehicle(HULL + SENSORS + "[sensors.moment]\naccuracy = 0.3\n", "turned.toml")
    assert absolute_force(with_known_forces(turned)) == absolute_force(turned) > 0.1


def test_sentences_on_known_forces_speak_of_no_curve():
    """Errors of three times the stated accuracy: what is off, and the test that shows it."""
    log = known(train_of(vehicle_of()))
    push = log.columns["force_X"]
    wrong = replace(log, columns={**log.columns, "force_X": push + 4.0 * np.sin(0.3 * push)})
    left = screened(pushed(), wrong).fit
    found = adequacy(left)
    text = unknown(found, []).description
    # A thrust that is far outside drags the others along.
    beyond = replace(found, leaving=1000.0, knots=10)
    far = replace(beyond, outside=(("port", 4.3), ("bow", 44.8), ("stern", 2.8)))
    near = replace(beyond, outside=(("port", 4.3), ("bow", 5.2)))
    said = [unknown(one, []).description for one in (far, near)]
    assert "bow (fitted at 44.8 times its accuracy, and no other at more than 4.3 times) is off" in said[0]
    assert "bow (fitted at 5.2 times its accuracy) and port (fitted at 4.3 times its accuracy) is off" in said[1]
    assert "known force_X" in text and not any(word in text for word in ("curve", "bollard", "thruster"))
