"""Mutated files for everything that the package reads: python -m tests.fuzz_files CASES [SEED] [KIND ...].

A case is a sound file with some changes: bytes, numbers that nobody would write, other types, nesting, pieces taken out or doubled. The reader has to
give a value or one sentence (``IvsidError``). Faults are any other exception, a sentence with a line break or a control character, a process that dies, and a case that takes
longer than ten seconds or more than two gigabytes beyond what the interpreter has at its start. One case in some hundred goes through the command line in a process of its own,
which has to end with code 0 or 2 and to print no traceback.

Cases are numbered: ``python -m tests.fuzz_files 1 SEED KIND at=NUMBER`` repeats one, and leaves its file in ``out/fuzz``.
"""

from __future__ import annotations

import multiprocessing
import os
import random
import re
import resource
import signal
import subprocess
import sys
import tempfile
import time
import traceback
from collections import Counter
from collections.abc import Callable
from contextlib import ExitStack
from dataclasses import dataclass
from multiprocessing.connection import Connection, wait
from pathlib import Path
from typing import TYPE_CHECKING

from tests.fuzz_changes import as_text, bytes_changed, index_changed, json_changed, repacked, text_changed

if TYPE_CHECKING:
    from ivsid.files.log_map import LogMap
    from ivsid.log import Parts

ROOT = Path(__file__).parents[1]
sys.path[:0] = [str(ROOT / "tests" / "python")]
# Seconds of a case, and bytes beyond those of the interpreter.
LONGEST = 10.0
# Seconds in which a worker makes its sound files.
STARTING = 60.0
MEMORY = 2 << 30
# A case of the command line takes a second: one in so many.
COMMANDS = 400
CONTROL = re.compile("[\x00-\x1f\x7f-\x9f]")


@dataclass(frozen=True)
class Kind:
    """A kind of file: a sound one, its mutation, its reader, and the command line that reads it (``{}`` stands for the file)."""

    name: str
    data: bytes
    ending: str
    change: Callable[[bytes, random.Random], bytes]
    read: Callable[[Path], object]
    command: tuple[str, ...] = ()


def kinds(folder: Path) -> dict[str, Kind]:
    """All kinds; the sound files are made in a folder."""
    import log_files
    from ivsid import export, identify, read_log, read_vehicle, validate, verify
    from ivsid.files.log_map import LogMap
    from ivsid.files.shipped import shipped
    from ivsid.identification.result import read_identification
    from ivsid.programme.scenario import parse_scenario, read_scenario
    from ivsid.simulation import simulate
    from ivsid.vehicle import parse_vehicle
    from ivsid.workflow.log_files import csv

    boat, plan = (shipped(n, s).read_text() for n, s in (("otter", ""), ("otter", "_programme")))
    swan = (Path(str(shipped("otter"))).parent / "swan.toml").read_text()
    train = (Path(str(shipped("otter"))).parent / "swan_train.toml").read_text()
    train = re.sub(r"duration = [0-9.]+", "duration = 8.0", train, count=1)
    vehicle = parse_vehicle(swan, "swan.toml")
    made = simulate(vehicle, parse_scenario(train, "train.toml"), 1)
    text = csv(made.t, made.columns)
    (folder / "swan.toml").write_text(swan)
    (folder / "train.toml").write_text(train)
    (folder / "run.csv").write_text(text)
    log = read_log(folder / "run.csv", vehicle.log)
    identify(vehicle, log, examine=False).save(folder / "fit")
    fit = (folder / "fit" / "result.json").read_bytes()

    def of_vehicle(path: Path) -> object:
        read = read_vehicle(path)
        return identify(read, log, examine=False)

    def of_scenario(path: Path) -> object:
        return simulate(vehicle, read_scenario(path), 1)

    def of_log(path: Path) -> object:
        return identify(vehicle, path)

    def of_fit(path: Path) -> object:
        read = read_identification(path)
        validate(read, log)
        export(read, "mss")
        return verify(path, log)

    found = [
        Kind(
            "vehicle",
            swan.encode(),
            "toml",
            as_text(text_changed),
            of_vehicle,
            ("identify", "{}", str(folder / "run.csv")),
        ),
        Kind("vehicle_otter", boat.encode(), "toml", as_text(text_changed), read_vehicle, ("simulate", "{}", "otter")),
        Kind(
            "scenario",
            train.encode(),
            "toml",
            as_text(text_changed),
            of_scenario,
            ("simulate", str(folder / "swan.toml"), "{}"),
        ),
        Kind("scenario_otter", plan.encode(), "toml", as_text(text_changed), read_scenario),
        Kind("run", text.encode(), "csv", as_text(text_changed), of_log, ("identify", str(folder / "swan.toml"), "{}")),
        Kind("fit", fit, "json", as_text(json_changed), of_fit, ("verify", "{}", str(folder / "run.csv"))),
    ]
    for name, (write, table) in log_files.FORMATS.items():
        place = folder / name
        place.mkdir()
        path = write(place)
        if path.is_dir():
            continue
        mapped = LogMap.model_validate(table)
        change = repacked if name == "gzip" else as_text(text_changed) if name == "csv" else bytes_changed
        ending = path.name.split(".", 1)[1]
        command = ("identify", str(folder / "swan.toml"), "{}")
        found.append(Kind(name, path.read_bytes(), ending, change, lambda p, m=mapped: read_log(p, m), command))
    for name in ("mcap_file", "parquet"):
        write, table = log_files.FORMATS[name]
        place = folder / f"{name}_parts"
        place.mkdir()
        path = write(place)
        mapped = LogMap.model_validate({**table, "span": [1.0, 8.0]})
        change = index_changed if name == "mcap_file" else bytes_changed
        found.append(
            Kind(f"{name}_parts", path.read_bytes(), path.suffix[1:], change, lambda p, m=mapped: in_parts(p, m))
        )
    return {k.name: k for k in found}


