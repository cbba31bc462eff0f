"""Stated accuracies as bounds: readings that jump in spells may not pass for noisy ones."""

from dataclasses import replace

import numpy as np
import pytest

from diagnosis_logs import train_of, vehicle_of
from ivsid.diagnosis.candidates.families import everything
from ivsid.diagnosis.data.channels import channels
from ivsid.diagnosis.estimation.learning import plain_fit
from ivsid.diagnosis.selection.adequacy import SCATTERED, adequacy
from ivsid.diagnosis.statements.unknown import unknown

# Accuracies that the vehicle file of these logs states.
STATED = {"x": 0.5, "psi": 0.015}


def jumping(channel, size, slow):
    """A log of which a channel is off by a few times its accuracy in spells of five seconds, or as much of it over minutes."""
    train = train_of(vehicle_of())
    t = train.t - train.t[0]
    spell = (t % 29.0 < 5.0) * np.sign(np.sin(t))
    wrong = size * STATED[channel] * (np.cos(2 * np.pi * t / 120.0) if slow else spell)
    return replace(train, columns={**train.columns, channel: train.columns[channel] + wrong})


@pytest.mark.parametrize(
    ("channel", "size", "slow", "told"),
    [
        ("x", 8.0, False, True),
        ("x", 0.9, True, False),
        # Nightly: a jump inside the accuracy, and another sensor.
        pytest.param("x", 0.5, False, False, marks=pytest.mark.nightly),
        pytest.param("psi", 20.0, False, True, marks=pytest.mark.nightly),
    ],
)
def test_readings_that_jump_are_no_noise(channel, size, slow, told):
    """A stranger's position jumped by metres, at an accuracy of 4 cm, and its model was adequate."""
    vehicle = vehicle_of()
    assert (vehicle.sensors.position.accuracy, vehicle.sensors.heading.accuracy) == tuple(STATED.values())
    left = adequacy(plain_fit(vehicle, channels(jumping(channel, size, slow), vehicle), everything))
    name, times = left.scattered
    assert (times > SCATTERED) == told and times < max(size, 0.5)
    assert not told or (name == channel and "times their stated accuracy" in unknown(left, []).description)
    assert told or left.quiet
