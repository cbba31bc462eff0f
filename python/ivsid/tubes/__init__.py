"""Guaranteed simulation: bounds of every trajectory that the data allow.

- ``columns``: the model's terms as a program of the core; ``parameters``: the fit's polytope as vertices; ``equations``: both together.
- ``inputs``: steps, forces at all moments of each step, measured states; ``given``: components that are not followed.
- ``horizons``: tubes of the whole log and of windows; ``attained``: what single members reach of them; ``refuted``: readings outside.
- ``reached``: readings of a log against the tubes of a fit, for those who want the refutations alone.
- ``checked``: the tubes proved once more by the checker.
- ``bounds``: all of it in order.

The chapter may use ``identification``, ``verification``, ``rows`` and the chapters below them. The proofs are in the core (docs/theory.md, "Guaranteed
simulation").
"""

from ivsid.tubes.bounds import Tube, tube

__all__ = ["Tube", "tube"]
