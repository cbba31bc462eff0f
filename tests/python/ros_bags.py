"""A run of ``ivsid example`` as a ROS 2 bag: REP 103 axes, odometry, an IMU without gravity, a command for each propeller."""

from pathlib import Path

import numpy as np
import polars as pl

EPOCH = 1_700_000_000_000_000_000


def bag(run: Path, folder: Path) -> None:
    """Writes the folder of a bag from the log ``run``, at its own stamps."""
    from rosbags.rosbag2 import StoragePlugin, Writer
    from rosbags.typesys import Stores, get_typestore

    store = get_typestore(Stores.ROS2_HUMBLE)

    def message(kind, **fields):
        return store.types[kind](**fields)

    def vector(x=0.0, y=0.0, z=0.0, kind="Vector3"):
        return message(f"geometry_msgs/msg/{kind}", x=x, y=y, z=z)

    pose_errors, errors = np.zeros(36), np.zeros(9)
    with Writer(folder, version=9, storage_plugin=StoragePlugin.MCAP) as writer:

        def topic(name, kind):
            made = writer.add_connection(name, kind, typestore=store)
            return lambda ns, content: writer.write(made, ns, store.serialize_cdr(content, kind))

        odometry, imu = topic("/odom", "nav_msgs/msg/Odometry"), topic("/imu/data", "sensor_msgs/msg/Imu")
        commands = {n: topic(f"/thrusters/{n}/command", "std_msgs/msg/Float64") for n in ("port", "starboard")}
        for row in pl.read_csv(run).iter_rows(named=True):
            ns = EPOCH + round(row["t"] * 1e9)
            stamp = message("builtin_interfaces/msg/Time", sec=ns // 10**9, nanosec=ns % 10**9)
            header = message("std_msgs/msg/Header", stamp=stamp, frame_id="base_link")
            # East of north becomes north of east.
            half = (np.pi / 2 - row["psi"]) / 2
            turned = message("geometry_msgs/msg/Quaternion", x=0.0, y=0.0, z=float(np.sin(half)), w=float(np.cos(half)))
            place = vector(row["y"], row["x"], kind="Point")
            pose = message("geometry_msgs/msg/Pose", position=place, orientation=turned)
            twist = message("geometry_msgs/msg/Twist", linear=vector(row["u"], -row["v"]), angular=vector(z=-row["r"]))
            odometry(
                ns,
                message(
                    "nav_msgs/msg/Odometry",
                    header=header,
                    child_frame_id="base_link",
                    pose=message("geometry_msgs/msg/PoseWithCovariance", pose=pose, covariance=pose_errors),
                    twist=message("geometry_msgs/msg/TwistWithCovariance", twist=twist, covariance=pose_errors),
                ),
            )
            imu(
                ns,
                message(
                    "sensor_msgs/msg/Imu",
                    header=header,
                    orientation=turned,
                    orientation_covariance=errors,
                    angular_velocity=vector(z=-row["r"]),
                    angular_velocity_covariance=errors,
                    linear_acceleration=vector(row["ax"], -row["ay"]),
                    linear_acceleration_covariance=errors,
                ),
            )
            for name, send in commands.items():
                send(ns, message("std_msgs/msg/Float64", data=row[f"demand_{name}"]))
