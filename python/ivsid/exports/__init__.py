"""Identified and extended models as files of other simulators.

- ``number``: a mid-value with its interval; ``planar``: a model in surge, sway and yaw in one form for every target.
- ``target``: what a target is, and the sentences on what its file cannot say.
- ``sdf``: elements that Gazebo and VRX share; ``formulas``: equations in the syntax that MATLAB and Python share.
- ``gazebo``, ``vrx``, ``mss``, ``pvs``, ``stonefish``, ``plain``: one target a file.
- ``export``: a result to the file of a target.

The chapter may use ``diagnosis`` and the chapters below it. Signs and names are those of each target's source (docs/export.md).
"""

from ivsid.exports.export import TARGETS, export
from ivsid.exports.target import Exported

__all__ = ["TARGETS", "Exported", "export"]
