"""Signs, units and axes of the channels of the motion: the suspect under which the identities hold that fail as logged."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

from ivsid.log import Log
from ivsid.setup.finding import Checked, SetupFinding
from ivsid.setup.identities import Identity, identities
from ivsid.setup.response import agreement
from ivsid.setup.suspects import SUSPECTS, Suspect
from ivsid.vehicle import Vehicle

# Least misfit of an identity that fails: velocities in knots have 0.19, a scale error of a third has 0.04.
# Source: geometry: (1 - k)^2 / (1 + k^2) for k = 0.514
FAILS: Final = 0.15
# Least fall of the misfit by which a suspect mends an identity.
# Source: geometry: half the difference of both sides at the most is left
FALL: Final = 4.0
# Misfits within this ratio do not tell two suspects apart.
# Source: definition: a fit that is as good but for the noise
ALIKE: Final = 1.2
# Explained share of the change of r from which the moment's response says that a channel is wrong.
# Source: definition: the larger half
CLEAR: Final = 0.5
# Most faults of one log that are named.
# Source: definition: the channels u and v, r, psi, and the accelerations
MOST_FAULTS: Final = 4

Found = Mapping[tuple[str, float], Identity]


@dataclass(frozen=True)
class Mended:
    """The identities that a suspect mends: those that fail as logged and hold without it.

    Attributes:
        suspect: the fault.
        log: without it.
        plainest: words of the identity with the largest fall of its misfit.
        length: of its windows [s].
        windows: their number.
        before: its misfit as logged.
        after: its misfit without the fault.
        names: of all identities that are mended.
    """

    suspect: Suspect
    log: Log
    plainest: str
    length: float
    windows: int
    before: float
    after: float
    names: frozenset[str]


def motion(vehicle: Vehicle, log: Log) -> Checked:
    """Faults of the signs, units and axes of velocities, rates, accelerations, heading and position.

    A fault is named only if an identity of the kinematics fails as logged, holds without the fault, and no identity that held is lost. The
    misfits are ``identities.HOLDS`` and ``FAILS``; no model of the vessel takes part, so that no hidden force can be taken for a fault.
    """
    findings: list[SetupFinding] = []
    for _ in range(MOST_FAULTS):
        now = identities(log, vehicle.sensors)
        if not any(_fails(i) for i in now.values()):
            break
        able = [m for s in SUSPECTS if s.possible(log) and (m := _mended(s, log, now, vehicle)) is not None]
        if not able:
            break
        best = max(able, key=lambda m: (len(m.names), -m.after))
        rivals = [m for m in able if m.names == best.names and m.after <= ALIKE * best.after + 1e-6]
        if len(rivals) > 1:
            # Two channels that contradict each other do not say which of them is wrong: the moment's response may.
            rivals = [m for m in rivals if agreement(vehicle, m.log) > -CLEAR] or rivals
        first, *others = rivals
        findings.append(_finding(first, others, vehicle, log))
        log = first.log
    return Checked(tuple(findings), log)


def _fails(i: Identity) -> bool:
    return i.told and i.misfit >= FAILS


def _mended(suspect: Suspect, log: Log, now: Found, vehicle: Vehicle) -> Mended | None:
    """What a suspect mends, or None if that is nothing or an identity that held is lost."""
    if not any(_fails(i) and suspect.channels & i.channels for i in now.values()):
        return None
    mended = suspect.mended(log)
    then = identities(mended, vehicle.sensors)
    held, kept = ({i.says for i in f.values() if i.holds} for f in (now, then))
    if held - kept:
        return None
    good = [
        (before.misfit, after.misfit, after, k)
        for k, after in then.items()
        if after.holds
        and (before := now.get(k)) is not None
        and before.told
        and before.misfit >= max(FAILS, FALL * after.misfit)
        and after.says not in held
    ]
    if not good:
        return None
    least, left, plainest, (says, length) = min(good, key=lambda g: g[1])
    names = frozenset(g[2].says for g in good)
    return Mended(suspect, mended, says, length, plainest.left.size, least, left, names)


def _finding(m: Mended, others: list[Mended], vehicle: Vehicle, log: Log) -> SetupFinding:
    s = m.suspect
    words = (
        f"{log.name}: {s.says}: {m.plainest} differ by {100 * min(m.before, 1.0):.0f} % of their energy over {m.windows} windows of {m.length:g} s, "
        f"and by {100 * m.after:.2g} % without that fault"
    )
    if others:
        words += f"; as likely, {' or '.join(o.suspect.says for o in others)}"
    evidence = {"misfit": m.before, "misfit_without": m.after, "windows": float(m.windows), "window": m.length}
    return SetupFinding(s.id, words, evidence, s.remedy(vehicle), certain=True)
