"""Statements of an identification against the proofs of its cells of signs."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from fractions import Fraction

from ivsid.vehicle import Vehicle
from ivsid.verification.cells import Cell, covers
from ivsid.verification.counted import linked
from ivsid.verification.errors import UnprovedError
from ivsid.verification.outliers import Proof, check_choices, left_open, shown
from ivsid.verification.physics import Meaning
from ivsid.verification.result import Stored

Terms = Mapping[str, Meaning]
Blocks = Mapping[int, "Block"]


@dataclass
class Block:
    """Parameters that share rows: the proofs of each cell of signs, and the regions in which signs are proved."""

    ids: tuple[str, ...]
    proofs: dict[Cell, list[Proof]] = field(default_factory=dict)
    signs: dict[Cell, tuple[Cell, int | None]] = field(default_factory=dict)

    def empties(self, cell: Cell) -> list[Proof]:
        """The proofs that a cell is empty."""
        return [p for p in self.proofs[cell] if p.end is None]

    def end(self, id_: str, end: str) -> Fraction:
        """The proved bound of one end in all cells of signs together.

        Raises:
            UnprovedError: a cell without a proof, or a block that is empty everywhere.
        """
        if not covers([*self.proofs], len(self.ids), self.signs):
            raise UnprovedError(f"not every cell of signs of {', '.join(self.ids)} has a certificate")
        direction, place, ends = 1 if end == "lower" else -1, self.ids.index(id_), []
        for cell, proofs in self.proofs.items():
            if self.empties(cell):
                continue
            bounds = [direction * p.bound for p in proofs if p.end == (id_, end) and p.bound is not None]
            bounds += [Fraction(0)] * (cell[place] == direction)
            if not bounds:
                raise UnprovedError(
                    f"the {end} end of {id_} has no certificate where the signs are {_region(self, cell)}"
                )
            ends.append(max(bounds))
        if not ends:
            raise UnprovedError("an empty block has no ends")
        return direction * min(ends)

    def is_empty(self, wrong: int) -> bool:
        """Whether no parameter is consistent, whichever ``wrong`` rows are wrong."""
        closed = [cell for cell in self.proofs if left_open(self.empties(cell), wrong) is None]
        return covers(closed, len(self.ids), self.signs)


def check_statements(record: Stored, vehicle: Vehicle, terms: Terms, blocks: Blocks, wrong: int) -> None:
    """Checks status, contradictions, wrong rows, intervals, and the comparison with the numbers of the vehicle file.

    Args:
        record: the content of result.json.
        vehicle: the vehicle in the result.
        terms: the parameters of the model.
        blocks: by number, with their proofs.
        wrong: number of rows of each block that may be wrong.

    Raises:
        UnprovedError: the first statement that does not follow.
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


def _intervals(record: Stored, vehicle: Vehicle, terms: Terms, blocks: Blocks, wrong: int) -> None:
    """Checks the ends of every parameter of a set that is not empty."""
    if set(record["parameters"]) != set(terms):
        raise UnprovedError(f"the parameters of the model are {', '.join(terms)}")
    for k, block in blocks.items():
        if not covers([*block.proofs], len(block.ids), block.signs):
            raise UnprovedError(f"not every cell of signs of block {k} ({', '.join(block.ids)}) has a certificate")
    open_ends = 0
    for id_, interval in record["parameters"].items():
        if (interval["unit"], interval["symbol"]) != (terms[id_].unit, terms[id_].symbol):
            raise UnprovedError(f"{id_} is {terms[id_].symbol} [{terms[id_].unit}]")
        block = next((b for b in blocks.values() if id_ in b.ids), Block(()))
        for end in ("lower", "upper"):
            if interval[end] is None:
                open_ends += 1
                continue
            if isinstance(interval[end], bool):
                raise UnprovedError(f"the {end} end of {id_} is no number")
            _end(id_, end, Fraction(interval[end]), block, wrong)
    _model_values(record, vehicle)
    if (record["status"] == "unbounded") != (open_ends > 0):
        raise UnprovedError(f"status {record['status']} does not go with {open_ends} open ends")


def _wrong_rows(record: Stored, terms: Terms, blocks: Blocks, wrong: int) -> None:
    """Checks the rows that have to be wrong, which a result lists if some may be."""
    listed = record["outliers"]
    if [integer(c["block"]) for c in listed] != (sorted(blocks) if wrong else []):
        raise UnprovedError(f"'outliers' is not a list of the {len(blocks)} blocks of which {wrong} rows may be wrong")
    for c in listed:
        block = blocks[c["block"]]
        linked(terms, block.ids)
        if not covers([*block.proofs], len(block.ids)):
            raise UnprovedError(f"not every cell of signs of block {c['block']} has a certificate")
        check_choices(c, [block.empties(cell) for cell in block.proofs], wrong)


def _model_values(record: Stored, vehicle: Vehicle) -> None:
    """Checks one statement for each number of the vehicle file's model: whether the interval contradicts it."""
    values = vehicle.model.values
    stated = {id_: value for id_, value in values.items() if id_ in record["parameters"]}
    if [c["parameter"] for c in record["claims"]] != list(stated):
        raise UnprovedError(f"the claims of the vehicle file are on {', '.join(stated) or 'nothing'}")
    for claim in record["claims"]:
        p, value = record["parameters"][claim["parameter"]], Fraction(stated[claim["parameter"]])
        beyond = (p["lower"] is not None and value < p["lower"]) or (p["upper"] is not None and value > p["upper"])
        # Printed ends lie outside of the computed ends: a number beyond a printed end is beyond the computed one.
        if float(claim["value"]) != float(value) or not isinstance(claim["contradicted"], bool):
            raise UnprovedError(f"the claim on {claim['parameter']} is not the file's")
        if beyond != claim["contradicted"]:
            raise UnprovedError(f"the claim on {claim['parameter']} is {'' if beyond else 'not '}contradicted")


def _end(id_: str, end: str, printed: Fraction, block: Block, wrong: int) -> None:
    """Checks that a printed end lies outside of the bound in every cell that is not empty, whichever rows are wrong."""
    direction = 1 if end == "lower" else -1
    if not block.ids:
        raise UnprovedError(f"the {end} end of {id_} has no certificate")
    place = block.ids.index(id_)
    for cell, proofs in block.proofs.items():
        if cell[place] == direction and direction * printed <= 0:
            continue
        here = [p for p in proofs if p.end is None or p.end == (id_, end)]
        enough = [p for p in here if p.bound is None or direction * p.bound >= direction * printed]
        gone = left_open(enough, wrong)
        if gone is None:
            continue
        bounds = [direction * p.bound for p in here if p.bound is not None and not p.rows & gone]
        bounds += [Fraction(0)] * (cell[place] == direction)
        why = f"is only proved to be {float(direction * max(bounds))!r}" if bounds else "has no certificate"
        where = f" where the signs are {_region(block, cell)}" + (f" without {shown(gone)}" if gone else "")
        raise UnprovedError(f"the {end} end of {id_}, {float(printed)!r}, {why}{where}")


def _region(block: Block, cell: Cell) -> str:
    return ", ".join(f"{i} {'>=' if s > 0 else '<='} 0" for i, s in zip(block.ids, cell, strict=True) if s) or "any"


def integer(value: object) -> int:
    """A whole number of JSON.

    Raises:
        TypeError: any other value.
    """
    if not isinstance(value, int) or isinstance(value, bool):
        raise TypeError(f"{value!r} is no whole number")
    return value
