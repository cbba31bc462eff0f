"""Rudders, and accelerations that hold gravity, once more in fractions."""

import json
from dataclasses import replace
from fractions import Fraction

import gmpy2
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from conftest import as_log
from edited_results import written
from ivsid import IntervalArray, verify
from ivsid.log import Log
from ivsid.propulsion.foil import rudder_force
from ivsid.propulsion.rudder import rudder_over
from ivsid.simulation import simulate
from ivsid.vehicle import Thruster, parse_vehicle
from ivsid.verification.angles import arctangent, direction
from ivsid.verification.decimals import Decimals
from ivsid.verification.rational import Range, cosine, sine
from ivsid.verification.rows import Rows
from ivsid.verification.rudders import Blade
from sampling import spaced
from test_actuators import scenario_of, vehicle_of
from test_mounting import changed, tilted
from test_rudders import RUDDER
from test_verification_rows import checked, ends, outside

# Rows of the core are compared with those of the checker: some of them in the gate, more in the nightly run.
pytestmark = [pytest.mark.sampled, pytest.mark.same_rows]


# Nightly: the other value of gravity with either attitude.
@pytest.mark.parametrize(
    ("attitude", "gravity"),
    [
        ("roll and pitch", "true"),
        ("quaternion", "9.81"),
        pytest.param("roll and pitch", "9.81", marks=pytest.mark.nightly),
        pytest.param("quaternion", "true", marks=pytest.mark.nightly),
    ],
)
def test_accelerations_that_hold_gravity_are_proved_and_a_rougher_attitude_is_not(
    swan, twin, tmp_path, attitude, gravity
):
    leaning = changed(
        swan,
        ("[sensors.acceleration]\n", f"[sensors.acceleration]\ngravity = {gravity}\n"),
        ("[sensors.velocity]\n", "[sensors.attitude]\naccuracy = 0.002\n\n[sensors.velocity]\n"),
    )
    columns, roll, pitch = tilted(twin)
    if attitude == "quaternion":
        x, y, z, w = Rotation.from_euler("ZYX", np.c_[twin.exact["psi"], pitch, roll]).as_quat().T
        columns |= {"qw": w, "qx": x, "qy": y, "qz": z}
    else:
        columns |= {"roll": roll, "pitch": pitch}
    imu = Log("imu.csv", "0" * 64, twin.t, columns)
    assert outside(leaning, imu) == []
    own = Rows(imu, leaning, "total").readings
    for name in ("ax", "ay"):
        for i in range(0, twin.t.size, 97):
            found = own.channel(name, i)
            assert found.lower <= Fraction(float(twin.exact[name][i])) <= found.upper
    assert checked(leaning, imu, tmp_path) == ("proved", "")
    record = json.loads((tmp_path / "fit.json").read_text())
    assert not ends(record, imu, tmp_path)
    for old, new in (("accuracy = 0.002", "accuracy = 0.003"), (f"gravity = {gravity}", "gravity = 9.7")):
        other = parse_vehicle(leaning.text.replace(old, new), "o.toml")
        edited = {**record, "vehicle": other.text}
        edited["inputs"] = [{**record["inputs"][0], "sha256": other.sha256}, record["inputs"][1]]
        verdict = verify(written(tmp_path / "r.json", edited), imu)
        assert verdict.status == "failed" and any("recomputed as" in f for f in verdict.failures)
    # Gravity may have any direction in a reading without attitude.
    for name in ("roll", "pitch", "qw"):
        if name in columns:
            lost = replace(
                imu, columns={**columns, name: np.where(np.arange(twin.t.size) == 50, np.nan, columns[name])}
            )
            assert Rows(lost, leaning, "total").readings.channel("ax", 50).magnitude > 9


CLAIMS = ("", "time_constant = 0.35\n", 'time_constant = 0.35\nlag = "demand"\n', "advance_loss = 0.3\n")


