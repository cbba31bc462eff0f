"""Runs in a folder and in those below it: which files and folders are a log each, and why others are none."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final

from ivsid.errors import IvsidError
from ivsid.log import TABLES, WHOLE, digest_of, open_source
from ivsid.log.runs import SPEEDS, TURNS
from ivsid.proposal.columns import columns_of

# Endings of text that may be a log, beside those that are one.
TEXTS: Final = tuple(e + z for e in (".txt", ".dat", ".json", ".slog", ".log", ".asc") for z in ("", ".gz"))
# Runs of a folder that are looked at.
# Source: resource: a minute of reading
MOST_RUNS: Final = 40
# Files of a folder that are looked at.
# Source: resource: bounds the time until the first word
MOST_FILES: Final = 2000


@dataclass(frozen=True)
class Found:
    """What a folder holds.

    Attributes:
        runs: logs, those with the most channels and demands first.
        left: files that are no run, with the reason.
    """

    runs: tuple[Path, ...]
    left: tuple[tuple[Path, str], ...]


@dataclass
class _Look:
    """A search that goes on: what each file holds, and the files that hold nothing of use."""

    columns: dict[Path, tuple[str, ...]] = field(default_factory=dict)
    rank: dict[Path, int] = field(default_factory=dict)
    left: dict[Path, str] = field(default_factory=dict)
    runs: set[Path] = field(default_factory=set)

    def at(self, path: Path) -> bool:
        """Whether a file or folder can be read as a log; it is remembered what it holds."""
        try:
            with open_source(path) as source:
                found = columns_of(source)
                self.columns[path] = tuple(sorted(source.columns))
        except IvsidError as error:
            self.left[path] = short(error, path)
            return False
        names = set(found.channels)
        self.rank[path] = len(names) + len(found.demands)
        if names & SPEEDS and names & TURNS:
            self.runs.add(path)
        return True


def runs_in(folder: Path) -> Found | None:
    """The runs in a folder; None where the folder itself is one log, or holds a single one.

    Raises:
        IvsidError: no log in the folder, or more files than are looked at.
    """
    look = _Look()
    paths = _logs(folder, look, [MOST_FILES])
    if folder in paths or (len(paths) == 1 and not look.left):
        return None
    # Runs first, those that say most before others; a log at rest has no motion, and its noise is of use.
    ordered = sorted((p for p in paths if p in look.columns), key=lambda p: (p not in look.runs, -look.rank[p]))
    if not ordered:
        shown = "; ".join(f"{p.relative_to(folder)}: {why}" for p, why in list(look.left.items())[:4])
        raise IvsidError(f"folder {folder} holds no log that can be read ({shown or 'it is empty'}); give a log file")
    kept: list[Path] = []
    known: dict[str, Path] = {}
    for path in ordered:
        twin = known.setdefault(digest_of(path), path)
        if twin != path:
            look.left[path] = f"has the same bytes as {twin.relative_to(folder)}"
        elif len(kept) == MOST_RUNS:
            look.left[path] = f"is not looked at, behind {MOST_RUNS} others"
        else:
            kept.append(path)
    return Found(tuple(kept), tuple(look.left.items()))


def _logs(folder: Path, look: _Look, budget: list[int]) -> list[Path]:
    """The logs in a folder, each a file or a folder."""
    if (folder / "metadata.yaml").is_file():
        return [folder] if look.at(folder) else []
    try:
        entries = sorted(p for p in folder.iterdir() if not p.name.startswith("."))
    except OSError as error:
        look.left[folder] = f"cannot be read ({error.strerror})"
        return []
    budget[0] -= len(entries)
    if budget[0] < 0:
        raise IvsidError(
            f"folder {folder} and those above it have more than {MOST_FILES:,} files; give the folder of the runs"
        )
    files = [p for p in entries if p.is_file()]
    tables = [p for p in files if p.name.lower().endswith(TABLES)]
    others = [p for p in files if p.name.lower().endswith((*TEXTS, *WHOLE)) and p not in tables]
    for p in files:
        if p not in tables and p not in others:
            look.left[p] = "has the ending of no log"
    found = [p for p in (*tables, *others) if look.at(p)]
    below = [p for sub in entries if sub.is_dir() and not sub.is_symlink() for p in _logs(sub, look, budget)]
    one = [*tables, *below]
    if (tables or below) and len(entries) > 1 and not _alike(tables, look) and not _alike(below, look):
        # Tables that say different things are one log on several clocks, if together they say more than each alone.
        held = look.left.copy()
        if look.at(folder) and look.rank[folder] > max((look.rank.get(p, 0) for p in one), default=0):
            look.left = {p: why for p, why in held.items() if not p.name.lower().endswith(TABLES)}
            return [folder, *(p for p in found if p not in tables)]
        look.left = held
    return [*found, *below]


def _alike(paths: Sequence[Path], look: _Look) -> bool:
    """Whether two files are runs of their own: with the same columns, or nothing but runs."""
    runs = [look.columns[p] for p in paths if p in look.runs]
    return any(count > 1 for count in Counter(runs).values()) or len(runs) == len(paths) > 1


def short(error: IvsidError, path: Path) -> str:
    """The fault of a file in some words: its sentence up to the advice, without its name."""
    text = str(error).partition(";")[0].removeprefix(f"log {path}").removeprefix(f"{path}:").removeprefix(str(path))
    return text.strip(" :") if len(text) <= 120 else f"{text.strip(' :')[:117]}..."
