"""Logs from a known truth.

``equations`` writes the equations of motion out as one function (``symbols`` does the writing), ``propulsion`` makes thrusts of
demands in time, ``integrate`` steps through it, ``sensing`` reads the motion as the vehicle's sensors would, ``hidden`` draws effects.
"""

from ivsid.simulation.hidden import hidden_effect, hidden_effects
from ivsid.simulation.sensing import gauss_markov
from ivsid.simulation.simulate import Simulated, follow, simulate

__all__ = ["Simulated", "follow", "gauss_markov", "hidden_effect", "hidden_effects", "simulate"]
