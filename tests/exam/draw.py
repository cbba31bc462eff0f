"""Cases by the package's own simulator, for tests of faults that an examination once showed: everything follows from the seed.

The examination itself draws with a simulator of its own (tests/exam/cases.py).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from tests.exam.thrust_errors import with_errors
from tests.exam.vessels import KINDS, Conditions, programme, vehicle_of

from ivsid.effects import EFFECTS, Effect, Parameter
from ivsid.effects.effect import Force
from ivsid.programme.scenario import parse_scenario
from ivsid.simulation import simulate
from ivsid.simulation.hidden import can_hide, draw
from ivsid.vehicle import Vehicle, parse_vehicle


def _outside() -> dict[str, Effect]:
    """Causes that the catalogue lacks."""

    def cubic(s, p):
        return {"surge": -p[0] * s.u * s.u * s.u, "sway": 0.0 * s.u}

    def shear(s, p):
        return {"surge": p[0] * (s.place.y * 0.02) * s.u, "yaw": 0.0 * s.u}

    def pulse(s, p):
        return {"yaw": p[0] * (s.u * s.u * s.u)}

    def mixed(s, p):
        return {"sway": p[0] * s.u * s.u, "yaw": 0.0 * s.u}

    one = (Parameter("", "", "1", 1.0, signed=True),)
    return {
        "x.cubic": Effect("x.cubic", "cubic drag", one, Force(cubic)),
        "x.shear": Effect("x.shear", "drag that depends on the place", one, Force(shear)),
        "x.torque": Effect("x.torque", "a moment with the cube of speed", one, Force(pulse)),
        "x.side": Effect("x.side", "a side force with the square of speed", one, Force(mixed)),
    }


OUTSIDE = _outside()
OUTSIDE_SIZE = {"x.cubic": 12.0, "x.shear": 8.0, "x.torque": 0.8, "x.side": 4.0}
# Causes that are drawn by their name alone: they joined the catalogue after tests had named these cases.
JOINED = ("drag.surge.cubic", "drag.sway.cubic", "drag.yaw.cubic")


@dataclass
class Case:
    """A drawn case."""

    seed: int
    vehicle: Vehicle
    train: object
    test: object
    truth: dict[str, float]
    stratum: dict[str, object]
    exact: dict[str, float]


def case(
    seed: int,
    what: str | None = None,
    effect: str | None = None,
    size: float | None = None,
    train_alone: bool = False,
    **given,
) -> Case:
    """The case of a seed; what is given (``Conditions``) is not drawn. TEST may be left out: it takes half of the time.

    True curves of a family of thrust errors fill half of their accuracy, unless a share is given; without a family there are none.
    """
    rng = np.random.default_rng([seed, 77])
    q = Conditions(**given)
    k = str(rng.choice(KINDS))
    k = q.kind or k
    text, exact, scale = vehicle_of(k, rng)
    a = float(rng.choice([0.3, 1.0, 1.0, 3.0, 10.0], p=[0.2, 0.3, 0.2, 0.2, 0.1])) if q.ambient is None else q.ambient
    force = scale**3
    text += f"[ambient]\nforce = {0.15 * force * a:.5g}\nmoment = {0.03 * force * scale * a:.5g}\ntime = {2.0 * scale**0.5:.4g}\n"
    st = str(rng.choice(["rich", "rich", "rich", "zigzag", "circle", "line"]))
    st = q.style or st
    d = float(rng.choice([300.0, 600.0])) if q.duration is None else q.duration
    drawn = float(rng.choice([10.0, 20.0]))
    rate = q.rate or drawn
    vehicle = parse_vehicle(text, "v.toml")
    w = what or str(rng.choice(["none", "one", "one", "two", "outside"], p=[0.34, 0.2, 0.26, 0.1, 0.1]))
    truth: dict[str, float] = {}
    head = f'duration = {d}\nrate = {rate}\nseed = {seed}\nnoise = "{q.noise}"\n[truth]\n'
    head += "\n".join(f'"{n}" = {v}' for n, v in exact.items()) + "\n"
    scenario = parse_scenario(head + programme(rng, d, k, scale, st), "s.toml")
    other = parse_scenario(head + programme(rng, d, k, scale, "rich"), "s.toml")
    sizes = []
    if w in ("one", "two"):
        possible = [
            e
            for e in EFFECTS.values()
            if can_hide(e, vehicle, scenario) and e.id not in ("thruster.gain", "environment.shallow_water", *JOINED)
        ]
        for _ in range(1 if w == "one" else 2):
            e = EFFECTS[effect] if effect else possible[int(rng.integers(len(possible)))]
            s = size if size is not None else float(np.exp(rng.uniform(np.log(0.1), np.log(3.0))))
            truth |= draw(e, s, vehicle, scenario, rng)
            sizes.append((e.id, s))
    if w == "outside":
        id_ = effect or str(rng.choice(list(OUTSIDE)))
        s = size if size is not None else 1.0
        value = OUTSIDE_SIZE[id_] * force * s
        truth[id_] = value * (scale if id_ == "x.torque" else 1.0)
        sizes.append((id_, s))
        EFFECTS[id_] = OUTSIDE[id_]
    share = 0.5 if q.share is None else q.share
    true = vehicle if q.thrust is None else with_errors(vehicle, q.thrust, share, np.random.default_rng([seed, 78]))
    try:
        train = simulate(true, scenario, seed, truth)
        test = None if train_alone else simulate(true, other, seed + 1_000_000, truth, thrusters=seed)
    finally:
        for id_ in OUTSIDE:
            EFFECTS.pop(id_, None)
    return Case(
        seed,
        vehicle,
        train,
        test,
        truth,
        {"what": w, "kind": k, "style": st, "ambient": a, "duration": d, "rate": rate, "sizes": sizes},
        exact,
    )
