"""Rows of every kind once more in fractions: inside those of the core, proved from end to end, or refused by name."""

import copy
import json
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

from conftest import as_log
from ivsid import identify, verify
from ivsid.effects import CHANNELS, terms_of
from ivsid.log import Log, StepRange
from ivsid.rows import ROW_KINDS, build_rows
from ivsid.sensors.bounds import bound_log
from ivsid.simulation import simulate
from ivsid.vehicle import parse_vehicle
from ivsid.verification.rows import Rows
from sampling import NIGHTLY, spaced
from test_actuators import POD, scenario_of, vehicle_of
from test_bias import VALUES, biased
from test_derivatives import towed as smooth_motion
from test_mounting import MOUNTS, changed
from test_verification import written
from test_weak_form import towed as from_pose

# Rows of the core are compared with those of the checker: some of them in the gate, more in the nightly run.
pytestmark = [pytest.mark.sampled, pytest.mark.same_rows]

WIND = (
    'terms = "paper"',
    'terms = ["mass.surge", "mass.sway", "inertia.yaw", "drag.surge.quadratic", "drag.sway.quadratic", "wind.steady"]',
)
HEADING = "\n[sensors.heading]\naccuracy = 0.004\n"


def outside(vehicle, log, picked=24 if NIGHTLY else 8, **how):
    """Rows of the core that do not hold those of the checker, of some that are picked: more in the nightly run."""
    made = build_rows(bound_log(log, vehicle), vehicle, terms_of(vehicle), **how)
    own, bad = Rows(log, vehicle, "total"), []
    for k in np.random.default_rng(0).choice(made.time.size, min(picked, made.time.size), replace=False):
        kind, channel = ROW_KINDS[made.kind[k]], CHANNELS[made.channel[k]]
        row = own.row(kind, channel, float(made.time[k]), float(made.duration[k]))
        ranges = [*(row.matrix[t.id] for t in made.terms), row.right]
        lower, upper = (
            [*x.tolist(), y]
            for x, y in (
                (made.matrix.lower[k], float(made.right.lower[k])),
                (made.matrix.upper[k], float(made.right.upper[k])),
            )
        )
        if not all(r.inside(Fraction(a), Fraction(b)) for r, a, b in zip(ranges, lower, upper, strict=True)):
            bad.append((kind, channel, made.time[k], [str(r) for r in ranges], lower, upper))
    return bad


def ends(record, log, tmp_path):
    """Every claimed end a little inside: which verdicts are not a failure."""
    passed = []
    for number, certificate in enumerate(record["certificates"]):
        if certificate["proves"] != "bound" or not np.isfinite(float.fromhex(certificate["bound"])):
            continue
        edited, bound = copy.deepcopy(record), float.fromhex(certificate["bound"])
        beyond = bound + (1e-6 + 1e-6 * abs(bound)) * (1 if certificate["end"] == "lower" else -1)
        edited["certificates"][number]["bound"] = beyond.hex()
        if verify(written(tmp_path / "r.json", edited), log).status != "failed":
            passed.append(number)
    return passed


def test_a_bias_that_is_one_unknown_is_proved_and_no_edit_of_it_passes(swan, programme, tmp_path):
    vehicle = biased(swan)
    log = as_log(simulate(vehicle, programme.model_copy(update={"duration": 60.0}), 100))
    fit = identify(vehicle, log)
    assert fit.options["bias"] == "log" and fit.status == "enclosed"
    fit.save(tmp_path / "fit.json")
    verdict = verify(tmp_path / "fit.json", log)
    assert verdict.proved, verdict.failures[:3]
    text = (tmp_path / "fit.json").read_text()
    record = json.loads(text)
    used = [r for c in record["certificates"] for r in c.get("rows", ())]
    kinds = {r["kind"] for r in used}
    assert {"pointwise", "bias.x"} <= kinds
    assert not ends(record, log, tmp_path)
    for change in ("sample", "never"):
        edited = copy.deepcopy(record)
        edited["options"]["bias"] = change
        assert verify(written(tmp_path / "r.json", edited), log).status == "failed"
    # A bias that is bounded more tightly, or not subtracted, or of another axis.
    for edit in ("narrow", "left out", "axis"):
        edited = copy.deepcopy(record)
        for certificate in edited["certificates"]:
            for row in certificate.get("rows", ()):
                ids = list(certificate["orthant"])
                if edit == "narrow" and row["kind"].startswith("bias"):
                    row["lower"] = [(0.9 * x if x != 1.0 else x).hex() for x in map(float.fromhex, row["lower"])]
                elif edit == "left out" and row["kind"] == "pointwise":
                    for k, id_ in enumerate(ids):
                        if id_.startswith("bias"):
                            row["lower"][k] = row["upper"][k] = (0.0).hex()
                elif edit == "axis" and row["kind"].startswith("bias"):
                    row["kind"] = "bias.y" if row["kind"] == "bias.x" else "bias.x"
        verdict = verify(written(tmp_path / "r.json", edited), log)
        assert verdict.status == "failed" and any("recomputed as" in f or "taken apart" in f for f in verdict.failures)
    box = identify(vehicle, log, bias="sample")
    box.save(tmp_path / "box.json")
    assert box.options["bias"] == "sample" and verify(tmp_path / "box.json", log).proved


