"""The start of a cause, where demands change so often that its chi-squared has a valley one sample wide."""

from ivsid import diagnose
from ivsid.files.shipped import shipped
from ivsid.log import Log
from ivsid.programme.scenario import read_scenario
from ivsid.simulation import simulate
from ivsid.vehicle import read_vehicle

START = 131.553


def test_the_start_of_a_failure_is_known_to_its_slack():
    """Steps of two seconds ended on a plateau 17 s later, whose interval began 2.5 s after the truth."""
    vehicle = read_vehicle("otter")
    failure = {"thruster.failure.thruster": 1.0, "thruster.failure.loss": 0.45, "thruster.failure.time": START}
    scenario = read_scenario(shipped("example", "_programme"))
    logs = []
    for k in (1, 2):
        made = simulate(vehicle, scenario, k, effects={**scenario.truth, **failure})
        logs.append(Log(f"run{k}", "", made.t, made.columns))
    (found,) = diagnose(vehicle, *logs, null_logs=0).findings
    assert found.effect == "thruster.failure"
    start, loss = (found.parameters[f"thruster.failure.{part}"] for part in ("time", "loss"))
    assert start.lower <= START <= start.upper and start.upper - start.lower < 3.0
    assert loss.lower <= 0.45 <= loss.upper and loss.upper - loss.lower < 0.03
