"""Logs as strangers write them: headers of instruments, GNSS, rudders, azimuth thrusters, thrusters of ROS by their topics."""

import datetime

import numpy as np
import polars as pl
import pytest

import program_logs as programs
from ivsid import IvsidError, read_log
from ivsid.log.given import log_of
from ivsid.proposal import Answers, propose

MOTION = programs.Motion(30.0, 20.0)
ROWS = [f"{t},{u},{r}" for t, u, r in zip(MOTION.t, MOTION.u, MOTION.r, strict=True)]


@pytest.mark.parametrize(
    ("before", "encoding"),
    [
        ("t,u,r\n", "utf-8"),
        ("sep=,\nt,u,r\n", "utf-8-sig"),
        ("# Logger 2.1\n# vessel: A, B\n\nt,u,r\n", "utf-8"),
        ("# t,u,r\n", "utf-8"),
        ("% t, u, r\n", "utf-8"),
        ("// by hand\nt,u,r\ns,m/s,rad/s\n", "utf-8"),
        ("t,u,r\n[s],[m/s],[rad/s]\n", "utf-8"),
        ("t,u,r\n", "utf-16"),
    ],
)
def test_what_stands_before_the_samples_is_no_sample(tmp_path, before, encoding):
    path = tmp_path / "log.csv"
    path.write_text(before + "\n".join(ROWS) + "\n", encoding=encoding)
    log = read_log(path)
    for name in ("t", "u", "r"):
        np.testing.assert_array_equal(getattr(log, name) if name == "t" else log.columns[name], getattr(MOTION, name))


def test_a_row_of_units_counts_and_words_in_samples_are_none(tmp_path):
    path = tmp_path / "log.csv"
    path.write_text("t;u;r\nms;kn;deg/min\n" + "0;1,5;60\n500;2;30\n1000;2,5;0\n")
    log = read_log(path)
    np.testing.assert_allclose(log.t, [0, 0.5, 1.0])
    np.testing.assert_allclose(log.columns["u"], np.array([1.5, 2, 2.5]) * 1852 / 3600)
    np.testing.assert_allclose(log.columns["r"], np.radians([1, 0.5, 0]))
    # A first row of samples whose words happen to be units.
    path.write_text("t,mode,side\n0,m,s\n1,m,s\n2,m,s\n")
    assert read_log(path).t.size == 3
    # A faulty cell is named by its line in the file.
    path.write_text("# made by hand\nt,u\ns,m/s\n0,1\n1,x\n")
    with pytest.raises(IvsidError, match="holds 'x' in row 5"):
        read_log(path)


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"PK\x03\x04 and more", "is a workbook or another packed archive; save the sheet as CSV"),
        (b"ULog\x01\x12\x35\x01 and more", "is a ULog of PX4; turn it into tables with `ulog2csv`"),
        (b"\xff\xfea\x00\x00\xd8b\x00\n\x00", "begins as text in UTF-16 and is damaged"),
        (b"0.0,1.5,2\n0.1,1.5,2\n", "has no header row: it begins with the numbers 0.0, 1.5, 2; write the names"),
    ],
)
def test_files_that_are_no_table_say_what_to_do(tmp_path, content, words):
    path = tmp_path / "log.csv"
    path.write_bytes(content)
    with pytest.raises(IvsidError, match=words):
        propose([path])


def rudder_log(tmp_path, **columns):
    """A zigzag by Nomoto's equation: a constant shaft, a rudder in degrees that is positive to port."""
    t = np.arange(1200) / 10
    rudder = 20.0 * np.sign(np.sin(0.2 * t + 0.4))
    r = np.zeros_like(t)
    for k in range(1, t.size):
        r[k] = r[k - 1] + 0.1 * (0.5 * np.radians(rudder[k - 1]) - r[k - 1]) / 4.0
    heading = np.degrees(np.cumsum(r) * 0.1)
    path = tmp_path / "ship.csv"
    made = {"t": t, "u": 5 + 0.1 * np.sin(t), "v": 0.1 * np.cos(t), "yaw_rate": r, "heading": heading % 360}
    pl.DataFrame({**made, "shaft_rpm": 80 + 0 * t, "rudder_angle": -rudder, **columns}).write_csv(path)
    return path, rudder, r


def test_a_rudder_is_read_by_its_range_and_by_the_turning(tmp_path):
    path, rudder, _ = rudder_log(tmp_path)
    found = propose([path])
    (thruster,) = found.demands
    log = found.logs[0]
    np.testing.assert_allclose(log.columns[f"rudder_{thruster.name}"], np.radians(rudder))
    assert f"thrusters.{thruster.name}.rudder" in found.blanks(Answers())
    assert any("rudder_angle reaches 20 and is read in deg" in q for q in found.questions)
    assert any("turns to port where rudder_angle is positive" in q for q in found.questions)
    assert any("heading" in q and "deg" in q for q in found.questions)


def test_a_measured_rudder_is_taken_before_the_demanded_one(tmp_path):
    t = np.arange(1200) / 10
    zero = 0 * t
    path, *_ = rudder_log(tmp_path, rudder_command=zero, autopilot_setpoint=zero)
    found = propose([path])
    (angle,) = found.angles.values()
    assert angle.match.column == "rudder_angle" and angle.others == ("rudder_command",)


def test_a_rudder_in_pulses_is_a_question(tmp_path):
    t = np.arange(1200) / 10
    path, _, _ = rudder_log(tmp_path, rudder_angle=1500 + 100 * np.sign(np.sin(t)))
    found = propose([path])
    assert not found.angles and any("rudder_angle may be the angle of a rudder" in q for q in found.questions)


