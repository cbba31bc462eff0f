"""Stonefish: a robot's base link and its thrusters. Axes are those of ivsid: north, east, down, and forward, starboard, down.

Drag and added mass come from the mesh of the body: its coefficients scale forces of the faces, so that no coefficient follows from a model
without the mesh.

Source: Stonefish, docs/theory.rst, docs/bodies.rst, docs/actuators.rst; docs/export.md.
"""

from __future__ import annotations

from typing import Final
from xml.sax.saxutils import quoteattr

from ivsid.exports import sdf
from ivsid.exports.planar import Planar
from ivsid.exports.target import Body, Target, steering_sentences
from ivsid.propulsion.thrust import ThrustCurve
from ivsid.vehicle import Thruster

# Points of a curve that is not linear, for a table between which the simulator is.
# Source: resource: a file that can be read; the error of a parabola falls with their square
POINTS: Final = 201
HELD: Final = (
    "drag.surge.linear",
    "drag.surge.quadratic",
    "drag.sway.linear",
    "drag.sway.quadratic",
    "drag.yaw.linear",
    "drag.yaw.quadratic",
)


def write(model: Planar) -> Body:
    """The body of a scenario's part."""
    x, y = model.centre
    inertia = model.rigid_inertia
    says = {"coupling.cg_x", "coupling.cg_y"}
    unstated = [
        "added masses: the simulator works them out from the mesh, one mean value for all axes (physics submerged), or none (floating)",
        "drags: viscous_drag and quadratic_drag scale forces of the mesh; tow it and set them so that the forces below come out",
        *steering_sentences(model),
    ]
    lines = [
        f'<robot name={quoteattr(model.title)} fixed="false" self_collisions="false">',
        '  <base_link name="base_link" type="model" physics="floating">',
        "    <!-- give physical and visual meshes, material and look -->",
        f'    <mass value="{model.mass!r}"/>',
        f'    <inertia xyz="{inertia!r} {inertia!r} {inertia!r}"/>  <!-- about z; x and y are not identified -->',
        f'    <cg xyz="{x!r} {y!r} 0.0" rpy="0.0 0.0 0.0"/>',
        "  </base_link>",
        *_forces(model),
    ]
    for t in model.vehicle.thrusters:
        made, told, lacks = _thruster(model, t)
        lines += made
        says |= told
        unstated += lacks
    lines.append("</robot>")
    return Body("\n".join(lines), frozenset(says), tuple(unstated))


def _forces(model: Planar) -> list[str]:
    """Forces to tow the mesh by."""
    lines = []
    for id_ in HELD:
        number = model.damping(id_)
        if number is not None:
            lines.append(f"  <!-- {id_} = {number.value!r}: {number.words} -->")
    return lines


def _thruster(model: Planar, t: Thruster) -> tuple[list[str], set[str], list[str]]:
    name = t.name
    says: set[str] = set()
    lacks: list[str] = []
    lag = model.of_thruster("thruster.lag", name)
    band = model.of_thruster("thruster.deadband", name)
    rotor = '<rotor_dynamics type="zero_order"/>'
    if lag is not None and t.lag == "demand":
        rotor = f'<rotor_dynamics type="first_order"><time_constant value="{lag.value!r}"/></rotor_dynamics>  <!-- {lag.words} -->'
        says |= {f"thruster.lag.{name}", "thruster.lag"}
    low, high = ThrustCurve(t).range
    most = max(abs(low), abs(high))
    setpoint = f'<specs max_setpoint="{most!r}" inverted_setpoint="false"/>' if most < float("inf") else ""
    if t.quadratic is not None and t.neutral == 0.0:
        edge = 0.0 if band is None else band.value
        ahead, astern = t.quadratic.forward, t.quadratic.astern
        curve = [
            '    <thrust_model type="deadband">',
            f'      <thrust_coeff forward="{ahead!r}" reverse="{astern!r}"/>',
            f'      <deadband lower="{-edge!r}" upper="{edge!r}"/>',
            "    </thrust_model>",
        ]
        if band is not None:
            says |= {f"thruster.deadband.{name}", "thruster.deadband"}
            lacks.append(
                f"the thrust of {name} beyond its dead band: compare it with the simulator's, whose source was not at hand"
            )
    elif most < float("inf"):
        demands = [low + (high - low) * k / (POINTS - 1) for k in range(POINTS)]
        thrusts = ThrustCurve(t.model_copy(update={"outside": "hold"})).value(demands).tolist()
        curve = [
            '    <thrust_model type="linear_interpolation">',
            f'      <input value="{" ".join(map(repr, demands))}"/>',
            f'      <output value="{" ".join(map(repr, thrusts))}"/>',
            "    </thrust_model>",
        ]
        # The table is that of the curve with the keys of its dead band, limit and weaker thrust astern.
        says |= {f"{q}.{name}" for q in ("thruster.deadband", "thruster.saturation", "thruster.reverse_loss")}
        lacks.append(f"the curve of {name} between its {POINTS} points, which the simulator joins by straight lines")
    else:
        curve = []
        lacks.append(f"the thrust curve of {name}: it has no end; give the vehicle file demand_range")
    x, y = t.position
    return (
        [
            f'  <actuator name="{name}" type="thruster">',
            *([f"    {setpoint}"] if setpoint else []),
            f"    {rotor}",
            *curve,
            f'    <origin xyz="{x!r} {y!r} 0.0" rpy="0.0 0.0 {t.azimuth!r}"/>',
            '    <link name="base_link"/>',
            "  </actuator>",
        ],
        says,
        lacks,
    )


TARGET: Final = Target("stonefish", "Stonefish", lambda _: "robot.xml", write, sdf.COMMENT, sdf.OPENING)
