"""Statements of an identification against its certificates, the log and the vehicle file (docs/theory.md, "Verification")."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from fractions import Fraction
from math import isfinite
from typing import Final

from ivsid.log import Log
from ivsid.verification.cells import Cell
from ivsid.verification.counted import counted
from ivsid.verification.errors import UncheckedError, UnprovedError
from ivsid.verification.multipliers import HalfSpace, Vector, contradict, half_space, least
from ivsid.verification.outliers import Proof, named
from ivsid.verification.physical import KINDS as ASSUMED
from ivsid.verification.rational import Range
from ivsid.verification.result import Result, Stored
from ivsid.verification.rows import Rows
from ivsid.verification.signs import Line, proved_signs
from ivsid.verification.statements import Block, check_statements, integer
from ivsid.verification.unchecked import estimated, left_out

# Statuses that certificates can prove.
PROVABLE: Final = ("enclosed", "empty", "unbounded")

# Errors of Python that an edited result can cause: each becomes a failure of the check, in a sentence.
READING_ERRORS: Final = (
    KeyError,
    TypeError,
    ValueError,
    AttributeError,
    IndexError,
    ArithmeticError,
    AssertionError,
    RecursionError,
)


@dataclass
class Checker:
    """The check of one result: failures, parts that cannot be recomputed, and the number of certificates that hold."""

    result: Result
    log: Log
    failures: list[str] = field(default_factory=list)
    unknown: list[str] = field(default_factory=list)
    certificates: int = 0
    wrong: int = 0
    rows_used: set[tuple[object, ...]] = field(default_factory=set)
    _spaces: dict[tuple[object, ...], HalfSpace] = field(default_factory=dict)

    def run(self, progress: Callable[[str], None]) -> None:
        """Checks the files, the status, each certificate, and the statements that rest on them; progress is told of each certificate."""
        self._files()
        self._kind()
        if self.failures:
            return
        with self._trying("the model"):
            options = self.record["options"]
            self.wrong = integer(options["outliers"])
            if self.wrong < 0:
                raise UnprovedError(f"{self.wrong} rows cannot be wrong")
            if self.wrong and options["bias"] != "sample":
                raise UnprovedError("a row that bounds a bias is no measurement that could be wrong")
            if not isinstance(options["physical"], bool) or (self.wrong and options["physical"]):
                raise UnprovedError("physical bounds are assumed or not, and are no measurements that could be wrong")
            if options["form"] not in ("total", "added"):
                raise UnprovedError(f"a form is total or added, not {options['form']!r}")
            if options["bias"] not in ("sample", "log"):
                raise UnprovedError(f"a bias is bounded by the sample or one of the log, not {options['bias']!r}")
            windows = len(options["window"]) if isinstance(options["window"], list) else 1
            self.rows = Rows(
                self.log,
                self.result.vehicle,
                options["form"],
                apart=options["bias"] == "log",
                windows=windows,
                assumed=options["physical"],
            )
        if self.failures or self.unknown:
            return
        blocks: dict[int, Block] = {}
        certificates = self.record["certificates"]
        for number, certificate in enumerate(certificates):
            progress(f"certificates {number} of {len(certificates)}")
            with self._trying(_name(number, certificate)):
                self._certificate(certificate, blocks)
                self.certificates += 1
        with self._trying("the claims"):
            check_statements(self.record, self.result.vehicle, self.rows.terms, blocks, self.wrong)

    @property
    def record(self) -> Stored:
        """The content of result.json."""
        return self.result.record

    @contextmanager
    def _trying(self, what: str) -> Iterator[None]:
        try:
            yield
        except UnprovedError as error:
            self.failures.append(f"{what}: {error}")
        except UncheckedError as error:
            self.unknown.append(str(error))
        except READING_ERRORS as error:
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
        if record["status"] not in PROVABLE:
            self.failures.append(f"the status: {record['status']} claims nothing that could be proved")
        ruled, guessed = self.result.vehicle.sensors.sigmas is None, estimated(self.log, self.result.vehicle)
        absent = left_out(self.log, self.result.vehicle)
        if record["guaranteed"] != (ruled and not guessed and not absent):
            rule = "under confidence a proved result is guaranteed" if ruled else "under sigmas nothing is guaranteed"
            rule = "with velocities by splines nothing is guaranteed" if guessed else rule
            rule = f"the rows leave out {', '.join(absent)} of [model.fitted]" if absent else rule
            self.failures.append(f"guaranteed: {record['guaranteed']} is claimed, but {rule}")

    def _certificate(self, certificate: Stored, blocks: dict[int, Block]) -> None:
        ids = tuple(certificate["orthant"])
        cell = tuple(certificate["orthant"].values())
        if any(s not in (-1, 0, 1) or isinstance(s, bool) for s in cell):
            raise UnprovedError("signs are 1, -1, or 0 for both")
        if not set(ids) <= self._known():
            raise UnprovedError(f"the model has no {', '.join(set(ids) - self._known())}")
        block = blocks.setdefault(integer(certificate["block"]), Block(ids))
        if block.ids != ids:
            raise UnprovedError("its parameters are not those of the other certificates of its block")
        if certificate["proves"] == "signs":
            if self.wrong:
                raise UnprovedError("its rows may be among the wrong ones")
            block.signs[cell] = self._signs(certificate, ids, cell)
            return
        known = block.proofs.setdefault(cell, [])
        if certificate["proves"] == "bound" and not isfinite(float.fromhex(certificate["bound"])):
            return
        names = [named(r) for r in certificate["rows"]]
        meant = frozenset(named(r) for r in certificate.get("dropped", ()))
        if len(meant) > self.wrong or meant & set(names):
            raise UnprovedError(
                f"it leaves out {len(meant)} rows and uses them, or no more than {self.wrong} may be wrong"
            )
        rows = [self._half_space(r, ids) for r in certificate["rows"]]
        if certificate["proves"] == "empty":
            used = contradict(rows, cell, _multipliers(certificate))
            if used is None:
                raise UnprovedError("its rows do not contradict each other")
            known.append(Proof(None, None, frozenset(names[k] for k in used), meant))
        elif certificate["proves"] == "bound":
            bound, used = self._bound(certificate, block, cell, rows)
            end = (certificate["parameter"], certificate["end"])
            known.append(Proof(end, bound, frozenset(names[k] for k in used), meant))
        else:
            raise UnprovedError(f"it proves '{certificate['proves']}', which is not known")

    def _bound(self, certificate: Stored, block: Block, cell: Cell, rows: list[HalfSpace]) -> tuple[Fraction, set[int]]:
        """The stored bound, if the certificate proves it, and the rows that the proof needs."""
        end, id_ = certificate["end"], certificate["parameter"]
        if end not in ("lower", "upper"):
            raise UnprovedError(f"an end is lower or upper, not {end!r}")
        direction = 1 if end == "lower" else -1
        objective = [Fraction(direction * (i == id_)) for i in block.ids]
        slack = {block.ids.index(s["parameter"]) for s in certificate["signs"]}
        if id_ not in block.ids:
            raise UnprovedError(f"{id_} is no parameter of its block")
        proved = least(objective, rows, cell, slack)
        bound = Fraction(float.fromhex(certificate["bound"]))
        if proved is None:
            raise UnprovedError("its rows bound nothing")
        if direction * bound > proved[0]:
            beyond = float(direction * bound - proved[0])
            raise UnprovedError(
                f"its rows prove {float(direction * proved[0])!r}, which is {beyond:.3g} short of the bound"
            )
        return bound, proved[1]

    def _signs(self, certificate: Stored, ids: Sequence[str], decided: Cell) -> tuple[Cell, int | None]:
        """The region that is left where the signs ``decided`` hold, and the unknown whose two signs are examined apart."""
        home = tuple(certificate["home"][id_] for id_ in ids)
        if any(s not in (-1, 0, 1) or (d and d != s) for d, s in zip(decided, home, strict=True)):
            raise UnprovedError("its signs are not 1, -1 or 0, or not those that were decided")
        branch = None if certificate["branch"] is None else ids.index(certificate["branch"])
        listed = {ids.index(id_) for id_ in certificate["proved"]}
        region = decided
        if listed:
            lines = []
            for column in certificate["columns"]:
                rows = [self._half_space(r, ids) for r in column["rows"]]
                slack = {ids.index(s["parameter"]) for s in column["signs"]}
                lines.append(Line(ids.index(column["parameter"]), rows, [_widths(r) for r in column["rows"]], slack))
            vector = [Fraction(float.fromhex(x)) for x in certificate["vector"]]
            proved = proved_signs(decided, home, lines, vector)
            if proved is None or not listed <= set(proved):
                raise UnprovedError("its rows do not prove these signs")
            region = tuple(home[k] if k in listed else s for k, s in enumerate(decided))
        return region, branch

    def _half_space(self, stored: Stored, ids: Sequence[str]) -> HalfSpace:
        """The half-space of a stored row, once the row is recomputed; certificates share rows, so that it is kept."""
        ends = (tuple(stored[k]) for k in ("lower", "upper", "right"))
        key = (*named(stored), stored.get("log"), stored["side"], *ends, tuple(ids))
        if key not in self._spaces:
            self._spaces[key] = self._recomputed(stored, ids)
        return self._spaces[key]

    def _recomputed(self, stored: Stored, ids: Sequence[str]) -> HalfSpace:
        channel, time, duration = stored["channel"], float(stored["time"]), float(stored["duration"])
        lower, upper = ([Fraction(float.fromhex(x)) for x in stored[k]] for k in ("lower", "upper"))
        one_sided = stored["kind"] in ASSUMED
        if one_sided and (stored["side"] != "lower" or stored["right"][1:] != ["inf"]):
            raise UnprovedError("a physical bound has a lower side alone")
        right = [Fraction(float.fromhex(x)) for x in (stored["right"][:1] * 2 if one_sided else stored["right"])]
        if not len(lower) == len(upper) == len(ids) or len(right) != 2:
            raise UnprovedError("a row has not one interval a parameter")
        if stored["side"] not in ("lower", "upper"):
            raise UnprovedError(f"a side is lower or upper, not {stored['side']!r}")
        here = half_space(lower, upper, (right[0], right[1]), lower_side=stored["side"] == "lower")
        if self.wrong:
            counted(self.rows, self.record["options"], named(stored))
        try:
            right_side, matrix = self._made(stored, ids, channel, time, duration)
        except UncheckedError as error:
            # The multipliers are checked against the stored rows all the same: a bound that those do not prove has failed.
            if str(error) not in self.unknown:
                self.unknown.append(str(error))
            return here
        where = f"the {channel} row at t = {time!r} s" + (f" over {duration!r} s" if duration else "")
        left_out = [id_ for id_, range_ in matrix.items() if id_ not in ids and range_.magnitude]
        if left_out:
            raise UnprovedError(f"{where} holds {left_out[0]}, which its block leaves out")
        for k, id_ in enumerate(ids):
            _inside(matrix.get(id_, Range(0)), lower[k], upper[k], f"{where}, column {id_}")
        if not one_sided:
            _inside(right_side, right[0], right[1], f"{where}, right-hand side")
        elif right_side.lower < right[0]:
            raise UnprovedError(
                f"{where}: its bound is {float(right_side.lower)!r}, and {float(right[0])!r} is claimed"
            )
        self.rows_used.add((stored["kind"], channel, time, duration, stored.get("log")))
        return here

    def _known(self) -> set[str]:
        """Names that the columns of a certificate may have."""
        return {*self.rows.terms, *self.rows.unknowns}

    def _made(
        self, stored: Stored, _ids: Sequence[str], channel: str, time: float, duration: float
    ) -> tuple[Range, Mapping[str, Range]]:
        """Right-hand side and columns of a stored row, from the log."""
        made = self.rows.row(stored["kind"], channel, time, duration)
        return made.right, made.matrix


def _inside(range_: Range, lower: Fraction, upper: Fraction, what: str) -> None:
    if not range_.inside(lower, upper):
        raise UnprovedError(f"{what}: recomputed as {range_}, which is not inside [{float(lower)!r}, {float(upper)!r}]")


def _multipliers(certificate: Stored) -> list[float]:
    """The stored multipliers, rounded; none if one of them is no number. They are a proposal: exact ones are found and checked."""
    try:
        return [float(r["multiplier"]) for r in certificate["rows"]]
    except (KeyError, TypeError, ValueError, OverflowError):
        return []


def _widths(stored: Stored) -> Vector:
    lower, upper = ([Fraction(float.fromhex(x)) for x in stored[k]] for k in ("lower", "upper"))
    return [b - a for a, b in zip(lower, upper, strict=True)]


def _name(number: int, certificate: object) -> str:
    what = ""
    if isinstance(certificate, dict) and certificate.get("proves") == "bound":
        what = f" ({certificate.get('end')} end of {certificate.get('parameter')})"
    elif isinstance(certificate, dict):
        what = " (empty)"
    return f"certificate {number}{what}"
