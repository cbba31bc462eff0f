"""Draws cases, examines them sealed, and scores them: python -m tests.exam.run FIRST COUNT [key=value ...].

Keys: ``out`` (a file for the rows), ``table`` (one for the table of the documentation), ``workers``, ``folders`` (a folder of cases by
another simulator, which replace the drawn ones; tests/exam/seal.py), and what is not to be drawn: ``what``, ``effect`` (``each`` takes
all in turn), ``size`` (a multiple of the typical one) or ``z`` (how far it shall stand out), ``style``, ``kind``, ``ambient``, ``duration``, ``rate``, ``noise``,
``thrust`` (the family of the thrust errors, ``inflow`` for errors by the speed of the water, or ``none``), ``share`` (of the accuracy that they fill) and
``sea`` (the spectrum of the ambient force) and ``sensors`` (errors of sensors beside their noise), by default ``any`` of tests/exam/seas.py and
tests/exam/sensor_errors.py where nothing is hidden.

The run fails if the counts contradict a demanded rate (tests/exam/criteria.py).
"""

from __future__ import annotations

import json
import os
import sys
import tempfile
from collections.abc import Iterable, Iterator
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from multiprocessing import get_context
from pathlib import Path

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
NUMBERS = ("size", "z", "ambient", "duration", "rate", "share")
# Cases that are drawn or graded while candidates work.
AHEAD = 2


def drawn(job: int | Path, options: dict, papers: Path, answers: Path) -> Path | str:
    """The folder of a drawn or given case, or why it cannot be."""
    from tests.exam.cases import case
    from tests.exam.seal import adopt, seal

    if isinstance(job, Path):
        return adopt(job, papers, answers)
    try:
        return seal(case(job, **options), papers, answers)
    except ValueError as error:
        return str(error)


def graded(folder: Path, answers: Path, said: dict) -> dict:
    """The row of a case."""
    from tests.exam.grade import grade
    from tests.exam.seal import answer

    return grade(folder, said, answer(folder, answers))


def examination(jobs: Iterable[int | Path], options: dict, workers: int = 1) -> Iterator[dict]:
    """Rows in the order of the seeds, or of the folders. Those who examine are processes of their own, and are told a folder."""
    from tests.exam.examine import examine

    from ivsid.intervals.apart import end_with_parent

    # The answers lie where no path of the papers leads.
    with tempfile.TemporaryDirectory() as one, tempfile.TemporaryDirectory() as other:
        papers, answers = Path(one), Path(other)
        spawn = get_context("spawn")
        with (
            ProcessPoolExecutor(workers, spawn, end_with_parent) as candidates,
            ProcessPoolExecutor(workers + 1, spawn, end_with_parent) as judge,
        ):

            def examined(job: int | Path) -> dict:
                folder = judge.submit(drawn, job, options, papers, answers).result()
                if isinstance(folder, str):
                    return {"seed": job, "skipped": folder}
                said = candidates.submit(examine, folder).result()
                return judge.submit(graded, folder, answers, said).result()

            # Judges draw and grade while candidates work: each case waits in a thread of its own, and a few are always under way.
            with ThreadPoolExecutor(workers + AHEAD) as cases:
                yield from cases.map(examined, jobs)


def main() -> int:
    from tests.exam.criteria import passed
    from tests.exam.grade import score
    from tests.exam.reliability import drawing
    from tests.exam.table import table

    first, count = int(sys.argv[1]), int(sys.argv[2])
    given = dict(a.split("=", 1) for a in sys.argv[3:])
    path, page, workers = given.pop("out", None), given.pop("table", None), int(given.pop("workers", 2))
    folders = given.pop("folders", None)
    jobs = range(first, first + count) if folders is None else sorted(q for q in Path(folders).iterdir() if q.is_dir())
    options = {"sea": "any", "sensors": "any", **{k: float(v) if k in NUMBERS else v for k, v in given.items()}}
    rows = []
    for row in examination(jobs, options, workers):
        rows.append(row)
        if path:
            # After each case: a run that is stopped leaves what it has.
            Path(path).parent.mkdir(parents=True, exist_ok=True)
            Path(path).write_text(json.dumps(rows, default=float))
    if page:
        Path(page).write_text(table(rows, first, count))
        drawing(rows, Path(page).with_name("reliability.svg"))
    sys.stdout.write(score(rows) + "\n")
    return 0 if passed(rows) else 1


if __name__ == "__main__":
    sys.exit(main())
