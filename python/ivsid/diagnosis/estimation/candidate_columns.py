"""The candidates of a log with their columns: every effect that the log can show, each by its kind."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

from ivsid.diagnosis.estimation.columns import Columns
from ivsid.diagnosis.estimation.kinds.candidate import Candidate
from ivsid.diagnosis.estimation.kinds.claim import ClaimCandidate
from ivsid.diagnosis.estimation.kinds.grid import GridCandidate
from ivsid.diagnosis.estimation.kinds.harmonic import HarmonicCandidate
from ivsid.diagnosis.estimation.kinds.hump import HumpCandidate
from ivsid.diagnosis.estimation.kinds.linear import LinearCandidate
from ivsid.diagnosis.estimation.kinds.step import StepCandidate
from ivsid.diagnosis.estimation.kinds.tether import TetherCandidate
from ivsid.diagnosis.estimation.signatures import Signatures
from ivsid.effects import EFFECTS, Anchored, Effect, Form, Grid, Harmonic, Hump, Linear, Step, lacking

# The kind of candidate by the form of an effect.
KINDS: Final[Mapping[type[Form], type[Candidate]]] = {
    Linear: LinearCandidate,
    Grid: GridCandidate,
    Step: StepCandidate,
    Harmonic: HarmonicCandidate,
    Anchored: TetherCandidate,
    Hump: HumpCandidate,
}


def candidate_columns(
    s: Signatures, only: frozenset[str] | None = None
) -> tuple[Columns, list[Candidate], dict[str, str]]:
    """Signatures of the effects that a log can show, their candidates, and the reason why each other effect is left out, by id.

    Args:
        s: signatures at a hypothesis; its own effects are no candidates.
        only: ids of effects that are looked at; all by default.
    """
    out = Columns()
    refused: dict[str, str] = {}
    terms = {t.id for t in s.h.terms}
    present = {g.effect.id for g in s.h.given} | terms
    present |= {e.id for e in EFFECTS.values() if e.terms and present.issuperset(e.parts)}
    candidates = ClaimCandidate.all(s, out)
    for effect in EFFECTS.values():
        # The paper's columns share one parameter among two terms of the plain model, so that one of them is lacking.
        if (only is not None and effect.id not in only) or (
            effect.id in present and not (effect.plain and effect.id not in terms)
        ):
            continue
        form = effect
        if effect.measured is not None and all(s.predictor.log.has(n) for n in effect.measured.needs):
            form = effect.measured
        missing = [n for n in form.needs if not s.predictor.log.has(n)]
        reason = _impossible(s, form, terms)
        if missing:
            refused[effect.id] = "no " + " and no ".join(n.replace("|", " or ") for n in missing)
        elif reason is not None:
            refused[effect.id] = reason
        else:
            candidates += KINDS[type(form.form)].made(s, form, out)
    return out, candidates, refused


def _impossible(s: Signatures, effect: Effect, terms: set[str]) -> str | None:
    """The reason why a log cannot show an effect, or None."""
    vehicle = s.predictor.vehicle
    if effect.plain and (effect.needed or effect.id in terms):
        return "a term of every model"
    if effect.hidden:
        return effect.hidden
    if effect.one_factor and not set(vehicle.model.values) - s.h.freed and not any(vehicle.hull.centre_of_gravity):
        # A stated centre of gravity off the origin is a claim, too: its moments do not scale.
        return "it scales every mass and drag alike, and none is claimed"
    return lacking(effect, vehicle, [c.largest for c in s.predictor.propulsion.curves])
