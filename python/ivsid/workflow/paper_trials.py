"""``ivsid demo``: the paper's experiment, end to end, on a twin of its vehicle."""

from __future__ import annotations

import hashlib
from dataclasses import replace
from importlib.resources import files
from typing import Any

import numpy as np

from ivsid import identification, simulation, validation
from ivsid.effects import terms_of
from ivsid.files.records import envelope, sealed, to_json
from ivsid.identification import Identification, Parameter
from ivsid.identification.constriction import Constriction, constrict
from ivsid.intervals import EndpointPair, IntervalArray
from ivsid.linear import linalg, regression
from ivsid.log import Log
from ivsid.programme.scenario import parse_scenario
from ivsid.propulsion import bollard
from ivsid.report.page import Report
from ivsid.report.tables import allan_record, bollard_record, validation_record
from ivsid.rows import RegressionRows, build_rows
from ivsid.sensors.allan import AllanDeviation, allan_deviation
from ivsid.sensors.bounds import BoundedLog, bound_log
from ivsid.simulation import gauss_markov
from ivsid.vehicle import AccelerationSensor, Vehicle, parse_vehicle
from ivsid.workflow.first_screens import demonstrated
from ivsid.workflow.log_files import csv
from ivsid.workflow.paper_page import Trial, drawings_of, lines_of, paper_numbers, sections_of
from ivsid.workflow.progress import Progress, silent

# Length [h] of the static recording: more than ten correlation times of the slowest bias of Table II, 670 s.
# Source: paper: Table II
STATIC_HOURS = 2.0
# Rate [Hz] of the static recording, which is that of both trials.
# Source: definition: rate of the shipped scenarios
STATIC_RATE = 20.0
# Partitions N of the published inverse.
# Source: measured: make constants
PARTITIONS = 1000


def demo(*, seed: int | None = None, progress: Progress = silent) -> Report:
    """Runs the whole experiment: sensors, thrusters, identification by every method, constriction, validation.

    Args:
        seed: added to the seeds of both trials and of the static recording.
        progress: told of each step.
    """
    vehicle = _vehicle()
    shift = 0 if seed is None else seed
    progress("simulating two trials of 300 s")
    train, test = (_trial(vehicle, name, shift) for name in ("swan_train", "swan_test"))
    progress(f"static recording of {STATIC_HOURS:g} h, Allan analysis")
    curves = _static(vehicle, 100 + shift)
    progress("thrust models of Table III")
    table_iii = bollard.examine(np.array(bollard.TABLE_III[0]), np.array(bollard.TABLE_III[1]), bollard.PUBLISHED_CUBIC)
    bounded = bound_log(train.log, vehicle)
    total = build_rows(bounded, vehicle, terms_of(vehicle))
    added = build_rows(bounded, vehicle, terms_of(vehicle, "added"), added_mass=True)
    fits = []
    for k, method in enumerate(identification.METHODS):
        progress(f"identifying {k} of {len(identification.METHODS)}: {method}")
        fits.append(_fit(total, bounded, vehicle, method, "total"))
    feasible = fits[0]
    published_added = _fit(added, bounded, vehicle, "published", "added")
    progress("constriction and validation")
    narrowed = _constrict(added, published_added)
    checks = [
        validation.validate(f, test.log, tubes=False) for f in (feasible, _constricted(published_added, narrowed))
    ]
    progress("drawing")
    drawings = drawings_of(train.log, curves, table_iii, fits, checks)
    inverses = _published_inverses(total, fits)
    record = {
        **envelope("demo", {"train.csv": train.log.sha256, "test.csv": test.log.sha256}, shift),
        "truth": train.made.truth["parameters"],
        "allan": allan_record(curves),
        "thrust": bollard_record(table_iii),
        "identifications": [
            {k: v for k, v in f.record().items() if k not in ("certificates", "vehicle")} for f in fits
        ],
        "published_inverse": inverses,
        "constriction": _constriction_record(added, narrowed),
        "validation": validation_record(checks[0]),
        "validation_constricted": validation_record(checks[1]),
        "paper": paper_numbers(),
    }
    sections = sections_of(
        vehicle, train, curves, table_iii, fits, inverses, published_added, narrowed, checks, drawings
    )
    extra: dict[str, str | bytes] = {"swan.toml": vehicle.text, "train.csv": train.text, "test.csv": test.text}
    extra["truth.json"] = to_json({"train": train.made.truth, "test": test.made.truth}) + "\n"
    extra["identify/result.json"] = to_json(sealed(feasible.record())) + "\n"
    lines = lines_of(fits, inverses, checks)
    return Report(
        "The paper, end to end: SWAN identified by interval analysis",
        lines[0],
        record,
        sections,
        drawings,
        extra,
        lines[1:],
        demonstrated(fits, checks),
    )


