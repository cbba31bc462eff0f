"""VRX: the plugin SimpleHydrodynamics, whose coefficients are positive and whose unset tags are not zero.

The plugin multiplies the added masses by the acceleration of an accelerometer, udot - v r and vdot + u r. Its Coriolis matrix is made and
not added to the forces. Both together are Fossen's equations where the added masses in surge and sway are equal, and there alone.

Source: osrf/vrx, vrx_gz/src/SimpleHydrodynamics.cc; docs/export.md.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final
from xml.sax.saxutils import quoteattr

from ivsid.exports import sdf
from ivsid.exports.planar import Planar
from ivsid.exports.target import INERTIA, Body, Target, steering_sentences

TAGS: Final[Mapping[str, str]] = {
    "xU": "drag.surge.linear",
    "xUU": "drag.surge.quadratic",
    "yV": "drag.sway.linear",
    "yVV": "drag.sway.quadratic",
    "nR": "drag.yaw.linear",
    "nRR": "drag.yaw.quadratic",
}
# Values of tags of heave, roll and pitch, which no motion in the plane shows, and of the largest force [N].
# Source: osrf/vrx, vrx_gz/src/SimpleHydrodynamics.cc, its defaults
DEFAULTS: Final[Mapping[str, float]] = {
    "zDotW": 0.1,
    "kDotP": 0.1,
    "mDotQ": 0.1,
    "zW": 20.0,
    "zWW": 0.0,
    "kP": 20.0,
    "kPP": 0.0,
    "mQ": 20.0,
    "mQQ": 0.0,
    "max_effort": 10000.0,
}
# Difference that counts as none, as a share of the mass.
# Source: definition: far above the rounding of sums of float64
EQUAL: Final = 1e-12


def write(model: Planar) -> Body:
    """The body of a model.sdf."""
    moved, says, lacks = sdf.thrusters(model)
    lines = [
        '<sdf version="1.11">',
        f"  <model name={quoteattr(model.title)}>",
        *sdf.link(model),
        '    <plugin filename="libSimpleHydrodynamics.so" name="vrx::SimpleHydrodynamics">',
        "      <link_name>base_link</link_name>",
        *(sdf.element(tag, n) for tag, n in zip(("xDotU", "yDotV", "nDotR"), model.added, strict=True)),
    ]
    for tag, id_ in TAGS.items():
        number = model.damping(id_)
        if number is None:
            lines.append(sdf.plain(tag, 0.0, "not in the model; an unset tag is not 0"))
        else:
            lines.append(sdf.element(tag, number))
            says.add(id_)
    lines += [sdf.plain(tag, value, "not identified: the plugin's default") for tag, value in DEFAULTS.items()]
    lines += ["    </plugin>", *moved, "  </model>", "</sdf>"]
    unstated = [*lacks, *steering_sentences(model)]
    apart = model.sway - model.surge
    if abs(apart.value) > EQUAL * model.mass:
        unstated.append(
            f"the Coriolis forces of unequal masses: surge lacks {apart.value:.6g} v r [N], sway has {apart.value:.6g} u r [N] too much on its left-hand "
            "side (the plugin leaves its Coriolis matrix out)"
        )
    kept = {"added_mass.munk"} if abs(model.get("added_mass.munk").value) == 0.0 else set()
    return Body("\n".join(lines), frozenset(says | INERTIA | kept), tuple(unstated))


TARGET: Final = Target("vrx", "VRX (SimpleHydrodynamics)", lambda _: "model.sdf", write, sdf.COMMENT, sdf.OPENING)
