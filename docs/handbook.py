"""Writes docs/effects_handbook.md and a figure of each effect's signature: python docs/handbook.py [FOLDER].

Each figure is made by the simulator: the standard boat sails a standard programme with the effect at its typical size and without any noise, and the
plain model is fitted to the readings of its sensors. Of the diagnosis it uses only the ordering of a force along a quantity.
"""

from __future__ import annotations

import io
import re
import sys
import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from handbook_signatures import CLAIM, RATE, TRUTH, Signature, signature, values_of
from matplotlib.backends.backend_svg import FigureCanvasSVG
from matplotlib.figure import Figure
from numpy.typing import NDArray

from ivsid.diagnosis.statements.binning import binned
from ivsid.effects import (
    CHANNELS,
    EFFECTS,
    Change,
    Current,
    Drive,
    Effect,
    Force,
    Place,
    Reading,
    Response,
    State,
    Terms,
    Thrust,
)

Array = NDArray[np.float64]
HERE = Path(__file__).parent
POINTS = 120
BLUE, GREY, RED = "#0072B2", "#9a9a9a", "#D55E00"
FAMILIES = {
    "Masses and coupling": ("mass", "inertia", "coupling", "added_mass", "payload"),
    "Drag, lift, friction": ("drag", "friction"),
    "Environment": ("current", "wind", "wave", "environment", "tether", "fouling"),
    "Thrusters": ("thruster",),
    "Sensors": ("sensor",),
}


def main(folder: Path = HERE) -> None:
    """Writes the page and the figures."""
    (folder / "effects").mkdir(parents=True, exist_ok=True)
    shares = {}
    for effect in EFFECTS.values():
        made = signature(effect)
        shares[effect.id] = made
        (folder / "effects" / f"{effect.id}.svg").write_text(drawn(made), encoding="utf-8")
    (folder / "effects_handbook.md").write_text(page(shares), encoding="utf-8")