def test_accelerations_under_a_jerk_are_proved_and_a_smaller_jerk_is_not(tmp_path):
    log, _, smooth, _ = smooth_motion(1)
    assert outside(smooth, log, kind="both") == []
    fit = identify(smooth, log)
    fit.save(tmp_path / "fit.json")
    record = json.loads((tmp_path / "fit.json").read_text())
    assert "pointwise" in {r["kind"] for c in record["certificates"] for r in c.get("rows", ())}
    verdict = verify(tmp_path / "fit.json", log)
    assert verdict.proved, verdict.failures[:3]
    assert not ends(record, log, tmp_path)
    # The same rows under a jerk that is allowed to be larger do not follow.
    jerk = f"jerk = {smooth.sensors.limits.jerk}"
    wider = parse_vehicle(smooth.text.replace(jerk, f"jerk = {smooth.sensors.limits.jerk * 1.2}", 1), "w.toml")
    record["vehicle"], record["inputs"][0]["sha256"] = wider.text, wider.sha256
    verdict = verify(written(tmp_path / "r.json", record), log)
    assert verdict.status == "failed" and any("recomputed as" in f for f in verdict.failures)


def windy(swan, programme, **update):
    vehicle = parse_vehicle(swan.text.replace(*WIND) + HEADING, "wind.toml")
    truth = {**VALUES, "wind.steady.north": 3.0, "wind.steady.east": -2.0}
    truth.pop("coupling.cg_y")
    made = simulate(vehicle, programme.model_copy(update={"noise": "uniform", "truth": truth, **update}), 5)
    psi = np.angle(np.exp(1j * (made.columns["psi"] - np.median(made.columns["psi"]) + np.pi)))
    return vehicle, Log("wind.csv", "0" * 64, made.t, {**made.columns, "psi": psi})


@pytest.mark.parametrize("rows", ["pointwise", "integral"])
def test_a_wind_is_proved_and_a_rougher_compass_is_not(swan, programme, tmp_path, rows):
    vehicle, log = windy(swan, programme, duration=40.0)
    assert np.abs(np.diff(log.columns["psi"])).max() > 6, "the heading jumps by a whole turn"
    assert outside(vehicle, log, kind=rows, window=0.2) == []
    fit = identify(vehicle, log, rows=rows, window=0.2)
    fit.save(tmp_path / "fit.json")
    verdict = verify(tmp_path / "fit.json", log)
    assert verdict.proved and "wind.steady.north" in fit.parameters, verdict.failures[:3]
    record = json.loads((tmp_path / "fit.json").read_text())
    rough = parse_vehicle(vehicle.text.replace("accuracy = 0.004", "accuracy = 0.008"), "w.toml")
    record["vehicle"], record["inputs"][0]["sha256"] = rough.text, rough.sha256
    assert verify(written(tmp_path / "r.json", record), log).status == "failed"


