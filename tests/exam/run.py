"""Draws cases, examines them sealed, and scores them: python -m tests.exam.run FIRST COUNT [key=value ...].

Keys: ``out`` (a file for the rows), ``table`` (one for the table of the documentation), ``workers``, and what is not to be drawn: ``what``, ``effect``, ``size``, ``style``, ``kind``,
``ambient``, ``duration``, ``rate`` (tests/exam/draw.py).
"""

from __future__ import annotations

import json
import os
import sys
import tempfile
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from multiprocessing import get_context
from pathlib import Path

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
NUMBERS = ("size", "ambient", "duration", "rate")
# Cases that are drawn or graded while candidates work.
AHEAD = 2


def drawn(seed: int, options: dict, papers: Path, answers: Path) -> Path | str:
    """The folder of a drawn case, or why it cannot be."""
    from tests.exam.draw import case
    from tests.exam.seal import seal

    from ivsid import IvsidError

    try:
        return seal(case(seed, **options), papers, answers)
    except IvsidError as error:
        return str(error)


def graded(folder: Path, answers: Path, said: dict) -> dict:
    """The row of a case."""
    from tests.exam.grade import grade
    from tests.exam.seal import answer

    return grade(folder, said, answer(folder, answers))


def examination(seeds: range, options: dict, workers: int = 1) -> Iterator[dict]:
    """Rows in the order of the seeds. Those who examine are processes of their own, and are told a folder."""
    from tests.exam.examine import examine

    with tempfile.TemporaryDirectory() as top:
        papers, answers = Path(top, "papers"), Path(top, "answers")
        spawn = get_context("spawn")
        with ProcessPoolExecutor(workers, spawn) as candidates, ProcessPoolExecutor(workers + 1, spawn) as judge:

            def examined(seed: int) -> dict:
                folder = judge.submit(drawn, seed, options, papers, answers).result()
                if isinstance(folder, str):
                    return {"seed": seed, "skipped": folder}
                said = candidates.submit(examine, folder).result()
                return judge.submit(graded, folder, answers, said).result()

            # Judges draw and grade while candidates work: each case waits in a thread of its own, and a few are always under way.
            with ThreadPoolExecutor(workers + AHEAD) as cases:
                yield from cases.map(examined, seeds)


def main() -> None:
    from tests.exam.grade import score
    from tests.exam.table import table

    first, count = int(sys.argv[1]), int(sys.argv[2])
    given = dict(a.split("=", 1) for a in sys.argv[3:])
    path, page, workers = given.pop("out", None), given.pop("table", None), int(given.pop("workers", 2))
    options = {k: float(v) if k in NUMBERS else v for k, v in given.items()}
    rows = []
    for row in examination(range(first, first + count), options, workers):
        rows.append(row)
        if path:
            # After each case: a run that is stopped leaves what it has.
            Path(path).parent.mkdir(parents=True, exist_ok=True)
            Path(path).write_text(json.dumps(rows, default=float))
    if page:
        Path(page).write_text(table(rows, first, count))
    sys.stdout.write(score(rows) + "\n")


if __name__ == "__main__":
    main()