def drawn(s: Signature) -> str:
    """The figure as SVG with text as text, one digit behind the point."""
    with mpl.rc_context(
        {
            "svg.hashsalt": "ivsid",
            "svg.fonttype": "none",
            "font.size": 8,
            "font.sans-serif": ["DejaVu Sans"],
            "axes.linewidth": 0.6,
        }
    ):
        figure = Figure(figsize=(7.0, 2.1), layout="constrained")
        left, right = figure.subplots(1, 2, width_ratios=(2, 1))
        thin = slice(None, None, max(1, s.time.size // POINTS))
        size = max(float(np.abs(s.whole).max()), 1e-12)
        digits = 3 - int(np.floor(np.log10(size)))
        if s.share is not None:
            left.plot(s.time[thin], np.round(s.whole, digits)[thin], color=GREY, lw=1.0)
        left.plot(s.time[thin], np.round(s.left, digits)[thin], color=BLUE, lw=1.2)
        m = binned(np.round(s.left, digits), np.round(s.values, 6), 1 / RATE)
        right.plot(np.round(m.centre, 4), np.round(m.mean, digits), "o-", ms=2.5, lw=0.8, color=BLUE)
        for axes in (left, right):
            axes.axhline(0.0, color="0.8", lw=0.6, zorder=0)
            axes.margins(x=0.02)
        # Nothing is left: the scale stays that of the whole.
        right.set_ylim(
            *(1.05 * size * np.array([-1, 1]) if float(np.abs(m.mean).max()) < 0.02 * size else right.get_ylim())
        )
        left.set_xlabel("time [s]")
        left.set_ylabel(f"{s.channel} [{s.unit}]")
        right.set_xlabel(s.quantity)
        buffer = io.StringIO()
        FigureCanvasSVG(figure)
        figure.savefig(buffer, format="svg", metadata={"Date": None, "Creator": None})
    text = re.sub(r"-?\d+\.\d{2,}", lambda q: f"{float(q[0]):.1f}".rstrip("0").rstrip("."), buffer.getvalue())
    text = re.sub(r"\s*<metadata>.*?</metadata>|\s*<!DOCTYPE.*?>", "", text, flags=re.DOTALL)
    return re.sub(r"\n\s*", "\n", text)


def traits(effect: Effect) -> list[str]:
    """Dependences of the physics, asked of the code: the sign of the motion, heading, place, clock, memory."""
    acts, said = effect.acts, []
    numbers = tuple(p.typical or 1.0 for p in effect.parameters)

    def force(sign: float = 1.0, **place: float) -> tuple[float, ...]:
        where = Place(**{"psi": 0.3, "x": 1.0, "y": -2.0, "t": 7.0, **place})
        state = State(*(sign * q for q in (0.7, -0.2, 0.3)), 0.0, 0.0, 0.0, place=where)
        if isinstance(acts, Force):
            made: Any = acts.function(state, numbers)
        elif isinstance(acts, Terms):
            made = {}
            for term in acts.terms:
                columns = (term.of_hull(1.2) if term.of_hull else term.columns)(state)
                made |= {c: x + made.get(c, 0.0) for c, x in columns.items()}
        else:
            return ()
        return tuple(round(float(made.get(c, 0.0)), 12) for c in CHANNELS)

    if isinstance(acts, (Terms, Force)):
        said += forced(force)
    if isinstance(acts, Current):
        said += ["depends on the heading"] + ["depends on the clock"] * (
            acts.function(numbers, 3.0) != acts.function(numbers, 8.0)
        )
    if isinstance(acts, Change):
        early, late = (acts.function(TRUTH, values_tuple(effect), t) for t in (3.0, 140.0))
        said += ["changes parameters"] + ["depends on the clock"] * (early != late)
    if isinstance(acts, Thrust):
        at = [acts.function(10.0, Drive(50.0, t, 0, -0.28, 40.0), values_tuple(effect)) for t in (3.0, 140.0)]
        said += ["follows the thrust"] + ["depends on the clock"] * bool(at[0] != at[1])
    if isinstance(acts, Response) or effect.id == "sensor.velocity.delay":
        said.append("has memory")
    if isinstance(acts, Reading):
        said.append(f"in the readings of {acts.sensor.replace('_', ' ')}")
    return said or ["follows the thrust and the speed of the water"]


def forced(force: Callable[..., tuple[float, ...]]) -> list[str]:
    """Symmetry of a force under a reversed motion, and its other dependences."""
    ahead, back = force(), force(-1.0)
    if not any(ahead) and not any(back):
        said = ["nothing without acceleration"]
    elif force(psi=1.3) != ahead:
        said = ["depends on the heading"]
    elif all(abs(a + b) < 1e-9 for a, b in zip(ahead, back, strict=True)):
        said = ["odd: reversed with the motion"]
    elif all(abs(a - b) < 1e-9 for a, b in zip(ahead, back, strict=True)):
        said = ["even: the same when the motion is reversed"]
    else:
        said = ["of one direction only"]
    said += ["depends on the place"] * (force(x=3.0, y=4.0) != ahead)
    return said + ["depends on the clock"] * (force(t=8.1) != ahead)


def values_tuple(effect: Effect) -> tuple[float, ...]:
    """Typical numbers in order."""
    return tuple(values_of(effect).values())


def page(made: dict[str, Signature]) -> str:
    """The handbook."""
    words = tomllib.loads((HERE / "handbook_words.toml").read_text(encoding="utf-8"))
    out = [
        "# Handbook of effects",
        "",
        "Made by `make handbook` from the catalogue, `docs/handbook_words.toml` and the simulator; edit those, not this page.",
        "",
        "Each figure is of a boat of 50 kg with two thrusters. It sails one programme (speed steps, zigzag, coast, astern, two circles, a turn on the spot, PRBS) with the effect at its "
        "typical size and no noise. The left panel is in time, below 0.35 Hz: grey is the force that the true plain model lacks, blue the remainder after the model's own five parameters "
        "are fitted anew. A diagnosis sees the remainder alone. The right panel is the remainder along the quantity that orders it best. Terms of the plain model are shown as a claim "
        f"that is {100 * CLAIM:.0f} % short. For sensors the kinematic residual is shown: K1 = ax - udot + v r, K2 = ay - vdot - u r, K3 = r - psidot. No force acts in it.",
        "",
        "An *odd* force changes its sign when all velocities do; an *even* force stays the same.",
        "",
    ]
    for family, heads in FAMILIES.items():
        out += [f"## {family}", ""]
        for effect in EFFECTS.values():
            if effect.id.split(".")[0] in heads:
                out += entry(effect, words[effect.id], made[effect.id])
    return "\n".join(out).rstrip() + "\n"


def entry(effect: Effect, words: dict[str, str], made: Signature) -> list[str]:
    """One effect."""
    forms = [effect] + ([effect.measured] if effect.measured is not None else [])
    numbers = "; ".join(
        ", ".join(
            f"`{name}`" + (f" ({p.symbol})" if p.symbol else "") + f" [{p.unit}] {p.typical:g}"
            for name, p in zip(form.parts, form.parameters, strict=True)
        )
        for form in forms
    )
    alike = list(dict.fromkeys((*effect.equivalents, *effect.confusable)))
    never = f" (the same thing in most logs: {', '.join(effect.equivalents)})" if effect.equivalents else ""
    rows = [
        ("Equation", f"`{words['equation']}`"),
        ("Numbers, typical", numbers + ("; also for one thruster, as `id.NAME`" if effect.per_thruster else "")),
        ("Symmetry", ", ".join(traits(effect))),
        ("Shows", words["shows"]),
        ("Left by the fit", left_by(made)),
        ("Excited by", words["excite"]),
        ("Needs", ", ".join(n.replace("|", " or ") for n in effect.needs) or "velocities and demands"),
        ("Confused with", (", ".join(alike) or "nothing in particular") + never),
        ("Separated by", effect.separate or "–"),
    ]
    cause = effect.cause[0].upper() + effect.cause[1:]
    cells = [f"| {k} | {v.replace('|', chr(92) + '|')} |" for k, v in rows]
    figure = f"![Signature of {effect.id}](effects/{effect.id}.svg)"
    return [f"### {effect.id}", "", f"{cause}.", "", "| | |", "|---|---|", *cells, "", figure, ""]


def left_by(made: Signature) -> str:
    """How much of it the plain model's own parameters take."""
    if made.share is None:
        return "all: no parameter of the model stands in a kinematic residual"
    share = 100 * made.share
    return (
        "nothing: the fit takes it all"
        if share < 0.1
        else f"{share:.{0 if share >= 10 else 1}f} % of its energy, most in {made.channel}"
    )


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else HERE)
