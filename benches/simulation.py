"""Seconds of processor time that a simulated log of 600 s at 20 Hz takes, its check by halving the step included.

Run: python benches/simulation.py
"""

from __future__ import annotations

import time
from importlib.resources import files

from ivsid.programme.scenario import parse_scenario
from ivsid.simulation import simulate
from ivsid.vehicle import parse_vehicle

MANY = {
    "drag.surge.linear": 4.0,
    "friction.coulomb": 1.0,
    "drag.cross_flow": 25.0,
    "drag.yaw.linear": 1.0,
    "added_mass.munk": 6.0,
    "coupling.cg_x": 1.5,
    "current.steady.north": 0.08,
    "current.steady.east": 0.05,
    "wave.force.amplitude": 2.0,
    "wave.force.period": 4.0,
    "wave.force.phase": 0.0,
    "wave.force.direction": 0.3,
    "thruster.advance_loss": 0.08,
    "sensor.velocity.delay": 0.1,
}


def main() -> None:
    """Prints one line a case, the best of three."""
    for name, programme, effects in (
        ("swan", "swan_train", {}),
        ("swan", "swan_train", {"thruster.lag": 0.25}),
        ("swan", "swan_train", {"thruster.delay": 0.13}),
        ("swan", "swan_train", MANY),
        ("otter", "otter_programme", {}),
        ("vectored_rov", "vectored_rov_programme", {}),
    ):
        texts = [(files("ivsid") / "data" / f"{n}.toml").read_text() for n in (name, programme)]
        vehicle, scenario = parse_vehicle(texts[0], name), parse_scenario(texts[1], programme)
        scenario = scenario.model_copy(update={"duration": 600.0, "rate": 20.0})
        spent = []
        for _ in range(3):
            start = time.process_time()
            made = simulate(vehicle, scenario, 1, effects)
            spent.append(time.process_time() - start)
        steps = made.truth["integration"]["steps_per_sample"]
        print(
            f"{name:13} with {', '.join(effects)[:60] or 'its model alone'}: {min(spent):.2f} s, {steps} steps a sample"
        )


if __name__ == "__main__":
    main()
