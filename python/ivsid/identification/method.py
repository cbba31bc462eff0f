"""Parameter intervals by the name of a method, with their status, assumptions and certificates."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any, Final

import numpy as np

from ivsid.effects import CHANNELS, terms_of
from ivsid.errors import IvsidError, choice, meant
from ivsid.identification.assumptions import assumptions, cause_notes, left_out
from ivsid.identification.bias import CHOICES, separate_bias, with_unknowns, without_unknowns
from ivsid.identification.blocks import linked, nonzero, outlier_notes, overall, parameters_of, solve
from ivsid.identification.combinations import determined
from ivsid.identification.physics import INFLATION, contradicted, of_no_vessel, subject_of, with_bounds
from ivsid.identification.result import ClaimCheck, Identification, Parameter
from ivsid.linear import regression
from ivsid.linear.linalg import INVERSE_METHODS, partition_count
from ivsid.log import GivenLog, log_of
from ivsid.memory.pieces import pieces
from ivsid.rows import ROW_KINDS, WINDOW, RegressionRows, build_rows, window_count
from ivsid.sensors.bounds import BoundedLog, bound_log
from ivsid.setup import examined
from ivsid.vehicle import GivenVehicle, Vehicle, vehicle_of

METHODS: Final = ("feasible", *regression.LEAST_SQUARES_METHODS, *INVERSE_METHODS)


def identify(
    vehicle: GivenVehicle,
    log: GivenLog,
    method: str = "feasible",
    *,
    partitions: int | None = None,
    form: str = "total",
    rows: str = "auto",
    window: float | Sequence[float] = WINDOW,
    bias: str = "auto",
    outliers: int = 0,
    physical: bool = False,
    progress: Callable[[str], None] = lambda _: None,
    examine: bool = True,
) -> Identification:
    """Parameter intervals of the vehicle file's model from a log.

    Args:
        vehicle: a checked vehicle, the path of its file, or the name of a shipped one.
        log: a checked log, its path, or a table in memory (a data frame of Polars or pandas, or arrays by name), which the file's section
            ``[log]`` maps.
        method: ``feasible`` encloses all parameters that are consistent with every row (docs/theory.md, "The feasible set"). ``qr`` and
            ``augmented`` enclose all least-squares solutions (docs/theory.md, "Least squares"). The others are interval least squares
            (paper, eq. 14) by an inverse: ``exact``, ``partitioned``, ``hansen-bliek-rohn``, ``krawczyk``, ``cramer``, ``kuttler``,
            ``neumaier``, ``published`` or ``published-hull``.
        partitions: N of the published methods, or the number of cells of ``partitioned``.
        form: ``total`` mass, or ``added`` mass with the rigid-body mass known (paper, eq. 6, second form).
        rows: ``auto``, ``pointwise``, ``integral``, ``weak`` or ``both``.
        window: length of integral rows [s], or several, whose rows hold together.
        bias: of the accelerometer, for ``feasible``. ``sample`` bounds it at every sample, ``log`` takes it as one unknown of the log,
            ``auto`` takes ``log`` where that is clearly tighter.
        outliers: number of rows that may be wrong in each set of parameters that share rows, for ``feasible``. The intervals hold
            every parameter that all but that many rows allow.
        physical: whether the bounds that every vessel keeps are rows, too, for ``feasible`` (docs/theory.md, "Physical bounds"). They are
            assumptions, and stand in ``assumes``.
        progress: told of each step.
        examine: whether the set-up is examined first; a caller that has done so says no.

    Returns:
        The intervals; ``setup`` holds what is doubtful about the set-up.

    Raises:
        IvsidError: unusable input, or a wrong set-up that is beyond doubt, in one sentence.
    """
    if bias not in CHOICES:
        raise IvsidError(f"bias '{bias}' is unknown; {meant(bias, CHOICES)}use {', '.join(CHOICES)}")
    if method not in METHODS:
        raise IvsidError(f"method '{method}' is not available; {choice(method, METHODS)}")
    if outliers < 0 or (outliers and method != "feasible"):
        raise IvsidError(
            f"outliers = {outliers} with method {method} is not possible; give a number of rows, at least 0, with method feasible"
        )
    if physical and (outliers or method != "feasible"):
        raise IvsidError(
            f"physical bounds with method {method} and outliers = {outliers} are not possible: they are no measurements that could be wrong, and "
            "only method feasible takes inequalities; use feasible without outliers"
        )
    vehicle = vehicle_of(vehicle)
    log = log_of(log, vehicle.log)
    doubts = examined(vehicle, [log], progress) if examine else ()
    progress(f"identifying by {method} on {log.t.size} samples")
    terms = terms_of(vehicle, form)
    bounded = bound_log(log, vehicle, window_count(window))
    # A row that bounds a bias is no measurement, so it cannot be wrong: with outliers the bias is bounded at every sample.
    taken = separate_bias(bounded, vehicle, bias) if method == "feasible" and not outliers else None
    bounded = bounded if taken is None else taken[0]
    made = build_rows(bounded, vehicle, terms, added_mass=form == "added", kind=rows, window=window)
    options = {
        "partitions": partition_count(partitions, method),
        "form": form,
        "rows": rows,
        "window": window if isinstance(window, float | int) else list(window),
        "bias": "sample" if taken is None else "log",
        "outliers": outliers,
        "physical": physical,
    }
    subject = subject_of(bounded, vehicle, terms, form)
    if taken is not None:
        mass = vehicle.hull.mass if form == "added" else 0.0
        made = with_unknowns(made, taken[1], bounded.log, vehicle, mass)
    if physical:
        made = with_bounds(made, subject)
    fit = identify_rows(made, bounded, vehicle, method, options)
    fit = fit if taken is None else without_unknowns(fit, terms)
    strange = of_no_vessel(subject, fit.estimate) if fit.status == "empty" else ()
    return replace(
        fit,
        physical=tuple(f.record() for f in contradicted(subject, fit.parameters)),
        notes=(*fit.notes, *strange, *((INFLATION,) if physical else ())),
        setup=doubts,
    )


def identify_rows(
    rows: RegressionRows, bounded: BoundedLog, vehicle: Vehicle, method: str, options: dict[str, Any]
) -> Identification:
    """Parameter intervals from rows, which several methods can share.

    Args:
        rows: of the vehicle's model.
        bounded: the log in intervals, from which the rows were made.
        vehicle: the checked vehicle file.
        method: as for ``identify``.
        options: to repeat the run; ``partitions`` and ``outliers`` are used.

    Raises:
        IvsidError: an unknown method.
    """
    if method not in METHODS:
        raise IvsidError(f"method '{method}' is not available; {choice(method, METHODS)}")
    allowed = options.get("outliers", 0)
    used = nonzero(rows)
    blocks = [solve(rows, used, columns, method, options["partitions"], allowed) for columns in linked(used)]
    parameters, estimate = parameters_of(rows.terms, blocks)
    status = overall([b.status for b in blocks])
    proved = status in ("enclosed", "empty", "unbounded")
    inflations = [b.inflation for b in blocks]
    directions = tuple(
        {rows.terms[c].id: float(x) for c, x in zip(b.columns, d, strict=True) if x}
        for b in blocks
        for d in b.directions
    )
    combinations = tuple(
        {rows.terms[c].id: float(x) for c, x in zip(b.columns, combination, strict=True) if x}
        for b in blocks
        if b.directions and b.status == "unbounded"
        for combination in determined(len(b.columns), b.directions)
    )
    reasons = [b.reason for b in blocks if b.reason]
    absent = left_out(vehicle, bounded)
    assumed = [k for k, kind in enumerate(ROW_KINDS) if kind.startswith("physical.")]
    return Identification(
        method=method,
        status=status,
        guaranteed=proved and bounded.rule.guaranteed and not bounded.statistical and not absent,
        assumes=assumptions(rows, bounded, vehicle, allowed),
        parameters=parameters if status != "empty" else {},
        estimate=estimate,
        inflation=None if not inflations or None in inflations else max(i for i in inflations if i is not None),
        improper=sum(b.improper for b in blocks),
        reason="; ".join(dict.fromkeys(reasons)) or None,
        directions=directions,
        certificates=tuple({**c, "block": k} for k, b in enumerate(blocks) for c in b.certificates),
        contradictions=tuple(k for k, b in enumerate(blocks) if b.status == "empty"),
        rows=_counted(rows, assumed),
        notes=(*bounded.log.notes, *outlier_notes(rows.terms, blocks), *cause_notes(absent)),
        ignored=bounded.log.ignored,
        options=options,
        vehicle=vehicle,
        log_name=bounded.log.name,
        log_sha256=bounded.log.sha256,
        determined=combinations,
        claims=checked_claims(vehicle, parameters if status != "empty" else {}),
        outliers=tuple({**b.outliers, "block": k} for k, b in enumerate(blocks) if b.outliers is not None),
    )


def _counted(rows: RegressionRows, assumed: Sequence[int]) -> dict[str, int]:
    """The number of measured rows of each channel."""
    found = [
        np.bincount(rows.channel[p][~np.isin(rows.kind[p], assumed)], minlength=len(CHANNELS))
        for p in pieces(rows.kind.size)
    ]
    return {name: int(sum(f[k] for f in found)) for k, name in enumerate(CHANNELS)}


def checked_claims(vehicle: Vehicle, parameters: Mapping[str, Parameter]) -> tuple[ClaimCheck, ...]:
    """The numbers that ``[model] values`` claims against the intervals: a number outside its interval is contradicted."""
    return tuple(
        {
            "parameter": id_,
            "value": value,
            "contradicted": not parameters[id_].lower <= value <= parameters[id_].upper,
        }
        for id_, value in vehicle.model.values.items()
        if id_ in parameters
    )