@pytest.mark.parametrize("claims", CLAIMS)
def test_rudders_are_proved_and_another_blade_is_not(tmp_path, claims):
    text = RUDDER.replace("gain = 0.4\n", f"gain = 0.4\ndemand_range = [-60.0, 60.0]\n{claims}")
    steered = vehicle_of(text)
    log = as_log(simulate(steered, scenario_of(), 3))
    assert outside(steered, log, kind="both", window=0.1) == []
    for rows in spaced(("integral", "pointwise"), 1):
        assert checked(steered, log, tmp_path, rows=rows, window=0.1) == ("proved", "")
    record = json.loads((tmp_path / "fit.json").read_text())
    other_blades = (
        ("area = 0.02", "area = 0.021"),
        ("position = -0.55", "position = -0.5"),
        ("propeller_diameter = 0.12", "propeller_diameter = 0.1"),
        ("rate = 0.5", "rate = 0.5, accuracy = 0.05"),
        ("rate = 0.5", "rate = 0.5, stall = 0.15"),
    )
    # The claims differ in the thrust; each blade is another one under any of them.
    for old, new in spaced(other_blades, 5 if not claims else 1):
        other = parse_vehicle(steered.text.replace(old, new), "o.toml")
        edited = {**record, "vehicle": other.text}
        edited["inputs"] = [{**record["inputs"][0], "sha256": other.sha256}, record["inputs"][1]]
        verdict = verify(written(tmp_path / "r.json", edited), log)
        assert verdict.status == "failed" and any("recomputed as" in f for f in verdict.failures), new


@pytest.mark.parametrize("seed", range(4))
def test_a_blade_s_force_is_enclosed_in_fractions(seed):
    """Points of random boxes across stall, reversal and standstill; and never wider than the box of the core."""

    rng = np.random.default_rng(seed)
    made = {"area": 0.02, "aspect_ratio": 1.5, "position": -0.5, "propeller_diameter": 0.12, "accuracy": 0.01}
    rudder = Thruster.model_validate({"name": "r", "gain": 1.0, "rudder": made}).rudder
    blade = Blade(rudder, Decimals(""))
    for _ in range(60):
        centre = rng.uniform(-1, 1, 5) * np.array([3.5, 15.0, 1.2, 0.6, 0.8])
        radius = 10 ** rng.uniform(-6, 0, 5) * np.array([0.5, 4.0, 0.4, 0.3, 0.3])
        low, high = centre - radius, centre + radius
        box = [Range(Fraction(a), Fraction(b)) for a, b in zip(low.tolist(), high.tolist(), strict=True)]
        found = blade.force(box[0], box[1], (box[2], box[3], box[4]))
        theirs = [IntervalArray(np.array([a]), np.array([b])) for a, b in zip(low, high, strict=True)]
        outer = rudder_over(rudder, theirs[0], theirs[1], (theirs[2], theirs[3], theirs[4]))
        for x, wide in zip(found, outer, strict=True):
            assert x.inside(Fraction(float(wide.lower[0])), Fraction(float(wide.upper[0])))
        for share in rng.uniform(-1, 1, (12, 5)):
            point = centre + share * radius
            for x, force in zip(found, rudder_force(rudder, *point), strict=True):
                # The oracle is a float, of some dozen operations.
                near = 1e-12 * (1 + abs(force))
                assert float(x.lower) - near <= force <= float(x.upper) + near


def turns(p, q):
    """The direction of a point in three turns, from below and from above."""
    ends = []
    for rounding in (gmpy2.RoundDown, gmpy2.RoundUp):
        with gmpy2.context(precision=300, round=rounding):
            angle, turn = gmpy2.atan2(gmpy2.mpfr(p), gmpy2.mpfr(q)), 2 * gmpy2.const_pi()
            ends.append([angle - turn, angle, angle + turn])
    # The turn that is taken away is rounded the other way.
    slack = Fraction(1, 2**280)
    down, up = ([Fraction(*map(int, a.as_integer_ratio())) for a in found] for found in ends)
    return [(low - slack, high + slack) for low, high in zip(down, up, strict=True)]


def test_directions_hold_every_angle_of_their_boxes():

    rng = np.random.default_rng(0)
    for x in (Fraction(0), Fraction(1), Fraction(-3, 7), Fraction(10) ** 40, Fraction(1, 10**40), Fraction(57, 100)):
        angle = arctangent(x)
        assert angle.upper - angle.lower < Fraction(1, 10**70)
        tangent = sine(angle) / cosine(angle)
        assert tangent.lower <= x <= tangent.upper
    for _ in range(300):
        centre = rng.choice([0.0, 0.5, 1.0, -1.0], 2) * rng.uniform(0, 1, 2)
        radius = rng.choice([0.0, 1e-9, 0.3, 1.0], 2)
        (y0, x0), (y1, x1) = centre - radius, centre + radius
        y, x = (Range(Fraction(a), Fraction(b)) for a, b in ((float(y0), float(y1)), (float(x0), float(x1))))
        angle = direction(y, x)
        for share in rng.uniform(-1, 1, (6, 2)):
            p, q = centre + share * radius
            # A share of one may round to beyond the box.
            p, q = min(max(p, y0), y1), min(max(q, x0), x1)
            if p or q:
                assert any(angle.lower <= above and below <= angle.upper for below, above in turns(p, q)), (y, x)
