"""``ivsid init``: a vehicle file proposed from logs, with the questions that they leave open."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from ivsid.errors import IvsidError
from ivsid.files.records import envelope
from ivsid.files.whole import write_whole
from ivsid.proposal import Answers, Proposal, propose, vehicle_file
from ivsid.workflow.progress import Progress, silent


@dataclass(frozen=True)
class Written:
    """A proposed vehicle file that has been written: the lines for its user, and the same as a record."""

    lines: tuple[str, ...]
    record: Mapping[str, object]


def init(
    logs: Sequence[str | Path],
    out: str | Path,
    *,
    ask: Callable[[Proposal], Answers] | None = None,
    progress: Progress = silent,
) -> Written:
    """Looks at logs and writes a vehicle file for them.

    Args:
        logs: of one vehicle, in one form; the first one has to move.
        out: the file to write, which must not exist.
        ask: gets the answers of the user; by default nobody is asked, and open keys are marked.
        progress: told of each step.

    Raises:
        IvsidError: an unusable log, or a file that exists or cannot be written.
    """
    target = Path(out)
    if target.exists():
        raise IvsidError(
            f"{target} exists, and ivsid init overwrites no file; name another one with --out, or remove it"
        )
    progress("reading")
    found = propose(logs)
    answers = Answers() if ask is None else ask(found)
    write_whole(target, vehicle_file(found, answers, target.stem))
    blanks = found.blanks(answers)
    log = found.logs[0]
    shown = {n: f.match.column for n, f in found.channels.items()}
    demands = {f"demand_{d.name}": d.column for d in found.demands}
    demands |= {n: f.match.column for n, f in found.angles.items()}
    lines = [
        f"{log.name}: {log.t.size} rows, {log.t[-1] - log.t[0]:.4g} s, names: {found.columns.program.name}, frame {found.mapped.frame}",
        *(f"  {name:<16} {column}" for name, column in {**shown, **demands}.items()),
        *(f"  question: {q}" for q in found.questions),
        f"written to {target}" + (f"; to fill in: {', '.join(blanks)}" if blanks else ""),
        f"next: ivsid diagnose {target} {logs[0]} {logs[1] if len(logs) > 1 else 'ANOTHER_LOG'}",
    ]
    record = {
        **envelope("init", [(x.name, x.sha256) for x in found.logs]),
        "file": str(target),
        "program": found.columns.program.name,
        "frame": found.mapped.frame,
        "columns": {**shown, **demands},
        "questions": list(found.questions),
        "blanks": list(blanks),
    }
    return Written(tuple(lines), record)
