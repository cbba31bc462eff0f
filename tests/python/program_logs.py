"""One motion in the names, units and axes of other programs: writers apart from the package, which know what each program means."""

import re
import struct
from pathlib import Path

import numpy as np
import polars as pl
from scipy.io import savemat

G = 9.80665
EPOCH = 1_700_000_000.0


class Motion:
    """A boat that turns both ways: forward, starboard, down; north, east; radians. Pulses of its two screws rest at 1500."""

    def __init__(self, seconds: float = 60.0, rate: float = 20.0):
        self.t = t = np.arange(round(seconds * rate)) / rate
        fine = np.arange(0, seconds, 1e-3)
        self.u = 1.2 + 0.4 * np.sin(0.3 * t)
        self.v = 0.15 * np.sin(0.7 * t + 0.2)
        self.r = 0.3 * np.sin(0.5 * t) + 0.05
        # The heading and the path as integrals on a clock of their own.
        r = 0.3 * np.sin(0.5 * fine) + 0.05
        psi = 0.4 + np.concatenate([[0.0], np.cumsum(0.5 * (r[1:] + r[:-1]) * 1e-3)])
        u, v = 1.2 + 0.4 * np.sin(0.3 * fine), 0.15 * np.sin(0.7 * fine + 0.2)
        north = np.cumsum(u * np.cos(psi) - v * np.sin(psi)) * 1e-3
        east = np.cumsum(u * np.sin(psi) + v * np.cos(psi)) * 1e-3
        at = np.round(t * 1e3).astype(int)
        self.psi, self.north, self.east = psi[at], north[at], east[at]
        self.ax = 0.12 * np.cos(0.3 * t) - self.v * self.r
        self.ay = 0.105 * np.cos(0.7 * t + 0.2) + self.u * self.r
        self.roll, self.pitch = 0.05 * np.sin(0.9 * t), 0.03 * np.cos(0.8 * t)
        turn = 80.0 * np.sign(np.sin(0.5 * t + 0.3))
        self.port, self.starboard = 1600.0 + turn, 1600.0 - turn

    @property
    def ned(self):
        """Velocity north and east."""
        c, s = np.cos(self.psi), np.sin(self.psi)
        return self.u * c - self.v * s, self.u * s + self.v * c

    @property
    def felt(self):
        """What an accelerometer reads along x and y: specific force less gravity's part, Fossen's rotation of [0, 0, g]."""
        return self.ax + G * np.sin(self.pitch), self.ay - G * np.cos(self.pitch) * np.sin(self.roll)


def compass(psi):
    """Degrees from 0 to 360."""
    return np.degrees(psi) % 360.0


def ros(m: Motion, folder: Path) -> Path:
    """Flattened topics: forward, left, up; east, north; level, so that gravity stays out of x and y."""
    yaw = np.pi / 2 - m.psi
    path = folder / "bag.csv"
    pl.DataFrame(
        {
            "time": EPOCH + m.t,
            "odom.twist.twist.linear.x": m.u,
            "odom.twist.twist.linear.y": -m.v,
            "odom.twist.twist.angular.z": -m.r + 0.01,
            "/imu/data.angular_velocity.z": -m.r,
            "/imu/data.linear_acceleration.x": m.ax,
            "/imu/data.linear_acceleration.y": -m.ay,
            "/imu/data.orientation.x": 0 * yaw,
            "/imu/data.orientation.y": 0 * yaw,
            "/imu/data.orientation.z": np.sin(yaw / 2),
            "/imu/data.orientation.w": np.cos(yaw / 2),
            "odom.pose.pose.position.x": m.east,
            "odom.pose.pose.position.y": m.north,
            "/thrusters/port/command.data": m.port,
            "/thrusters/starboard/command.data": m.starboard,
        }
    ).write_csv(path)
    return path


def foxglove(m: Motion, folder: Path) -> Path:
    """Message paths as columns; only a yaw rate from the odometry, and a heading by nobody."""
    path = folder / "foxglove.csv"
    pl.DataFrame(
        {
            "elapsed time": m.t,
            "/odometry/filtered.twist.twist.linear.x": m.u,
            "/odometry/filtered.twist.twist.linear.y": -m.v,
            "/odometry/filtered.twist.twist.angular.z": -m.r,
            "/cmd/port.data": m.port,
            "/cmd/starboard.data": m.starboard,
        }
    ).write_csv(path)
    return path