def test_between_rows_the_heading_of_a_steady_turn_is_enclosed():
    """Turning one way alone, the heading starts at the first row's: nothing of it may be left out."""
    from ivsid.rows.equations import Equations
    from ivsid.rows.integral import Quadrature

    text = (
        'name = "a"\n[hull]\nmass = 50\n[sensors.velocity]\naccuracy = 0.01\n[sensors.yaw_rate]\naccuracy = 1e-4\n[sensors.heading]\n'
        "accuracy = 1e-4\n[sensors.force]\naccuracy = 0.1\n[sensors.moment]\naccuracy = 0.1\n[sensors.limits]\nacceleration = 1\n"
        'yaw_acceleration = 0.001\n[model]\nterms = ["mass.surge", "wind.steady"]\n'
    )
    vehicle, t = parse_vehicle(text, "a.toml"), np.arange(50) * 0.5
    for rate in (0.6, -0.6):
        same = {n: np.zeros(50) for n in ("u", "v", "force_X", "force_Y", "moment_N")}
        log = Log("a.csv", "0" * 64, t, {**same, "r": np.full(50, rate), "psi": np.angle(np.exp(1j * rate * t))})
        equations = Equations(bound_log(log, vehicle), vehicle, terms_of(vehicle), 0.0)
        starts = np.arange(49)
        quadrature = Quadrature(equations, np.diff(t), starts, 1, equations.clock[1:] - equations.clock[:-1])
        r = equations.bounded.channels["r"]
        _, along = quadrature._places(r, r[:-1].hull(r[1:]))
        for share in np.linspace(0, 1, 21):
            true = np.cos(rate * (t[:-1] + share * 0.5))
            assert np.cos(along.psi.value).contains(true).all(), (rate, share)
        assert np.median(along.psi.value.width) < 0.5 * abs(rate) * 1.6
        assert outside(vehicle, log, kind="integral", window=1.0) == []


def checked(vehicle, log, tmp_path, **how):
    identify(vehicle, log, **how).save(tmp_path / "fit.json")
    verdict = verify(tmp_path / "fit.json", log)
    assert not verdict.failures, verdict.failures[:2]
    return verdict.status, " ".join(verdict.not_checked)


def test_mounted_sensors_are_recomputed_and_a_sensor_that_may_stand_elsewhere_is_not_proved(swan, programme, tmp_path):
    mounted = changed(swan, *MOUNTS)
    log = as_log(simulate(mounted, programme.model_copy(update={"noise": "uniform", "duration": 40.0}), 4))
    assert outside(mounted, log, kind="both", window=0.2) == []
    assert checked(mounted, log, tmp_path) == ("proved", "")
    record = json.loads((tmp_path / "fit.json").read_text())
    assert not ends(record, log, tmp_path)
    for old, new in (("position = [0.5, -0.2]", "position = [0.7, -0.2]"), ("position = [-0.3", "position = [-0.5")):
        other = parse_vehicle(mounted.text.replace(old, new), "o.toml")
        edited = {**record, "vehicle": other.text}
        edited["inputs"] = [{**record["inputs"][0], "sha256": other.sha256}, record["inputs"][1]]
        verdict = verify(written(tmp_path / "r.json", edited), log)
        assert verdict.status == "failed" and any("recomputed as" in f for f in verdict.failures)


def test_averaged_accelerations_are_recomputed(swan, programme, tmp_path):
    averaged = changed(
        swan,
        ("[sensors.acceleration]\n", '[sensors.acceleration]\nsampling = "averaged"\n'),
        ("random_walk = [0.0018, 0.002]", "random_walk = [0.0002, 0.0002]"),
    )
    log = as_log(simulate(averaged, programme.model_copy(update={"noise": "uniform", "duration": 40.0}), 12))
    assert outside(averaged, log, window=0.05) == outside(averaged, log, window=0.5) == []
    assert checked(averaged, log, tmp_path, window=0.1) == ("proved", "")
    record = json.loads((tmp_path / "fit.json").read_text())
    assert not ends(record, log, tmp_path)
    # Noisier averages leave the differences of the velocities, which are wider.
    noisy = parse_vehicle(averaged.text.replace("[0.0002, 0.0002]", "[0.002, 0.002]"), "n.toml")
    record["vehicle"], record["inputs"][0]["sha256"] = noisy.text, noisy.sha256
    assert verify(written(tmp_path / "r.json", record), log).status == "failed"


