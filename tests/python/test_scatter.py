"""Stated accuracies as bounds: readings that jump in spells may not pass for noisy ones."""

from dataclasses import replace

import numpy as np
import pytest

from diagnosis_logs import train_of, vehicle_of
from ivsid.diagnosis.candidates.families import everything
from ivsid.diagnosis.data.channels import channels
from ivsid.diagnosis.estimation.learning import plain_fit
from ivsid.diagnosis.selection.adequacy import adequacy
from ivsid.diagnosis.selection.structure import SCATTERED
from ivsid.diagnosis.statements.unknown import unknown
from ivsid.vehicle import parse_vehicle

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


def test_a_rough_sea_between_two_rows_is_no_scatter_of_exact_readings():
    """A declared sea of 0.1 m/s^2 moves a hull by 2 cm/s from row to row at 5 Hz, where velocities and positions are exact to 1 mm/s and 2 mm."""
    text = vehicle_of().text.replace("force = 0.15\nmoment = 0.03", "force = 6.0\nmoment = 1.2")
    text = text.replace("accuracy = 0.006", "accuracy = 0.001").replace("accuracy = 0.5", "accuracy = 0.002")
    vehicle = parse_vehicle(text, "exact.toml")
    assert (vehicle.sensors.velocity.accuracy, vehicle.sensors.position.accuracy) == (0.001, 0.002)
    assert vehicle.ambient.force == 6.0
    scatter = plain_fit(vehicle, channels(train_of(vehicle, rate=5.0), vehicle), everything).noise.scatter
    assert {"u", "v", "psi", "x", "y"} == set(scatter) and max(scatter.values()) < SCATTERED
