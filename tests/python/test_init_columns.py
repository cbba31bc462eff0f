"""``ivsid init``: columns, units and signs of a motion in the names of other programs."""

import re

import numpy as np
import polars as pl
import pytest

import program_logs as programs
from ivsid.log import read_log
from ivsid.proposal import propose
from ivsid.vehicle import parse_vehicle
from ivsid.workflow import init
from program_logs import MOTION, filled

# Each writer, the frame of its file, the words of the questions that it must raise, and channels beside u, v, r and the demands.
WRITERS = {
    "ros": (programs.ros, "flu", (), ("psi", "x", "y", "ax", "ay")),
    "foxglove": (programs.foxglove, "flu", (), ()),
    "foxglove_rows": (programs.foxglove_rows, "flu", (), ()),
    "data_base": (programs.data_base, "frd", (), ("psi",)),
    "ardupilot": (programs.ardupilot, "frd", (), ("psi", "x", "y", "roll", "pitch")),
    "mavlink": (programs.mavlink, "frd", (), ("psi", "x", "y", "roll", "pitch")),
    "px4": (programs.px4, "frd", (), ("psi", "x", "y")),
    "mss": (programs.mss, "frd", (), ("psi", "x", "y")),
    "pvs": (programs.pvs, "frd", (), ("psi",)),
    "endings": (programs.endings, "frd", (), ("psi",)),
    "bare": (programs.bare, "frd", (), ("psi", "x", "y")),
    "bare_degrees": (
        programs.bare_degrees,
        "frd",
        ("psi reaches .* read in deg", "r reaches .* read in deg/s"),
        ("psi",),
    ),
    "mirrored": (programs.mirrored, "flu", ("r falls where port pushes more",), ("psi", "x", "y")),
    "topics": (programs.topics, "flu", (), ("psi",)),
    "ros_compass": (
        programs.ros_compass,
        "flu",
        ("heading_deg rises where the yaw rate turns to starboard, so it is read from north to east",),
        ("psi",),
    ),
    "opposed": (
        programs.opposed,
        "frd",
        ("gyro_z falls while heading_deg rises, so it is read with the opposite sign",),
        ("psi",),
    ),
}


TRUE = {
    **{"u": MOTION.u, "v": MOTION.v, "r": MOTION.r, "psi": MOTION.psi, "x": MOTION.north, "y": MOTION.east},
    **{"ax": MOTION.ax, "ay": MOTION.ay, "roll": MOTION.roll, "pitch": MOTION.pitch},
}


@pytest.mark.parametrize("name", WRITERS)
def test_a_motion_in_the_names_of_a_program_is_read_as_it_was(tmp_path, name):
    write, frame, questions, further = WRITERS[name]
    path = write(MOTION, tmp_path)
    if name == "ardupilot":
        pytest.importorskip("pymavlink")
    out = tmp_path / "boat.toml"
    made = init([path], out)
    # The file is read back from its text, by the readers that identify and diagnose use.
    vehicle = parse_vehicle(filled(out.read_text()), "boat.toml")
    log = read_log(path, vehicle.log)
    assert vehicle.log.frame == frame and made.record["frame"] == frame
    np.testing.assert_allclose(log.t - log.t[0], MOTION.t, atol=2e-6)
    for channel in ("u", "v", "r", *further):
        error = log.columns[channel] - TRUE[channel]
        error = np.angle(np.exp(1j * error)) if channel == "psi" else error
        # A slower table stands between its own rows under the proposed rates; but for the last row, after its end.
        own = error[:: 2 if name == "px4" and channel != "r" else 1]
        assert np.isfinite(error[:-1]).all() and np.nanmax(np.abs(own)) < 1e-5, channel
    pushed = [t.name for t in vehicle.thrusters]
    assert len(pushed) == 2
    for side, thruster in zip((MOTION.port, MOTION.starboard), vehicle.thrusters, strict=True):
        demand = log.columns[f"demand_{thruster.name}"]
        expected = (side - 1500) / 400 if name == "px4" else side
        assert np.nanmax(np.abs(demand - expected)) < 1e-9
        # Shares of a controller and speeds in rad/s rest at zero, pulses at 1500.
        assert thruster.neutral == (0.0 if name in ("px4", "pvs") else 1500.0)
    raised = made.record["questions"]
    assert len(raised) == len(questions)
    assert all(re.search(q, r) for q, r in zip(questions, raised, strict=True)), raised