def in_parts(path: Path, mapping: LogMap) -> object:
    """A log from a disk and from elsewhere, which have to be one: with one identity and one time, or in a sentence each."""
    from ivsid import IvsidError, read_log
    from ivsid.log import Parts

    content = path.read_bytes()

    def read(given: Path | Parts) -> str:
        try:
            log = read_log(given, mapping)
        except IvsidError as error:
            if found := CONTROL.search(str(error)):
                raise ValueError(f"a sentence with U+{ord(found[0]):04X}") from None
            return "sentence"
        return f"{log.sha256} {log.t.size}"

    with tempfile.TemporaryDirectory() as folder:
        there = Parts(Path(folder) / path.name, "store://log", lambda a, b: content[a:b], len(content))
        found = read(path), read(there)
    if found[0] != found[1]:
        raise ValueError(f"a disk gives {found[0]}, a store {found[1]}")
    if found[0] == "sentence":
        raise IvsidError("no log")
    return found[0]


def file_of(kind: Kind, seed: int, number: int, folder: Path) -> Path:
    """The file of a case."""
    rng = random.Random(f"{seed} {kind.name} {number}")
    path = folder / f"case.{kind.ending}" if kind.name != "fit" else folder / "result.json"
    path.write_bytes(kind.change(kind.data, rng))
    return path


def outcome(kind: Kind, path: Path) -> str:
    """``value``, ``sentence``, or what is wrong."""
    from ivsid import IvsidError

    try:
        kind.read(path)
    except IvsidError as error:
        if found := CONTROL.search(str(error)):
            return f"FAULT a sentence with U+{ord(found[0]):04X}: {str(error)[:200]!r}"
        return "sentence"
    except MemoryError:
        # The command line says so in a sentence.
        return "memory"
    except BaseException as error:
        at = traceback.extract_tb(error.__traceback__)[-1]
        own = [f for f in traceback.extract_tb(error.__traceback__) if "ivsid" in f.filename]
        where = f"{Path(own[-1].filename).name}:{own[-1].lineno}" if own else ""
        return f"FAULT {type(error).__name__} at {where} ({Path(at.filename).name}:{at.lineno}): {str(error)[:200]}"
    return "value"


def by_command(kind: Kind, path: Path, folder: Path) -> str:
    """The same through the command line."""
    words = [w.replace("{}", str(path)) for w in kind.command]
    environment = {**os.environ, "PYTHONPATH": str(ROOT / "python")}
    try:
        done = subprocess.run(
            [sys.executable, "-m", "ivsid.cli", *words, "--out", str(folder / "out")],
            capture_output=True, timeout=12 * LONGEST, env=environment, check=False, preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (4 * MEMORY, 4 * MEMORY)),
        )  # fmt: skip
    except subprocess.TimeoutExpired:
        return "FAULT the command does not end"
    said = done.stderr.decode("utf-8", "replace")
    if done.returncode not in (0, 2) or "Traceback" in said or "internal fault" in said:
        return f"FAULT the command ends with {done.returncode}: {said[-300:]}"
    if CONTROL.search(re.sub(r"[\r\n]", "", said)):
        return f"FAULT the command prints control characters: {said[-300:]!r}"
    return "value" if done.returncode == 0 else "sentence"


