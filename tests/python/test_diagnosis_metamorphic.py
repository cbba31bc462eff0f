"""Findings when the log is turned, rescaled, cut or shuffled.

Nightly, as two or three whole diagnoses each; the gate has the same relations of the scores in test_diagnosis_stages.py.
"""

import numpy as np
import pytest

from diagnosis_logs import TWIN, logs_of, names, rows, vehicle_of, with_columns
from ivsid import diagnose
from ivsid.log import Log

pytestmark = pytest.mark.nightly


def test_turning_the_earth_frame_turns_a_current():
    vehicle = vehicle_of()
    train, test = logs_of(vehicle, {"current.steady.north": 0.08, "current.steady.east": 0.05})
    angle = 0.9
    c, s = np.cos(angle), np.sin(angle)

    def turned(log):
        x, y = log.columns["x"], log.columns["y"]
        new = {"psi": log.columns["psi"] + angle, "x": c * x - s * y, "y": s * x + c * y}
        return Log(log.name, log.sha256, log.t, {**log.columns, **new})

    one, other = diagnose(vehicle, train, test), diagnose(vehicle, turned(train), turned(test))
    assert [f.effect for f in one.findings] == [f.effect for f in other.findings] == ["current.steady"]
    a, b = (
        np.array(
            [
                0.5 * (q.lower + q.upper)
                for q in (r.findings[0].parameters[f"current.steady.{k}"] for k in ("north", "east"))
            ]
        )
        for r in (one, other)
    )
    np.testing.assert_allclose(b, [c * a[0] - s * a[1], s * a[0] + c * a[1]], atol=2e-3)


def test_demands_in_other_units_change_nothing():
    """Per mille in place of per cent, in the table and in the log."""
    demand = [-100, -60, -30, 0, 30, 60, 100]
    assert TWIN.count(str(demand)) == 2
    other = vehicle_of(TWIN.replace(str(demand), str([10 * d for d in demand])))
    vehicle = vehicle_of()
    train, test = logs_of(vehicle, {"drag.surge.linear": 4.0})
    scaled = [with_columns(q, lambda k, x: 10 * x if k.startswith("demand") else x) for q in (train, test)]
    one, two = diagnose(vehicle, train, test), diagnose(other, *scaled)
    assert names(one) == names(two) and one.verdict == "wrong"
    for a, b in zip(one.findings, two.findings, strict=True):
        for name, bound in a.parameters.items():
            assert b.parameters[name].lower == pytest.approx(bound.lower, rel=1e-3)
            assert b.parameters[name].upper == pytest.approx(bound.upper, rel=1e-3)


@pytest.mark.parametrize("effects", [{}, {"drag.surge.linear": 0.15}, {"friction.coulomb": 0.03}])
def test_half_a_log_never_turns_adequate_into_a_name(effects):
    vehicle = vehicle_of()
    train, test = logs_of(vehicle, effects)
    whole = diagnose(vehicle, train, test)
    assert whole.verdict == "adequate", names(whole)
    for keep in (train.t < 120, train.t >= 120):
        half = diagnose(vehicle, rows(train, keep), test)
        assert half.verdict == "adequate", names(half)


def test_shuffled_demands_of_the_other_log_give_no_gain():
    """A model is of no use under demands that did not move the vehicle, and its gain must not say otherwise."""
    vehicle = vehicle_of()
    train, test = logs_of(vehicle, {"thruster.lag": 0.4})
    fair = diagnose(vehicle, train, test).gain.simulation_rms
    assert max(b / a for b, a in fair.values()) > 1.5
    rng = np.random.default_rng(8)
    blocks = rng.permutation(test.t.size // 40)

    def shuffled(k, x):
        if not k.startswith("demand"):
            return x
        parts = x[: blocks.size * 40].reshape(-1, 40)
        return np.r_[parts[blocks].ravel(), x[blocks.size * 40 :]]

    result = diagnose(vehicle, train, with_columns(test, shuffled))
    assert all(b / a < 1.15 for b, a in result.gain.simulation_rms.values()), result.gain.simulation_rms
