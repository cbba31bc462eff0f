"""Velocities that come some samples late, and are looked at as many samples later."""

import numpy as np
import pytest

from ivsid import diagnose
from ivsid.diagnosis.plant.readings import added_readings, lateness
from ivsid.effects import EFFECTS, Given
from ivsid.log import Log
from ivsid.vehicle import parse_vehicle
from test_filters import resting
from test_irregular_clock import FELT, sailed
from test_slow_clock import CRAFT

STEP = 0.1


def late(seed, steps):
    """A log of the craft whose velocities come whole steps late."""
    log = sailed(120.0, seed, 0.0, STEP, feels=False)
    columns = {k: x[:-steps] if k in "uv" else x[steps:] for k, x in log.columns.items()}
    return Log(f"{seed}.csv", f"{seed:x}" * 64, log.t[:-steps], columns)


# Nightly: a delay that the filters' answer to their own past survives, and one whose search starts at a sixth of it.
@pytest.mark.parametrize(
    "steps", [pytest.param(2, marks=pytest.mark.nightly), 4, pytest.param(6, marks=pytest.mark.nightly)]
)
def test_a_delay_of_several_steps_has_its_name_and_its_size(steps):
    craft = CRAFT.replace("time_constant = {lag}\n", "")
    vehicle = parse_vehicle(craft.replace("[ambient]", f"{FELT.format(sampling='instantaneous')}[ambient]"), "v.toml")
    result = diagnose(vehicle, late(3, steps), late(4, steps))
    assert [f.effect for f in result.findings] == ["sensor.velocity.delay"]
    bound = result.findings[0].parameters["sensor.velocity.delay"]
    assert bound.lower <= STEP * steps <= bound.upper and bound.upper - bound.lower < 0.01


def test_numbers_that_are_added_to_readings_at_a_later_sample():
    """Oracle: a hull that comes to rest, whose samples have the readings of 0.3 s later: a delay is that less, and other causes act there too."""
    t = STEP * np.arange(60)
    velocity, points, nudot, exact = resting(t, STEP)
    delay, scale = Given(EFFECTS["sensor.velocity.delay"], (0.37,)), Given(EFFECTS["sensor.velocity.scale"], (0.02,))
    # A filter with a memory of 0.25 s follows one step, and one with a shorter memory the nearest of them.
    asked = [
        lateness(given, STEP, memory) for memory in (0.25, 0.1) for given in ((), (scale,), (delay,), (scale, delay))
    ]
    assert asked == [0, 0, 3, 3, 0, 0, 4, 4]

    def added(*given):
        return added_readings(given, points, nudot, exact, STEP, 3)

    def read(given, then):
        out = velocity(t + 0.3 - then)[:2] * (1.02 if scale in given else 1.0)
        return dict(zip("uv", out - velocity(t)[:2], strict=True))

    short = Given(delay.effect, (0.24,))
    for given, then in (((delay,), 0.37), ((delay, scale), 0.37), ((short,), 0.24), ((scale,), 0.0), ((), 0.0)):
        found, expected = added(*given), read(given, then)
        for name in "uv":
            np.testing.assert_allclose(found[name][4:-4], expected[name][4:-4], rtol=2e-3, atol=1e-5)
        assert not np.any(found["r"])
