"""Gazebo: a model with ``<fluid_added_mass>`` and the plugin Hydrodynamics, whose forces are + coefficient times velocity.

The physics engine (DART) takes the added mass into its inertia, and with it Coriolis forces and the Munk moment of unequal masses.
The plugin's own path (``xDotU`` ...) is not used: its Coriolis force in sway has the wrong sign.

Source: gz-sim, src/systems/hydrodynamics/Hydrodynamics.cc; gz-physics, dartsim/src/AddedMassFeatures.cc; docs/export.md.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final
from xml.sax.saxutils import quoteattr

from ivsid.exports import sdf
from ivsid.exports.number import Number
from ivsid.exports.planar import Planar
from ivsid.exports.target import INERTIA, Body, Target, steering_sentences

# Tags of the plugin with factors, by id. The force astern, u|u| where u < 0, is half of u|u| - u u.
# Source: definition: the names of SNAME 1950, force component, then velocities, as Hydrodynamics.cc composes them
TAGS: Final[Mapping[str, tuple[tuple[str, float], ...]]] = {
    "drag.surge.linear": (("xU", -1.0),),
    "drag.surge.quadratic": (("xUabsU", -1.0),),
    "drag.surge.astern": (("xUabsU", -0.5), ("xUU", 0.5)),
    "drag.surge.sideslip": (("xVV", -1.0),),
    "drag.sway.linear": (("yV", -1.0),),
    "drag.sway.quadratic": (("yVabsV", -1.0),),
    "drag.sway.yaw_rate": (("yR", -1.0),),
    "drag.lift.sway": (("yVabsU", -1.0),),
    "drag.yaw.linear": (("nR", -1.0),),
    "drag.yaw.quadratic": (("nRabsR", -1.0),),
}
UNKNOWN: Final = ("zz", "pp", "qq")


def write(model: Planar) -> Body:
    """The body of a model.sdf."""
    surge, sway, yaw = model.added
    added = [
        "        <fluid_added_mass>  <!-- positive, about the link's origin -->",
        *(sdf.element(tag, n, 10) for tag, n in (("xx", surge), ("yy", sway), ("rr", yaw))),
        *(sdf.plain(tag, 0.0, "not identified", 10) for tag in UNKNOWN),
        "        </fluid_added_mass>",
    ]
    moved, says, lacks = sdf.thrusters(model)
    says |= {i for i in TAGS if model.damping(i) is not None} | INERTIA | {"added_mass.munk", "drag.lift.yaw"}
    current: list[str] = []
    unstated = [*lacks, *steering_sentences(model)]
    north, east = (model.numbers.get(f"current.steady.{p}") for p in ("north", "east"))
    if north is not None and east is not None:
        current = [
            f"      <default_current>{east.value!r} {north.value!r} 0</default_current>  <!-- east, north; {east.words}; {north.words} -->"
        ]
        says |= {"current.steady.north", "current.steady.east"}
        unstated.append(
            "the Coriolis forces of the added mass in a current: the engine takes the velocity over ground, the plugin's drag that through the water"
        )
    if min(n.value for n in (surge, sway, yaw)) < 0:
        unstated.append(
            "an added mass below 0: the rigid mass or inertia of the file is larger than the whole that the log shows"
        )
    tags: dict[str, Number] = {**sdf.summed(TAGS, model), "nUV": model.moment}
    lines = [
        '<sdf version="1.11">',
        f"  <model name={quoteattr(model.title)}>",
        *sdf.link(model, added),
        '    <plugin filename="gz-sim-hydrodynamics-system" name="gz::sim::systems::Hydrodynamics">',
        "      <link_name>base_link</link_name>",
        *current,
        *(sdf.element(tag, n) for tag, n in tags.items()),
        "    </plugin>",
        *moved,
        "  </model>",
        "</sdf>",
    ]
    return Body("\n".join(lines), frozenset(says), tuple(unstated))


TARGET: Final = Target("gz", "Gazebo (gz-sim)", lambda _: "model.sdf", write, sdf.COMMENT, sdf.OPENING)
