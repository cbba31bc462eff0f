"""First screens of the pages of single stages: what was found, how sure it is, and what to do next."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Final

from ivsid.report.page import Card, First
from ivsid.workflow.parameters import bounded, freedom_lines

if TYPE_CHECKING:
    from ivsid.diagnosis import Isolability
    from ivsid.identification import Identification
    from ivsid.propulsion.bollard import Bollard
    from ivsid.sensors.allan import AllanDeviation
    from ivsid.validation import Validation

# What to do after each status of an identification.
NEXT: Final = {
    "enclosed": "Check the intervals on another log: ivsid validate result.json LOG.",
    "empty": "Look for the cause: ivsid diagnose VEHICLE LOG OTHER_LOG. The rows that contradict each other stand below.",
    "unbounded": "Sail what the open directions lack: ivsid isolability names the manoeuvre.",
    "not_proved": "Identify by the method feasible for intervals that are guaranteed.",
    "not_applicable": "Identify by the method feasible, whose conditions always hold.",
}
TITLES: Final = {"surge": "force X", "sway": "force Y", "yaw": "moment N"}
# Sets of causes that the first screen names.
# Source: definition: what a screen holds
SETS: Final = 4


def identified(fit: Identification, further: Sequence[str] = ()) -> First:
    """The first screen of an identification.

    Args:
        fit: the identification.
        further: what would narrow its intervals, in sentences.
    """
    verdict = {
        "enclosed": f"{len(fit.parameters)} parameters are enclosed",
        "empty": "No parameters explain this log",
        "unbounded": "The log leaves some parameters open",
    }.get(fit.status, "These intervals prove nothing")
    tone = {"enclosed": "good", "empty": "bad"}.get(fit.status, "open")
    said = [f"{line[0].upper()}{line[1:]}." for line in freedom_lines(fit)]
    if fit.inflation is not None:
        room = "the log leaves room to spare" if fit.inflation < 1 else "so wide would all bounds have to be"
        said.append(f"Smallest factor on all bounds with a consistent parameter: {fit.inflation:.3g}, {room}.")
    facts = tuple((id_, bounded(p.lower, p.upper, p.unit)) for id_, p in fit.parameters.items())
    cards = (Card("Intervals", f"Method {fit.method}.", facts, "parameters"),) if facts else ()
    claims = [c for c in fit.claims if c["contradicted"]]
    warnings = [f"The claimed {c['parameter']} = {c['value']:.4g} is contradicted." for c in claims]
    return First(verdict, tone, " ".join(said), cards, (NEXT[fit.status], *further), tuple(warnings))


def validated(result: Validation) -> First:
    """The first screen of a validation."""
    wrong, total = sum(f.falsified for f in result.forces), sum(f.time.size for f in result.forces)
    fit = result.fit
    units = {"yaw": "N m"}
    facts = [
        (
            TITLES[f.channel],
            f"error {f.sigma:.3g} {units.get(f.channel, 'N')} about a mean of {f.mean:.3g} {units.get(f.channel, 'N')}; {100 * f.coverage:.4g} % inside the bounds",
        )
        for f in result.forces
    ]
    motion = {"u": "m/s", "v": "m/s", "r": "rad/s", "position": "m"}
    facts += [(f"simulated {k}", f"rms error {x:.3g} {motion[k]}") for k, x in result.motion.rms.items()]
    if result.motion.reason:
        facts.append(("simulated motion", result.motion.reason))
    found = result.tubes
    outside = f"{max(found.outside.values(), default=0)} rows"
    facts.append(("tubes", found.reason) if found.reason else ("readings outside of the tubes", outside))
    verdict = "The parameters hold on the other log"
    if result.motion.reason:
        verdict = "No row of the other log contradicts the parameters"
    if wrong:
        verdict = f"{wrong} of {total} rows contradict the parameters"
    elif found.refuted:
        verdict = "No row alone contradicts the parameters, and the motion does"
    sure = (
        "guaranteed under the assumptions below: a row that contradicts them proves them wrong there"
        if fit.guaranteed
        else "not guaranteed, so agreement proves nothing"
    )
    twin = " (the log of this call)" if result.log_name == fit.log_name else ""
    rows = "" if wrong else f", {total} rows"
    words = f"{result.log_name}{twin}{rows}, against the fit of {fit.log_name} by {fit.method}. The bounds are {sure}."
    # Logs of one name stand in folders of their own, which the fit does not know.
    logs = "LOG OTHER_LOG" if twin else f"{fit.log_name} {result.log_name}"
    following = (
        f"Look for the cause: ivsid diagnose VEHICLE {logs}."
        if result.contradicted
        else "Use the parameters for motion like that of both logs; sail other motion to test them further."
    )
    # Where the log leaves parameters open, no motion can be simulated: agreement of rows is half of the answer.
    tone = "bad" if result.contradicted else "open" if result.motion.reason else "good"
    return First(verdict, tone, words, (Card("Errors", "Predicted against measured.", tuple(facts)),), (following,))


def analysed(
    curves: Mapping[str, AllanDeviation], bounds: Mapping[str, float], units: Mapping[str, str], duration: float
) -> First:
    """The first screen of an Allan analysis."""
    facts = []
    for name, a in curves.items():
        low, high = a.bands["random_walk"]
        bias = f"{a.bias_instability:.3g} {units[name]}" + ("" if a.resolved else " (not resolved)")
        walk = f"{a.random_walk:.3g} {_over_root(units[name])} ({low:.3g} to {high:.3g})"
        facts.append((name, f"N {walk}; B {bias}; half-width {float(bounds[name]):.3g} {units[name]}"))
    open_ = [n for n, a in curves.items() if not a.resolved]
    verdict = f"Noise of {len(curves)} {'channel' if len(curves) == 1 else 'channels'} for the vehicle file"
    words = f"From {duration:.4g} s at rest. N is the random walk with its 95 % band, B the bias instability, and the half-width bounds every sample of a log of this length with probability 0.999."
    following = ["Copy sensors.toml into the vehicle file."]
    if open_:
        following.append(
            f"Record for longer to measure the bias of {', '.join(open_)}: its hump lies beyond this record."
        )
    card = Card("Coefficients", "", tuple(facts), "coefficients")
    return First(verdict, "open" if open_ else "good", words, (card,), tuple(following))


def _over_root(unit: str) -> str:
    """The unit of a random walk: that of the readings times the root of a second."""
    once = unit.removesuffix("/s^2") + "/s/√s" if unit.endswith("/s^2") else unit.removesuffix("/s") + "/√s"
    return once if unit.endswith(("/s", "/s^2")) else f"{unit}·√s"


def pulled(table: Bollard) -> First:
    """The first screen of a bollard pull."""
    best = table.recommended
    facts = [
        *(
            [("residuals", "none: it goes through every point")]
            if best.passes
            else [("largest residual", f"{best.largest:.3g} N"), ("rms residual", f"{best.rms:.3g} N")]
        ),
        ("range of thrust", f"{table.thrust.min():.4g} to {table.thrust.max():.4g} N"),
        ("points", str(table.demand.size)),
    ]
    if table.dead_band is not None:
        facts.append(("dead band", f"demands {table.dead_band[0]:.4g} to {table.dead_band[1]:.4g}"))
    kept = "It goes through every point" if best.passes else "It misses no point by more than 1 % of the largest thrust"
    words = f"{kept}; the candidates stand below with what they miss."
    following = (
        "Copy thruster.toml into the vehicle file, and add its position and azimuth.",
        "State an accuracy that holds for the vehicle in the water: the table itself says nothing of inflow and of the battery.",
    )
    return First(
        f"Use the {best.name}", "good", words, (Card("Thrust curve", best.name, tuple(facts), "candidates"),), following
    )


def separable(result: Isolability) -> First:
    """The first screen of an isolability study."""
    tested = sum(v.tested for v in result.visible.values())
    apart = len(result.classes)
    advised = {a.ids: a for a in result.advice}
    facts, following = [], []
    for ids, said in result.classes[:SETS]:
        best = advised[ids].best if ids in advised else None
        facts.append(
            (", ".join(ids), f"{best.trial}: distance {best.d:.3g} instead of {advised[ids].d:.3g}" if best else said)
        )
        if best:
            following.append(f"Sail {best.trial} to tell {', '.join(ids)} apart.")
    blind = [(id_, *result.shown[id_]) for id_, v in result.visible.items() if not v.tested and id_ in result.shown]
    following += [f"Sail {trial} to see {id_}." for id_, trial, _ in blind[:SETS]]
    verdict = f"{tested} of {len(result.visible)} causes would show in this programme"
    words = (
        f"{apart} {'set of them is' if apart == 1 else 'sets of them are'} not told apart; at its typical size a cause is tested from 8 standard deviations, and two are told apart from a distance of 5."
        if apart
        else "All of them are told apart."
    )
    cards = (Card("Not told apart", "With the manoeuvre that does most.", tuple(facts)),) if facts else ()
    return First(
        verdict,
        "open" if apart or tested < len(result.visible) else "good",
        words,
        cards,
        tuple(dict.fromkeys(following)),
    )


def demonstrated(fits: Sequence[Identification], checks: Sequence[Validation]) -> First:
    """The first screen of the paper's experiment."""
    feasible = fits[0]
    facts = tuple((id_, bounded(p.lower, p.upper, p.unit)) for id_, p in feasible.parameters.items())
    proved = [f.method for f in fits if f.guaranteed and f.parameters]
    wrong = sum(f.falsified for f in checks[0].forces)
    words = (
        f"Of {len(fits)} methods on the same rows, {len(proved)} give guaranteed intervals ({', '.join(proved)}). "
        f"On the second trial {wrong or 'no'} rows contradict those of the feasible set."
    )
    card = Card(
        "Intervals of the feasible set", "Guaranteed under the assumptions below.", facts, "parameters-by-every-method"
    )
    following = (
        "Identify your own log: ivsid identify VEHICLE LOG.",
        "Read what the published method's numbers are worth, below.",
    )
    return First("The paper's experiment, repeated on a twin with a known truth", "good", words, (card,), following)
