"""Cases of the examination, drawn from a seed and written by the examiner's own simulator."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from tests.exam.catalogue import CLAIMED, EFFECTS, ON_TEST_ALONE, OUTSIDE, drawn, drawn_by, outside_by, possible
from tests.exam.readings import exact as clean_readings
from tests.exam.readings import log as noisy
from tests.exam.seas import drawn_force, drawn_sea
from tests.exam.sensor_errors import drawn_sensors, mounting, slow_errors, stated
from tests.exam.shown import Sailed, shown
from tests.exam.simulator import Vessel, grouped, sail
from tests.exam.thrust_curves import Curve, by_inflow, errors
from tests.exam.thrust_errors import SHAPES
from tests.exam.vessels import KINDS, Conditions, programme, vehicle_of

from ivsid.programme.scenario import Scenario, parse_scenario

FAMILIES = (*sorted(set(SHAPES) - {"levels"}), "hysteresis")
# The share of cases in which all thrusters have the same error.
ALIKE = 0.25
# Seeds from which on a thrust that should be none may be wrong by the absolute accuracy, and errors may jump every fortieth of the range: earlier cases
# stay what they were.
AT_REST = 217000
JUMPING = 230000
# Largest multiple of a typical size.
LARGEST = 64.0


@dataclass
class Case:
    """A drawn case.

    Attributes:
        seed: of every draw.
        text: of the vehicle file.
        logs: the columns of both logs with their times, ``t``.
        truth: the hidden effects by id and part.
        exact: the numbers of the plain model.
        stratum: everything else that was drawn.
        here: all that the seed drew but the effects.
        hidden: the parts of each hidden effect.
    """

    seed: int
    text: str
    logs: tuple[dict[str, np.ndarray], ...]
    truth: dict[str, float]
    exact: dict[str, float]
    stratum: dict[str, object]
    here: Setting
    hidden: dict[str, dict[str, float]]

    @cached_property
    def z(self) -> dict[str, float]:
        """How far each hidden effect stands out, by the examiner (tests/exam/shown.py); takes another sail each."""
        return {i: self.here.z(own) for i, own in self.hidden.items()}


@dataclass
class Setting:
    """Everything about a case but what is hidden in it: whatever that is, the draws of the sea and the sensors stay the same."""

    seed: int
    text: str
    exact: dict[str, float]
    programmes: tuple[Scenario, ...]
    scale: float
    family: str | None
    share: float
    alike: bool
    noise: str
    sea: str
    sensors: str
    stratum: dict[str, object]

    @property
    def at_rest(self) -> bool:
        """Whether thrust errors fill their bounds where there is no thrust, too."""
        return self.seed >= AT_REST

    @property
    def vessel(self) -> Vessel:
        return Vessel.read(self.text, self.exact)

    def sailed(self, truth: Mapping[str, float], which: int, *, calm: bool = False) -> tuple[Sailed, list[np.ndarray]]:
        """One of the logs: its motion and its readings without noise."""
        vessel, scenario = self.vessel, self.programmes[which]
        effects = grouped(truth, {**EFFECTS, **OUTSIDE})
        if which == 0:
            effects = {k: p for k, p in effects.items() if k not in ON_TEST_ALONE}
        streams = [np.random.default_rng([self.seed, which, k]) for k in range(3)]
        n, h = round(scenario.duration * scenario.rate), 1 / scenario.rate
        sea = vessel.table["ambient"]
        ambient = drawn_force(self.sea, n, h, (sea["force"], sea["force"], sea["moment"]), sea["time"], streams[0])
        if self.family == "inflow":
            own = np.random.default_rng([self.seed, 5])
            length = vessel.body.length
            drift = tuple(by_inflow(t, self.share, length, own, at_rest=self.at_rest) for t in vessel.thrusters)
            vessel = replace(vessel, drift=drift)
        # The curves belong to the vehicle: both logs have the same errors.
        own = errors(self.family, len(vessel.thrusters), self.alike, np.random.default_rng([self.seed, 3]))
        curves = [Curve(t, e, self.share, at_rest=self.at_rest) for t, e in zip(vessel.thrusters, own, strict=True)]
        motion = sail(vessel, scenario, effects, curves, 0.0 * ambient if calm else ambient, streams[1])
        if self.sensors == "mounted":
            # A sensor is mounted once for both logs.
            effects = effects | mounting(vessel.body.length, np.random.default_rng([self.seed, 8]))
        return Sailed(vessel, motion, clean_readings(motion, effects), tuple(curves)), streams

    def logs(self, truth: Mapping[str, float]) -> tuple[dict[str, np.ndarray], ...]:
        """The columns of both logs, and their times."""
        out = []
        for k in range(2):
            q, streams = self.sailed(truth, k)
            slow = (0.0, {})
            if self.sensors == "slow":
                own = np.random.default_rng([self.seed, 9, k])
                slow = slow_errors(q.vessel.table["sensors"], q.motion.t.size, own)
            out.append({"t": q.motion.t, **noisy(q.vessel, q.motion, q.clean, self.noise, streams[2], slow)})
        return tuple(out)

    def z(self, truth: Mapping[str, float]) -> float:
        """How far the effects stand out of this log, or of both where they differ between them."""
        both = any(k in truth for k in ON_TEST_ALONE)
        claimed = tuple(c for k, ids in CLAIMED.items() if any(q.startswith(k) for q in truth) for c in ids)
        return shown([self.sailed(truth, k)[0] for k in range(2 if both else 1)], claimed)

    def draw(self, id_: str, size: float) -> dict[str, float]:
        """The numbers of an effect at a multiple of its typical size: of another size they are the same otherwise."""
        thrusters = self.vessel.thrusters
        rng = np.random.default_rng([self.seed, 4, *id_.encode()])
        value = drawn(id_, size, self.vessel.body.mass, len(thrusters), self.programmes[0].duration, rng)
        if id_ == "thruster.deadband":
            # A percentage of the largest demand.
            value[id_] *= max(abs(d) for t in thrusters for d in t["table"]["demand"]) / 100
        return value


def setting(seed: int, claims: tuple[str, ...] = (), **given) -> Setting:
    """What a seed draws; what is given (``Conditions``) is not drawn."""
    rng = np.random.default_rng([seed, 1077])
    q = Conditions(**given)
    k = str(rng.choice(KINDS)) if q.kind is None else q.kind
    text, exact, scale = vehicle_of(k, rng)
    choices = ([0.3, 1.0, 3.0, 10.0], [0.2, 0.5, 0.2, 0.1])
    drawn_ambient = float(rng.choice(choices[0], p=choices[1]))
    a = drawn_ambient if q.ambient is None else q.ambient
    force = 0.15 * scale**3 * a
    text += f"[ambient]\nforce = {force:.5g}\nmoment = {0.2 * force * scale:.5g}\ntime = {2.0 * math.sqrt(scale):.4g}\n"
    if claims:
        text += "[model.values]\n" + "".join(f'"{c}" = {exact[c]!r}\n' for c in claims)
    st = str(rng.choice(["rich", "zigzag", "circle", "line"], p=[0.5, 0.5 / 3, 0.5 / 3, 0.5 / 3]))
    d, f = float(rng.choice([300.0, 600.0])), float(rng.choice([10.0, 20.0]))
    st, d, f = q.style or st, q.duration or d, q.rate or f
    head = f"duration = {d}\nrate = {f}\n[truth]\n"
    programmes = tuple(parse_scenario(head + programme(rng, d, k, scale, s), "s.toml") for s in (st, "rich"))
    families = FAMILIES if seed < JUMPING else (*FAMILIES, "levels")
    family, part, alike = str(rng.choice(families)), float(rng.uniform()), bool(rng.uniform() < ALIKE)
    family = q.thrust or family
    part = part if q.share is None else q.share
    stratum = {"kind": k, "style": st, "ambient": a, "duration": d, "rate": f, "family": family, "share": part}
    family = None if family == "none" else family
    stratum |= {"sea": q.sea, "sensors": q.sensors}
    here = Setting(seed, text, exact, programmes, scale, family, part, alike, q.noise, q.sea, q.sensors, stratum)
    return here if q.sensors != "mounted" else replace(here, text=stated(text, here.vessel.body.length))


def case(
    seed: int,
    what: str | None = None,
    effect: str | None = None,
    size: float | None = None,
    z: float | None = None,
    **given,
) -> Case:
    """The case of a seed.

    Args:
        seed: of every draw.
        what: ``none``, ``one``, ``two`` or ``outside``.
        effect: the one that is hidden; ``each`` takes them in turn, seed by seed.
        size: as a multiple of the typical one.
        z: how far the effect shall stand out; the size follows.
        given: as ``Conditions`` names it.
    """
    rng = np.random.default_rng([seed, 1078])
    w = what or str(rng.choice(["none", "one", "two", "outside"], p=[0.34, 0.46, 0.1, 0.1]))
    for name, draw, usual in (("sea", drawn_sea, "markov"), ("sensors", drawn_sensors, "white")):
        if given.get(name) == "any":
            # The examiner's z counts on the sea of the vehicle file, and on sensors with noise alone.
            given[name] = draw(seed) if w == "none" else usual
    probe = setting(seed, **given)
    sides = tuple(t["position"][1] for t in probe.vessel.thrusters)
    able = [i for i in drawn_by(seed) if possible(i, sides)]
    if effect == "each":
        effect = drawn_by(seed)[seed % len(drawn_by(seed))]
    if effect in EFFECTS and not possible(effect, sides):
        raise ValueError(f"the vehicle of seed {seed} cannot have {effect}")
    ids = {
        "none": [],
        "one": [effect or str(rng.choice(able))],
        "two": [str(i) for i in rng.choice(able, 2, replace=False)],
        "outside": [effect or str(rng.choice(outside_by(seed)))],
    }[w]
    claims = tuple(dict.fromkeys(c for i in ids for c in CLAIMED.get(i, ())))
    here = setting(seed, claims=claims, **given)
    sizes: dict[str, float] = {}
    hidden: dict[str, dict[str, float]] = {}
    for id_ in ids:
        s = size or (1.0 if w == "outside" else float(np.exp(rng.uniform(math.log(0.1), math.log(3.0)))))
        s = s if z is None else sized(here, id_, z)
        sizes[id_], hidden[id_] = s, here.draw(id_, s)
    truth = {k: x for own in hidden.values() for k, x in own.items()}
    stratum = {"what": w, "sizes": sizes, **here.stratum}
    return Case(seed, here.text, here.logs(truth), truth, here.exact, stratum, here, hidden)


def sized(here: Setting, id_: str, z: float) -> float:
    """The least multiple of an effect's typical size at which it stands out by z, to three per cent of z or one of the size.

    z is proportional to the size of most effects. It is 0 up to a size for those that a thrust curve may hide, and a staircase for a
    dead band, so that the two sizes that enclose the answer close in by interpolation of the logarithms, and by halving otherwise.

    Raises:
        ValueError: no size up to 64 times the typical one does, or any size does: a thrust that is late by nothing misses the reading
            of the very moment at which its demand jumps.
    """
    low, high, size = (0.0, 0.0), None, 1.0
    while True:
        at = here.z(here.draw(id_, size))
        if at >= z:
            high = (size, at)
        else:
            low = (size, at)
        if high is None:
            size *= 4 if at < z / 4 else 1.02 * z / at
            if size > LARGEST:
                raise ValueError(
                    f"{id_} of seed {here.seed} stands out by {at:.1f} at {low[0]:.3g} times its typical size"
                )
            continue
        if high[1] <= 1.03 * z or high[0] <= 1.01 * low[0]:
            return high[0]
        if high[0] < 1 / LARGEST**2:
            raise ValueError(f"{id_} of seed {here.seed} stands out by {high[1]:.1f} at any size")
        if not low[0]:
            size = 1.01 * high[0] * z / high[1]
            continue
        span, power = math.log(high[0] / low[0]), 0.5
        if low[1] > z / 20:
            power = min(max(math.log(1.01 * z / low[1]) / math.log(high[1] / low[1]), 0.1), 0.9)
        size = low[0] * math.exp(power * span)
