"""Sensors that stand off the origin, are turned, or feel gravity: readings come back to the body origin, in intervals."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from conftest import as_log
from ivsid import IntervalArray, IvsidError
from ivsid.effects import terms_of
from ivsid.log import Log
from ivsid.rows import build_rows
from ivsid.sensors import lever_arms
from ivsid.sensors.bounds import bound_log
from ivsid.sensors.mounting import force_at_origin, velocity_at_origin
from ivsid.simulation import simulate
from ivsid.vehicle import parse_vehicle
from ivsid.vehicle.mount import Mounted
from test_rows import violated

G = 9.81


def changed(swan, *edits):
    text = swan.text
    for old, new in edits:
        assert old in text
        text = text.replace(old, new)
    return parse_vehicle(text, "mounted.toml")


arms = st.tuples(st.floats(-2, 2), st.floats(-2, 2))


@settings(max_examples=200, deadline=None)
@given(
    arms,
    st.floats(-3, 3),
    st.floats(0, 0.1),
    st.floats(-1, 1),
    st.floats(0, 0.2),
    arms,
    st.floats(-1, 1),
    st.floats(-2, 2),
)
def test_any_mounting_is_undone(position, rotation, turn_error, share, arm_error, motion, r, rdot):
    """The truth lies inside for any true mounting within the stated accuracy, to the last bit of what is computed here in floats."""
    a, (x, y) = rotation + turn_error * share, (p + arm_error * share for p in position)
    mount = Mounted(
        position=position, position_accuracy=arm_error + 1e-12, rotation=rotation, rotation_accuracy=turn_error + 1e-12
    )
    c, s = np.cos(a), np.sin(a)

    def read(first, second):
        return (IntervalArray.around(q, 1e-13) for q in (first * c + second * s, second * c - first * s))

    one, two = motion
    rate, turning = IntervalArray(r), IntervalArray(rdot)
    u, v = velocity_at_origin(tuple(read(one - y * r, two + x * r)), rate, mount)
    assert u.contains(one) and v.contains(two)
    ax, ay = force_at_origin(tuple(read(one - x * r * r - y * rdot, two + x * rdot - y * r * r)), rate, turning, mount)
    assert ax.contains(one) and ay.contains(two)


MOUNTS = (
    (
        "[sensors.velocity]\naccuracy",
        "[sensors.velocity]\nposition = [0.5, -0.2]\nrotation = 0.7853981633974483\nrotation_accuracy = 1e-3\naccuracy",
    ),
    ("[sensors.acceleration]\n", "[sensors.acceleration]\nposition = [-0.3, 0.1]\nrotation = -1.5707963267948966\n"),
)


def test_rows_hold_with_mounted_sensors(swan, programme):
    vehicle = changed(swan, *MOUNTS)
    made = simulate(vehicle, programme.model_copy(update={"noise": "uniform"}), 11)
    assert np.abs(made.columns["u"] - made.exact["u"]).max() > 0.1, "the reading is another point's"
    bounded = bound_log(as_log(made), vehicle)
    for name in ("u", "v", "ax", "ay"):
        assert bounded.channels[name].contains(made.exact[name]).all(), name
        # Columns that are shown as measured are the origin's, too.
        assert np.abs(bounded.log.columns[name] - made.exact[name]).max() < bounded.channels[name].width.max()
    rows = build_rows(bounded, vehicle, terms_of(vehicle), kind="both")
    assert violated(rows, made.truth["parameters"]) == 0
    plain = bound_log(as_log(made), swan)
    assert not plain.channels["u"].contains(made.exact["u"]).all(), "left out, the mounting is a wrong reading"


def test_a_missing_yaw_rate_takes_the_moved_velocity_with_it(swan, programme):
    vehicle = changed(swan, *MOUNTS)
    made = simulate(vehicle, programme, 11)
    columns = {k: v.copy() for k, v in made.columns.items()}
    columns["r"][50] = np.nan
    bounded = bound_log(Log("x.csv", "", made.t, columns), vehicle)
    assert not bounded.present["u"][50] and not bounded.present["ax"][50] and np.isnan(bounded.log.columns["u"][50])


def tilted(made, seed=1, level=0.06):
    """The specific force of an IMU on a rolling, pitching vehicle: a - g in body axes, and its attitude."""
    rng = np.random.default_rng(seed)
    t = made.t
    roll, pitch = (level * np.sin(w * t + p) for w, p in rng.uniform((0.5, 0), (1.5, 6), (2, 2)))
    turns = Rotation.from_euler("ZYX", np.c_[made.exact["psi"], pitch, roll])
    down = turns.inv().apply([0.0, 0.0, G])
    return ({**made.columns, "ax": made.columns["ax"] - down[:, 0], "ay": made.columns["ay"] - down[:, 1]}, roll, pitch)


@pytest.mark.parametrize("attitude", ["roll and pitch", "quaternion"])
@pytest.mark.parametrize("gravity", ["true", "9.81"])
def test_gravity_is_taken_away_by_the_attitude(swan, twin, attitude, gravity):
    vehicle = changed(
        swan,
        ("[sensors.acceleration]\n", f"[sensors.acceleration]\ngravity = {gravity}\n"),
        ("[sensors.velocity]\n", "[sensors.attitude]\naccuracy = 0.002\n\n[sensors.velocity]\n"),
    )
    columns, roll, pitch = tilted(twin)
    errors = np.random.default_rng(2).choice([-1, 1], (2, twin.t.size)) * 0.0019
    if attitude == "quaternion":
        turned = Rotation.from_euler("ZYX", np.c_[twin.exact["psi"], pitch + errors[1], roll + errors[0]])
        x, y, z, w = turned.as_quat().T
        columns |= {"qw": w, "qx": x, "qy": y, "qz": z}
    else:
        columns |= {"roll": roll + errors[0], "pitch": pitch + errors[1]}
    bounded = bound_log(Log("imu.csv", "", twin.t, columns), vehicle)
    for name in ("ax", "ay"):
        assert bounded.channels[name].contains(twin.exact[name]).all(), name
    rows = build_rows(bounded, vehicle, terms_of(vehicle))
    assert violated(rows, twin.truth["parameters"]) == 0
    assert not bound_log(Log("imu.csv", "", twin.t, columns), swan).channels["ax"].contains(twin.exact["ax"]).all()


@pytest.mark.parametrize(
    ("edits", "drop", "extra", "sentence"),
    [
        (MOUNTS, ["r"], {}, "stands off the origin.*needs the column r"),
        (MOUNTS, [], {"udot": 0.0}, "udot, vdot, which are of the origin"),
        (
            (("[sensors.acceleration]\n", "[sensors.acceleration]\ngravity = true\n"),),
            [],
            {},
            r"\[sensors.attitude\] accuracy",
        ),
        (
            (
                ("[sensors.acceleration]\n", "[sensors.acceleration]\ngravity = true\n"),
                ("[sensors.velocity]\n", "[sensors.attitude]\naccuracy = 0.002\n\n[sensors.velocity]\n"),
            ),
            [],
            {},
            "no attitude; give columns qw",
        ),
        (MOUNTS, ["ay"], {}, "logs one of ax and ay.*needs both"),
        ((MOUNTS[1], ("yaw_acceleration = 1.5\n", "")), [], {}, "needs the column rdot"),
        (
            (("[sensors.acceleration]\n", '[sensors.acceleration]\nsampling = "averaged"\nposition = [1, 0]\n'),),
            [],
            {},
            "cannot be undone together",
        ),
    ],
)
def test_what_a_mounting_needs_is_said(swan, twin, edits, drop, extra, sentence):
    vehicle = changed(swan, *edits)
    columns = {k: v for k, v in twin.columns.items() if k not in drop}
    columns |= {k: np.full(twin.t.size, v) for k, v in extra.items()}
    with pytest.raises(IvsidError, match=sentence) as caught:
        bound_log(Log("x.csv", "", twin.t, columns), vehicle)
    assert "\n" not in str(caught.value)


def test_averaged_accelerations_narrow_the_rows_over_steps(swan, programme):
    """Rows over single steps hold with an averaging accelerometer, and are narrower than without it; none is pointwise."""
    averaged = changed(
        swan,
        ("[sensors.acceleration]\n", '[sensors.acceleration]\nsampling = "averaged"\n'),
        ("random_walk = [0.0018, 0.002]", "random_walk = [0.0002, 0.0002]"),
    )
    made = simulate(averaged, programme.model_copy(update={"noise": "uniform"}), 12)
    with_it = build_rows(bound_log(as_log(made), averaged), averaged, terms_of(averaged), window=0.05)
    columns = {k: v for k, v in made.columns.items() if k not in ("ax", "ay")}
    without = build_rows(bound_log(Log("x.csv", "", made.t, columns), swan), swan, terms_of(swan), window=0.05)
    assert violated(with_it, made.truth["parameters"]) == violated(without, made.truth["parameters"]) == 0
    assert (with_it.duration > 0).all() and with_it.time.size == without.time.size
    surge = with_it.channel == 0
    assert np.median(with_it.matrix[surge].width[:, 0]) < 0.7 * np.median(without.matrix[surge].width[:, 0])


def test_a_lost_row_is_not_averaged_over(swan, programme):
    """Every seventh row is missing from the file: the reading after it averages one sample of the two, and is not used for both."""
    averaged = changed(
        swan,
        ("[sensors.acceleration]\n", '[sensors.acceleration]\nsampling = "averaged"\n'),
        ("random_walk = [0.0018, 0.002]", "random_walk = [1e-6, 1e-6]"),
        ("bias_instability = [3.0e-4, 2.8e-4]", "bias_instability = 1e-7"),
    )
    made = simulate(averaged, programme.model_copy(update={"noise": "uniform"}), 13)
    kept = np.arange(made.t.size) % 7 != 3
    columns = {k: v[kept] for k, v in made.columns.items()}
    # A demand that changed in a lost row is known no more: such steps are left to one constant demand.
    steady = {k: np.full(kept.sum(), v[0]) for k, v in columns.items() if k.startswith("demand")}
    log = Log("x.csv", "", made.t[kept], {**columns, **steady})
    bounded = bound_log(log, averaged)
    from ivsid.rows.equations import Equations
    from ivsid.rows.integral import Quadrature

    equations = Equations(bounded, averaged, tuple(terms_of(averaged)), 0.0)
    t = made.t[kept]
    starts = np.arange(t.size - 1)
    spans = equations.clock[starts + 1] - equations.clock[starts]
    quadrature = Quadrature(equations, np.diff(t), starts, 1, spans)
    u = bounded.channels["u"]
    found = quadrature._narrowed(u[1:] - u[:-1], "u")
    true = np.diff(made.exact["u"][kept])
    assert found.contains(true).all()
    short = np.diff(t) < 0.06
    assert np.median(found.width[short]) < 0.7 * np.median(found.width[~short])


def test_an_averaged_gyro_is_widened_by_what_the_rate_can_move(swan, twin):
    vehicle = changed(swan, ("bias_time = 270.0", 'bias_time = 270.0\nsampling = "averaged"'))
    mean = np.r_[twin.columns["r"][0], 0.5 * (twin.exact["r"][1:] + twin.exact["r"][:-1])]
    columns = {**twin.columns, "r": mean}
    bounded = bound_log(Log("x.csv", "", twin.t, columns), vehicle)
    assert bounded.channels["r"].contains(twin.exact["r"]).all()
    h = np.diff(twin.t).max()
    wider = bounded.channels["r"].radius - bound_log(Log("x.csv", "", twin.t, columns), swan).channels["r"].radius
    assert wider == pytest.approx(0.5 * 1.5 * h, rel=1e-6)
    unbounded = changed(
        swan, ("bias_time = 270.0", 'bias_time = 270.0\nsampling = "averaged"'), ("yaw_acceleration = 1.5\n", "")
    )
    with pytest.raises(IvsidError, match="needs .*yaw_acceleration"):
        bound_log(as_log(twin), unbounded)


def test_averaged_forces_off_the_origin_come_back_by_the_means_over_their_steps(swan):
    """The oracle averages the formula of a rigid body over each step by fine sums; derivatives at samples were half a step late."""
    h, fine = 0.05, 400
    t = np.arange(0.0, 20.0, h)
    inside = t[:, None] - h + (np.arange(fine) + 0.5) / fine * h
    r, rdot = (
        (lambda s: 0.8 * np.sin(3.0 * s) + 0.3 * np.cos(7.0 * s)),
        (lambda s: 2.4 * np.cos(3.0 * s) - 2.1 * np.sin(7.0 * s)),
    )
    x, y = 0.05, -0.03
    text = changed(
        swan, ("[sensors.acceleration]\n", f'[sensors.acceleration]\nsampling = "averaged"\nposition = [{x}, {y}]\n')
    )
    ax, ay = 0.2 * np.sin(t), 0.1 * np.cos(t)
    read = {
        "ax": ax + (-x * r(inside) ** 2 - y * rdot(inside)).mean(axis=1),
        "ay": ay + (x * rdot(inside) - y * r(inside) ** 2).mean(axis=1),
        "r": r(t),
    }
    back = lever_arms.at_origin(Log("1.csv", "0" * 64, t, read), text.sensors).columns
    assert np.abs(back["ax"] - ax)[1:].max() < 1e-3 and np.abs(back["ay"] - ay)[1:].max() < 1e-3
    # What samples give of the same readings is wrong by ten times that.
    sampled = text.sensors.model_copy(
        update={"acceleration": text.sensors.acceleration.model_copy(update={"sampling": "instantaneous"})}
    )
    late = lever_arms.at_origin(Log("1.csv", "0" * 64, t, read), sampled).columns
    assert np.abs(late["ay"] - ay)[1:].max() > 0.01
