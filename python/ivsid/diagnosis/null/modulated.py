"""Thrusts that fall with the speed of the hull, the heat of their motor or the wash of another: forces that no cause of the catalogue is.

A tunnel thruster loses its thrust as the hull moves ahead, a motor while it is warm, and gets it back. Each is a thrust times a function of the motion
or of its own past. A step in time explains a part of it, with a start wherever the programme changes.

Source: docs/theory.md, "Test"; Chislett and Bjorheden, "Influence of ship speed on the effectiveness of a lateral-thrust unit", HyA report 8, 1966
(tunnel thrusters); a first-order thermal model of a motor (IEC 60034-1).
"""

from __future__ import annotations

from itertools import permutations
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ivsid.diagnosis.estimation.fit import Fit
from ivsid.diagnosis.plant.thruster_forces import bollard_force
from ivsid.linear.filters import decaying
from ivsid.vehicle import KnownForce, Vehicle

Array = NDArray[np.float64]
# Thrusters that have forces of their own.
# Source: resource: each adds three columns
THRUSTERS: Final = 4
# Time constants with which motors grow warm [s].
# Source: physics: windings and the oil around them follow their losses within one to some minutes
HEATS: Final = (60.0, 240.0)
# First words of their names.
FALL: Final = "fall of"
# What all thrusts together are called.
EVERY: Final = "every thrust"
# What a thrust of no size is divided by.
# Source: definition: keeps the columns from "not a number"
NONE: Final = 1e-9


def modulated(fit: Fit) -> tuple[list[str], list[Array], list[int | None]]:
    """Names of the forces, their accelerations, shape (3, 2 n) each, and the index of the thruster that loses them; None for all together."""
    predictor, p = fit.noise.predictor, fit.states.points
    vehicle, n, h = predictor.vehicle, predictor.log.n, predictor.log.h
    known = [k for k, t in enumerate(vehicle.thrusters) if not isinstance(t, KnownForce)]
    if not known:
        return [], [], []
    speed = of_unit_size(p.nu[0] ** 2 + p.nu[1] ** 2)
    by = {"with the square of the speed": np.tile(speed, (len(vehicle.thrusters), 1))}
    for time in HEATS:
        by[f"with its heat of {time:.0f} s"] = np.stack([_warm(x, n, float(np.exp(-h / time))) for x in p.thrusts])
    turn = p.swing or (np.cos(p.angles), np.sin(p.angles))

    asked: list[tuple[str, list[int], int | None]] = [(vehicle.thrusters[k].words, [k], k) for k in known[:THRUSTERS]]
    if len(known) > 1:
        asked.append((EVERY, known, None))
    names, forces, own = [], [], []
    for words, at, k in asked:
        for how, size in by.items():
            lost = np.zeros_like(p.thrusts)
            lost[at] = -p.thrusts[at] * size[at]
            names.append(f"{FALL} {words} {how}")
            forces.append(fit.signatures.mass.solve(bollard_force(vehicle, lost, turn)))
            own.append(k)
    for i, k in permutations(known[:THRUSTERS], 2):
        lost = np.zeros_like(p.thrusts)
        lost[k] = -p.thrusts[k] * of_unit_size(np.abs(p.thrusts[i]) * _meets(vehicle, i, k, turn))
        names.append(f"{FALL} {vehicle.thrusters[k].words} in the wash of {vehicle.thrusters[i].name}")
        forces.append(fit.signatures.mass.solve(bollard_force(vehicle, lost, turn)))
        own.append(k)
    return names, forces, own


def modulated_columns(fit: Fit) -> tuple[list[str], Array, list[int | None]]:
    """The forces as whitened columns in unit length, shape (forces, blocks, numbers)."""
    names, forces, own = modulated(fit)
    g = fit.gram
    x, _ = g.white.blocks([fit.noise.predictor.answer(a) for a in forces], g.good, g.length)
    return names, x.reshape(-1, *g.y.shape), own


def _meets(vehicle: Vehicle, i: int, k: int, turn: tuple[Array, Array]) -> Array | float:
    """How far the jet of a thruster that turns points at another one, from 0 to 1; 1 where it does not turn: its jet meets what it meets."""
    if vehicle.thrusters[i].steering != "azimuth":
        return 1.0
    ahead, aside = np.subtract(vehicle.thrusters[k].position, vehicle.thrusters[i].position)
    distance = max(float(np.hypot(ahead, aside)), NONE)
    # A thruster that pushes ahead throws its jet astern.
    return np.asarray(np.maximum(-(turn[0][i] * ahead + turn[1][i] * aside) / distance, 0.0) ** 2)


def _warm(thrust: Array, n: int, decay: float) -> Array:
    """How warm a motor is that was cold at the start and loses the square of its thrust in heat, of unit size, shape (2 n,)."""
    return of_unit_size(np.concatenate([decaying((1.0 - decay) * x**2, decay) for x in (thrust[:n], thrust[n:])]))


def of_unit_size(x: Array) -> Array:
    """A function of unit mean square."""
    return np.asarray(x / max(float(np.sqrt(np.mean(x**2))), NONE))
