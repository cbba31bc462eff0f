"""Room that intervals of times have beside what chi-squared says."""

from types import SimpleNamespace

import pytest

from ivsid.diagnosis.candidates.profile import slack
from ivsid.effects import EFFECTS, Given

STEP = 0.1
PROBLEM = SimpleNamespace(noise=SimpleNamespace(predictor=SimpleNamespace(log=SimpleNamespace(h=STEP))))


@pytest.mark.parametrize("id_", ["thruster.delay", "thruster.lag", "sensor.velocity.delay"])
def test_a_delay_is_not_known_within_a_hundredth_of_a_step(id_):
    """The filters take accelerations as even over a step: a delay of 34 ms came out 0.3 ms beyond its interval at 330 standard deviations."""
    assert slack(PROBLEM, Given(EFFECTS[id_], (0.034,)), 0) >= 0.01 * STEP


def test_a_size_has_no_room_and_a_start_has_three_steps_or_a_second():
    deadband = Given(EFFECTS["thruster.deadband"], (5.0,))
    assert slack(PROBLEM, deadband, 0) == 0.0
    step = EFFECTS["payload.step"]
    at = [p.draw for p in step.parameters].index("time")
    assert slack(PROBLEM, Given(step, tuple(1.0 for _ in step.parameters)), at) == 1.0
