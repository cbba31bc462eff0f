"""Every claim of an identification against its certificates, the log and the vehicle file (METHODS 5.3)."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from fractions import Fraction
from math import isfinite
from typing import Any, Final

from ivsid.log import Log
from ivsid.verification.cells import Cell, covers
from ivsid.verification.errors import UncheckedError, UnprovedError
from ivsid.verification.multipliers import HalfSpace, Vector, contradict, half_space, least
from ivsid.verification.rational import Range
from ivsid.verification.result import Result
from ivsid.verification.rows import Rows
from ivsid.verification.signs import Line, proved_signs
from ivsid.verification.unchecked import estimated

CLAIMS: Final = ("enclosed", "empty", "unbounded")


@dataclass
class _Block:
    """Parameters that share rows: the cells of signs that were closed, what bounds them, and where signs are proved."""

    ids: tuple[str, ...]
    empty: list[Cell] = field(default_factory=list)
    bounds: dict[Cell, dict[tuple[str, str], Fraction]] = field(default_factory=dict)
    signs: dict[Cell, tuple[Cell, int | None]] = field(default_factory=dict)


@dataclass
class Checker:
    """Collects what fails and what it does not know, and counts what holds."""

    result: Result
    log: Log
    failures: list[str] = field(default_factory=list)
    unknown: list[str] = field(default_factory=list)
    certificates: int = 0
    rows_used: set[tuple[Any, ...]] = field(default_factory=set)

    def run(self) -> None:
        """Checks everything."""
        self._files()
        self._kind()
        if self.failures:
            return
        with self._trying("the model"):
            options = self.record["options"]
            left_out = any(c.get("dropped") for c in self.record["certificates"]) or self.record["outliers"]
            if _integer(options["outliers"]) or left_out:
                self.unknown.append("results that leave rows out (outliers) are not recomputed by the checker")
                return
            if options["form"] not in ("total", "added"):
                raise UnprovedError(f"a form is total or added, not {options['form']!r}")
            if options["bias"] not in ("sample", "log"):
                raise UnprovedError(f"a bias is bounded by the sample or one of the log, not {options['bias']!r}")
            windows = len(options["window"]) if isinstance(options["window"], list) else 1
            self.rows = Rows(
                self.log, self.result.vehicle, options["form"], apart=options["bias"] == "log", windows=windows
            )
        if self.failures:
            return
        blocks: dict[int, _Block] = {}
        for number, certificate in enumerate(self.record["certificates"]):
            with self._trying(_name(number, certificate)):
                self._certificate(certificate, blocks)
                self.certificates += 1
        with self._trying("the claims"):
            self._claims(blocks)

    @property
    def record(self) -> dict[str, Any]:
        """The result."""
        return self.result.record

    @contextmanager
    def _trying(self, what: str) -> Iterator[None]:
        try:
            yield
        except UnprovedError as error:
            self.failures.append(f"{what}: {error}")
        except (KeyError, TypeError, ValueError, AttributeError, IndexError, ArithmeticError, AssertionError) as error:
            self.failures.append(f"{what}: cannot be read or recomputed ({type(error).__name__}: {error})")

    def _files(self) -> None:
        if not self.result.sealed:
            self.failures.append("the seal: the result was edited after it was written")
        with self._trying("the inputs"):
            vehicle, log = self.record["inputs"]
            if vehicle["sha256"] != self.result.vehicle.sha256:
                self.failures.append("the vehicle: its text is not the file that was identified (SHA-256)")
            if log["sha256"] != self.log.sha256:
                self.failures.append(f"the log: {self.log.name} is not the file that was identified (SHA-256)")

    def _kind(self) -> None:
        record = self.record
        if record["method"] != "feasible":
            self.failures.append(
                f"the method: {record['method']} leaves no certificates that could be checked; use feasible"
            )
        if record["status"] not in CLAIMS:
            self.failures.append(f"the status: {record['status']} claims nothing that could be proved")
        ruled, guessed = self.result.vehicle.sensors.sigmas is None, estimated(self.log, self.result.vehicle)
        if record["guaranteed"] != (ruled and not guessed):
            rule = "under confidence a proved result is guaranteed" if ruled else "under sigmas nothing is guaranteed"
            rule = "with velocities by splines nothing is guaranteed" if guessed else rule
            self.failures.append(f"guaranteed: {record['guaranteed']} is claimed, but {rule}")

    def _certificate(self, certificate: Mapping[str, Any], blocks: dict[int, _Block]) -> None:
        ids = tuple(certificate["orthant"])
        cell = tuple(certificate["orthant"].values())
        if any(s not in (-1, 0, 1) or isinstance(s, bool) for s in cell):
            raise UnprovedError("signs are 1, -1, or 0 for both")
        if not set(ids) <= {*self.rows.terms, *self.rows.unknowns}:
            raise UnprovedError(f"the model has no {', '.join(set(ids) - set(self.rows.terms))}")
        block = blocks.setdefault(_integer(certificate["block"]), _Block(ids))
        if block.ids != ids:
            raise UnprovedError("its parameters are not those of the other certificates of its block")
        if certificate["proves"] == "bound" and not isfinite(float.fromhex(certificate["bound"])):
            block.bounds.setdefault(cell, {})
            return
        if certificate["proves"] == "signs":
            block.signs[cell] = self._signs(certificate, ids, cell)
            return
        rows = [self._half_space(r, ids) for r in certificate["rows"]]
        if certificate["proves"] == "empty":
            if not contradict(rows, cell):
                raise UnprovedError("its rows do not contradict each other")
            block.empty.append(cell)
        elif certificate["proves"] == "bound":
            self._bound(certificate, block, cell, rows)
        else:
            raise UnprovedError(f"it proves '{certificate['proves']}', which is not known")

    def _bound(self, certificate: Mapping[str, Any], block: _Block, cell: Cell, rows: list[HalfSpace]) -> None:
        end, id_ = certificate["end"], certificate["parameter"]
        if end not in ("lower", "upper"):
            raise UnprovedError(f"an end is lower or upper, not {end!r}")
        direction = 1 if end == "lower" else -1
        objective = [Fraction(direction * (i == id_)) for i in block.ids]
        slack = {block.ids.index(s["parameter"]) for s in certificate["signs"]}
        if id_ not in block.ids:
            raise UnprovedError(f"{id_} is no parameter of its block")
        proved = least(objective, rows, cell, slack)
        claimed = Fraction(float.fromhex(certificate["bound"]))
        if proved is None:
            raise UnprovedError("its rows bound nothing")
        if direction * claimed > proved:
            beyond = float(direction * claimed - proved)
            raise UnprovedError(
                f"its rows prove {float(direction * proved)!r}, which is {beyond:.3g} short of the bound"
            )
        known = block.bounds.setdefault(cell, {})
        known[id_, end] = max(claimed, known.get((id_, end), claimed), key=lambda b: direction * b)

    def _signs(self, certificate: Mapping[str, Any], ids: Sequence[str], decided: Cell) -> tuple[Cell, int | None]:
        """The region that is left where the signs ``decided`` hold, and the unknown whose signs are looked at apart."""
        home = tuple(certificate["home"][id_] for id_ in ids)
        if any(s not in (-1, 0, 1) or (d and d != s) for d, s in zip(decided, home, strict=True)):
            raise UnprovedError("its signs are not 1, -1 or 0, or not those that were decided")
        branch = None if certificate["branch"] is None else ids.index(certificate["branch"])
        claimed = {ids.index(id_) for id_ in certificate["proved"]}
        region = decided
        if claimed:
            lines = []
            for column in certificate["columns"]:
                rows = [self._half_space(r, ids) for r in column["rows"]]
                slack = {ids.index(s["parameter"]) for s in column["signs"]}
                lines.append(Line(ids.index(column["parameter"]), rows, [_widths(r) for r in column["rows"]], slack))
            vector = [Fraction(float.fromhex(x)) for x in certificate["vector"]]
            proved = proved_signs(decided, home, lines, vector)
            if proved is None or not claimed <= set(proved):
                raise UnprovedError("its rows do not prove these signs")
            region = tuple(home[k] if k in claimed else s for k, s in enumerate(decided))
        return region, branch

    def _half_space(self, stored: Mapping[str, Any], ids: Sequence[str]) -> HalfSpace:
        channel, time, duration = stored["channel"], float(stored["time"]), float(stored["duration"])
        lower, upper, right = ([Fraction(float.fromhex(x)) for x in stored[k]] for k in ("lower", "upper", "right"))
        if not len(lower) == len(upper) == len(ids) or len(right) != 2:
            raise UnprovedError("a row has not one interval a parameter")
        if stored["side"] not in ("lower", "upper"):
            raise UnprovedError(f"a side is lower or upper, not {stored['side']!r}")
        here = half_space(lower, upper, (right[0], right[1]), lower_side=stored["side"] == "lower")
        try:
            made = self.rows.row(stored["kind"], channel, time, duration)
        except UncheckedError as error:
            # The multipliers are checked all the same: what does not even follow from the stored rows has failed.
            if str(error) not in self.unknown:
                self.unknown.append(str(error))
            return here
        where = f"the {channel} row at t = {time!r} s" + (f" over {duration!r} s" if duration else "")
        left_out = [id_ for id_, range_ in made.matrix.items() if id_ not in ids and range_.magnitude]
        if left_out:
            raise UnprovedError(f"{where} holds {left_out[0]}, which its block leaves out")
        for k, id_ in enumerate(ids):
            _inside(made.matrix.get(id_, Range(0)), lower[k], upper[k], f"{where}, column {id_}")
        _inside(made.right, right[0], right[1], f"{where}, right-hand side")
        self.rows_used.add((stored["kind"], channel, time, duration))
        return here

    def _claims(self, blocks: Mapping[int, _Block]) -> None:
        record = self.record
        owners = [id_ for block in blocks.values() for id_ in block.ids]
        if len(set(owners)) != len(owners):
            raise UnprovedError("a parameter stands in two blocks")
        contradictions = [_integer(k) for k in record["contradictions"]]
        falsifying = [c for c in record["certificates"] if c["proves"] == "empty" and c["block"] in contradictions]
        if (record["certificate"] or []) != falsifying:
            raise UnprovedError("'certificate' is not the list of the rows that falsify the model")
        proved_empty = [k for k, b in blocks.items() if covers(b.empty, len(b.ids), b.signs)]
        if record["status"] == "empty":
            if not contradictions or not set(contradictions) <= set(proved_empty):
                raise UnprovedError("no block of parameters is proved empty in every cell of signs")
            if record["parameters"]:
                raise UnprovedError("an empty set has no intervals")
            return
        if proved_empty or contradictions:
            raise UnprovedError("the model is proved wrong, but the status is another")
        self._intervals(blocks)

    def _intervals(self, blocks: Mapping[int, _Block]) -> None:
        """The ends of every parameter, where the set is not empty."""
        record, terms = self.record, self.rows.terms
        if set(record["parameters"]) != set(terms):
            raise UnprovedError(f"the parameters of the model are {', '.join(terms)}")
        for k, block in blocks.items():
            if not covers([*block.empty, *block.bounds], len(block.ids), block.signs):
                raise UnprovedError(f"not every cell of signs of block {k} ({', '.join(block.ids)}) has a certificate")
        open_ends = 0
        for id_, claimed in record["parameters"].items():
            if (claimed["unit"], claimed["symbol"]) != (terms[id_].unit, terms[id_].symbol):
                raise UnprovedError(f"{id_} is {terms[id_].symbol} [{terms[id_].unit}]")
            block = next((b for b in blocks.values() if id_ in b.ids), _Block(()))
            for end in ("lower", "upper"):
                if claimed[end] is None:
                    open_ends += 1
                    continue
                if isinstance(claimed[end], bool):
                    raise UnprovedError(f"the {end} end of {id_} is no number")
                _end(id_, end, Fraction(claimed[end]), block)
        self._model_values()
        if (record["status"] == "unbounded") != (open_ends > 0):
            raise UnprovedError(f"status {record['status']} does not go with {open_ends} open ends")

    def _model_values(self) -> None:
        """What the vehicle file claims, and whether its interval contradicts it: one statement for each number."""
        record, values = self.record, self.result.vehicle.model.values
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


def _inside(range_: Range, lower: Fraction, upper: Fraction, what: str) -> None:
    if not range_.inside(lower, upper):
        raise UnprovedError(f"{what}: recomputed as {range_}, which is not inside [{float(lower)!r}, {float(upper)!r}]")


def _end(id_: str, end: str, claimed: Fraction, block: _Block) -> None:
    """A claimed end must lie outside of the bound in every cell that is not empty."""
    direction = 1 if end == "lower" else -1
    if not block.ids:
        raise UnprovedError(f"the {end} end of {id_} has no certificate")
    place = block.ids.index(id_)
    for cell, bounds in block.bounds.items():
        if cell in block.empty:
            continue
        known = [direction * b for b in (bounds.get((id_, end)),) if b is not None]
        if cell[place] == direction:
            known.append(Fraction(0))
        if not known or direction * claimed > max(known):
            why = "has no certificate" if not known else f"is only proved to be {float(direction * max(known))!r}"
            raise UnprovedError(
                f"the {end} end of {id_}, {float(claimed)!r}, {why} where the signs are {_region(block, cell)}"
            )


def _widths(stored: Mapping[str, Any]) -> Vector:
    lower, upper = ([Fraction(float.fromhex(x)) for x in stored[k]] for k in ("lower", "upper"))
    return [b - a for a, b in zip(lower, upper, strict=True)]


def _region(block: _Block, cell: Cell) -> str:
    return ", ".join(f"{i} {'>=' if s > 0 else '<='} 0" for i, s in zip(block.ids, cell, strict=True) if s) or "any"


def _integer(value: Any) -> int:
    if not isinstance(value, int) or isinstance(value, bool):
        raise TypeError(f"{value!r} is no block")
    return value


def _name(number: int, certificate: Any) -> str:
    what = ""
    if isinstance(certificate, dict) and certificate.get("proves") == "bound":
        what = f" ({certificate.get('end')} end of {certificate.get('parameter')})"
    elif isinstance(certificate, dict):
        what = " (empty)"
    return f"certificate {number}{what}"
