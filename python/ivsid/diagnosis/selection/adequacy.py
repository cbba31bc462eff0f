"""Stage 9: is anything left that a generic dictionary of motions, thrusts, heading and time can see?"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.stats import chi2

from ivsid.diagnosis.estimation.fit import Fit
from ivsid.diagnosis.estimation.projection import Projection

Array = NDArray[np.float64]
SYMBOLS: Final = re.compile(r"[a-z]+")
AXES: Final = ("surge", "sway", "yaw")
# Probability of calling a true model insufficient, and the share of the excess that a right cause may leave.
LEVEL: Final = 1e-3
REST: Final = 0.02


@dataclass(frozen=True)
class Adequacy:
    """What a dictionary finds in the errors that a hypothesis leaves.

    Attributes:
        fall: fall of chi^2 by the whole dictionary.
        freedom: its directions that are not in the model.
        chance: of such a gain without anything left.
        strongest: single regressors with their channel and gain, the best first.
        chance_of_one: of the best single gain, over the whole dictionary.
        excess: what each channel's part of the dictionary gains beyond chance.
    """

    fall: float
    freedom: int
    chance: float
    strongest: tuple[tuple[str, str, float], ...]
    chance_of_one: float
    excess: Mapping[str, float]

    @property
    def statistic(self) -> float:
        """Gain over its degrees of freedom; about 1 where nothing is left."""
        return self.fall / max(self.freedom, 1)

    @property
    def quiet(self) -> bool:
        """Whether no more than chance is left."""
        return self.chance > LEVEL or self.chance_of_one > LEVEL

    def sufficient(self, before: Adequacy, findings: int) -> bool:
        """Whether nothing that counts is left: no more than chance, or at most two parts in a hundred of what there was."""
        if self.quiet:
            return True
        return findings > 0 and self.fall - self.freedom < REST * max(before.fall - before.freedom, 0.0)

    def beside(self, fit: Fit, columns: Sequence[int]) -> float:
        """What is left unexplained in the channels where a cause acts, by the share of its signature in each."""
        whole = max(self.fall - self.freedom, 0.0)
        energy = energy_of(fit, columns)
        if not energy.sum() > 0:
            return whole
        by_row = [self.excess.get(c, whole) for c in fit.noise.predictor.channels]
        return float(energy @ np.array(by_row) / energy.sum())


def energy_of(fit: Fit, columns: Sequence[int]) -> Array:
    """Of signatures, by row of the errors."""
    rows = len(fit.noise.predictor.labels)
    x = fit.gram.columns(columns)
    return np.asarray((x.reshape(-1, rows, fit.gram.length) ** 2).sum(axis=(0, 2)))


def adequacy(fit: Fit) -> Adequacy:
    """The errors of a fit against powers and products of the states, thrusts and their changes, heading and time, in every channel."""
    names, arrays = _dictionary(fit)
    # Nothing but the model's own columns stands beside the dictionary.
    g = fit.gram.only(fit.base)
    first = len(g.names)
    wide = g.extended(names, [fit.noise.predictor.answer(a) for a in arrays])
    p = Projection(wide, range(first))
    columns = list(range(first, len(wide.names)))
    H = p.information(columns)
    d = np.sqrt(np.maximum(np.diag(H), 1e-300))
    real = np.diag(H) > 1e-6
    single = np.where(real, p.left_score[columns] ** 2 / np.maximum(np.diag(H), 1e-300), 0.0)
    scores = p.left_score[columns] / d

    def gained(which: NDArray[np.bool_]) -> tuple[float, int]:
        values, vectors = np.linalg.eigh(H[np.ix_(which, which)] / np.outer(d[which], d[which]))
        keep = values > 1e-4
        s = vectors[:, keep].T @ scores[which]
        return float(np.sum(s**2 / values[keep])), int(keep.sum())

    fall, freedom = gained(real)
    excess = {}
    for axis in AXES:
        own, directions = gained(real & np.array([n.startswith(axis) for n in names]))
        excess[axis] = max(own - directions, 0.0)
    order = np.argsort(-single)[:3]
    strongest = tuple((names[k].split("|")[1], names[k].split("|")[0], float(single[k])) for k in order)
    one = float(min(1.0, chi2.sf(float(single.max()), 1) * len(names)))
    return Adequacy(fall, freedom, float(chi2.sf(fall, freedom)), strongest, one, excess)


def _dictionary(fit: Fit) -> tuple[list[str], list[Array]]:
    p = fit.states.points
    u, v, r = p.nu
    predictor = fit.noise.predictor
    n = predictor.log.n
    scale = [max(float(np.sqrt(np.mean(x**2))), 1e-9) for x in (u, v, r)]
    a, b, c = u / scale[0], v / scale[1], r / scale[2]
    t = (p.t - p.t[0]) / (p.t.max() - p.t[0])
    functions: dict[str, Array] = {
        "1": np.ones(2 * n),
        "u": a,
        "v": b,
        "r": c,
        "u^2": a * a,
        "v^2": b * b,
        "r^2": c * c,
        "u|u|": a * np.abs(a),
        "v|v|": b * np.abs(b),
        "r|r|": c * np.abs(c),
        "u v": a * b,
        "u r": a * c,
        "v r": b * c,
        "u^3": a**3,
        "v^3": b**3,
        "r^3": c**3,
        "u^2 r": a * a * c,
        "u^2 v": a * a * b,
        "t": t,
        "t^2": t * t,
        "t u|u|": t * a * np.abs(a),
    }
    if len(p.thrusts):
        total = p.thrusts.sum(axis=0)
        size = max(float(np.sqrt(np.mean(total**2))), 1e-9)
        force = total / size
        before = np.concatenate([np.r_[force[0], force[: n - 1]], np.r_[force[n], force[n:-1]]])
        functions |= {
            "thrust": force,
            "thrust^2": force * np.abs(force),
            "thrust u": force * a,
            "change of thrust": force - before,
            "t thrust": t * force,
        }
        for k, thruster in enumerate(predictor.vehicle.thrusters[:4]):
            functions[f"thrust of {thruster.name}"] = p.thrusts[k] / size
    if predictor.log.psi is not None:
        cosine, sine = np.cos(p.psi), np.sin(p.psi)
        functions |= {"cos psi": cosine, "sin psi": sine, "u cos psi": a * cosine, "u sin psi": a * sine}
    if predictor.log.place is not None:
        x, y = (q - q.mean() for q in p.place)
        reach = max(float(np.abs(x).max()), float(np.abs(y).max()), 1e-9)
        functions |= {"x": x / reach, "y": y / reach, "x u": x / reach * a, "y u": y / reach * a}
    if fit.noise.left_out:
        # Where sway and yaw are left out, nothing that is made of their velocities says anything of a cause.
        functions = {k: f for k, f in functions.items() if not {"v", "r"} & set(SYMBOLS.findall(k))}
    names, arrays = [], []
    sizes = [max(d, 1e-6) for d in predictor.ambient.deviation]
    for k, axis in enumerate(AXES):
        for name, f in functions.items():
            process = np.zeros((3, 2 * n))
            process[k] = sizes[k] * f
            names.append(f"{axis}|{name}")
            arrays.append(process)
    return names, arrays