def work(jobs: list[tuple[str, int]], seed: int, link: Connection) -> None:
    """Cases in turn; each is announced before it is done."""
    from ivsid.intervals.apart import end_with_parent

    end_with_parent()
    stack = ExitStack()
    known = kinds(Path(stack.enter_context(tempfile.TemporaryDirectory(prefix="ivsid-fuzz-"))))
    used = (
        int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
        if Path("/proc/self/statm").exists()
        else MEMORY
    )
    # The soft limit alone, so that a command gets one of its own.
    resource.setrlimit(resource.RLIMIT_AS, (used + MEMORY, resource.getrlimit(resource.RLIMIT_AS)[1]))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    null = os.open(os.devnull, os.O_WRONLY)
    os.dup2(null, 2)
    with stack, tempfile.TemporaryDirectory(prefix="ivsid-fuzz-") as name:
        folder = Path(name)
        for k, (kind, number) in enumerate(jobs):
            path = file_of(known[kind], seed, number, folder)
            command = known[kind].command and number % COMMANDS == COMMANDS - 1
            link.send((k, 13 * LONGEST if command else LONGEST))
            begin = time.monotonic()
            said = by_command(known[kind], path, folder) if command else outcome(known[kind], path)
            link.send((said, time.monotonic() - begin))
    link.send(None)


def patience() -> float:
    """By how much the clock runs ahead of a process on a busy machine."""
    return max(1.0, 2.0 * os.getloadavg()[0] / len(os.sched_getaffinity(0)))


def run(jobs: list[tuple[str, int]], seed: int, told: Callable[[str, int, str, float], None]) -> None:
    """All cases by several workers; one that dies or hangs is replaced, and its case is a fault."""
    # Polars has threads of its own: a process that is forked after its first table waits for them for ever.
    context = multiprocessing.get_context("spawn")
    count = max(1, min(len(os.sched_getaffinity(0)), len(jobs)))
    queues = [jobs[w::count] for w in range(count)]
    state: dict[Connection, list] = {}

    def begin(queue: list[tuple[str, int]]) -> None:
        reader, writer = context.Pipe(duplex=False)
        worker = context.Process(target=work, args=(queue, seed, writer), daemon=True)
        worker.start()
        writer.close()
        state[reader] = [worker, queue, -1, time.monotonic() + STARTING * patience()]

    def lost(reader: Connection, why: str) -> None:
        worker, queue, at, _ = state.pop(reader)
        worker.kill()
        worker.join()
        if at < 0:
            raise TimeoutError(f"a worker made no files: {why}")
        told(*queue[at], f"FAULT {why} ({worker.exitcode})", LONGEST)
        if queue[at + 1 :]:
            begin(queue[at + 1 :])

    for queue in queues:
        begin(queue)
    while state:
        for reader in wait(list(state), 0.2):
            try:
                said = reader.recv()
            except EOFError:
                lost(reader, "the process died")
                continue
            if said is None:
                state.pop(reader)[0].join()
            elif isinstance(said[0], int):
                state[reader][2:] = [said[0], time.monotonic() + said[1] * patience()]
            else:
                told(*state[reader][1][state[reader][2]], *said)
                state[reader][3] = time.monotonic() + STARTING * patience()
        for reader in [r for r, s in state.items() if time.monotonic() > s[3]]:
            if not reader.poll():
                lost(reader, f"no end in {LONGEST:g} s")


def main() -> int:
    """Runs the cases, and prints each fault and the counts."""
    words = [w for w in sys.argv[1:] if "=" not in w]
    at = next((int(w[3:]) for w in sys.argv[1:] if w.startswith("at=")), None)
    cases = int(float(words[0])) if words else 10_000
    seed = int(words[1]) if len(words) > 1 else time.time_ns() % 10_000_000
    sys.stdout.write(f"seed {seed}\n")
    with tempfile.TemporaryDirectory(prefix="ivsid-fuzz-") as name:
        known = kinds(Path(name))
        chosen = words[2:] or list(known)
        if at is not None:
            place = ROOT / "out" / "fuzz"
            place.mkdir(parents=True, exist_ok=True)
            path = file_of(known[chosen[0]], seed, at, place)
            sys.stdout.write(f"{path}\n")
            known[chosen[0]].read(path)
            return 0
        counts: Counter[tuple[str, str]] = Counter()
        slowest: dict[str, float] = {}

        def told(kind: str, number: int, said: str, spent: float) -> None:
            counts[kind, said.split(maxsplit=1)[0]] += 1
            slowest[kind] = max(slowest.get(kind, 0.0), spent)
            if said.startswith("FAULT"):
                sys.stdout.write(f"{kind} at={number}: {said}\n")
                sys.stdout.flush()

        # Whoever ends the run gets the counts so far.
        signal.signal(signal.SIGTERM, signal.default_int_handler)
        try:
            run([(chosen[k % len(chosen)], k // len(chosen)) for k in range(cases)], seed, told)
        except KeyboardInterrupt:
            cases = sum(counts.values())
            sys.stdout.write(f"ended after {cases} cases\n")
    for kind in chosen:
        parts = ", ".join(f"{counts[kind, w]} {w}" for w in ("value", "sentence", "memory", "FAULT"))
        sys.stdout.write(f"{kind}: {parts}, slowest {slowest.get(kind, 0.0):.1f} s\n")
    faults = sum(n for (_, said), n in counts.items() if said == "FAULT")
    sys.stdout.write(f"test result: {cases - faults} passed, {faults} failed\n")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
