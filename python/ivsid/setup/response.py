"""Thrusters against the response: changes of u, v and r over windows, regressed on the integrals of the modelled forces.

The statistic is the share of the change that a force explains, with the sign of its coefficient, after damping, Coriolis part, a constant
force and one that keeps its direction over ground have been projected out of both (the squared partial correlation; Frisch and Waugh
1933, theorem 1). Masses need not be known: their sign is. A wrong set-up is named only if the forces under it explain most of the change
where the stated forces, and those of a thruster that has failed, leave at least twice as much of it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ivsid.errors import IvsidError
from ivsid.log import Log
from ivsid.sensors.lever_arms import at_origin
from ivsid.setup.finding import Checked, SetupFinding
from ivsid.setup.histories import History, histories, stated
from ivsid.setup.identities import ABOVE, USUAL, vouched
from ivsid.setup.windows import LEAST, Course, angle_course, edges_of
from ivsid.vehicle import Sensors, Vehicle

Array = NDArray[np.float64]
# Lengths of windows [s]: long against the lag of a thruster, short against a manoeuvre.
# Source: physics: lags of thrusters are tenths of a second, manoeuvres take ten seconds and more
WINDOWS: Final = (1.0, 2.0, 5.0, 10.0)
# Least share of a change that the forces explain under a fault that is named: three times what they leave.
# Source: definition: the larger half
EXPLAINS: Final = 0.75
# Least gain of the log-likelihood over the stated forces and over a thruster that has failed. Feedback and slow disturbances make fewer
# windows independent than there are: with a quarter of them it is still that of three standard errors.
# Source: theorem: a gain of k^2 / 2 is one of k standard errors (Wilks 1938), and it is proportional to the number of windows
SURE: Final = 18.0
# Most of what the stated forces, or those of a failed thruster, leave unexplained that may be left under the fault.
# Source: definition: the smaller half
HALF: Final = 0.5
# Least share that the stated forces explain in a channel that is evidence against a fault under which they explain less there.
# Source: geometry: a correlation of one half
AGAINST: Final = 0.25
# Least energy of the difference of two force histories, as a share of the stated one, at which the fault changes a channel at all.
# Source: geometry: a smaller one moves the explained share by less than a tenth
DIFFERS: Final = 0.05
# Shares within this distance do not tell two faults apart.
# Source: geometry: the error of a share of 0.9 from a hundred windows
ALIKE: Final = 0.02
AXES: Final = ("u", "v", "r")


@dataclass(frozen=True)
class Axis:
    """One channel's changes over windows, with what needs no thrust projected out.

    Attributes:
        name: u, v or r.
        change: shape (m,).
        stated: impulses of the stated forces, shape (m,).
        others: of each history, shape (m,).
        free: degrees of freedom.
        length: of the windows [s].
    """

    name: str
    change: Array
    stated: Array
    others: tuple[Array, ...]
    free: int
    length: float

    def share(self, force: Array) -> float:
        """Explained share of the change, negative where the force acts against it."""
        across = float(force @ self.change)
        whole = float(force @ force) * float(self.change @ self.change)
        return float(np.sign(across)) * across * across / whole if whole > 0 else 0.0

    def differs(self, force: Array) -> bool:
        """Whether a history is another one than the stated one here."""
        d = force - self.stated
        scale = max(float(self.stated @ self.stated), float(force @ force))
        return float(d @ d) > DIFFERS * scale

    def clear(self, force: Array, *, reverses: bool) -> bool:
        """Whether a history explains most of the change, and far more than the stated one does.

        Where the history has a thruster reversed, the middle of both is one that has failed, and has to explain far less, too.
        """
        share = self.share(force)
        rival = max(self.share(self.stated), self.share(0.5 * (self.stated + force)) if reverses else 0.0, 0.0)
        left = max(1.0 - share, np.finfo(float).eps)
        gain = 0.5 * self.free * np.log((1.0 - rival) / left)
        return share >= EXPLAINS and left <= HALF * (1.0 - rival) and gain >= SURE


def axes(vehicle: Vehicle, log: Log, found: tuple[History, ...]) -> list[Axis]:
    """Channels that stand above the errors of their readings, on windows of each length."""
    log = at_origin(log, vehicle.sensors)
    t = log.t
    u, v, r = (log.columns[n] for n in AXES)
    forces = [stated(vehicle, log), *(h.forces for h in found)]
    still = [np.ones_like(t)]
    if "psi" in log.columns:
        psi = angle_course(t, log.columns["psi"]).at(t)
        still += [np.cos(psi), np.sin(psi)]
    beside = ((u, u * abs(u), v * r), (v, v * abs(v), u * r, r, u * v), (r, r * abs(r), u * v, v, u * r))
    made = []
    for length in WINDOWS:
        edges = edges_of(t, length)
        if edges is None:
            break
        for k, (name, x) in enumerate(zip(AXES, (u, v, r), strict=True)):
            change = Course(t, x).change(edges)
            smooth = np.stack([Course(t, c).integral(edges) for c in (*beside[k], *still)], axis=1)
            pushes = np.stack([Course(t, f[:, k], held=True).integral(edges) for f in forces], axis=1)
            there = np.isfinite(change) & np.isfinite(smooth).all(1) & np.isfinite(pushes).all(1)
            free = int(there.sum()) - smooth.shape[1] - 1
            if free < LEAST:
                continue
            q = np.linalg.qr(smooth[there])[0]
            y, p = (x[there] - q @ (q.T @ x[there]) for x in (change, pushes))
            if float(np.sqrt(np.mean(y * y))) >= _least(vehicle.sensors, name, log.period):
                made.append(Axis(name, y, p[:, 0], tuple(p[:, 1:].T), free, length))
    return made


def _least(sensors: Sensors, name: str, period: float) -> float:
    """The least rms of a change [m/s, rad/s] that tells anything."""
    if name != "r":
        known = sensors.velocity
        return USUAL["velocity"] if known is None or not known.accuracy else ABOVE * known.accuracy
    gyro = sensors.yaw_rate
    noise = 0.0 if gyro is None else gyro.accuracy + gyro.random_walk / np.sqrt(period)
    return float(ABOVE * noise) or USUAL["yaw_rate"]


def response(vehicle: Vehicle, log: Log) -> Checked:
    """Reversed and swapped thrusters, and a motion that answers the moment the wrong way round."""
    try:
        known = vouched(vehicle, log)
        found = tuple(h for h in histories(vehicle, log) if not h.channels & known)
        seen = axes(vehicle, log, found)
    except (IvsidError, KeyError):
        # A demand or a channel is missing: the fit says so.
        return Checked((), log)
    named = [
        (score, k) for k in range(len(found)) if (score := _score(seen, k, reverses=found[k].reverses)) is not None
    ]
    if not named:
        return Checked((), log)
    best = max(score for score, _ in named)
    first, *others = [found[k] for score, k in named if score >= best - ALIKE]
    return Checked((_finding(first, others, log, seen, found.index(first)),), log)


def agreement(vehicle: Vehicle, log: Log) -> float:
    """The largest explained share of the change of r by the stated moment, negative where it acts against it; 0 where nothing tells."""
    try:
        shares = [a.share(a.stated) for a in axes(vehicle, log, ()) if a.name == "r"]
    except (IvsidError, KeyError):
        return 0.0
    return max(shares, key=abs, default=0.0)


def _score(seen: list[Axis], k: int, *, reverses: bool) -> float | None:
    """The mean explained share under a fault over the channels that it changes, or None if it is not named."""
    touched = [a for a in seen if a.differs(a.others[k])]
    shares = {(a.name, a.length): (a.share(a.stated), a.share(a.others[k])) for a in touched}
    # A channel in which the stated forces explain more than the fault does, at any length of window, is no such fault.
    if any(before > after and before >= AGAINST for before, after in shares.values()):
        return None
    if not any(a.clear(a.others[k], reverses=reverses) for a in touched):
        return None
    # The channels that a fault leaves alone count as well: a swap that mends yaw and spoils nothing is better than one that also spoils sway.
    by_name = {n: max(a.share(a.others[k]) for a in seen if a.name == n) for n in {a.name for a in seen}}
    return float(np.mean(list(by_name.values())))


def _finding(h: History, others: list[History], log: Log, seen: list[Axis], k: int) -> SetupFinding:
    touched = [a for a in seen if a.differs(a.others[k])]
    plainest = max(touched, key=lambda a: a.share(a.others[k]) - a.share(a.stated))
    before, after = plainest.share(plainest.stated), plainest.share(plainest.others[k])
    words = (
        f"{log.name}: {h.says}: the forces so explain {100 * after:.0f} % of the changes of {plainest.name} over {plainest.change.size} windows of "
        f"{plainest.length:g} s, and as the vehicle file has them {100 * max(before, 0.0):.0f} %"
    )
    if before < 0:
        words += f" (they act against {-100 * before:.0f} %)"
    if others:
        words += f"; as likely, {' or '.join(o.says for o in others)}"
    evidence = {
        "explained": before,
        "explained_without": after,
        "windows": float(plainest.change.size),
        "window": plainest.length,
    }
    return SetupFinding(h.id, words, evidence, h.remedy, certain=False)
