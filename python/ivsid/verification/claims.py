"""What an identification claims, against the proofs of its cells of signs."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any

from ivsid.vehicle import Vehicle
from ivsid.verification.cells import Cell, covers
from ivsid.verification.counted import linked
from ivsid.verification.errors import UnprovedError
from ivsid.verification.outliers import Proof, check_choices, left_open, shown
from ivsid.verification.physics import Meaning

Terms = Mapping[str, Meaning]
Blocks = Mapping[int, "Block"]


@dataclass
class Block:
    """Parameters that share rows: what is proved of each cell of signs, and where signs are proved."""

    ids: tuple[str, ...]
    proofs: dict[Cell, list[Proof]] = field(default_factory=dict)
    signs: dict[Cell, tuple[Cell, int | None]] = field(default_factory=dict)

    def empties(self, cell: Cell) -> list[Proof]:
        """The proofs that a cell is empty."""
        return [p for p in self.proofs[cell] if p.end is None]

    def is_empty(self, wrong: int) -> bool:
        """Whether no parameter is consistent, whichever rows are wrong."""
        closed = [cell for cell in self.proofs if left_open(self.empties(cell), wrong) is None]
        return covers(closed, len(self.ids), self.signs)


def check_claims(record: Mapping[str, Any], vehicle: Vehicle, terms: Terms, blocks: Blocks, wrong: int) -> None:
    """Status, contradictions, wrong rows, intervals, and what the vehicle file claims of them.

    Args:
        record: the result.
        vehicle: that it carries.
        terms: the model.
        blocks: by number, with their proofs.
        wrong: rows of each block that may be wrong.

    Raises:
        UnprovedError: what is claimed and does not follow.
    """
    owners = [id_ for block in blocks.values() for id_ in block.ids]
    if len(set(owners)) != len(owners):
        raise UnprovedError("a parameter stands in two blocks")
    contradictions = [integer(k) for k in record["contradictions"]]
    falsifying = [c for c in record["certificates"] if c["proves"] == "empty" and c["block"] in contradictions]
    if (record["certificate"] or []) != falsifying:
        raise UnprovedError("'certificate' is not the list of the rows that falsify the model")
    proved_empty = [k for k, b in blocks.items() if b.is_empty(wrong)]
    _wrong_rows(record, terms, blocks, wrong)
    if record["status"] == "empty":
        if not contradictions or not set(contradictions) <= set(proved_empty):
            raise UnprovedError("no block of parameters is proved empty in every cell of signs")
        if record["parameters"]:
            raise UnprovedError("an empty set has no intervals")
        return
    if proved_empty or contradictions:
        raise UnprovedError("the model is proved wrong, but the status is another")
    _intervals(record, vehicle, terms, blocks, wrong)


def _intervals(record: Mapping[str, Any], vehicle: Vehicle, terms: Terms, blocks: Blocks, wrong: int) -> None:
    """The ends of every parameter, where the set is not empty."""
    if set(record["parameters"]) != set(terms):
        raise UnprovedError(f"the parameters of the model are {', '.join(terms)}")
    for k, block in blocks.items():
        if not covers([*block.proofs], len(block.ids), block.signs):
            raise UnprovedError(f"not every cell of signs of block {k} ({', '.join(block.ids)}) has a certificate")
    open_ends = 0
    for id_, claimed in record["parameters"].items():
        if (claimed["unit"], claimed["symbol"]) != (terms[id_].unit, terms[id_].symbol):
            raise UnprovedError(f"{id_} is {terms[id_].symbol} [{terms[id_].unit}]")
        block = next((b for b in blocks.values() if id_ in b.ids), Block(()))
        for end in ("lower", "upper"):
            if claimed[end] is None:
                open_ends += 1
                continue
            if isinstance(claimed[end], bool):
                raise UnprovedError(f"the {end} end of {id_} is no number")
            _end(id_, end, Fraction(claimed[end]), block, wrong)
    _model_values(record, vehicle)
    if (record["status"] == "unbounded") != (open_ends > 0):
        raise UnprovedError(f"status {record['status']} does not go with {open_ends} open ends")


def _wrong_rows(record: Mapping[str, Any], terms: Terms, blocks: Blocks, wrong: int) -> None:
    """Which rows have to be wrong: only where the result says that some may be."""
    claimed = record["outliers"]
    if [integer(c["block"]) for c in claimed] != (sorted(blocks) if wrong else []):
        raise UnprovedError(f"'outliers' is not a list of the {len(blocks)} blocks of which {wrong} rows may be wrong")
    for c in claimed:
        block = blocks[c["block"]]
        linked(terms, block.ids)
        if not covers([*block.proofs], len(block.ids)):
            raise UnprovedError(f"not every cell of signs of block {c['block']} has a certificate")
        check_choices(c, [block.empties(cell) for cell in block.proofs], wrong)


def _model_values(record: Mapping[str, Any], vehicle: Vehicle) -> None:
    """What the vehicle file claims, and whether its interval contradicts it: one statement for each number."""
    values = vehicle.model.values
    stated = {id_: value for id_, value in values.items() if id_ in record["parameters"]}
    if [c["parameter"] for c in record["claims"]] != list(stated):
        raise UnprovedError(f"the claims of the vehicle file are on {', '.join(stated) or 'nothing'}")
    for claim in record["claims"]:
        p, value = record["parameters"][claim["parameter"]], Fraction(stated[claim["parameter"]])
        beyond = (p["lower"] is not None and value < p["lower"]) or (p["upper"] is not None and value > p["upper"])
        # Printed ends lie outside of those that were compared: what they contradict is contradicted.
        if float(claim["value"]) != float(value) or not isinstance(claim["contradicted"], bool):
            raise UnprovedError(f"the claim on {claim['parameter']} is not the file's")
        if beyond != claim["contradicted"]:
            raise UnprovedError(f"the claim on {claim['parameter']} is {'' if beyond else 'not '}contradicted")


def _end(id_: str, end: str, claimed: Fraction, block: Block, wrong: int) -> None:
    """A claimed end must lie outside of the bound in every cell that is not empty, whichever rows are wrong."""
    direction = 1 if end == "lower" else -1
    if not block.ids:
        raise UnprovedError(f"the {end} end of {id_} has no certificate")
    place = block.ids.index(id_)
    for cell, proofs in block.proofs.items():
        if cell[place] == direction and direction * claimed <= 0:
            continue
        here = [p for p in proofs if p.end is None or p.end == (id_, end)]
        enough = [p for p in here if p.bound is None or direction * p.bound >= direction * claimed]
        gone = left_open(enough, wrong)
        if gone is None:
            continue
        bounds = [direction * p.bound for p in here if p.bound is not None and not p.rows & gone]
        bounds += [Fraction(0)] * (cell[place] == direction)
        why = f"is only proved to be {float(direction * max(bounds))!r}" if bounds else "has no certificate"
        where = f" where the signs are {_region(block, cell)}" + (f" without {shown(gone)}" if gone else "")
        raise UnprovedError(f"the {end} end of {id_}, {float(claimed)!r}, {why}{where}")


def _region(block: Block, cell: Cell) -> str:
    return ", ".join(f"{i} {'>=' if s > 0 else '<='} 0" for i, s in zip(block.ids, cell, strict=True) if s) or "any"


def integer(value: Any) -> int:
    """A whole number as JSON has it."""
    if not isinstance(value, int) or isinstance(value, bool):
        raise TypeError(f"{value!r} is no whole number")
    return value
