"""The next trial: demands that narrow the widest interval, or tell two causes apart, on a stated area of water.

- ``shape``: numbers that stand for a programme of levels inside the vehicle's limits.
- ``known``: what a fit knows already, as rows.
- ``sailed``: a programme as the fit's estimate, or another vehicle, would sail it.
- ``purpose``: what a programme is good for; ``narrowing`` (widths of the set of both logs) and ``separation`` (distance of two causes).
- ``fence``: how far from its start the vehicle gets: what the tube proves, and what members do.
- ``search``: the best of many programmes; ``rivals``: a zigzag, a PRBS and the library beside it.
- ``planning``: all of it in order.

The chapter may use ``diagnosis``, ``tubes``, ``identification``, ``simulation`` and the chapters below them.
"""

from ivsid.plans.planning import Plan, plan

__all__ = ["Plan", "plan"]
