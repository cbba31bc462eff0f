"""Cases for numbers of the diagnosis that the plain logs of ``benches/constants.py`` do not read.

A case returns a word on the outcome, names, and ends of intervals or other numbers that a user reads. Logs are those of the tests, drawn
with fixed seeds.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from constants_tasks import Task, done

AMBIENT = "[ambient]\nforce = 0.15\nmoment = 0.03\ntime = 2.0\n"
ACCURACY = "accuracy = { absolute = 0.1, relative = 0.02 }\n"
STRAIGHT = """
[[segments]]
manoeuvre = "steps"
demand = [60.0, 30.0, 75.0, 40.0]
period = 15.0
duration = 60.0
"""


def _diagnosed(
    effects: dict[str, float],
    *,
    remove: tuple[str, ...] = (),
    keep: str = "",
    segments: str = "",
    duration: float = 150.0,
    unlike: bool = False,
) -> Task:
    """Verdict, names with reasons, and numbers of a diagnosis and its evidence.

    Args:
        effects: that the logs hold.
        remove: lines that the vehicle file leaves out.
        keep: the only channels of the log beside the demands, if not all.
        segments: of the programme, if not those of the tests.
        duration: of each log [s].
        unlike: whether the surge velocity is bent by a law that no cause has.
    """
    from diagnosis_logs import SENSORS, TWIN, ZIGZAGS, logs_of  # noqa: PLC0415 - after the patch of a constant, as all imports of the package here
    from ivsid import diagnose, diagnosis  # noqa: PLC0415 - see above
    from ivsid.log import Log  # noqa: PLC0415 - see above
    from ivsid.vehicle import parse_vehicle  # noqa: PLC0415 - see above

    text = TWIN + SENSORS
    made = logs_of(parse_vehicle(text, "boat.toml"), effects, segments=segments or ZIGZAGS, duration=duration, seed=701)
    for line in remove:
        text = text.replace(line, "")
    logs = []
    for m in made:
        columns = {k: x for k, x in m.columns.items() if not keep or k.startswith("demand") or k in keep.split()}
        if unlike:
            columns["u"] = columns["u"] + 0.05 * np.sin(9.0 * columns["u"])
        logs.append(Log(m.name, m.sha256, m.t, columns))
    result = diagnose(parse_vehicle(text, "boat.toml"), *logs, null_logs=0)
    numbers = [x for f in result.findings for b in f.parameters.values() for x in (b.lower, b.upper)]
    numbers += [float(v) for v in result.selection.last.h.values.values()]
    shown = diagnosis.evidence(result)
    rules = [r.refusal.rule for r in result.rejected]
    numbers += [float(rules.count(rule)) for rule in ("visible", "faint", "chance", "rival", "full fit", "dominant")]
    numbers += [float(x) for e in shown for x in e.rms]
    numbers += [float(b.mean.max()) for e in shown for b in e.means]
    over = {e.effect: f" over {e.quantity}" for e in shown}
    words = [f.effect + over.get(f.effect, "") for f in result.findings]
    return result.verdict, sorted(words), numbers


def _null_logs() -> Task:
    """Largest strengths of twelve null logs, the threshold, and the feedback that their programme was found to have."""
    from ivsid.diagnosis.null.calibration import examined  # noqa: PLC0415 - see _diagnosed
    from test_null_logs import STRAIGHT as COURSE  # noqa: PLC0415 - see _diagnosed
    from test_null_logs import trial  # noqa: PLC0415 - see _diagnosed

    words, numbers = [], []
    for segments in ({}, {"segments": COURSE}):
        made = trial(duration=120.0, **segments)[2]
        back = made.programme.feedback
        found = examined(made, 1, range(12))
        words.append(f"usable: {found.usable}, closed: {back.closed}, passed: {int(found.passed.sum())}")
        numbers += [*np.ravel(back.feedback_gains).tolist(), float(np.mean(back.at[0]))]
        numbers += [float(found.threshold())] if found.kept.size else []
        numbers += np.sort(found.strengths).tolist()
    return "null logs", words, numbers


def _advised() -> Task:
    """The best manoeuvres for two sets of causes, and the smallest distance of each."""
    from diagnosis_logs import TRUTH, train_of, vehicle_of  # noqa: PLC0415 - see _diagnosed
    from ivsid.diagnosis.candidates.families import everything  # noqa: PLC0415 - see _diagnosed
    from ivsid.diagnosis.data.channels import channels  # noqa: PLC0415 - see _diagnosed
    from ivsid.diagnosis.estimation.learning import plain_fit  # noqa: PLC0415 - see _diagnosed
    from ivsid.diagnosis.planning.advice import advise  # noqa: PLC0415 - see _diagnosed
    from ivsid.log import Log  # noqa: PLC0415 - see _diagnosed
    from ivsid.programme import trials  # noqa: PLC0415 - see _diagnosed
    from ivsid.simulation import simulate  # noqa: PLC0415 - see _diagnosed

    vehicle = vehicle_of()
    train = train_of(vehicle, duration=120.0)
    fit = plain_fit(vehicle, channels(train, vehicle), everything)
    logs = {}
    for trial in trials.library(vehicle):
        if trial.name in ("coast to rest", "zigzag 20/20", "speed steps", "PRBS"):
            made = simulate(vehicle, trials.scenario(trial, vehicle, 10.0, TRUTH, "none"))
            logs[trial.name] = Log(
                trial.name, "", made.t, {k: x for k, x in made.columns.items() if k in train.columns}
            )
    sets = [
        ("drag.surge.linear", "friction.coulomb"),
        ("added_mass.munk", "drag.lift.yaw"),
        ("thruster.lag", "thruster.delay"),
    ]
    found, _ = advise(fit, sets, logs)
    words = [f"{' | '.join(a.ids)}: {a.best.trial if a.best else 'none'}" for a in found]
    return "advised", words, [float(c.d) for a in found for c in a.choices]


#: A case and the constants that it is for, by file below ivsid/diagnosis and name.
RARE: dict[str, tuple[Callable[[], Task], tuple[str, ...]]] = {
    "nothing declared": (
        lambda: _diagnosed({"drag.yaw.linear": 1.5}, remove=(AMBIENT, ACCURACY)),
        tuple(f"estimation/noise.py {n}" for n in ("ASSUMED_SHARE", "ASSUMED_ACCURACY", "ASSUMED_ARM", "ASSUMED_TIME")),
    ),
    "pose alone": (
        lambda: _diagnosed({"drag.surge.linear": 6.0}, keep="x y psi"),
        ("data/from_pose.py STEP", "data/from_pose.py CLOSE"),
    ),
    "straight": (
        lambda: _diagnosed({"drag.surge.linear": 6.0}, segments=STRAIGHT),
        tuple(f"plant/usual_hull.py {n}" for n in ("SWAY_MASS", "YAW_INERTIA", "SWAY_DRAG")),
    ),
    "starting load": (
        lambda: _diagnosed({"payload.step.mass": 8.0, "payload.step.time": 70.0}),
        tuple(f"candidates/profile.py {n}" for n in ("TIME_STEP", "TIME_STEPS")),
    ),
    "limit": (
        lambda: _diagnosed({"thruster.saturation": 22.0}),
        ("selection/admission.py RESTARTS",),
    ),
    "unlike": (
        lambda: _diagnosed({"drag.yaw.linear": 1.5}, unlike=True),
        (
            "selection/verdict.py REST",
            "statements/rules.py DOMINANT",
            "statements/binning.py BINS",
            "statements/binning.py PREFERRED",
            "candidates/intervals.py SAME",
        ),
    ),
    "six causes": (
        lambda: _diagnosed(
            {
                "drag.surge.linear": 6.0,
                "drag.yaw.linear": 1.5,
                "sensor.yaw_rate.scale": 0.06,
                "thruster.deadband": 12.0,
                "current.steady.north": 0.08,
                "current.steady.east": 0.05,
                "sensor.velocity.misalignment": 0.08,
            }
        ),
        ("selection/rules.py WORTH", "selection/review.py SWAP"),
    ),
    "heavy drag": (
        lambda: _diagnosed({"drag.yaw.linear": 60.0, "drag.surge.linear": 150.0}),
        ("estimation/noise.py QUICKENING",),
    ),
    "null logs": (
        _null_logs,
        (
            "null/calibration.py SETTLED",
            *(f"null/tail.py {n}" for n in ("TAIL_OF_FEW", "MOST_LOST")),
            *(f"null/simulated_logs.py {n}" for n in ("SIZES", "LOST", "LEAST_SPEED")),
            *(f"null/feedback.py {n}" for n in ("SPAN", "BLOCK", "EXPLAINED", "LONGER", "UNCHANGED", "USABLE")),
        ),
    ),
    "advised": (_advised, tuple(f"planning/isolability.py {n}" for n in ("NONE", "BETTER", "DEPENDENT"))),
}


def served() -> set[str]:
    """The constants that have a case here, as ``file NAME``."""
    return {f"diagnosis/{c}" for _, constants in RARE.values() for c in constants}


def rare(constant: str) -> dict[str, dict[str, Any]]:
    """Outcome, names and numbers of the cases for a constant, as ``file NAME``; of all cases for another one."""
    every = constant not in served()
    return done(
        {name: case for name, (case, own) in RARE.items() if every or constant.removeprefix("diagnosis/") in own}
    )
