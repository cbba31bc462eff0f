"""What a diagnosis is worth on TEST beside the true model: (before / after) over the same ratio of the truth."""

from __future__ import annotations

from dataclasses import replace

from ivsid.diagnosis.bench import Bench
from ivsid.diagnosis.channels import channels
from ivsid.diagnosis.gain import compare
from ivsid.diagnosis.physics import Hypothesis
from ivsid.effects import Terms, terms_of
from ivsid.effects.given import Given, sort_given
from ivsid.log import Log


def true_model(case, like: Hypothesis) -> Hypothesis:
    """The hypothesis that was simulated, under the same declared errors."""
    names = [t.name for t in case.vehicle.thrusters]
    terms, values, given = list(terms_of(case.vehicle)), dict(case.exact), []
    length = case.vehicle.hull.length
    for g in sort_given(case.truth, names):
        if isinstance(g.effect.acts, Terms):
            for term, value in zip(g.effect.acts.terms, g.values, strict=True):
                fitting = replace(term, columns=term.of_hull(length)) if term.of_hull else term
                if term.id not in {t.id for t in terms}:
                    terms.append(fitting)
                values[term.id] = value
        else:
            given.append(Given(g.effect, g.values, g.thruster))
    return Hypothesis(tuple(terms), values, tuple(given), like.declared)


def worth(case, diagnosis) -> dict[str, float]:
    """By u, v, r and position: how much of the true model's gain is reached; 1 is all of it."""
    last = diagnosis.selection.last
    log = channels(Log("2.csv", "0" * 64, case.test.t, case.test.columns), case.vehicle, None)
    bench = Bench(case.vehicle, log, last.noise.bench.ambient)
    both = compare(bench, true_model(case, last.h), last.h)
    out = {k: t / f for k, (t, f) in both.simulation_rms.items()}
    if both.position_rms is not None:
        out["position"] = both.position_rms[0] / both.position_rms[1]
    return out
