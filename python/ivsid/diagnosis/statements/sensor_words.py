"""Names of the errors of readings that a vehicle file declares, as sentences say them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

from ivsid.diagnosis.estimation.parting import HEADING, PLACE


@dataclass(frozen=True)
class Words:
    """How an error of a reading is said.

    Attributes:
        name: in a sentence, without an article.
        unit: of its size.
        channel: in which it acts most.
    """

    name: str
    unit: str
    channel: str


WORDS: Final = {
    "~bias.ax": Words("accelerometer's bias in x", "m/s^2", "surge"),
    "~bias.ay": Words("accelerometer's bias in y", "m/s^2", "sway"),
    "~bias.r": Words("gyro's bias", "rad/s", "yaw"),
    "~bias.rdot": Words("bias of the yaw acceleration", "rad/s^2", "yaw"),
    "~bias.u": Words("bias of the velocity ahead", "m/s", "surge"),
    "~bias.v": Words("bias of the velocity to starboard", "m/s", "sway"),
    "~bias.north": Words("bias of the velocity north", "m/s", "surge"),
    "~bias.east": Words("bias of the velocity east", "m/s", "sway"),
    "~bias.psi": Words("bias of the heading", "rad", "yaw"),
    "~deviation.psi": Words("deviation of the compass", "rad", "yaw"),
    "~bias.x": Words("change of the position's error north", "m", "surge"),
    "~bias.y": Words("change of the position's error east", "m", "sway"),
    "~scale.velocity": Words("scale factor error of the velocity", "1", "surge"),
    "~arm.velocity.x": Words("distance of the velocity sensor ahead of its stated position", "m", "sway"),
    "~arm.velocity.y": Words("distance of the velocity sensor to starboard of its stated position", "m", "surge"),
    "~arm.acceleration.x": Words("distance of the accelerometer ahead of its stated position", "m", "sway"),
    "~arm.acceleration.y": Words("distance of the accelerometer to starboard of its stated position", "m", "surge"),
    "~turn.velocity": Words("turn of the velocity sensor beyond its stated rotation", "rad", "sway"),
    "~turn.acceleration": Words("turn of the accelerometer beyond its stated rotation", "rad", "sway"),
}
# Readings that follow from one another, as sentences say them, and the channel of the motion in which they act most.
APART: Final = {
    HEADING: ("the heading and what the gyro adds up", "yaw"),
    PLACE: ("the position and what the velocities add up", "surge"),
}
# Readings with a stated accuracy by channel, as sentences say them, and the channel of the motion in which they act most.
READ: Final = {
    "u": ("the velocity ahead", "surge"),
    "v": ("the velocity to starboard", "sway"),
    "psi": ("the heading", "yaw"),
    "x": ("the position north", "surge"),
    "y": ("the position east", "sway"),
}