def foxglove_rows(m: Motion, folder: Path) -> Path:
    """A plot of Foxglove: a row for each reading, and the stamp of a header where the message has one."""
    series = {
        "/odometry/filtered.twist.twist.linear.x": (m.u, True),
        "/odometry/filtered.twist.twist.linear.y": (-m.v, True),
        "/odometry/filtered.twist.twist.angular.z": (-m.r, True),
        "/thrusters/port/command.data": (m.port, False),
        "/thrusters/starboard/command.data": (m.starboard, False),
    }
    rows = []
    for topic, (values, header) in series.items():
        for t, value in zip(m.t, values, strict=True):
            rows.append((f"{t:.6f}", f"{EPOCH + t:.6f}", f"{EPOCH + t - 0.002:.6f}" if header else "", topic, value))
    rows.sort(key=lambda row: float(row[0]))
    path = folder / "plot.csv"
    names = ("elapsed time", "receive time", "header.stamp", "topic", "value")
    pl.DataFrame(rows, schema=names, orient="row").write_csv(path)
    return path


def data_base(m: Motion, folder: Path) -> Path:
    """Readings of a data base for time series: a measurement, a field and its unit beside each value; all at the same stamps."""
    series = {
        ("motion", "surge", "kn"): m.u * 3600 / 1852,
        ("motion", "sway", "kn"): m.v * 3600 / 1852,
        ("motion", "yaw_rate", "deg/s"): np.degrees(m.r),
        ("motion", "heading", "deg"): compass(m.psi),
        ("actuators", "port_pwm", ""): m.port,
        ("actuators", "starboard_pwm", ""): m.starboard,
    }
    stamps = np.round((EPOCH + m.t) * 1e3).astype(int)
    rows = [(t, *key, x) for key, values in series.items() for t, x in zip(stamps, values, strict=True)]
    path = folder / "base.parquet"
    names = ("time", "_measurement", "_field", "unit", "_value")
    pl.DataFrame(rows, schema=names, orient="row").write_parquet(path)
    return path


def ardupilot(m: Motion, folder: Path) -> Path:
    """A DataFlash log with the usual fields of IMU, ATT, XKF1 and RCOU."""

    def layout(number, size, name, form, labels):
        return struct.pack("<BBBBB4s16s64s", 0xA3, 0x95, 0x80, number, size, name, form, labels)

    def size(form):
        return 3 + {"Q": 8, "f": 4, "d": 8, "H": 2}["Q"] + sum({"d": 8, "H": 2}[c] for c in form[1:])

    kinds = {
        0x90: (b"IMU", "Qddd", b"TimeUS,GyrZ,AccX,AccY"),
        0x91: (b"ATT", "Qddd", b"TimeUS,Roll,Pitch,Yaw"),
        0x92: (b"XKF1", "Qddddd", b"TimeUS,Yaw,VN,VE,PN,PE"),
        0x93: (b"RCOU", "QHHH", b"TimeUS,C1,C2,C3"),
    }
    parts = [layout(0x80, 89, b"FMT", b"BBnNZ", b"Type,Length,Name,Format,Columns")]
    parts += [layout(n, size(f), name, f.encode(), labels) for n, (name, f, labels) in kinds.items()]
    north, east = m.ned
    x, y = m.felt
    for k, us in enumerate(np.round((m.t + 30.0) * 1e6).astype(int)):
        rows = {
            0x90: (m.r[k], x[k], y[k]),
            0x91: (np.degrees(m.roll[k]), np.degrees(m.pitch[k]), compass(m.psi[k])),
            0x92: (compass(m.psi[k]), north[k], east[k], m.north[k], m.east[k]),
            0x93: (round(m.port[k]), 1500, round(m.starboard[k])),
        }
        for n, row in rows.items():
            form = "<BBBQ" + kinds[n][1][1:].replace("Q", "")
            parts.append(struct.pack(form, 0xA3, 0x95, n, int(us), *row))
    path = folder / "00000042.bin"
    path.write_bytes(b"".join(parts))
    return path