def _data(name: str) -> str:
    return (files("ivsid") / "data" / name).read_text()


def _vehicle() -> Vehicle:
    return parse_vehicle(_data("swan.toml"), "swan.toml")


def _trial(vehicle: Vehicle, name: str, shift: int) -> Trial:
    scenario = parse_scenario(_data(f"{name}.toml"), f"{name}.toml")
    made = simulation.simulate(vehicle, scenario, scenario.seed + shift)
    text = csv(made.t, made.columns)
    digest = hashlib.sha256(text.encode()).hexdigest()
    return Trial(made, Log(f"{name.removeprefix('swan_')}.csv", digest, made.t, made.columns), text)


def _static(vehicle: Vehicle, seed: int) -> dict[str, AllanDeviation]:
    """Allan analyses of two hours at rest with the noise of Table II (paper Figs 1-2)."""
    rng = np.random.default_rng(seed)
    n, h = round(STATIC_HOURS * 3600 * STATIC_RATE), 1 / STATIC_RATE
    sensors = vehicle.sensors
    curves = {}
    for name, sensor, axis in (
        ("ax", sensors.acceleration, 0),
        ("ay", sensors.acceleration, 1),
        ("r", sensors.yaw_rate, 0),
    ):
        if sensor is None:
            continue
        walk = sensor.walk(axis) if isinstance(sensor, AccelerationSensor) else sensor.random_walk
        bias, time = sensor.axis(axis)
        values = rng.standard_normal(n) * walk / np.sqrt(h) + gauss_markov(n, h, bias, time, rng)
        curves[name] = allan_deviation(name, values, h)
    return curves


def _fit(rows: RegressionRows, bounded: BoundedLog, vehicle: Vehicle, method: str, form: str) -> Identification:
    options = {"partitions": PARTITIONS, "form": form, "rows": "auto", "window": 1.0}
    return identification.identify_rows(rows, bounded, vehicle, method, options)


def _constrict(rows: RegressionRows, fit: Identification) -> Constriction:
    lower, upper = (np.array([getattr(fit.parameters[t.id], end) for t in rows.terms]) for end in ("lower", "upper"))
    return constrict(rows, lower, upper)


def _constricted(fit: Identification, narrowed: Constriction) -> Identification:
    """The published fit with the heuristic's box in place of its own; it guarantees nothing."""
    parameters = {
        id_: Parameter(float(low), float(high), p.unit, p.symbol)
        for (id_, p), low, high in zip(fit.parameters.items(), narrowed.lower, narrowed.upper, strict=True)
    }
    estimate = {id_: p.midpoint for id_, p in parameters.items()}
    return replace(fit, method="published, constricted", guaranteed=False, parameters=parameters, estimate=estimate)


def _published_inverses(rows: RegressionRows, fits: list[Identification]) -> dict[str, Any]:
    """The published inverses: improper entries, entries that enclose the exact hull's, and widths over the feasible set's."""
    mass_and_drag = [j for j, t in enumerate(rows.terms) if t.id != "inertia.yaw"]
    block = rows.take(np.isin(rows.channel, (0, 1)), mass_and_drag)
    gram = regression.gram(block.matrix)
    exact = linalg.inverse_one(gram, "exact")
    results = {m: linalg.inverse_one(gram, m, PARTITIONS) for m in ("published", "published-hull")}
    found: dict[str, Any] = {"partitions": PARTITIONS, "entries": gram.size, "exact_status": exact.status}
    for method, result in results.items():
        value = result.value
        if not isinstance(value, EndpointPair):
            continue
        found[method] = {"improper": int(value.improper.sum()), "lower": value.lower, "upper": value.upper}
        if isinstance(exact.value, IntervalArray):
            encloses = (value.lower <= exact.value.lower) & (exact.value.upper <= value.upper)
            found[method]["enclosed_entries"] = int(encloses.sum())
    if isinstance(exact.value, IntervalArray):
        found["exact"] = {"lower": exact.value.lower, "upper": exact.value.upper}
    feasible = fits[0].parameters
    found["width_over_feasible"] = {
        f.method: {i: f.parameters[i].width / feasible[i].width for i in feasible if i in f.parameters}
        for f in fits[1:]
        if feasible and f.parameters
    }
    return found


def _constriction_record(rows: RegressionRows, c: Constriction) -> dict[str, object]:
    boxes = {
        t.id: {"lower": low, "upper": high, "unit": t.unit}
        for t, low, high in zip(rows.terms, c.lower, c.upper, strict=True)
    }
    return {"guaranteed": False, "parameters": boxes, "coverage": c.coverage, "error": c.error, "steps": c.steps}
