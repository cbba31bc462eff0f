"""Elements of SDF that Gazebo and VRX share. Axes: forward, port, up; the earth's: east, north, up (REP 103).

Sway, yaw rate and arms change their sign against forward, starboard, down; a coefficient whose force and velocities all change theirs
keeps its own.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Final

from ivsid.exports.number import Number
from ivsid.exports.planar import Planar
from ivsid.propulsion.thrust import ThrustCurve

# Density of the plugin Thruster in its formula T = rho K D^4 w|w| [kg/m^3]. Only the product of all factors acts.
# Source: gz-sim, src/systems/thruster/Thruster.cc, default of fluid_density
DENSITY: Final = 1000.0
OPENING: Final = '<?xml version="1.0"?>'
COMMENT: Final = ("<!--", "-->")


def element(tag: str, number: Number, indent: int = 6) -> str:
    """An element with its interval as a comment."""
    return f"{' ' * indent}<{tag}>{number.value!r}</{tag}>  <!-- {number.words} -->"


def plain(tag: str, value: float, why: str, indent: int = 6) -> str:
    """An element that no log gave, with the reason of its value."""
    return f"{' ' * indent}<{tag}>{value!r}</{tag}>  <!-- {why} -->"


def link(model: Planar, added: Sequence[str] = ()) -> list[str]:
    """The link base_link at the body origin.

    Args:
        model: whose rigid body it is.
        added: lines of ``<fluid_added_mass>``.
    """
    x, y = model.centre
    inertia = model.rigid_inertia
    return [
        '    <link name="base_link">',
        "      <inertial>",
        f"        <pose>{x!r} {-y!r} 0 0 0 0</pose>  <!-- centre of gravity: forward, port, up -->",
        plain("mass", model.mass, "rigid body, kg", 8),
        "        <inertia>",
        plain("ixx", inertia, "not identified: as izz, so that the matrix is valid", 10),
        plain("iyy", inertia, "not identified: as izz, so that the matrix is valid", 10),
        plain("izz", inertia, "about the centre of gravity; only its sum with the added inertia acts", 10),
        *(f"          <{q}>0</{q}>" for q in ("ixy", "ixz", "iyz")),
        "        </inertia>",
        *added,
        "      </inertial>",
        "    </link>",
    ]


def thrusters(model: Planar) -> tuple[list[str], set[str], list[str]]:
    """A frame and a plugin Thruster for each thruster, the numbers that they hold, and sentences on what they lack."""
    lines: list[str] = []
    says: set[str] = set()
    lacks: list[str] = []
    for t in model.vehicle.thrusters:
        x, y = t.position
        lines += [
            f'    <frame name="thruster_{t.name}" attached_to="base_link">',
            f"      <pose>{x!r} {-y!r} 0 0 0 {-t.azimuth!r}</pose>  <!-- place of the joint; thrust along its x axis -->",
            "    </frame>",
            '    <plugin filename="gz-sim-thruster-system" name="gz::sim::systems::Thruster">',
            f"      <joint_name>{t.name}_joint</joint_name>",
        ]
        cap = model.of_thruster("thruster.saturation", t.name)
        low, high = ThrustCurve(t).range
        if t.quadratic is not None and t.quadratic.forward and t.neutral == 0.0:
            k = t.quadratic.forward
            lines += [
                "      <velocity_control>true</velocity_control>",
                "      <use_angvel_cmd>true</use_angvel_cmd>  <!-- the demand goes to cmd_vel -->",
                f"      <fluid_density>{DENSITY!r}</fluid_density>",
                "      <propeller_diameter>1.0</propeller_diameter>  <!-- only rho K D^4 acts -->",
                f"      <thrust_coefficient>{k / DENSITY!r}</thrust_coefficient>  <!-- T = rho K D^4 w|w| -->",
            ]
            if t.quadratic.astern != k:
                lacks.append(
                    f"the thrust of {t.name} astern, {t.quadratic.astern!r} n|n|: the plugin has one coefficient"
                )
            band = model.of_thruster("thruster.deadband", t.name)
            if band is not None:
                # The plugin compares the thrust [N] with it.
                lines.append(f"      <deadband>{k * band.value**2!r}</deadband>  <!-- of the demand: {band.words} -->")
                says |= {"thruster.deadband", f"thruster.deadband.{t.name}"}
            if cap is not None:
                low, high = max(low, -math.sqrt(cap.value / k)), min(high, math.sqrt(cap.value / k))
        else:
            lacks.append(
                f"the thrust curve of {t.name}: command its thrust [N] by cmd_thrust, worked out from the vehicle file's curve"
            )
            if high < math.inf:
                low, high = ThrustCurve(t).value((low, high)).tolist()
            if cap is not None:
                low, high = max(low, -cap.value), min(high, cap.value)
        if cap is not None:
            says |= {"thruster.saturation", f"thruster.saturation.{t.name}"}
        if high < math.inf:
            lines.append(f"      <max_thrust_cmd>{high!r}</max_thrust_cmd>  <!-- the largest command -->")
            lines.append(f"      <min_thrust_cmd>{low!r}</min_thrust_cmd>")
        lines.append("    </plugin>")
    return lines, says, lacks


def summed(parts: Mapping[str, Sequence[tuple[str, float]]], model: Planar) -> dict[str, Number]:
    """Coefficients by tag: the sum of all numbers that it stands for.

    Args:
        parts: tags with factors by id.
        model: with the numbers.
    """
    found: dict[str, Number] = {}
    for id_, tags in parts.items():
        number = model.damping(id_)
        if number is None:
            continue
        for tag, factor in tags:
            # The sign belongs to the symbol, too.
            symbol = (
                number.symbol.lstrip("-")
                if factor == -1.0 and number.symbol.startswith("-")
                else f"{factor:g} ({number.symbol})"
            )
            here = (number * factor).called(symbol)
            found[tag] = found[tag] + here if tag in found else here
    return found
