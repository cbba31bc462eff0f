"""``ivsid init``: a vehicle file proposed from logs, with the questions that they leave open."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from ivsid.errors import IvsidError
from ivsid.files.records import envelope
from ivsid.files.whole import write_whole
from ivsid.proposal import Answers, Proposal, propose, vehicle_file
from ivsid.workflow.progress import Progress, silent

# Files of a folder that are no log and are named on the terminal.
# Source: definition: the lines of a screen
MOST_LEFT: Final = 12


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
        logs: of one vehicle, in one form, or folders of such; the first one has to move.
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
    if answers.scales:
        found = propose(logs, answers.scales)
    write_whole(target, vehicle_file(found, answers, target.stem))
    blanks = found.blanks(answers)
    log = found.logs[0]
    shown = {n: f.match.column for n, f in found.channels.items()}
    demands = {f"demand_{d.name}": d.column for d in found.demands}
    demands |= {n: f.match.column for n, f in found.angles.items()}
    lines = [
        *_folder(found, logs),
        f"{log.name}: {log.t.size} rows, {log.t[-1] - log.t[0]:.4g} s, names: {found.columns.program.name}, frame {found.mapped.frame}",
        *(f"  {name:<16} {column}" for name, column in {**shown, **demands}.items()),
        *(f"  question: {q}" for q in found.questions),
        *(f"  assumed: {a}" for a in found.assumed),
        f"written to {target}" + (f"; to fill in: {', '.join(blanks)}" if blanks else ""),
        f"next: ivsid diagnose {target} {found.paths[0]} {found.paths[1] if len(found.paths) > 1 else 'ANOTHER_LOG'}",
    ]
    record = {
        **envelope("init", [(x.name, x.sha256) for x in found.logs]),
        "file": str(target),
        "program": found.columns.program.name,
        "frame": found.mapped.frame,
        "columns": {**shown, **demands},
        "questions": list(found.questions),
        "assumed": list(found.assumed),
        "logs": [str(p) for p in found.paths],
        "left": {str(p): why for p, why in found.left},
        "blanks": list(blanks),
    }
    return Written(tuple(lines), record)


def _folder(found: Proposal, given: Sequence[str | Path]) -> list[str]:
    """Which logs of the folders were taken, and which files were not."""
    if [Path(p) for p in given] == list(found.paths) and not found.left:
        return []
    lines = [f"taken: {', '.join(str(p) for p in found.paths)}"]
    return (
        lines
        + [f"  not taken: {p}, which {why}" for p, why in found.left[:MOST_LEFT]]
        + ([f"  and {len(found.left) - MOST_LEFT} more, which stand in --json"] if len(found.left) > MOST_LEFT else [])
    )
