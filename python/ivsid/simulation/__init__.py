"""Logs from a known truth.

- ``simulate``: a scenario to a log and its truth; ``follow``: the motion under the demands of a log.
- ``equations``: a vehicle with its true physics, and its equations of motion as one function.
- ``symbols``, ``compiled``: symbols that note operations down, and functions and Runge-Kutta steps compiled from the notes.
- ``true_thrust``: a thrust curve with its true error; ``propulsion``: demands to thrusts in time, with effects, lag and delay.
- ``integrate``: the Runge-Kutta method, with steps halved until the motion settles.
- ``steersman``: a helm that follows a programme; ``surroundings``: wind, depth and voltage.
- ``sensing``: geometry, noise and faults of the sensors.
- ``hidden``: effects drawn from a seed.

The chapter may use ``programme``, ``effects``, ``propulsion``, ``sensors`` and the chapters below them. It shares the formulas of
``effects`` with identification and diagnosis and nothing else, so that a simulated log tests both.
"""

from ivsid.simulation.hidden import hidden_effect, hidden_effects
from ivsid.simulation.sensing import gauss_markov
from ivsid.simulation.simulate import Simulated, follow, simulate

__all__ = ["Simulated", "follow", "gauss_markov", "hidden_effect", "hidden_effects", "simulate"]
