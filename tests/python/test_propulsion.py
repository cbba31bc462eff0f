"""Thrusts of demands between samples: worked out once a log, and the same as if every hypothesis did it for itself."""

import numpy as np
import pytest

from diagnosis_logs import TWIN, train_of, vehicle_of, with_columns
from ivsid.diagnosis.data.channels import channels
from ivsid.diagnosis.plant.propulsion import Propulsion
from ivsid.effects import EFFECTS, Given

HYPOTHESES = (
    (),
    (Given(EFFECTS["thruster.lag"], (0.3,)),),
    (Given(EFFECTS["thruster.delay"], (0.25,)), Given(EFFECTS["thruster.deadband"], (10.0,))),
    (Given(EFFECTS["thruster.voltage_sag"], (1e-3,)),),
)


@pytest.mark.parametrize("slow", [True, False])
@pytest.mark.parametrize("held", [True, False])
def test_what_is_kept_between_hypotheses_changes_no_bit(slow, held):
    vehicle = vehicle_of(extra=f'[log]\ndemand = "{"hold" if held else "linear"}"\n')
    log = train_of(vehicle, duration=80.0)
    if slow:
        fifth = np.arange(log.t.size) % 5 > 0
        log = with_columns(log, lambda name, x: np.where(fifth, np.nan, x) if name in ("u", "v", "r") else x)
    data = channels(log, vehicle)
    assert (data.between is not None) == (slow and held)
    kept = Propulsion(vehicle, data)
    some = [0.3, 0.0, -0.2, 0.1, 0.0, 0.0, 0.4]
    sizes = [[*some, *[0.0] * (len(e.spreads) - len(some))] for e in kept.errors]
    for given in (*HYPOTHESES, *HYPOTHESES):
        for errors in (None, sizes):
            seen, alone = kept.thrusts(given, errors), Propulsion(vehicle, data).thrusts(given, errors)
            assert np.array_equal(seen.now, alone.now) and np.array_equal(seen.mean, alone.mean)
    # Declared errors count between samples, too.
    assert not np.array_equal(kept.thrusts((), sizes).mean, kept.thrusts().mean)
    if slow and held:
        # The mean over a step is that of its parts, worked out here by the curve alone.
        parts = np.stack([c.value(d) for c, d in zip(kept.curves, data.between.demands, strict=True)])
        assert np.allclose(kept.thrusts().mean, parts.mean(axis=2), atol=1e-12)


@pytest.mark.parametrize("slow", [True, False])
@pytest.mark.parametrize("held", [True, False])
@pytest.mark.parametrize("given", HYPOTHESES)
def test_a_thruster_without_a_stated_accuracy_has_no_slopes(slow, held, given):
    hold = f'[log]\ndemand = "{"hold" if held else "linear"}"\n'
    vehicle = vehicle_of(TWIN.replace("accuracy = { absolute = 0.1, relative = 0.02 }", ""), hold)
    log = train_of(vehicle, duration=80.0)
    if slow:
        fifth = np.arange(log.t.size) % 5 > 0
        log = with_columns(log, lambda name, x: np.where(fifth, np.nan, x) if name in ("u", "v", "r") else x)
    kept = Propulsion(vehicle, channels(log, vehicle))
    assert kept.slopes(0, given, []).shape == (0, 2 * kept.log.n)
