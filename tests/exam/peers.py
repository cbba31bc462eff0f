"""Other methods on the same logs: sparse and stepwise regression on the derivatives, over the same physical columns.

All three see the accelerations (differences of the velocities, means over windows of a second) and the same library: how the
model's acceleration changes with each cause of the catalogue that is a force and needs no search of its own. They name what stays in the model.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.ndimage import uniform_filter1d
from scipy.stats import norm

from ivsid.diagnosis.data.channels import channels
from ivsid.diagnosis.estimation.first_values import first_values
from ivsid.diagnosis.estimation.noise import declared_ambient
from ivsid.diagnosis.prediction.innovations import Predictor
from ivsid.effects import EFFECTS, Reading, Terms, terms_of
from ivsid.effects.values import Given
from ivsid.log import Log
from ivsid.vehicle import Vehicle

WINDOW = 1.0
# Sparse regression keeps what explains a tenth of the derivative's spread (columns and target scaled to one), the usual 0.1.
SPARSE = 0.1
RIDGE = 0.05
# Seconds of a block, draws, and the chance for one candidate to stay by luck.
BLOCK = 20.0
DRAWS = 200
CHANCE = 0.01
MOST = 4
# Effects that have to be searched for, change in time, or have no direction of their own.
SEARCHED = (
    "wave.force",
    "tether.tension",
    "drag.surge.hump",
    "current.oscillating",
    "payload.step",
    "thruster.failure",
    "environment.shallow_water",
)
UNKNOWN_SIZE = ("thruster.gain", "thruster.deadband", "thruster.saturation")


@dataclass(frozen=True)
class Regression:
    """Windows of a log.

    Attributes:
        y: what the plain model's start leaves of the accelerations, shape (3 n,), each axis scaled to one.
        plain: its tangents, shape (3 n, 5).
        library: those of the candidates, shape (3 n, k).
        owner: the effect of each candidate column.
        block: the block of each row.
    """

    y: np.ndarray
    plain: np.ndarray
    library: np.ndarray
    owner: tuple[str, ...]
    block: np.ndarray


def regression(vehicle: Vehicle, train: Log) -> Regression:
    """Of TRAIN."""
    log = channels(train, vehicle, None)
    terms = terms_of(vehicle)
    h = first_values(vehicle, log, terms, {})
    predictor = Predictor(vehicle, log, declared_ambient(vehicle))
    n = log.n
    # Over the steps between samples: the same time as the differences of the velocities.
    here = predictor.start(h).nudot[:, n:]
    moved = lambda other: predictor.start(other).nudot[:, n:] - here  # noqa: E731
    # A drag that stands at its limit is zero.
    steps = {t.id: 0.01 * h.values[t.id] or 0.01 for t in terms}
    plain = [moved(type(h)(h.terms, {**h.values, i: h.values[i] + step})) / step for i, step in steps.items()]
    columns, owner = [], []
    for effect in EFFECTS.values():
        if effect.id in (*h.values, *SEARCHED, *UNKNOWN_SIZE) or isinstance(effect.acts, Reading):
            continue
        for j, p in enumerate(effect.parameters):
            size = p.scaled(vehicle.hull.mass)
            if isinstance(effect.acts, Terms):
                term = effect.acts.terms[j]
                if term.of_hull:
                    term = type(term)(term.id, term.symbol, term.unit, term.of_hull(vehicle.hull.length))
                other = type(h)((*h.terms, term), {**h.values, term.id: size})
            else:
                values = [q.none for q in effect.parameters]
                values[j] = size
                other = h.with_effect(Given(effect, tuple(values)))
            columns.append(moved(other) / size)
            owner.append(effect.id)
    measured = np.diff(log.nu, axis=1, append=log.nu[:, -1:]) / log.h
    q = max(2, round(WINDOW / log.h))
    at = np.arange(q, n - q, q)

    def windows(x):
        return uniform_filter1d(x, q, axis=-1)[..., at]

    y = windows(measured - here)
    scale = y.std(axis=1)[:, None]
    shaped = lambda c: (windows(c) / scale).ravel()  # noqa: E731
    block = np.tile((log.t[at] - log.t[0]) // BLOCK, 3).astype(int)
    library = np.stack([shaped(c) for c in columns], axis=1)
    keep = np.linalg.norm(library, axis=0) > 1e-9
    return Regression(
        (y / scale).ravel(),
        np.stack([shaped(c) for c in plain], axis=1),
        library[:, keep],
        tuple(o for o, k in zip(owner, keep, strict=True) if k),
        block,
    )


def sparse(r: Regression) -> list[str]:
    """Sequentially thresholded least squares (Brunton, Proctor and Kutz 2016), with the ridge and threshold that are usual."""
    A = np.concatenate([r.plain, r.library], axis=1)
    A = A / np.maximum(A.std(axis=0), 1e-12)
    first = r.plain.shape[1]
    kept = np.ones(A.shape[1], dtype=bool)
    for _ in range(20):
        B = A[:, kept]
        x = np.linalg.solve(B.T @ B + RIDGE * np.eye(B.shape[1]), B.T @ r.y)
        small = np.zeros_like(kept)
        small[np.flatnonzero(kept)[np.abs(x) < SPARSE]] = True
        small[:first] = False
        if not small.any():
            break
        kept &= ~small
    return _named(r, [k - first for k in np.flatnonzero(kept) if k >= first])


def stepwise(r: Regression) -> list[str]:
    """Forward selection while the Bayesian information criterion falls, every row counted as one."""
    chosen: list[int] = []
    n = r.y.size
    best = n * np.log(_left(r, chosen)) + r.plain.shape[1] * np.log(n)
    while len(chosen) < MOST:
        sizes = [(_left(r, [*chosen, k]), k) for k in range(r.library.shape[1]) if k not in chosen]
        left, k = min(sizes)
        now = n * np.log(left) + (r.plain.shape[1] + len(chosen) + 1) * np.log(n)
        if now >= best:
            break
        best = now
        chosen.append(k)
    return _named(r, chosen)


def bootstrap(r: Regression, seed: int = 0) -> list[str]:
    """Forward selection while the candidate's number differs from nothing in a bootstrap over blocks of 20 s, shared chance among all."""
    rng = np.random.default_rng(seed)
    chosen: list[int] = []
    ids = np.unique(r.block)
    level = CHANCE / r.library.shape[1]
    while len(chosen) < MOST:
        sizes = [(_left(r, [*chosen, k]), k) for k in range(r.library.shape[1]) if k not in chosen]
        k = min(sizes)[1]
        A = np.concatenate([r.plain, r.library[:, [*chosen, k]]], axis=1)
        A = A / np.maximum(np.linalg.norm(A, axis=0), 1e-30)
        parts = [(A[r.block == b], r.y[r.block == b]) for b in ids]
        gram = np.stack([a.T @ a for a, _ in parts])
        score = np.stack([a.T @ y for a, y in parts])
        drawn = []
        for _ in range(DRAWS):
            pick = rng.integers(0, ids.size, ids.size)
            drawn.append(np.linalg.lstsq(gram[pick].sum(axis=0), score[pick].sum(axis=0), rcond=1e-10)[0][-1])
        # So small a chance is beyond 200 draws: the normal tail of their spread.
        if abs(np.mean(drawn)) < norm.isf(level / 2) * np.std(drawn):
            break
        chosen.append(k)
    return _named(r, chosen)


PEERS = {"sparse": sparse, "stepwise": stepwise, "bootstrap": bootstrap}


def _left(r: Regression, chosen: list[int]) -> float:
    A = np.concatenate([r.plain, r.library[:, chosen]], axis=1)
    x = np.linalg.lstsq(A, r.y, rcond=1e-10)[0]
    return float(np.sum((r.y - A @ x) ** 2))


def _named(r: Regression, columns: list[int]) -> list[str]:
    return list(dict.fromkeys(r.owner[k] for k in columns))
