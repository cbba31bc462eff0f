"""Passes of the filters settle where the whole of each would go too far."""

import re

import numpy as np
import pytest

from diagnosis_logs import TRUTH, logs_of, vehicle_of
from ivsid import diagnose
from ivsid.diagnosis.data.channels import channels
from ivsid.diagnosis.estimation.noise import CONTRACTION, QUICKENING, quick_enough
from ivsid.diagnosis.plant.physics import Hypothesis
from ivsid.diagnosis.prediction.axes import Ambient
from ivsid.diagnosis.prediction.innovations import Predictor
from ivsid.diagnosis.prediction.passes import LEFT, MOST, handed_on, passes
from ivsid.effects import CATALOGUE
from ivsid.log import Log
from ivsid.vehicle import parse_vehicle

# A log of velocities that is poor beside accelerometers: these tell the ambient force at once, and a filter of velocities forgets within seconds.
POOR, TERMS = 0.09, [*TRUTH, "drag.yaw.linear"]
# A calm sea: ambient accelerations [m/s^2, rad/s^2], and their correlation times [s].
CALM = Ambient((0.001, 0.0005, 0.001), (5.0, 5.0, 4.0))
HIDDEN = {"drag.yaw.linear": 5.0, "coupling.cg_x": -3.0}


def of(accuracy):
    """The vessel in a sea that its file does not state, with velocities of this accuracy [m/s]."""
    text = re.sub(r"\[ambient\]\n(?:[a-z_]+ = .*\n)+", "", vehicle_of().text)
    text = text.replace("accuracy = 0.006", f"accuracy = {accuracy}")
    return parse_vehicle(f"{text}\n[model]\nterms = {TERMS}\n", "poor.toml")


@pytest.fixture(scope="module")
def poor():
    return of(POOR)


def truth():
    values = {**TRUTH, **HIDDEN}
    return Hypothesis(tuple(CATALOGUE[i] for i in values), values, ())


def test_a_part_of_the_way_leaves_little_of_what_a_first_order_filter_hands_on():
    frequencies = np.r_[0.0, np.geomspace(1e-3, 1e3, 400)]
    for radius in (1.1, 2.0, 4.0):
        share, count = passes(radius)
        factor = 1.0 + share * (-radius / (1.0 + 1j * frequencies) - 1.0)
        assert np.abs(factor).max() ** count <= LEFT * (1 + 1e-9), radius
        # The whole of the way makes slow errors grow.
        assert radius**count > 1.0
    assert passes(0.99) == (1.0, 1)
    assert passes(100.0)[1] == MOST


def test_states_of_a_poor_log_of_velocities_settle(poor, monkeypatch):
    train, _ = logs_of(poor, HIDDEN)
    log = channels(train, poor)

    def left(times):
        """The prediction errors after passes from the states as they are read."""
        predictor = Predictor(poor, log, CALM)
        return predictor.errors(predictor.settle(predictor.start(truth()), times))

    few, many = left(4), left(40)
    size = np.sqrt(np.mean(many**2, axis=1))
    assert (np.sqrt(np.mean((few - many) ** 2, axis=1)) < 0.05 * size).all()
    monkeypatch.setattr("ivsid.diagnosis.prediction.states.passes", lambda _: (1.0, 1))
    assert (np.sqrt(np.mean((left(40) - many) ** 2, axis=1)) > size).any()


# Nightly: a whole diagnosis; that its passes settle stands above.
@pytest.mark.nightly
def test_a_cause_is_named_whose_full_fit_ran_away(poor):
    """A centre of gravity aft had a fall of 60,000 by its score and none by its full fit: the verdict was `unknown`."""
    result = diagnose(poor, *logs_of(poor, HIDDEN), null_logs=0)
    assert [f.effect for f in result.findings] == ["coupling.cg_x"]


def test_no_axis_is_made_quicker_for_what_goes_through_others():
    """Yaw had been told to expect 11 rad/s^2 beside a cause in surge, and its drag was known seven times less well."""
    vehicle = of(0.03)
    train, _ = logs_of(vehicle, HIDDEN)
    # No sensor reads the acceleration in yaw.
    columns = {k: x for k, x in train.columns.items() if k != "rdot"}
    log = channels(Log(train.name, train.sha256, train.t, columns), vehicle)
    # Their filters forget soon enough for a hull without damping.
    calm = Ambient(tuple(5.0 * x for x in CALM.deviation), CALM.time)
    predictor = Predictor(vehicle, log, calm)
    slopes = np.zeros((3, 3, 2 * log.n))
    # Surge and sway act on each other alone, and no axis is damped.
    slopes[0, 1], slopes[1, 0] = 0.8, -0.8
    quicker = quick_enough(predictor, slopes)
    assert quicker.ambient.deviation[2] <= QUICKENING * calm.deviation[2]
    assert handed_on(quicker.axes, slopes) > CONTRACTION