def mavlink(m: Motion, folder: Path) -> Path:
    """A telemetry log as one table: thousandths of g and of rad/s in SCALED_IMU2."""
    north, east = m.ned
    x, y = m.felt
    path = folder / "telemetry.csv"
    pl.DataFrame(
        {
            "timestamp": EPOCH + m.t,
            "ATTITUDE.roll": m.roll,
            "ATTITUDE.pitch": m.pitch,
            "ATTITUDE.yaw": (m.psi + np.pi) % (2 * np.pi) - np.pi,
            "SCALED_IMU2.xacc": x / G * 1e3,
            "SCALED_IMU2.yacc": y / G * 1e3,
            "SCALED_IMU2.zgyro": m.r * 1e3,
            "LOCAL_POSITION_NED.x": m.north,
            "LOCAL_POSITION_NED.y": m.east,
            "LOCAL_POSITION_NED.vx": north,
            "LOCAL_POSITION_NED.vy": east,
            "SERVO_OUTPUT_RAW.servo1_raw": m.port,
            "SERVO_OUTPUT_RAW.servo2_raw": 0 * m.port + 1500,
            "SERVO_OUTPUT_RAW.servo3_raw": m.starboard,
        }
    ).write_csv(path)
    return path


def px4(m: Motion, folder: Path) -> Path:
    """A folder of tables, as a converter of ULog writes them; microseconds since the start of the board. The position comes at half the rate."""
    north, east = m.ned
    stamps = np.round((m.t + 97.0) * 1e6).astype(np.int64)
    place = folder / "flight"
    place.mkdir()
    tables = {
        "vehicle_local_position_0": {"x": m.north, "y": m.east, "vx": north, "vy": east, "heading": m.psi},
        "vehicle_local_position_setpoint_0": {"x": 0 * north, "y": 0 * north, "vx": 0 * north},
        "vehicle_angular_velocity_0": {"xyz[0]": 0 * m.r, "xyz[1]": 0 * m.r, "xyz[2]": m.r},
        "actuator_motors_0": {"control[0]": (m.port - 1500) / 400, "control[1]": (m.starboard - 1500) / 400},
    }
    for name, columns in tables.items():
        rows = slice(None, None, 2 if "position" in name else 1)
        table = pl.DataFrame({"timestamp": stamps[rows], **{n: c[rows] for n, c in columns.items()}})
        table.write_csv(place / f"run7_{name}.csv")
    return place


def mss(m: Motion, folder: Path) -> Path:
    """A MATLAB file with the vectors eta and nu of six degrees of freedom, and propeller speeds n."""
    zero = 0 * m.t
    path = folder / "simulation.mat"
    eta = np.column_stack([m.north, m.east, zero, zero, zero, m.psi])
    nu = np.column_stack([m.u, m.v, zero, zero, zero, m.r])
    savemat(path, {"t": m.t, "eta": eta, "nu": nu, "n": np.column_stack([m.port, m.starboard])})
    return path


def pvs(m: Motion, folder: Path) -> Path:
    """The legends of PythonVehicleSimulator as header: degrees."""
    path = folder / "pvs.csv"
    pl.DataFrame(
        {
            "Time (s)": m.t,
            "Surge velocity (m/s)": m.u,
            "Sway velocity (m/s)": m.v,
            "Yaw rate (deg/s)": np.degrees(m.r),
            "Yaw angle (deg)": np.degrees(m.psi),
            "Left propeller shaft speed (rad/s)": m.port,
            "Right propeller shaft speed (rad/s)": m.starboard,
        }
    ).write_csv(path)
    return path


def endings(m: Motion, folder: Path) -> Path:
    """Plain names that end with their units, separated by semicolons; knots and degrees."""
    path = folder / "boat.csv"
    pl.DataFrame(
        {
            "time_ms": m.t * 1e3,
            "surge_kn": m.u * 3600 / 1852,
            "sway_kn": m.v * 3600 / 1852,
            "yaw_rate_deg_s": np.degrees(m.r),
            "heading_deg": compass(m.psi),
            "port_pwm": m.port,
            "starboard_pwm": m.starboard,
            "battery_temperature": 20 + 0 * m.t,
        }
    ).write_csv(path, separator=";")
    return path


def bare(m: Motion, folder: Path) -> Path:
    """The names of the equations alone, in SI."""
    path = folder / "bare.csv"
    pl.DataFrame(
        {
            **{"t": m.t, "u": m.u, "v": m.v, "r": m.r, "psi": m.psi, "x": m.north, "y": m.east},
            **{"demand_port": m.port, "demand_starboard": m.starboard},
        }
    ).write_csv(path)
    return path


