"""Gain of a diagnosis on TEST beside the true model: (before / after) over the same ratio of the truth."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from ivsid.diagnosis.data.channels import channels
from ivsid.diagnosis.estimation.noise import declared_ambient
from ivsid.diagnosis.plant.physics import Hypothesis
from ivsid.diagnosis.prediction.innovations import Predictor
from ivsid.diagnosis.statements.comparison import compare
from ivsid.effects import Terms, terms_of
from ivsid.effects.values import sort_given
from ivsid.log import read_log
from ivsid.vehicle import Vehicle, read_vehicle


def true_model(vehicle: Vehicle, exact: dict[str, float], effects: dict[str, float]) -> Hypothesis:
    """The hypothesis that was simulated, without the errors that were declared: nobody can know those of another log."""
    terms, values, given = list(terms_of(vehicle)), dict(exact), []
    length = vehicle.hull.length
    for g in sort_given(effects, [t.name for t in vehicle.thrusters]):
        if not isinstance(g.effect.acts, Terms):
            given.append(g)
            continue
        for term, value in zip(g.effect.acts.terms, g.values, strict=True):
            if term.id not in {t.id for t in terms}:
                terms.append(replace(term, columns=term.of_hull(length)) if term.of_hull else term)
            values[term.id] = value
    return Hypothesis(tuple(terms), values, tuple(given))


def worth(folder: Path, gain: dict, truth: dict) -> dict[str, float]:
    """By u, v, r and position: how much of the true model's gain is reached; 1 is all of it."""
    vehicle = read_vehicle(folder / "vehicle.toml")
    log = channels(read_log(folder / "2.csv", vehicle.log), vehicle, None)
    h = true_model(vehicle, truth["exact"], truth["truth"])
    best = compare(Predictor(vehicle, log, declared_ambient(vehicle)), h, h)
    out = {k: best.simulation_rms[k][1] / after for k, (_, after) in gain["simulation_rms"].items()}
    if best.position_rms is not None and gain["position_rms"] is not None:
        out["position"] = best.position_rms[1] / gain["position_rms"][1]
    return out
