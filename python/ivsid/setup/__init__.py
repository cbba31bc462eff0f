"""Wrong set-ups, named before anything is fitted: signs, axes, units, and thrusters that are reversed or swapped.

- ``finding``: a fault in words and figures, with the key of the vehicle file to change; the shape of a check.
- ``demands``, ``motion``, ``limits``, ``angles``, ``response``, ``scale``: the checks, one file each. ``findings`` calls them in turn, and refuses certain faults.
- ``suspects``: the faults of channels that ``motion`` judges; ``identities`` of the kinematics, by which it does.
- ``histories``: the modelled forces under each fault of the thrusters, which ``response`` judges.
- ``windows``: changes and integrals of channels over windows.

The chapter may use ``propulsion``, ``sensors`` and the chapters below them. It fits no model: masses and drags are unknown to it.
"""

from ivsid.setup.finding import SetupFinding, in_doubt
from ivsid.setup.findings import examined, refuse, setup_findings

__all__ = ["SetupFinding", "examined", "in_doubt", "refuse", "setup_findings"]