def test_azimuth_thrusters_get_their_own_direction(tmp_path):
    m, swing = MOTION, np.sin(MOTION.t / 3)
    path = tmp_path / "log.csv"
    motion = {"t": m.t, "u": m.u, "v": m.v, "r": m.r, "thruster_port_rpm": m.port, "thruster_stbd_rpm": m.starboard}
    pl.DataFrame({**motion, "azimuth_stbd_deg": -30 * swing, "azimuth_port_deg": 30 * swing}).write_csv(path)
    found = propose([path])
    columns = found.logs[0].columns
    np.testing.assert_allclose(columns["azimuth_port"], np.radians(30 * swing))
    np.testing.assert_allclose(columns["azimuth_stbd"], np.radians(-30 * swing))
    # Speeds of 1520 to 1680 a minute are no pulses.
    assert [d.neutral for d in found.demands] == [0.0, 0.0]
    # One direction without a side is that of both.
    pl.DataFrame({**motion, "steering_angle": swing}).write_csv(path)
    shared = propose([path])
    assert set(shared.angles) == {"azimuth_port", "azimuth_stbd"}
    assert any("steering_angle is taken for the direction of port, stbd" in q for q in shared.questions)


def test_latitude_and_longitude_are_a_position_in_metres(tmp_path):
    m = programs.Motion(60.0, 5.0)
    # Radii of curvature at 54.3 degrees north on WGS 84, worked out apart.
    lat, lon = 54.3 + m.north / 111310.58, 10.1 + m.east / 65103.38
    stamps = [(datetime.datetime(2024, 5, 31) + datetime.timedelta(seconds=float(t))).isoformat() for t in m.t]
    path = tmp_path / "gnss.csv"
    columns = {"utc": stamps, "lat": lat, "lon": lon, "sog_kn": m.u, "heading_deg": programs.compass(m.psi)}
    pl.DataFrame({**columns, "rpm": m.port}).write_csv(path)
    found = propose([path])
    log = found.logs[0]
    np.testing.assert_allclose(log.columns["x"] - log.columns["x"][0], m.north - m.north[0], atol=1e-3)
    np.testing.assert_allclose(log.columns["y"] - log.columns["y"][0], m.east - m.east[0], atol=1e-3)
    assert any("lat and lon are read as metres from the first fix" in q for q in found.questions)


def test_thrusters_of_ros_are_named_by_their_topics(tmp_path):
    """Messages that hold nothing but ``data``, in a folder of tables and in one table; a velocity that is asked for is none that is sailed."""
    m = MOTION
    folder = tmp_path / "bag"
    for topic, columns in {
        "nav/odom": {"twist.twist.linear.x": m.u, "twist.twist.linear.y": -m.v, "twist.twist.angular.z": -m.r},
        "nav/cmd_vel": {"linear.x": m.u + 1, "linear.y": m.v, "angular.z": m.r},
        "thrusters/port/command": {"data": m.port},
        "thrusters/starboard/command": {"data": m.starboard},
        "thrusters/port/state": {"data": m.port + 1},
    }.items():
        (folder / topic).parent.mkdir(parents=True, exist_ok=True)
        pl.DataFrame({"t": m.t, **columns}).write_csv(folder / f"{topic}.csv")
    found = propose([folder])
    assert [d.name for d in found.demands] == ["port", "starboard"]
    np.testing.assert_array_equal(found.logs[0].columns["u"], m.u)
    flat = tmp_path / "flat.csv"
    command = {"/wamv/thrusters/left/thrust/data": m.port, "/wamv/thrusters/right/thrust/data": m.starboard}
    asked = {"/cmd_vel/twist/linear/x": m.u + 1, "/odom/twist/twist/linear/x": m.u}
    pl.DataFrame({"__time": m.t, **asked, "/odom/twist/twist/linear/y": -m.v, "/r": m.r, **command}).write_csv(flat)
    found = propose([flat])
    assert [d.name for d in found.demands] == ["left", "right"]
    np.testing.assert_array_equal(found.logs[0].columns["u"], m.u)


def test_a_row_for_each_reading_in_memory_and_on_clocks_of_their_own(tmp_path):
    """Two topics at different rates, and a series of words beside them."""
    m = MOTION
    rows = [(t, "/odom.twist.twist.linear.x", x) for t, x in zip(m.t, m.u, strict=True)]
    rows += [(t, "/odom.twist.twist.linear.y", x) for t, x in zip(m.t, m.v, strict=True)]
    rows += [(t, "/imu/angular_velocity/z", x) for t, x in zip(m.t[::2] + 0.001, m.r[::2], strict=True)]
    rows += [(t, "/shaft.demand_a", x) for t, x in zip(m.t, m.port, strict=True)]
    frame = pl.DataFrame(sorted(rows), schema=("t", "topic", "value"), orient="row")
    path = tmp_path / "rows.csv"
    frame.write_csv(path)
    for given in (read_log(path, propose([path]).mapped.checked), log_of(frame, propose([path]).mapped.checked)):
        assert set(given.columns) == {"u", "v", "demand_a", "r"}
        np.testing.assert_array_equal(given.columns["r"], -m.r[::2])
        np.testing.assert_allclose(given.columns["u"], np.interp(given.t, m.t, m.u), atol=1e-4)
    # A wide table that has such columns, too, stays as it is.
    pl.DataFrame({"t": m.t, "u": m.u, "name": ["boat"] * m.t.size, "value": m.v}).write_csv(path)
    np.testing.assert_array_equal(read_log(path).columns["u"], m.u)