@pytest.mark.parametrize("sign", [-1.0, 1.0])
def test_sway_takes_the_sign_of_a_turned_yaw_rate_where_the_vessel_drifts_outward(tmp_path, sign):
    """Plain names beside a compass: forward, port and up, or a gyro alone upside down."""
    v = -0.3 * MOTION.r
    ay = np.gradient(v, MOTION.t) + MOTION.u * MOTION.r
    table = {"t": MOTION.t, "u": MOTION.u, "v": sign * v, "r": -MOTION.r, "ax": MOTION.ax, "ay": sign * ay}
    table |= {
        "heading_deg": np.degrees(MOTION.psi) % 360,
        "demand_port": MOTION.port,
        "demand_starboard": MOTION.starboard,
    }
    pl.DataFrame(table).write_csv(tmp_path / "log.csv")
    raised = init([tmp_path / "log.csv"], tmp_path / "boat.toml").record["questions"]
    vehicle = parse_vehicle(filled((tmp_path / "boat.toml").read_text()), "boat.toml")
    log = read_log(tmp_path / "log.csv", vehicle.log)
    assert vehicle.log.frame == "frd"
    for name, true in (("v", v), ("r", MOTION.r), ("ay", ay)):
        np.testing.assert_allclose(log.columns[name], true, atol=1e-9)
    assert not any("does the sway velocity need" in q for q in raised)
    assert sum("with the opposite sign alone" in q for q in raised) == (2 if sign < 0 else 0)


def test_a_smooth_heading_keeps_the_constant_error_of_a_good_compass(tmp_path):
    """The attitude of a filter has no scatter, and was proposed with an accuracy of 0.008 degrees."""
    made = init([programs.topics(MOTION, tmp_path)], tmp_path / "boat.toml")
    sensors = parse_vehicle(filled((tmp_path / "boat.toml").read_text()), "boat.toml").sensors
    assert sensors.heading.accuracy == 0.009 and sensors.attitude.accuracy >= 0.0045
    assert (
        "the constant error of a good sensor" in (tmp_path / "boat.toml").read_text() and made.record["questions"] == []
    )


def test_an_accelerometer_that_feels_gravity_is_declared_so(tmp_path):
    for write in (programs.mavlink, programs.ros):
        path = write(MOTION, tmp_path)
        out = tmp_path / f"{write.__name__}.toml"
        init([path], out)
        vehicle = parse_vehicle(filled(out.read_text()), "boat.toml")
        assert vehicle.sensors.acceleration.gravity is True and vehicle.sensors.attitude is not None
        felt = read_log(path, vehicle.log).columns
        x, y = MOTION.felt if write is programs.mavlink else (MOTION.ax, MOTION.ay)
        assert np.abs(felt["ax"] - x).max() < 1e-9 and np.abs(felt["ay"] - y).max() < 1e-9


def test_readings_of_gravity_without_attitude_are_left_out_with_a_word(tmp_path):
    path = tmp_path / "log.csv"
    pl.DataFrame(
        {
            "t": MOTION.t,
            "u": MOTION.u,
            "v": MOTION.v,
            "IMU.GyrZ": MOTION.r,
            "IMU.AccX": MOTION.ax,
            "IMU.AccY": MOTION.ay,
        }
    ).write_csv(path)
    found = propose([path])
    assert "ax" not in found.channels and "ay" not in found.channels
    assert any("IMU.AccX holds gravity" in q for q in found.questions)


def test_a_gyro_in_degrees_is_known_by_the_compass_beside_it(tmp_path):
    """The largest reading, 2 deg/s, would be a possible yaw rate in rad/s."""
    path = programs.bare_slow_degrees(MOTION, tmp_path)
    found = propose([path])
    assert np.abs(found.logs[0].columns["r"] - MOTION.r / 10).max() < 1e-12
    assert any("psi changes as if r were in deg/s" in q for q in found.questions)
    np.testing.assert_array_equal(found.logs[0].columns["psi"], MOTION.psi)


def test_a_heading_that_counts_turns_is_no_heading_in_degrees(tmp_path):
    turns = MOTION.psi - MOTION.psi[0] + 3.0 + 0.2 * MOTION.t
    for factor, unit in ((1.0, "rad"), (180 / np.pi, "deg")):
        path = tmp_path / f"{unit}.csv"
        north = np.cumsum(np.cos(turns)) * 0.05
        east = np.cumsum(np.sin(turns)) * 0.05
        zero = 0 * turns
        pl.DataFrame(
            {"t": MOTION.t, "u": zero + 1, "v": zero, "r": zero + 0.1, "psi": factor * turns, "x": north, "y": east}
        ).write_csv(path)
        found = propose([path])
        assert np.abs(found.logs[0].columns["psi"] - turns).max() < 1e-9
        assert any(f"read in {unit}" in q for q in found.questions)


def test_the_best_column_is_taken_and_the_others_are_named(tmp_path):
    text = propose_text(programs.ros(MOTION, tmp_path), tmp_path)
    (line,) = [x for x in text.splitlines() if x.startswith("r = ")]
    assert '"/imu/data.angular_velocity.z"' in line and "also odom.twist.twist.angular.z" in line


def propose_text(path, folder):
    init([path], folder / "text.toml")
    return (folder / "text.toml").read_text()
