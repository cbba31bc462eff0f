"""Short tasks outside the diagnosis, whose numbers ``benches/constants.py`` compares: one for each constant that it varies.

A task returns a word on the outcome, names, and ends of intervals. Logs are those of the tests, drawn with fixed seeds.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from importlib.resources import files
from typing import Any

import numpy as np

Task = tuple[str, list[str], list[float]]
TRUTH = {"mass.surge": 60.45, "drag.surge.quadratic": 255.0, "inertia.yaw": 8.0}


def _swan() -> Any:
    from ivsid.vehicle import parse_vehicle  # noqa: PLC0415 - after the patch of a constant, as all imports of the package here

    return parse_vehicle((files("ivsid") / "data" / "swan.toml").read_text(), "swan.toml")


def _twin(duration: float = 60.0) -> Any:
    from ivsid.log import Log  # noqa: PLC0415 - see _swan
    from ivsid.programme.scenario import parse_scenario  # noqa: PLC0415 - see _swan
    from ivsid.simulation import simulate  # noqa: PLC0415 - see _swan

    scenario = parse_scenario((files("ivsid") / "data" / "swan_train.toml").read_text(), "swan_train.toml")
    made = simulate(_swan(), scenario.model_copy(update={"duration": duration, "noise": "uniform"}), 7)
    return Log("twin.csv", "0" * 64, made.t, made.columns)


def _identified(**options: Any) -> Task:
    from ivsid import identify  # noqa: PLC0415 - see _swan

    fit = identify(_swan(), _twin(), **options)
    return str(fit.status), sorted(fit.parameters), [e for p in fit.parameters.values() for e in (p.lower, p.upper)]


def _bounded(from_pose: str) -> Task:
    """Velocities of a boat whose log has a pose alone: the share of known rows and the median widths."""
    from ivsid.log import Log  # noqa: PLC0415 - see _swan
    from ivsid.sensors.bounds import bound_log  # noqa: PLC0415 - see _swan
    from ivsid.vehicle import parse_vehicle  # noqa: PLC0415 - see _swan
    from test_pose import boat, motion  # noqa: PLC0415 - see _swan

    t, pose, _, (acceleration, yaw) = motion(4, 120.0)
    rng = np.random.default_rng(4)
    columns = {c: pose[c] + rng.standard_normal(t.size) * 0.002 for c in ("x", "y", "psi")}
    columns |= dict.fromkeys(("force_X", "force_Y", "moment_N"), 0 * t)
    columns["x"][500:520] = np.nan
    columns["x"][520 + np.arange(0, 400, 45)] = np.nan
    text = boat(0.01, 0.01, 1.01 * acceleration, 1.01 * yaw).text
    text += "[sensors.force]\naccuracy = 50.0\n[sensors.moment]\naccuracy = 50.0\n"
    if from_pose == "spline":
        text = text.replace("[sensors.position]", '[sensors]\nfrom_pose = "spline"\n[sensors.position]', 1)
    bounded = bound_log(Log("a.csv", "0" * 64, t, columns), parse_vehicle(text, "boat.toml"))
    ends = []
    for name in ("u", "v", "r"):
        known = bounded.present[name]
        ends += [float(known.mean()), float(np.median(bounded.channels[name].width[known]))]
    return "bounded", [], ends


def _derived() -> Task:
    from ivsid import identify  # noqa: PLC0415 - see _swan
    from test_derivatives import towed  # noqa: PLC0415 - see _swan

    log, _, smooth, _ = towed(1)
    fit = identify(smooth, log)
    return str(fit.status), sorted(fit.parameters), [e for p in fit.parameters.values() for e in (p.lower, p.upper)]


def _open() -> Task:
    """Combinations that stay bounded under open directions of several scales."""
    from ivsid.identification.combinations import determined, in_words  # noqa: PLC0415 - see _swan

    rng = np.random.default_rng(5)
    found = [
        [in_words({f"p{k}": float(c) for k, c in enumerate(row) if c}) for row in determined(n, rays)]
        for n, rays in (
            (3, [np.array([1.0, -0.5, 0.0])]),
            (4, [np.array([1.0, 1e-5, 0.0, 2.0]), np.array([0.0, 3e4, 1.0, 0.0])]),
            (6, list(rng.standard_normal((3, 6)))),
            (5, [np.array([1e-8, 1.0, 0.0, 1e3, 0.0]) + 1e-12 * rng.standard_normal(5)]),
        )
    ]
    return "combinations", [w for words in found for w in words], []


def _recorded() -> Task:
    """The coefficients of a drawn record: white noise with a Gauss-Markov bias."""
    from ivsid.sensors.allan import allan_deviation  # noqa: PLC0415 - see _swan

    rng, period, n = np.random.default_rng(6), 0.05, 100_000
    bias, decay = np.empty(n), np.exp(-period / 120.0)
    bias[0] = 3e-4 * rng.standard_normal()
    steps = 3e-4 * np.sqrt(1 - decay**2) * rng.standard_normal(n)
    for k in range(1, n):
        bias[k] = decay * bias[k - 1] + steps[k]
    found = allan_deviation("r", 2e-3 / np.sqrt(period) * rng.standard_normal(n) + bias, period)
    return "recorded", [], [float(v) for v in _numbers(found)]


def _numbers(value: Any) -> list[float]:
    """All plain numbers of a record, in its order."""
    kept = []
    for v in vars(value).values():
        if isinstance(v, int | float):
            kept.append(float(v))
        elif isinstance(v, tuple):
            kept += [float(x) for x in v if isinstance(x, int | float)]
    return kept


def _narrowed() -> Task:
    from ivsid import identify  # noqa: PLC0415 - see _swan
    from ivsid.effects.catalogue import terms_of  # noqa: PLC0415 - see _swan
    from ivsid.identification.constriction import constrict  # noqa: PLC0415 - see _swan
    from ivsid.rows import build_rows  # noqa: PLC0415 - see _swan
    from ivsid.sensors.bounds import bound_log  # noqa: PLC0415 - see _swan

    vehicle, log = _swan(), _twin()
    fit = identify(vehicle, log)
    rows = build_rows(bound_log(log, vehicle), vehicle, terms_of(vehicle))
    ends = [np.array([getattr(fit.parameters[t.id], end) for t in rows.terms]) for end in ("lower", "upper")]
    found = constrict(rows, ends[0], ends[1])
    return "narrowed", [], [*found.lower.tolist(), *found.upper.tolist(), found.coverage]


def _sailed() -> Task:
    """Every trial of the library: whether it is believed, its length, largest speed and yaw rate."""
    from ivsid.programme.trials import believable, library, scenario  # noqa: PLC0415 - see _swan
    from ivsid.simulation import simulate  # noqa: PLC0415 - see _swan

    vehicle = _swan()
    words, ends = [], []
    for trial in library(vehicle):
        made = simulate(vehicle, scenario(trial, vehicle, 10.0, TRUTH), 1)
        r = made.columns["r"]
        words.append(f"{trial.name}: {'believed' if believable(vehicle, r) else 'not believed'}")
        ends += [float(made.t[-1]), float(np.abs(made.columns["u"]).max()), float(np.abs(r).max())]
    return "sailed", words, ends


def _settled() -> Task:
    """A motion at slow clocks, whose steps the integration halves until it settles, and the last states."""
    from ivsid import IvsidError  # noqa: PLC0415 - see _swan
    from ivsid.programme.scenario import parse_scenario  # noqa: PLC0415 - see _swan
    from ivsid.simulation import simulate  # noqa: PLC0415 - see _swan

    plan = parse_scenario((files("ivsid") / "data" / "swan_train.toml").read_text(), "swan_train.toml")
    words: list[str] = []
    ends: list[float] = []
    for rate in (0.5, 1.0, 2.0, 5.0):
        slow = plan.model_copy(update={"duration": 120.0, "rate": rate, "noise": "none"})
        try:
            made = simulate(_swan(), slow, 1)
        except IvsidError:
            words.append(f"{rate:g} Hz: not settled")
        else:
            words.append(f"{rate:g} Hz: settled")
            ends += [float(made.columns[c][-1]) for c in ("u", "r")]
    return "settled", words, ends


def _published() -> Task:
    """Improper entries and bounds of the published inverse of the demo's gram matrix, at its number of partitions."""
    from ivsid import linalg, regression  # noqa: PLC0415 - see _swan
    from ivsid.effects.catalogue import terms_of  # noqa: PLC0415 - see _swan
    from ivsid.rows import build_rows  # noqa: PLC0415 - see _swan
    from ivsid.sensors.bounds import bound_log  # noqa: PLC0415 - see _swan
    from ivsid.workflow import paper_trials  # noqa: PLC0415 - see _swan

    vehicle = _swan()
    rows = build_rows(bound_log(_twin(), vehicle), vehicle, terms_of(vehicle))
    found = linalg.inverse_one(regression.gram(rows.matrix), "published-hull", paper_trials.PARTITIONS)
    ends = [] if found.value is None else [*found.value.lower.ravel().tolist(), *found.value.upper.ravel().tolist()]
    return str(found.status), [], ends


TASKS: dict[str, Callable[[], Task]] = {
    "pointwise": _identified,
    "integral": lambda: _identified(rows="integral"),
    "enclosed pose": lambda: _bounded("enclose"),
    "splines": lambda: _bounded("spline"),
    "derived": _derived,
    "open": _open,
    "record": _recorded,
    "narrowed": _narrowed,
    "trials": _sailed,
    "slow clocks": _settled,
    "published": _published,
}


def worked() -> dict[str, Any]:
    """Outcome, names and ends of every task."""
    return done(TASKS)


def done(tasks: Mapping[str, Callable[[], Task]]) -> dict[str, Any]:
    """Outcome, names and ends of some tasks; a refusal is an outcome."""
    from ivsid import IvsidError  # noqa: PLC0415 - see _swan

    found = {}
    for name, task in tasks.items():
        try:
            verdict, names, ends = task()
        except IvsidError as refusal:
            verdict, names, ends = f"refused: {refusal}", [], []
        found[name] = {"verdict": verdict, "names": names, "ends": ends}
    return found