def bare_degrees(m: Motion, folder: Path) -> Path:
    """The names of the equations alone, in degrees and degrees per second, which no name says."""
    path = folder / "degrees.csv"
    pl.DataFrame(
        {
            **{"t": m.t, "u": m.u, "v": m.v, "r": np.degrees(m.r), "psi": compass(m.psi)},
            **{"demand_port": m.port, "demand_starboard": m.starboard},
        }
    ).write_csv(path)
    return path


def bare_slow_degrees(m: Motion, folder: Path) -> Path:
    """A compass in radians beside a gyro in deg/s that never reads much, so that only the two together tell the unit."""
    path = folder / "slow.csv"
    pl.DataFrame(
        {
            **{"t": 10 * m.t, "u": m.u, "v": m.v, "r": np.degrees(m.r) / 10, "psi": m.psi},
            **{"demand_port": m.port, "demand_starboard": m.starboard},
        }
    ).write_csv(path)
    return path


def mirrored(m: Motion, folder: Path) -> Path:
    """Plain names in the axes of ROS, which only the side of the stronger screw tells."""
    path = folder / "mirrored.csv"
    pl.DataFrame(
        {
            **{"t": m.t, "u": m.u, "v": -m.v, "r": -m.r, "psi": np.pi / 2 - m.psi, "x": m.east, "y": m.north},
            **{"demand_left": m.port, "demand_right": m.starboard},
        }
    ).write_csv(path)
    return path


def ros_compass(m: Motion, folder: Path) -> Path:
    """Velocities in the axes of ROS beside a compass of plain name."""
    path = folder / "ros_compass.csv"
    pl.DataFrame(
        {
            "time": EPOCH + m.t,
            "odom.twist.twist.linear.x": m.u,
            "odom.twist.twist.linear.y": -m.v,
            "odom.twist.twist.angular.z": -m.r,
            "heading_deg": compass(m.psi),
            "/thrusters/port/command.data": m.port,
            "/thrusters/starboard/command.data": m.starboard,
        }
    ).write_csv(path)
    return path


def topics(m: Motion, folder: Path) -> Path:
    """A folder of topics, of which the commands share another name of their stamps than the rest."""
    path = folder / "run"
    path.mkdir()
    yaw = np.pi / 2 - m.psi
    whole = np.round(m.t * 1e9).astype(int)
    stamp = {"header.stamp.sec": int(EPOCH) + whole // 10**9, "header.stamp.nanosec": whole % 10**9}
    odometry = {"twist.twist.linear.x": m.u, "twist.twist.linear.y": -m.v, "twist.twist.angular.z": -m.r}
    attitude = {
        "orientation.x": 0 * yaw,
        "orientation.y": 0 * yaw,
        "orientation.z": np.sin(yaw / 2),
        "orientation.w": np.cos(yaw / 2),
    }
    pl.DataFrame({**stamp, **odometry}).write_csv(path / "odometry_filtered.csv")
    pl.DataFrame({**stamp, **attitude}).write_csv(path / "imu_data.csv")
    for side, sent in (("left", m.port), ("right", m.starboard)):
        pl.DataFrame({"stamp": EPOCH + m.t, "data": sent}).write_csv(path / f"{side}_thrust_cmd.csv")
    return path


def opposed(m: Motion, folder: Path) -> Path:
    """A gyro that is mounted upside down beside a compass."""
    path = folder / "opposed.csv"
    pl.DataFrame(
        {
            **{"t": m.t, "u": m.u, "v": m.v, "gyro_z": -m.r, "heading_deg": compass(m.psi)},
            **{"demand_port": m.port, "demand_starboard": m.starboard},
        }
    ).write_csv(path)
    return path


MOTION = Motion()


def filled(text: str) -> str:
    """A proposed file with its marked keys filled in, as a user does it by hand: two screws aft."""
    text = re.sub(r'^mass = "TODO"', "mass = 80.0\nlength = 2.0\ncentre_of_gravity = [0.153125, 0.0]", text, flags=re.M)
    sides = iter(("-0.395", "0.395"))
    text = re.sub(r'^position = "TODO"', lambda _: f"position = [0.0, {next(sides)}]", text, flags=re.M)
    curve = 'quadratic = { forward = 0.01108, reverse = 0.006445 }\ntime_constant = 0.1\nlag = "demand"'
    return re.sub(r'^quadratic = "TODO"', curve, text, flags=re.M)
