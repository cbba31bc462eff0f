"""Method by name -> parameter intervals with their status, what they assume, and their certificates."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from ivsid import regression
from ivsid.effects import CHANNELS, Term, terms_of
from ivsid.errors import IvsidError
from ivsid.identification.bias import CHOICES, apart, with_unknowns, without_unknowns
from ivsid.identification.fit import Identification, Parameter
from ivsid.identification.freedom import determined
from ivsid.intervals import FloatArray
from ivsid.linalg import INVERSE_METHODS, partition_count
from ivsid.log import Log
from ivsid.pieces import over_pieces, pieces
from ivsid.rows import ROW_KINDS, WINDOW, RegressionRows, build_rows
from ivsid.sensors import BoundedLog, bound_log
from ivsid.vehicle import Vehicle

METHODS: Final = ("feasible", *regression.LEAST_SQUARES_METHODS, *INVERSE_METHODS)


@dataclass(frozen=True)
class _Block:
    """Parameters that share rows, and what a method said of them."""

    columns: tuple[int, ...]
    status: str
    lower: FloatArray | None
    upper: FloatArray | None
    centre: FloatArray | None
    inflation: float | None
    improper: int
    reason: str | None
    directions: tuple[FloatArray, ...]
    certificates: tuple[dict[str, Any], ...]
    outliers: dict[str, Any] | None = None


def identify(
    vehicle: Vehicle,
    log: Log,
    method: str = "feasible",
    *,
    partitions: int | None = None,
    form: str = "total",
    rows: str = "auto",
    window: float | Sequence[float] = WINDOW,
    bias: str = "auto",
    outliers: int = 0,
) -> Identification:
    """Parameter intervals of the vehicle file's model from a log.

    Args:
        vehicle: the checked vehicle file.
        log: the checked log.
        method: ``feasible`` (all parameters that are consistent with every row; guaranteed), the set of all least-squares
            solutions by ``qr`` or ``augmented`` (METHODS 4.4), or interval least squares
            (eq. 14) with the inverse ``exact``, ``partitioned``, ``hansen-bliek-rohn``,
            ``krawczyk``, ``cramer``, ``kuttler``, ``neumaier``, ``published`` or ``published-hull``.
        partitions: N of the published methods, or the cells of ``partitioned``.
        form: ``total`` mass, or ``added`` mass with the rigid-body mass known (eq. 6, second form).
        rows: ``auto``, ``pointwise``, ``integral`` or ``both``.
        window: length of integral rows [s], or several: their rows are intersected.
        bias: of the accelerometer: ``sample`` bounds it anew at every sample, ``log`` takes it as one unknown (method ``feasible``),
            ``auto`` does so where that is clearly tighter.
        outliers: how many rows of each set of parameters that share rows may be wrong (method ``feasible``): the intervals hold every
            parameter that all but so many rows allow (METHODS 5.3).

    Raises:
        IvsidError: unusable input, in one sentence.
    """
    if bias not in CHOICES:
        raise IvsidError(f"bias '{bias}' is unknown; use {', '.join(CHOICES)}")
    if method not in METHODS:
        raise IvsidError(f"method '{method}' is not available; choose one of {', '.join(METHODS)}")
    if outliers < 0 or (outliers and method != "feasible"):
        raise IvsidError(
            f"outliers = {outliers} with method {method} is not possible; give a number of rows, at least 0, with method feasible"
        )
    terms = terms_of(vehicle, form)
    bounded = bound_log(log, vehicle, 1 if isinstance(window, float | int) else max(len(window), 1))
    # A row that bounds a bias is no measurement that could be wrong.
    taken = apart(bounded, vehicle, bias) if method == "feasible" and not outliers else None
    bounded = bounded if taken is None else taken[0]
    made = build_rows(bounded, vehicle, terms, added_mass=form == "added", kind=rows, window=window)
    options = {
        "partitions": partition_count(partitions, method),
        "form": form,
        "rows": rows,
        "window": window if isinstance(window, float | int) else list(window),
        "bias": "sample" if taken is None else "log",
        "outliers": outliers,
    }
    if taken is None:
        return identify_rows(made, bounded, vehicle, method, options)
    mass = vehicle.hull.mass if form == "added" else 0.0
    extended = with_unknowns(made, taken[1], bounded.log, vehicle, mass)
    return without_unknowns(identify_rows(extended, bounded, vehicle, method, options), terms)


def identify_rows(
    rows: RegressionRows, bounded: BoundedLog, vehicle: Vehicle, method: str, options: dict[str, Any]
) -> Identification:
    """The same from rows that stand already, so that several methods can share them."""
    if method not in METHODS:
        raise IvsidError(f"method '{method}' is not available; choose one of {', '.join(METHODS)}")
    allowed = options.get("outliers", 0)
    used = _used(rows)
    blocks = [_solve(rows, used, columns, method, options["partitions"], allowed) for columns in _blocks(used)]
    parameters, estimate = _gather(rows.terms, blocks)
    status = _overall([b.status for b in blocks])
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
    return Identification(
        method=method,
        status=status,
        guaranteed=proved and bounded.rule.guaranteed and not bounded.statistical,
        assumes=_assumptions(rows, bounded, vehicle, allowed),
        parameters=parameters if status != "empty" else {},
        estimate=estimate,
        inflation=None if not inflations or None in inflations else max(i for i in inflations if i is not None),
        improper=sum(b.improper for b in blocks),
        reason="; ".join(dict.fromkeys(reasons)) or None,
        directions=directions,
        certificates=tuple({**c, "block": k} for k, b in enumerate(blocks) for c in b.certificates),
        contradictions=tuple(k for k, b in enumerate(blocks) if b.status == "empty"),
        rows={name: int((rows.channel == k).sum()) for k, name in enumerate(CHANNELS)},
        notes=(*bounded.log.notes, *outlier_notes(rows.terms, blocks)),
        ignored=bounded.log.ignored,
        options=options,
        vehicle=vehicle,
        log_name=bounded.log.name,
        log_sha256=bounded.log.sha256,
        determined=combinations,
        claims=_claims(vehicle, parameters if status != "empty" else {}),
        outliers=tuple({**b.outliers, "block": k} for k, b in enumerate(blocks) if b.outliers is not None),
    )


def _claims(vehicle: Vehicle, parameters: dict[str, Parameter]) -> tuple[dict[str, Any], ...]:
    """What ``model.values`` claims, beside what the data say: contradicted where it lies outside of the interval."""
    return tuple(
        {
            "parameter": id_,
            "value": value,
            "contradicted": not parameters[id_].lower <= value <= parameters[id_].upper,
        }
        for id_, value in vehicle.model.values.items()
        if id_ in parameters
    )


def outlier_notes(terms: Sequence[Term], blocks: Sequence[_Block]) -> list[str]:
    """What is wrong in each block, in words."""
    notes = []
    for b in blocks:
        if b.outliers is None or not b.outliers["fewest"]:
            continue
        few, sets = b.outliers["fewest"], b.outliers["sets"]
        rows = " and ".join(f"the {r['channel']} row at t = {r['time']:.6g} s" for r in sets[0])
        others = f", or {len(sets) - 1} other choices" if len(sets) > 1 else ""
        notes.append(
            f"at least {few} row{'s' * (few > 1)} of {', '.join(terms[c].id for c in b.columns)} must be wrong; without {rows}{others}, no "
            "contradiction was found"
        )
    return notes


def _assumptions(rows: RegressionRows, bounded: BoundedLog, vehicle: Vehicle, allowed: int = 0) -> tuple[str, ...]:
    lines = [bounded.rule.sentence, _force_accuracy(vehicle)]
    if allowed:
        lines.append(f"all but {allowed} rows of each set of parameters that share rows hold")
    if bounded.ambient != (0.0, 0.0):
        force, moment = bounded.ambient
        lines.append(f"ambient force within {force:.3g} N and moment within {moment:.3g} N m")
    for thruster in vehicle.thrusters:
        if thruster.outside == "hold":
            lines.append(f"beyond its table the thrust of {thruster.name} keeps the end values")
    if vehicle.thrusters:
        hold = "held from its row to the next" if vehicle.log.demand == "hold" else "linear from its row to the next"
        lines.append(f"each demand is {hold}")
    else:
        lines.append("between two rows each logged force lies between their values")
    return (*lines, *bounded.statistical, *bounded.log.assumes, *rows.assumes, "model structure")


def _force_accuracy(vehicle: Vehicle) -> str:
    if not vehicle.thrusters:
        return "accuracy of the logged forces"
    each = {t.name: f"{t.accuracy.absolute!r} N + {t.accuracy.relative!r} |T|" for t in vehicle.thrusters}
    return "thrust accuracy: " + "; ".join(f"{name} within {bound}" for name, bound in each.items())


def _overall(statuses: Sequence[str]) -> str:
    """The weakest statement, except that one contradiction falsifies the whole model."""
    for status in ("empty", "not_applicable", "singular", "not_proved", "unbounded"):
        if status in statuses:
            return "not_applicable" if status == "singular" else status
    return "enclosed"


def _used(rows: RegressionRows) -> list[NDArray[np.bool_]]:
    """Where each column is more than zero."""

    def used(columns: slice) -> NDArray[np.bool_]:
        j = columns.start
        return np.asarray((rows.matrix.lower[:, j] != 0) | (rows.matrix.upper[:, j] != 0))

    return over_pieces(pieces(rows.matrix.shape[1], 1), used)


def _any(used: Sequence[NDArray[np.bool_]], columns: Iterable[int]) -> NDArray[np.bool_]:
    """Rows in which one of some columns is more than zero."""
    first, *others = columns
    found = used[first].copy()
    for j in others:
        found |= used[j]
    return found


def _blocks(used: Sequence[NDArray[np.bool_]]) -> list[tuple[int, ...]]:
    """Columns that are linked by a common row: each set can be solved on its own."""
    remaining, blocks = set(range(len(used))), []
    while remaining:
        group = {min(remaining)}
        while True:
            touched = _any(used, group)
            grown = group | {j for j in remaining - group if (used[j] & touched).any()}
            if grown == group:
                break
            group = grown
        remaining -= group
        blocks.append(tuple(sorted(group)))
    return blocks


def _solve(
    rows: RegressionRows,
    used: Sequence[NDArray[np.bool_]],
    columns: tuple[int, ...],
    method: str,
    partitions: int,
    allowed: int = 0,
) -> _Block:
    # Rows without any parameter say nothing of this block; where the model has one block they falsify it, so they stay.
    mine = _any(used, columns)
    if columns[0] == 0:
        mine |= ~_any(used, range(len(used)))
    part = rows.take(mine, columns)
    ids = [t.id for t in part.terms]
    if not part.time.size:
        n = len(columns)
        reason = f"no row holds {', '.join(ids)}"
        if method != "feasible":
            return _Block(columns, "not_applicable", None, None, None, None, 0, reason, (), ())
        free = tuple(np.eye(n))
        return _Block(columns, "unbounded", np.full(n, -np.inf), np.full(n, np.inf), None, 0.0, 0, reason, free, ())
    if method == "feasible":
        found = regression.feasible_set(part.matrix, part.right, outliers=allowed)
        lower, upper = (found.value.lower, found.value.upper) if found.value is not None else (None, None)
        certificates = _certificates(part, found)
        directions = tuple(found.directions) if found.status == "unbounded" else ()
        return _Block(
            columns,
            found.status,
            lower,
            upper,
            found.centre,
            found.inflation,
            0,
            found.reason,
            directions,
            certificates,
            None if not allowed else _wrong(part, found),
        )
    if method in regression.LEAST_SQUARES_METHODS:
        solved = regression.least_squares(part.matrix, part.right, method)
        lower, upper = (solved.value.lower, solved.value.upper) if solved.value is not None else (None, None)
        status = solved.status if solved.value is not None else "not_applicable"
        why = f"{', '.join(ids)}: {solved.reason}" if solved.reason else None
        return _Block(columns, status, lower, upper, None, None, 0, why, (), ())
    fit = regression.normal_equations(part.matrix, part.right, method, partitions)
    lower, upper = (fit.value.lower, fit.value.upper) if fit.value is not None else (None, None)
    why = f"{', '.join(ids)}: {fit.inverse.reason}" if fit.inverse.reason else None
    return _Block(columns, fit.status, lower, upper, None, None, fit.improper, why, (), ())


def _named(rows: RegressionRows, index: int) -> dict[str, Any]:
    """A row by its kind, channel and time."""
    return {
        "kind": ROW_KINDS[rows.kind[index]],
        "channel": CHANNELS[rows.channel[index]],
        "time": float(rows.time[index]),
        "duration": float(rows.duration[index]),
    }


def _wrong(rows: RegressionRows, found: regression.FeasibleSet) -> dict[str, Any]:
    """The fewest rows that must be wrong, and every choice of so many, by name."""
    return {
        "fewest": found.fewest_outliers,
        "sets": [[_named(rows, k) for k in sorted(chosen)] for chosen in found.outliers]
        if found.fewest_outliers
        else [],
    }


def _gather(terms: Sequence[Term], blocks: Sequence[_Block]) -> tuple[dict[str, Parameter], dict[str, float]]:
    """Parameters and the point estimate, in the order of the model."""
    parameters: dict[str, Parameter] = {}
    estimate: dict[str, float] = {}
    for j, term in enumerate(terms):
        block = next(b for b in blocks if j in b.columns)
        k = block.columns.index(j)
        if block.lower is not None and block.upper is not None:
            parameters[term.id] = Parameter(float(block.lower[k]), float(block.upper[k]), term.unit, term.symbol)
        if block.status == "enclosed" or block.centre is None:
            if term.id in parameters and np.isfinite(parameters[term.id].midpoint):
                estimate[term.id] = parameters[term.id].midpoint
        else:
            estimate[term.id] = float(block.centre[k])
    return parameters, estimate


def _certificates(rows: RegressionRows, found: regression.FeasibleSet) -> tuple[dict[str, Any], ...]:
    """Per orthant and bound: the interval rows used (hexadecimal floats), their times, and which end of each is meant."""
    ids = [t.id for t in rows.terms]

    def row(entry: tuple[int, bool, float]) -> dict[str, Any]:
        index, lower_side, multiplier = entry
        matrix, right = rows.matrix[index], rows.right[index]
        return {
            "row": int(index),
            **_named(rows, index),
            "side": "lower" if lower_side else "upper",
            "multiplier": multiplier,
            "lower": [x.hex() for x in matrix.lower.tolist()],
            "upper": [x.hex() for x in matrix.upper.tolist()],
            "right": [float(right.lower).hex(), float(right.upper).hex()],
        }

    certificates: list[dict[str, Any]] = []
    for proof in found.sign_proofs:
        home = dict(zip(ids, proof["home"], strict=True))
        reach = zip((c[0] for c in proof["columns"]), proof["reach"], strict=True)
        certificates.append(
            {
                "proves": "signs",
                "orthant": dict(zip(ids, proof["decided"], strict=True)),
                "home": home,
                "proved": [ids[j] for j, r in reach if r == 0],
                "branch": None if proof["branch"] is None else ids[proof["branch"]],
                "columns": [
                    {
                        "parameter": ids[j],
                        "rows": [row(e) for e in rows_],
                        "signs": [{"parameter": ids[k], "multiplier": m} for k, m in signs_],
                    }
                    for j, rows_, signs_ in proof["columns"]
                ],
                "vector": [float(v).hex() for v in proof["vector"]],
            }
        )
    for orthant in found.certificate:
        signs = dict(zip(ids, orthant["signs"], strict=True))
        left_out = {"dropped": [_named(rows, k) for k in orthant["dropped"]]} if orthant["dropped"] else {}
        if orthant["empty"]:
            contradiction = [row(e) for e in orthant["rows"]]
            certificates.append({"proves": "empty", "orthant": signs, "rows": contradiction, **left_out})
            continue
        for bound in orthant["bounds"]:
            certificates.append(
                {
                    "proves": "bound",
                    "orthant": signs,
                    "parameter": ids[bound["column"]],
                    "end": bound["end"],
                    "bound": bound["bound"].hex(),
                    "rows": [row(e) for e in bound["rows"]],
                    "signs": [{"parameter": ids[j], "multiplier": m} for j, m in bound["signs"]],
                    **left_out,
                }
            )
    return tuple(certificates)
