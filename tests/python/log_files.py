"""Writers of small logs in every format that is read, for the tests of the readers."""

import gzip
import struct
from pathlib import Path

import numpy as np
import polars as pl
from scipy.io import savemat

from ivsid.files.log_map import LogMap

N = 200
T = np.arange(N) * 0.05
U = 1.0 + 0.3 * np.sin(T)
V = 0.1 * np.cos(2 * T)
R = 0.2 * np.sin(3 * T + 0.4)
PORT = np.where(T < 4, 30.0, 55.0)
COLUMNS = {"u": U, "v": V, "r": R, "demand_port": PORT}
# Stamps as ROS and ArduPilot write them.
NS = 1_700_000_000_000_000_000 + np.round(T * 1e9).astype(np.int64)


def frame(**columns) -> pl.DataFrame:
    return pl.DataFrame({"t": T, **(columns or COLUMNS)})


def csv(path: Path) -> Path:
    frame().write_csv(path)
    return path


def packed(path: Path) -> Path:
    path.write_bytes(gzip.compress(frame().write_csv().encode()))
    return path


def parquet(path: Path) -> Path:
    frame().write_parquet(path)
    return path


def packed_parquet(path: Path) -> Path:
    frame().write_parquet(path)
    path.write_bytes(gzip.compress(path.read_bytes()))
    return path


def matlab(path: Path, version: str = "5") -> Path:
    savemat(path, {"t": T, **COLUMNS}, format=version)
    return path


def bag(path: Path, storage: str = "sqlite3", u=U, stamps=NS) -> Path:
    """Velocities on /dvl, rates on /imu, the demand on /port without a header."""
    from rosbags.rosbag2 import StoragePlugin, Writer
    from rosbags.typesys import Stores, get_typestore

    store = get_typestore(Stores.ROS2_HUMBLE)
    kinds = {
        name: store.types[name]
        for name in (
            *("std_msgs/msg/Header", "builtin_interfaces/msg/Time", "std_msgs/msg/Float64", "geometry_msgs/msg/Twist"),
            *("geometry_msgs/msg/Vector3", "geometry_msgs/msg/TwistStamped", "sensor_msgs/msg/Imu"),
            "geometry_msgs/msg/Quaternion",
        )
    }
    header, time, number = (kinds[k] for k in list(kinds)[:3])
    twist, vector, stamped, imu, quaternion = (kinds[k] for k in list(kinds)[3:])

    def stamp(ns):
        return header(stamp=time(sec=int(ns) // 10**9, nanosec=int(ns) % 10**9), frame_id="base")

    plugin = StoragePlugin.SQLITE3 if storage == "sqlite3" else StoragePlugin.MCAP
    with Writer(path, version=9, storage_plugin=plugin) as writer:
        dvl = writer.add_connection("/dvl", "geometry_msgs/msg/TwistStamped", typestore=store)
        gyro = writer.add_connection("/imu/data", "sensor_msgs/msg/Imu", typestore=store)
        port = writer.add_connection("/port", "std_msgs/msg/Float64", typestore=store)
        zero, nine = vector(x=0.0, y=0.0, z=0.0), np.zeros(9)
        for k, ns in enumerate(stamps):
            message = stamped(stamp(ns), twist(vector(x=float(u[k]), y=float(V[k]), z=0.0), zero))
            writer.write(dvl, int(ns), store.serialize_cdr(message, "geometry_msgs/msg/TwistStamped"))
            rate = vector(x=0.0, y=0.0, z=float(R[k]))
            reading = imu(stamp(ns), quaternion(x=0.0, y=0.0, z=0.0, w=1.0), nine, rate, nine, zero, nine)
            writer.write(gyro, int(ns), store.serialize_cdr(reading, "sensor_msgs/msg/Imu"))
            writer.write(port, int(ns), store.serialize_cdr(number(float(PORT[k])), "std_msgs/msg/Float64"))
    return path


BAG_MAP = {
    "columns": {
        "u": "/dvl/twist.linear.x",
        "v": "/dvl/twist.linear.y",
        "r": "/imu/data/angular_velocity.z",
        "demand_port": "/port/data",
    }
}


def dataflash(path: Path, u=U, stamps=None) -> Path:
    """Two message types on one clock; the floats of the format are doubles here."""
    stamps = (T * 1e6 + 5e6).round().astype(np.int64) if stamps is None else stamps

    def layout(number, size, name, form, labels):
        return struct.pack("<BBBBB4s16s64s", 0xA3, 0x95, 0x80, number, size, name, form, labels)

    parts = [
        layout(0x80, 89, b"FMT", b"BBnNZ", b"Type,Length,Name,Format,Columns"),
        layout(0x90, 3 + 8 + 16, b"DVL", b"Qdd", b"TimeUS,VX,VY"),
        layout(0x91, 3 + 8 + 16, b"CTL", b"Qdd", b"TimeUS,GyrZ,Port"),
    ]
    for k, us in enumerate(stamps):
        parts.append(struct.pack("<BBBQdd", 0xA3, 0x95, 0x90, int(us), u[k], V[k]))
        parts.append(struct.pack("<BBBQdd", 0xA3, 0x95, 0x91, int(us), R[k], PORT[k]))
    path.write_bytes(b"".join(parts))
    return path


DATAFLASH_MAP = {"columns": {"u": "DVL/VX", "v": "DVL/VY", "r": "CTL/GyrZ", "demand_port": "CTL/Port"}}


def folder(path: Path) -> Path:
    path.mkdir()
    frame(u=U, v=V).write_csv(path / "dvl.csv")
    frame(r=R, demand_port=PORT).write_parquet(path / "imu.parquet")
    (path / "notes.txt").write_text("not a table")
    return path


FORMATS = {
    "csv": (lambda p: csv(p / "log.csv"), {}),
    "gzip": (lambda p: packed(p / "log.csv.gz"), {}),
    "parquet": (lambda p: parquet(p / "log.parquet"), {}),
    "parquet_gzip": (lambda p: packed_parquet(p / "log.parquet.gz"), {}),
    "matlab5": (lambda p: matlab(p / "log.mat"), {}),
    "matlab4": (lambda p: matlab(p / "log.mat", "4"), {}),
    "sqlite": (lambda p: bag(p / "bag"), BAG_MAP),
    "sqlite_file": (lambda p: next(bag(p / "bag").glob("*.db3")), BAG_MAP),
    "mcap": (lambda p: bag(p / "bag", "mcap"), BAG_MAP),
    "mcap_file": (lambda p: next(bag(p / "bag", "mcap").glob("*.mcap")), BAG_MAP),
    "dataflash": (lambda p: dataflash(p / "log.bin"), DATAFLASH_MAP),
    "folder": (lambda p: folder(p / "run"), {}),
}


def log_map(**more):
    return LogMap.model_validate(more)


def two_tables(path, **tables):
    """A folder with a table of each name."""
    path.mkdir()
    for name, columns in tables.items():
        pl.DataFrame(columns).write_csv(path / f"{name}.csv")
    return path


def rows_at(t):
    """Rows whose readings do not matter."""
    return {"t": t, "u": np.ones(t.size), "v": np.zeros(t.size), "r": 0.1 + 0.01 * (np.arange(t.size) % 9)}
