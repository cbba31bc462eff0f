"""The tables of a fleet as Parquet files: the same bytes for the same inputs, apart from ``times.parquet``."""

from __future__ import annotations

import io
from collections.abc import Sequence
from typing import TYPE_CHECKING

import polars as pl

if TYPE_CHECKING:
    from ivsid.fleets.result import Fleet


def tables(fleet: Fleet) -> dict[str, pl.DataFrame]:
    """All tables by name: ``logs``, ``parameters``, ``pooled``, ``findings``, ``contradictions``, ``changes`` and ``times``."""
    return {
        "logs": _logs(fleet),
        "parameters": _parameters(fleet),
        "pooled": _pooled(fleet),
        "findings": _findings(fleet),
        "contradictions": _contradictions(fleet),
        "changes": _changes(fleet),
        "times": _times(fleet),
    }


def parquet(table: pl.DataFrame) -> bytes:
    """A table as the content of a Parquet file."""
    buffer = io.BytesIO()
    table.write_parquet(buffer, compression="zstd", statistics=True)
    return buffer.getvalue()


def _logs(fleet: Fleet) -> pl.DataFrame:
    period = {} if fleet.drift is None else {k: p for p, logs in enumerate(fleet.drift.periods) for k in logs}
    place = {k: i for i, k in enumerate(fleet.order)}
    rows = []
    for k, e in enumerate(fleet.entries):
        r, d = e.record, None if e.diagnosis is None else e.diagnosis.record
        rows.append(
            {
                "log": e.place.name,
                "sha256": r.get("sha256"),
                "began": r.get("began"),
                "order": place.get(k),
                "period": period.get(k),
                "samples": r.get("samples"),
                "length": r.get("length"),
                "status": e.status,
                "guaranteed": r.get("guaranteed"),
                "inflation": r.get("inflation"),
                "verdict": None if d is None else d["verdict"],
                "setup": len(r.get("setup", ())),
                "error": e.error,
                "diagnosis_error": None if e.diagnosis is None else e.diagnosis.error,
                "key": r.get("key"),
            }
        )
    return pl.DataFrame(
        rows,
        schema={
            "log": pl.String,
            "sha256": pl.String,
            "began": pl.Float64,
            "order": pl.Int64,
            "period": pl.Int64,
            "samples": pl.Int64,
            "length": pl.Float64,
            "status": pl.String,
            "guaranteed": pl.Boolean,
            "inflation": pl.Float64,
            "verdict": pl.String,
            "setup": pl.Int64,
            "error": pl.String,
            "diagnosis_error": pl.String,
            "key": pl.String,
        },
    )


def _parameters(fleet: Fleet) -> pl.DataFrame:
    rows = [(e.place.name, t.id, t.unit, *e.bound(t.id)) for e in fleet.entries if e.usable for t in fleet.terms]
    return _frame(rows, log=pl.String, parameter=pl.String, unit=pl.String, lower=pl.Float64, upper=pl.Float64)


def _pooled(fleet: Fleet) -> pl.DataFrame:
    """The bounds of all logs together, beside the tightest ends that a single log has."""
    rows = []
    for t in fleet.terms:
        lower, upper = fleet.parameters.get(t.id, (None, None))
        each = [(e.place.name, *e.bound(t.id)) for e in fleet.entries if e.usable]
        low = max(each, key=lambda b: b[1], default=(None, None, None))
        high = min(each, key=lambda b: b[2], default=(None, None, None))
        rows.append((t.id, t.symbol, t.unit, lower, upper, low[1], low[0], high[2], high[0]))
    number, word = pl.Float64, pl.String
    return _frame(
        rows,
        parameter=word,
        symbol=word,
        unit=word,
        lower=number,
        upper=number,
        largest_lower=number,
        of_log=word,
        smallest_upper=number,
        of_other_log=word,
    )


def _findings(fleet: Fleet) -> pl.DataFrame:
    rows: list[tuple[object, ...]] = []
    for e in fleet.entries:
        record = None if e.diagnosis is None else e.diagnosis.record
        if record is None:
            continue
        for f in record["findings"]:
            shared = (e.place.name, record["other"], f["effect"], f["probability"], f["confidence"])
            for k, b in f["parameters"].items():
                ends = (b["unit"], float.fromhex(b["lower"]), float.fromhex(b["upper"]), b["guaranteed"])
                rows.append((*shared, k, *ends))
            if not f["parameters"]:
                rows.append((*shared, *[None] * 5))
    number, word = pl.Float64, pl.String
    return _frame(
        rows,
        log=word,
        tried_on=word,
        effect=word,
        probability=number,
        confidence=number,
        parameter=word,
        unit=word,
        lower=number,
        upper=number,
        guaranteed=pl.Boolean,
    )


def _contradictions(fleet: Fleet) -> pl.DataFrame:
    names, terms = fleet.names, [t.id for t in fleet.terms]
    pairs = {} if fleet.drift is None else fleet.drift.pairs
    # Column by column: a season that changed once has a quarter of a million pairs.
    columns = {
        "log": [names[a] for a, _ in pairs],
        "other": [names[b] for _, b in pairs],
        "proof": ["intervals" if changed else "rows" for changed in pairs.values()],
        "disjoint": [[terms[j] for j in changed] for changed in pairs.values()],
    }
    return pl.DataFrame(
        columns, schema={"log": pl.String, "other": pl.String, "proof": pl.String, "disjoint": pl.List(pl.String)}
    )


def _changes(fleet: Fleet) -> pl.DataFrame:
    rows, names = [], fleet.names
    for k, c in enumerate(() if fleet.drift is None else fleet.drift.changes):
        ids = [t.id for t in fleet.terms]
        each = ([names[n] for n in c.logs], c.irreducible)
        rows.append((k, *each, [ids[j] for j in c.changed], [ids[j] for j in c.alone], [ids[j] for j in c.excluded]))
    words = pl.List(pl.String)
    return _frame(
        rows,
        boundary=pl.Int64,
        logs=words,
        irreducible=pl.Boolean,
        must_have_changed=words,
        could_explain_alone=words,
        cannot_explain_alone=words,
    )


def _times(fleet: Fleet) -> pl.DataFrame:
    rows = []
    for e in fleet.entries:
        for step, o in (("identify", e.outcome), ("diagnose", e.diagnosis)):
            if o is not None:
                rows.append((e.place.name, step, o.seconds, o.reused, o.bytes))
    return _frame(rows, log=pl.String, step=pl.String, seconds=pl.Float64, reused=pl.Boolean, bytes=pl.Int64)


def _frame(rows: Sequence[tuple[object, ...]], **schema: object) -> pl.DataFrame:
    return pl.DataFrame(rows, schema=schema, orient="row")  # type: ignore[arg-type]
