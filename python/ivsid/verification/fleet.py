"""Statements of a fleet against its certificates and the logs whose rows they use (docs/theory.md, "Many logs").

A certificate of many logs is one of a single log whose rows each name theirs. The pooled bounds and every contradiction are checked as those of one
log. Each contradiction is checked once more for the period that it ends, so that the number of periods is proved as well.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from pathlib import Path
from typing import Final

from ivsid.errors import IvsidError
from ivsid.files.log_map import LogMap
from ivsid.log import PARTS, Log, digest_of, read_log
from ivsid.verification.checker import PROVABLE, Checker
from ivsid.verification.errors import UnprovedError
from ivsid.verification.rational import Range
from ivsid.verification.result import Result, Stored
from ivsid.verification.rows import Rows
from ivsid.verification.statements import Block, check_statements, integer
from ivsid.verification.unchecked import estimated, left_out

# Probability that all sensor bounds hold at once below which a fleet may not be called guaranteed.
# Source: definition: more likely than not
LIKELY: Final = Fraction(1, 2)
# The sign between a parameter and the log in which it has a value of its own.
APART: Final = " @ "


def logs_of(given: str | Path | Sequence[str | Path], needed: Mapping[str, str], mapping: LogMap) -> dict[str, Path]:
    """The files of the logs that a result needs, by name, found by their content.

    Args:
        given: a folder with logs in it or below it, or logs.
        needed: names of logs by SHA-256.
        mapping: the section ``[log]``, by which the parts of a log are chosen that its identity stands for.

    Raises:
        IvsidError: a path that cannot be read, or a log that is not there.
    """
    paths: list[Path] = []
    for each in [given] if isinstance(given, str | Path) else given:
        path = Path(each)
        inside = path.is_dir() and not _is_bag(path)
        paths += sorted(p for p in path.rglob("*") if p.is_file() or _is_bag(p)) if inside else [path]
    found: dict[str, Path] = {}
    parts = any(digest.startswith(PARTS) for digest in needed)
    # A log most often has the name that the result gives it, so that few files are read.
    names = {Path(n).name for n in needed.values()}
    for path in sorted(paths, key=lambda p: p.name not in names):
        if len(found) == len(needed):
            break
        try:
            name = needed.get(digest_of(path))
            if name is None and parts:
                name = needed.get(read_log(path, mapping, parts=True).sha256)
        except IvsidError:
            continue
        if name is not None:
            found[name] = path
    missing = sorted(set(needed.values()) - set(found))
    if missing:
        raise IvsidError(
            f"{len(missing)} of the {len(needed)} logs that the proofs use are not there ({', '.join(missing[:6])}), or changed; give the folder with "
            "all logs of the fleet"
        )
    return found


def _is_bag(path: Path) -> bool:
    return (path / "metadata.yaml").is_file()


def needed_logs(record: Stored) -> dict[str, str]:
    """The names of the logs whose rows the proofs use, by SHA-256.

    Raises:
        KeyError: a damaged result.
    """
    digests = {str(i["name"]): str(i["sha256"]) for i in record["inputs"][1:]}
    used = {str(r["log"]) for c in _certificates(record) for r in _rows(c)}
    return {digests[name]: name for name in sorted(used)}


def _certificates(record: Stored) -> list[Stored]:
    found = list((record["pooled"] or {}).get("certificates", ()))
    for change in (record["drift"] or {}).get("changes", ()):
        proofs = [change["proof"], *change["proofs_alone"].values()]
        proofs += [end for pair in change["proofs_changed"].values() for end in pair.values()]
        found += [c for p in proofs for c in p["certificates"]]
    return found


def _rows(certificate: Stored) -> list[Stored]:
    if "rows" in certificate:
        return list(certificate["rows"])
    return [r for column in certificate["columns"] for r in column["rows"]]


class FleetChecker(Checker):
    """The check of the result of a fleet.

    Args:
        result: of ``ivsid fleet``.
        logs: those whose rows the proofs use, by name.
    """

    def __init__(self, result: Result, logs: Mapping[str, Log]) -> None:
        self.logs = logs
        # A result of no log proves nothing, and asks nothing of this one.
        super().__init__(result, next(iter(logs.values())))
        self._rows_of: dict[str, Rows] = {}

    def run(self, progress: Callable[[str], None]) -> None:
        """Checks the files, and each statement with its certificates; progress is told of each."""
        self._files()
        self._kind()
        with self._trying("the model"):
            options = self.record["options"]
            if options["form"] not in ("total", "added"):
                raise UnprovedError(f"a form is total or added, not {options['form']!r}")
            if options["bias"] != "sample":
                raise UnprovedError("the rows of a fleet bound a bias at every sample")
            windows = len(options["window"]) if isinstance(options["window"], list) else 1
            for name, log in self.logs.items():
                self._rows_of[name] = Rows(log, self.result.vehicle, options["form"], windows=windows)
            self.rows = next(iter(self._rows_of.values()))
        if self.failures or self.unknown:
            return
        self._pooled(progress)
        self._drift(progress)

    def _files(self) -> None:
        if not self.result.sealed:
            self.failures.append("the seal: the result was edited after it was written")
        with self._trying("the inputs"):
            vehicle, *logs = self.record["inputs"]
            if vehicle["sha256"] != self.result.vehicle.sha256:
                self.failures.append("the vehicle: its text is not the file that was identified (SHA-256)")
            digests = {log["name"]: log["sha256"] for log in logs}
            together = set(self.record["logs"]["together"])
            for name, log in self.logs.items():
                if digests[name] != log.sha256:
                    self.failures.append(f"the log: {name} is not the file that was identified (SHA-256)")
                if name not in together:
                    self.failures.append(
                        f"the log {name} proves something, and is not among those that are held together"
                    )

    def _kind(self) -> None:
        if not self.record["guaranteed"]:
            return
        sensors, number = self.result.vehicle.sensors, len(self.record["logs"]["together"])
        if sensors.sigmas is not None:
            self.failures.append("guaranteed: under sigmas nothing is guaranteed")
        elif 1 - number * (1 - Fraction(repr(sensors.confidence))) < LIKELY:
            self.failures.append(f"guaranteed: the sensor bounds of {number} logs need not hold at once")
        if any(estimated(log, self.result.vehicle) for log in self.logs.values()):
            self.failures.append("guaranteed: with velocities by splines nothing is guaranteed")
        absent = {n: None for log in self.logs.values() for n in left_out(log, self.result.vehicle)}
        if absent:
            self.failures.append(f"guaranteed: the rows leave out {', '.join(absent)} of [model.fitted]")

    def _pooled(self, progress: Callable[[str], None]) -> None:
        pooled = self.record["pooled"]
        if pooled["status"] not in PROVABLE:
            self.failures.append(f"the status: {pooled['status']} claims nothing that could be proved")
            return
        blocks = self._proofs("all logs", pooled["certificates"], progress)
        contradictions = pooled["contradictions"]
        with self._trying("the bounds of all logs"):
            statement = {
                **pooled,
                "outliers": [],
                "certificate": [
                    c for c in pooled["certificates"] if c["proves"] == "empty" and c["block"] in contradictions
                ],
            }
            check_statements(statement, self.result.vehicle, self.rows.terms, blocks, 0)

    def _drift(self, progress: Callable[[str], None]) -> None:
        drift = self.record["drift"]
        with self._trying("the periods"):
            whole = [name for period in drift["periods"] for name in period]
            if sorted(whole) != sorted(self.record["logs"]["together"]):
                raise UnprovedError("the periods are not those of the logs that are held together")
            if len(drift["changes"]) != len(drift["periods"]) - 1:
                raise UnprovedError("a boundary between two periods has no proof")
        for k, change in enumerate(drift["changes"]):
            what = f"change {k}"
            with self._trying(what):
                reach = {*drift["periods"][k], drift["periods"][k + 1][0]}
                if not set(change["logs"]) <= reach:
                    raise UnprovedError("its logs are not those of its period and the first one after it")
            self._contradiction(what, change["proof"], set(change["logs"]), progress)
            for id_, proof in change["proofs_alone"].items():
                self._contradiction(f"{what} by {id_} alone", proof, set(change["logs"]), progress, id_)
            with self._trying(what):
                if set(change["cannot_explain_alone"]) != set(change["proofs_alone"]):
                    raise UnprovedError("a parameter that cannot explain it has no proof")
                if set(change["changed"]) != set(change["proofs_changed"]):
                    raise UnprovedError("a parameter that must have changed has no proof")
            for id_, pair in change["proofs_changed"].items():
                self._disjoint(f"{what} of {id_}", id_, pair, set(change["changed"][id_]), progress)

    def _contradiction(
        self, what: str, proof: Stored, logs: set[str], progress: Callable[[str], None], alone: str | None = None
    ) -> None:
        """Checks that the rows of some logs contradict each other, a parameter apart from the others if it is named."""
        blocks = self._proofs(what, proof["certificates"], progress)
        with self._trying(what):
            used = {r["log"] for c in proof["certificates"] for r in _rows(c)}
            if not used <= logs:
                raise UnprovedError("its rows are of other logs")
            ids = {id_ for b in blocks.values() for id_ in b.ids}
            apart = {id_.split(APART)[0] for id_ in ids if APART in id_}
            if apart - {alone}:
                raise UnprovedError(f"it leaves {', '.join(sorted(apart))} apart")
            if alone in ids:
                raise UnprovedError(f"{alone} is shared by the logs")
            if not any(blocks[integer(k)].is_empty(0) for k in proof["contradictions"]):
                raise UnprovedError("no block of parameters is proved empty in every cell of signs")

    def _disjoint(self, what: str, id_: str, pair: Stored, logs: set[str], progress: Callable[[str], None]) -> None:
        """Checks that the interval of a parameter in one log lies above that in another."""
        bounds: dict[str, Fraction] = {}
        with self._trying(what):
            if {pair["lower"]["log"], pair["upper"]["log"]} != logs:
                raise UnprovedError("its logs are others")
        for end in ("lower", "upper"):
            proof = pair[end]
            blocks = self._proofs(f"{what}, {end} end", proof["certificates"], progress)
            with self._trying(f"{what}, {end} end"):
                if {r["log"] for c in proof["certificates"] for r in _rows(c)} != {proof["log"]}:
                    raise UnprovedError("its rows are of other logs")
                (block,) = (b for b in blocks.values() if id_ in b.ids)
                bounds[end] = block.end(id_, end)
        with self._trying(what):
            if not bounds["lower"] > bounds["upper"]:
                raise UnprovedError("the intervals of the two logs meet")

    def _proofs(self, what: str, certificates: Sequence[Stored], progress: Callable[[str], None]) -> dict[int, Block]:
        """The proofs of some certificates, by block."""
        blocks: dict[int, Block] = {}
        for number, certificate in enumerate(certificates):
            progress(f"{what}: certificates {number} of {len(certificates)}")
            with self._trying(f"{what}, certificate {number}"):
                self._certificate(certificate, blocks)
                self.certificates += 1
        return blocks

    def _known(self) -> set[str]:
        apart = {f"{t}{APART}{name}" for t in self.rows.terms for name in self.logs}
        return {*self.rows.terms, *apart}

    def _made(
        self, stored: Stored, ids: Sequence[str], channel: str, time: float, duration: float
    ) -> tuple[Range, Mapping[str, Range]]:
        """Right-hand side and columns of a row of its log; each column is that of all logs, or of this one alone."""
        name = stored["log"]
        made = self._rows_of[name].row(stored["kind"], channel, time, duration)
        return made.right, apart_of(made.matrix, ids, name)


def apart_of(matrix: Mapping[str, Range], ids: Sequence[str], log: str) -> dict[str, Range]:
    """The columns of a row under the names of a certificate: that of a parameter apart is the one of its log, and 0 in others."""
    found = {}
    for id_, column in matrix.items():
        own = f"{id_}{APART}{log}"
        found[own if own in ids else id_] = column
    return found
