"""Finding ``unknown``: structure that no cause of the catalogue explains, in a sentence that says what is seen and what would tell more."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator, Mapping, Sequence
from typing import Final

import numpy as np

from ivsid.diagnosis.null.blows import BLOWS
from ivsid.diagnosis.null.modulated import FALL
from ivsid.diagnosis.selection.dictionary import FELT, WRONG
from ivsid.diagnosis.selection.structure import PARTED, REPEATS, ROUGHER, SCATTERED, Adequacy
from ivsid.diagnosis.statements.findings import Finding
from ivsid.diagnosis.statements.residuals import FindingEvidence
from ivsid.diagnosis.statements.sensor_words import APART, READ, WORDS
from ivsid.effects import CHANNELS

# What a regressor of the dictionary suggests, by the first of these words that its name holds.
_SUGGESTED: Final = {
    "psi": "it repeats with the heading, as a force does that keeps its direction over ground",
    "t": "it grows or fades over the log, as a thrust does while a motor warms or a battery runs down",
    "x": "it differs from place to place, as a current or a depth does",
    "y": "it differs from place to place, as a current or a depth does",
    "thrust": "it goes with the thrust, as an interaction of thrusters with the hull or with each other does",
    "trailing": "it trails the path, as a body in tow does",
    "memory": "it trails the motion, as water does that swings in a tank or in waves that the hull made",
    "1": "it is the same all the time, as a steady force or an offset of a sensor is",
}
_MOTION: Final = "it follows the velocities, as a drag or a coupling does"
# Multiple of every other thrust's error, in bounds, from which on one leaves its bound alone: the fit moves the others along.
# Source: measured: one of four thrusters that was capped at 0.6 had 45 bounds, and the others 2.8 to 4.3
ALONG: Final = 5.0


def _read(regressor: str) -> str:
    """A clause on what the strongest regressor suggests."""
    if regressor.startswith(FALL):
        return "; a thrust that falls with the speed of the hull, the heat of its motor or the wash of another does so: the same demand at rest and at speed, early and late in a run, and with the others at rest tells them apart"
    if regressor.startswith(WRONG):
        return "; a gyro that feels accelerations or is filtered, or whose scale drifts, does so: turns both ways at rest and at speed beside a compass show it"
    if regressor.startswith(FELT):
        return "; an accelerometer whose scale is off, that feels its other axis, or that a bracket that swings with the thrusters shakes does so: readings at rest on each of its sides, with the thrusters off and at each demand, show it"
    if regressor.startswith("thrust of "):
        return f"; {_SUGGESTED['thrust']}"
    if "known" in regressor:
        return "; it goes with a known force, as an error of that force does"
    words = re.split(r"[ ^|]+", regressor)
    return f"; {next((said for word, said in _SUGGESTED.items() if word in words), _MOTION)}"


def _rough(left: Adequacy) -> Iterator[tuple[str, str]]:
    """The channel of a force that is rougher than declared, and a clause on it."""
    if left.roughest <= ROUGHER:
        return
    declared = max(left.rougher) > ROUGHER
    times, allowed = (
        (
            left.rougher,
            "what [ambient] and the thrusters' accuracy allow (their absolute accuracy alone, where the file has no [ambient])",
        )
        if declared
        else (left.beyond_curves, "what [ambient] allows, whatever thrust curve inside its accuracy acts beside it")
    )
    k = int(np.argmax(times))
    yield (
        CHANNELS[k],
        f"{'the moment' if k == 2 else 'the force'} in {CHANNELS[k]} that nothing explains is at least {times[k]:.2g} times {allowed}: the sea was "
        "rougher than the vehicle file declares, an accelerometer is worse than it states, or a cause that the catalogue lacks acts there",
    )


def _read_wrong(left: Adequacy) -> Iterator[tuple[str, str]]:
    """The channel in which readings act that scatter, or part from one another, beyond their stated accuracies, and a clause on them."""
    asked = (
        (
            left.scattered,
            SCATTERED,
            READ,
            "the readings of {} scatter about the motion by at least {:.2g} times their stated accuracy: the sensor is worse than it states, or its readings "
            "jump, as a position does by reflected signals",
        ),
        (
            left.parted,
            PARTED,
            APART,
            "{} part by {:.2g} times what their stated accuracies allow over seconds or minutes: one of the sensors is worse than it states, or wrong for a while, "
            "as a compass is near steel, a position in reflected signals and a velocity that is lost and kept",
        ),
    )
    for (name, times), limit, words, sentence in asked:
        if times > limit:
            read, channel = words[name]
            yield channel, sentence.format(read, times)


def _repeated(left: Adequacy) -> Iterator[tuple[str, str]]:
    """The channel of a force that repeats with the way, and a clause on it."""
    one = left.rhythm
    if one.chance < REPEATS:
        kind = "a moment" if one.channel == CHANNELS[2] else "a force"
        yield (
            one.channel,
            f"{kind} in {one.channel} repeats every {one.length:.3g} m of the way through the water, {one.height:.0f} times as strong as its neighbours, and not with the "
            "time: vortices that a frame, a strut or a line sheds do so every five of its widths",
        )


def _struck(left: Adequacy) -> Iterator[tuple[str, str]]:
    """The channel of a force that comes in blows, and a clause on it."""
    one = left.blow
    if one.times > BLOWS:
        turns = one.channel == CHANNELS[2]
        again = (
            f" at {one.time:.0f} s"
            if one.count < 2
            else f", in {one.count} seconds of the log, the strongest at {one.time:.0f} s"
        )
        yield (
            one.channel,
            f"{'a moment' if turns else 'a force'} in {one.channel} of {one.load:.2g} {'N m' if turns else 'N'} comes in blows of a second or less{again}: a bow that slams, ice or "
            "wood that is struck, a line that snatches and a sensor that jumps do so",
        )


def _of_force(left: Adequacy) -> tuple[str, str]:
    """What of the forces leaves its bound, and the test that shows it: of thrusts, or of forces that the log holds."""
    known = max(left.outside, key=lambda one: one[1], default=("", 0.0))[0].startswith("the known ")
    return (
        ("error of a known force", "a gauge beside it") if known else ("thrust curve", "a bollard test of the thrust")
    )


def _off(outside: Sequence[tuple[str, float]]) -> str:
    """The thrusts that leave their bounds, the one farthest outside first, and alone where the fit moves the others along with it."""
    ranked = sorted(outside, key=lambda one: -one[1])
    said = [f"{name} (fitted at {most:.1f} times its accuracy)" for name, most in ranked]
    if len(ranked) > 1 and ranked[0][1] > ALONG * ranked[1][1]:
        return f"{ranked[0][0]} (fitted at {ranked[0][1]:.1f} times its accuracy, and no other at more than {ranked[1][1]:.1f} times)"
    return " and ".join(said)


def _followed(left: Adequacy, likely: str) -> str:
    """A sentence on the regressors that the errors follow, on this log, on the other one alone, or on both together."""
    read = _read(left.strongest[0][0])
    if left.only:
        return (
            f"the errors that the model leaves on {left.only}, fitted to it, still follow the motion, strongest with {likely}, and this log shows no cause that explains "
            f"it{read}; a diagnosis of {left.only} as the first log asks the whole catalogue of it, and a cause that it names there is one that only that manoeuvre "
            "excites, or one of that day alone"
        )
    both = f" on this log and on {left.shared} together" if left.shared else ""
    return (
        f"the errors that the model leaves{both} still follow the motion (dictionary statistic {left.statistic:.2f}, about 1 where nothing is "
        f"left), strongest with {likely}; no cause of the catalogue that this log tests explains it{read}"
    )


def _passed(imitated: Collection[str], faint: Collection[str]) -> Iterator[str]:
    """Clauses on causes that passed every test and are no findings, from a clause on each."""
    if imitated:
        yield f"a force that the catalogue lacks acts on the hull, or a sensor is worse than it states: {'; '.join(imitated)}"
    if faint:
        yield (
            f"{'; '.join(faint)}: either the ambient force makes what stays unexplained, or another cause makes that and what is taken for this one; "
            "a longer log, or one in a calmer sea, tells the two apart"
        )


def unknown(
    left: Adequacy,
    near: Sequence[str],
    *,
    proved: str = "",
    imitated: Mapping[str, float] | None = None,
    faint: Mapping[str, float] | None = None,
) -> Finding:
    """Finding ``unknown``: structure that no cause of the catalogue explains.

    Args:
        left: adequacy of the extended model.
        near: causes that the fit holds and that are no findings.
        proved: what the rows of the log prove, in a sentence, where statistics alone would leave the model adequate.
        imitated: why causes that passed every test are a force of no cause, a clause each that begins with the cause, with their falls of chi-squared.
        faint: the same of causes that do not dominate what is left.
    """
    likely = ", ".join(f"{name} in {channel} ({np.sqrt(fall):.0f} sigma)" for name, channel, fall in left.strongest)
    channel = left.strongest[0][1]
    text = _followed(left, likely)
    z = float(np.sqrt(left.strongest[0][2]))
    if not left.bounded:
        if left.pushed and left.leaving > left.strongest[0][2]:
            channel, z = left.pushed, float(np.sqrt(left.leaving))
        where = _off(left.outside)
        what, test = _of_force(left)
        text = (
            f"the errors that the model leaves{f' on {left.elsewhere}' if left.elsewhere else ''} follow the motion, and no {what} inside the stated accuracy takes them: either "
            f"{where or 'the thrust'} is off by more than the stated accuracy, or a force that the model lacks goes with the demands; "
            f"all masses and drags may be wrong with it; {test} tells the two apart"
        )
    if not left.sensed and left.misread is not None:
        name, most, _ = left.misread
        said = WORDS[name]
        wrong = (
            f"the {said.name} would have to be {most.largest:.2g} times what the vehicle file allows for: the sensor is worse than it states, or "
            "a cause that the catalogue lacks looks like it; all masses and drags may be wrong with it"
        )
        if left.white and left.bounded:
            channel, z, text = said.channel, float(np.sqrt(most.fall)), wrong
        else:
            text += f"; {wrong}"
    if odd := [*_rough(left), *_read_wrong(left), *_repeated(left), *_struck(left)]:
        rest = [said for _, said in odd]
        if left.white and left.in_bounds:
            channel, z, text = odd[0][0], 0.0, "; ".join(rest)
        else:
            text = "; ".join([text, *rest])
    if left.hulls:
        numbers = " and ".join(
            f"{a.id} {'above' if a.estimate > a.limit else 'below'} {a.limit:.3g}" for a in left.hulls
        )
        text += (
            f"; the log asks for {numbers}, which no hull of this mass and length has: masses, thrust curves, units or signs in the vehicle "
            "file may be wrong, and the fit stops at the limit"
        )
        z = max(z, left.hulls[0].deviations)
    if passed := {**(imitated or {}), **(faint or {})}:
        clauses = "; ".join(_passed(imitated or {}, faint or {}))
        z, text = (float(np.sqrt(max(passed.values()))), clauses) if left.quiet else (z, f"{text}; {clauses}")
    if proved:
        z, text = 0.0, f"{proved}; the statistics see no structure that the model lacks"
    if near:
        one = len(near) == 1
        text += f"; the nearest {'is' if one else 'are'} {' and '.join(near)}, which the fit holds and nothing proves, so that the extended model leaves {'it' if one else 'them'} out"
    evidence: FindingEvidence = {
        "channel": channel,
        "z": z,
        "statistic": left.statistic,
        # What the other log shows is rare there: the whole dictionary on this one may be no more than chance.
        "chance": left.chance_of_one if left.shared or left.only else left.chance,
    }
    return Finding("unknown", 1.0, (), "", {}, evidence, text)