def test_velocities_by_splines_are_neither_guaranteed_nor_checked(tmp_path):
    log, vehicle = from_pose(1, length=60.0)
    smooth = parse_vehicle(
        vehicle.text.replace("[sensors.position]", '[sensors]\nfrom_pose = "spline"\n[sensors.position]'), "s.toml"
    )
    fit = identify(smooth, log)
    status, words = checked(smooth, log, tmp_path)
    assert not fit.guaranteed and status == "not_checked" and "estimate" in words
    record = json.loads((tmp_path / "fit.json").read_text())
    record["guaranteed"] = True
    verdict = verify(written(tmp_path / "r.json", record), log)
    assert verdict.status == "failed" and "with velocities by splines nothing is guaranteed" in verdict.failures[0]


@pytest.mark.parametrize("demand", ["hold", "linear"])
def test_angles_are_followed_between_rows(demand):
    vehicle = vehicle_of(POD)
    log = as_log(simulate(vehicle, scenario_of(), 3))
    if demand == "linear":
        vehicle = parse_vehicle(vehicle.text + '[log]\ndemand = "linear"\n', "linear.toml")
        # Through half a turn: the angle jumps by a whole one.
        angle = np.angle(np.exp(1j * (log.columns["azimuth_pod"] + np.pi)))
        log = replace(log, columns={**log.columns, "azimuth_pod": angle})
    assert outside(vehicle, log, kind="integral", window=0.5) == []
    angle = log.columns["azimuth_pod"]
    near = np.minimum(angle[1:], angle[:-1]) - 0.01, np.maximum(angle[1:], angle[:-1]) + 0.02
    swept = replace(log, over={"azimuth_pod": StepRange(*near, "in between")})
    assert outside(vehicle, swept, kind="integral", window=0.5) == []
    # The checker takes the sweep, not the row: under the core's rows without it nothing is proved.
    made = build_rows(bound_log(log, vehicle), vehicle, terms_of(vehicle), kind="integral", window=0.5)
    own = Rows(swept, vehicle, "total")
    k = int(np.argmax(made.channel == 0))
    row = own.row("integral", "surge", float(made.time[k]), float(made.duration[k]))
    assert not row.right.inside(Fraction(float(made.right.lower[k])), Fraction(float(made.right.upper[k])))


def test_forces_between_rows_demands_beyond_curves_and_gyros_that_average(swan, programme, twin):
    log, plain, _, _ = smooth_motion(2)
    n = log.t.size - 1
    for width in (0.02, 1.0):
        force = log.columns["force_X"]
        between = np.minimum(force[1:], force[:-1]) - width, np.maximum(force[1:], force[:-1]) + width
        over = {"force_X": StepRange(*between, "in between")}
        assert outside(plain, replace(log, over=over), kind="integral") == []
    gap = between[0].copy()
    gap[n // 2] = np.nan
    assert outside(plain, replace(log, over={"force_X": StepRange(gap, between[1], "gap")}), kind="integral") == []
    gyro = changed(swan, ("bias_time = 270.0", 'bias_time = 270.0\nsampling = "averaged"'))
    assert outside(gyro, as_log(twin), kind="both") == []
    held = changed(swan, ("azimuth = 0.0", 'azimuth = 0.0\noutside = "hold"'))
    columns = dict(twin.columns)
    columns["demand_port"] = columns["demand_port"] * 1.4
    assert columns["demand_port"].max() > 85
    assert outside(held, Log("a.csv", "0" * 64, twin.t, columns), kind="both") == []
    for lag in spaced(("thrust", "demand"), 1):
        lagged = changed(
            swan, ("azimuth = 0.0", f'azimuth = 0.0\noutside = "hold"\ntime_constant = 0.4\nlag = "{lag}"')
        )
        assert outside(lagged, Log("a.csv", "0" * 64, twin.t, columns), kind="both") == []


def test_a_heading_that_may_have_turned_either_way_gives_no_window():
    log, vehicle = from_pose(2, length=40.0)
    psi = log.columns["psi"].copy()
    psi[400:] += 3.14 - (psi[400] - psi[399])
    turned = replace(log, columns={**log.columns, "psi": np.angle(np.exp(1j * psi))})
    own = Rows(turned, vehicle, "total").readings.pose
    assert own.piece[0] != own.piece[-1]
    assert outside(vehicle, log, kind="integral", window=1.0, picked=12) == []
    uncertain = replace(log, certain={"psi": 1e-4})
    from ivsid.verification.errors import UnprovedError

    with pytest.raises(UnprovedError, match="way round"):
        Rows(uncertain, vehicle, "total")
