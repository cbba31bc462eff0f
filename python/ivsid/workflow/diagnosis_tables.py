"""Tables of a diagnosis: gain, candidates, claims, and what the log could not show."""

from __future__ import annotations

from typing import Final

from ivsid import diagnosis
from ivsid.diagnosis import Claim, Diagnosis
from ivsid.diagnosis.statements.prose import TINY
from ivsid.intervals import shown
from ivsid.report import page
from ivsid.report.page import Part

# Digits of the numbers on the page; result.json has all of them.
# Source: definition: no interval is read off more finely
DIGITS: Final = 4


def gain_table(result: Diagnosis) -> Part:
    """Errors of the simulation on the other log, before and after."""
    rows = [
        [f"{what} [{unit}]", before, after, *(interval or (None, None)), said]
        for what, unit, before, after, interval, said in diagnosis.worth(result.gain)
    ]
    header = ["on the other log", "before", "after", "before/after from", "to", "so it is"]
    caption = "Medians over windows, rms for forces; 95 % intervals of before/after by drawing windows anew. A loss is a loss."
    return page.table(header, rows, caption)


def candidates_table(result: Diagnosis) -> Part:
    """Causes that came near and are no findings, each with the reason."""
    rows = [
        [
            r.effect,
            r.fall,
            r.numbers,
            f"below {TINY:g}" if r.chance < TINY else r.chance,
            None if r.full is None else f"{r.full[0]:.0f} of {r.full[1]:.0f}",
            r.beside,
            r.reason,
        ]
        for r in result.rejected[:20]
    ]
    header = [
        "cause",
        "fall of chi² alone",
        "numbers",
        "chance without it",
        "in a finding's place",
        "left beside the findings",
        "why it is none",
    ]
    return page.table(header, rows, "The twenty that came nearest; result.json has them all.")


def claims_table(result: Diagnosis) -> Part:
    """Numbers of the vehicle file against the log."""
    rows = [
        [
            c.parameter,
            f"{c.value:g} {c.unit}",
            c.z,
            *("–" if b is None else shown(b.lower, b.upper, DIGITS) for b in (c.beside, c.alone)),
            _said(c),
        ]
        for c in result.claims
    ]
    header = ["number", "claimed", "away [σ]", "the log, other claims held", "the log alone", "so it is"]
    caption = "Statistical intervals; they hold what a cause that was not found may hide. A claim is a finding only where nothing else could move it."
    return page.table(header, rows, caption)


def _said(claim: Claim) -> str:
    if claim.beside is None:
        return claim.reason
    if claim.contradicted:
        return "contradicted: a finding"
    if claim.beside.lower <= claim.value <= claim.beside.upper:
        return "not contradicted"
    return "outside of the interval, and no finding: too little of the rest is explained, or too little of it is there"


def untested_table(result: Diagnosis) -> Part:
    """Causes that the log could not show, with the reason and the remedy."""
    return page.table(
        ["effect", "why not", "needs"], [[q["effect"], q["reason"], q["needs"] or None] for q in result.not_tested]
    )


def allowed_table(result: Diagnosis) -> Part:
    """Intervals of causes that are no findings."""
    least = {k: v for q in result.visible.values() if q.tested for k, v in q.detectable.items()}
    rows = [
        [
            name,
            f"{shown(b.lower, b.upper, DIGITS)} {b.unit}",
            f"{abs(least[name]):.3g}" if name in least else "not tested",
        ]
        for name, b in result.allowed.items()
    ]
    caption = "Causes that are no findings, each alone beside the extended model: statistical intervals of what may be there all the same."
    return page.table(["number", "the log allows", "would have shown from"], rows, caption)
