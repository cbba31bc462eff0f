"""Mutated files for everything that the package reads: python -m tests.fuzz_files CASES [SEED] [KIND ...].

A case is a sound file with some changes: bytes, numbers that nobody would write, other types, nesting, pieces taken out or doubled. The reader has to
give a value or one sentence (``IvsidError``). Faults are any other exception, a sentence with a line break or a control character, a process that dies, and a case that takes
longer than ten seconds or more than two gigabytes beyond what the interpreter has at its start. One case in some hundred goes through the command line in a process of its own,
which has to end with code 0 or 2 and to print no traceback.

Cases are numbered: ``python -m tests.fuzz_files 1 SEED KIND at=NUMBER`` repeats one, and leaves its file in ``out/fuzz``.
"""

from __future__ import annotations

import json
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
from contextlib import ExitStack, suppress
from dataclasses import dataclass
from multiprocessing.connection import Connection, wait
from pathlib import Path
from typing import TYPE_CHECKING

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
NUMBERS = (
    *("0", "-1", "1e308", "-1e308", "1e-320", "nan", "inf", "-inf", "1e18", "9223372036854775808", "-0.0", "1e400"),
    *("0.1", "3", "1_000", "0x7fffffff", "1e-9", "1e9", "1979-05-27", "true", '""', "[]", "[1, 2]", "{a = 1}", '"x"'),
)
WORDS = (
    *(
        '"../../escape"',
        '"<script>alert(7)</script>"',
        '"\\u0000"',
        '"' + "a" * 5000 + '"',
        '"a\\nb"',
        '"{{7*7}}"',
        '"%s%n"',
    ),
    *(
        "\"__import__('os')\"",
        '"="',
        '"u * 1e400"',
        '"u / 0"',
        '"' + "(" * 300 + "u" + ")" * 300 + '"',
        '"-u"',
        '"$(id)"',
    ),
)


def bytes_changed(data: bytes, rng: random.Random) -> bytes:
    """Some bytes changed, a piece taken out, doubled or overwritten, or the end gone."""
    made = bytearray(data)
    for _ in range(rng.choice((1, 1, 1, 2, 5))):
        if not made:
            break
        at, size = rng.randrange(len(made)), rng.choice((1, 2, 4, 8, 64, 1000))
        match rng.randrange(8):
            case 0:
                made[at] = rng.randrange(256)
            case 1:
                made[at] ^= 1 << rng.randrange(8)
            case 2:
                del made[at:]
            case 3:
                del made[at : at + size]
            case 4:
                made[at:at] = made[at : at + size]
            case 5:
                made[at : at + size] = rng.randbytes(size)
            case 6:
                # Lengths and counts are integers of four or eight bytes.
                number = rng.choice((0, 1, 2**31 - 1, 2**31, 2**32 - 1, 2**40, 2**63 - 1, 2**64 - 1))
                width = rng.choice((2, 4, 8))
                made[at : at + width] = (number & (256**width - 1)).to_bytes(width, rng.choice(("little", "big")))
            case _:
                other = rng.randrange(len(made))
                made[at : at + size] = made[other : other + size]
    return bytes(made)


def text_changed(text: str, rng: random.Random) -> str:
    """Numbers, words and lines of a text changed; the rest stays what it was, so that the change is read."""
    for _ in range(rng.choice((1, 1, 1, 2, 4))):
        numbers = list(re.finditer(r"(?<![\w.])-?\d+(\.\d+)?([eE][-+]?\d+)?", text))
        words = list(re.finditer(r'"[^"\n]*"', text))
        lines = text.split("\n")
        match rng.randrange(9):
            case 0 | 1 | 2 if numbers:
                m = rng.choice(numbers)
                text = text[: m.start()] + rng.choice(NUMBERS) + text[m.end() :]
            case 3 if words:
                m = rng.choice(words)
                text = text[: m.start()] + rng.choice((*WORDS, rng.choice(words)[0])) + text[m.end() :]
            case 4:
                del lines[rng.randrange(len(lines))]
                text = "\n".join(lines)
            case 5:
                lines.insert(rng.randrange(len(lines)), rng.choice(lines))
                text = "\n".join(lines)
            case 6:
                k = rng.randrange(len(lines))
                deep = rng.choice((50, 99, 101, 5000))
                lines[k] += rng.choice(
                    ("[" * deep + "]" * deep, "{a=" * deep + "1" + "}" * deep, " # é\u202e", "\x1b[31m", "\ufeff")
                )
                text = "\n".join(lines)
            case 7 if numbers:
                m = rng.choice(numbers)
                text = (
                    text[: m.start()]
                    + m[0]
                    + rng.choice(("0" * 400, "e99", ".", "_", " ", ",", ",,"))
                    + text[m.end() :]
                )
            case _:
                return bytes_changed(text.encode(), rng).decode(
                    "utf-8", rng.choice(("replace", "ignore", "surrogateescape"))
                )
    return text


def json_changed(text: str, rng: random.Random) -> str:
    """Values of a JSON text changed in their place: other types, numbers, missing and further keys. The seal is made anew."""
    record = json.loads(text)
    for _ in range(rng.choice((1, 1, 2, 4))):
        holder, key = record, rng.choice(list(record))
        while isinstance(holder[key], dict | list) and len(holder[key]) and rng.random() < 0.9:
            holder = holder[key]
            key = rng.choice(list(holder)) if isinstance(holder, dict) else rng.randrange(len(holder))
        nasty = (
            None,
            True,
            -1,
            0,
            1e308,
            2**70,
            "",
            "x",
            "nan",
            "0x1p5000",
            "0x1.8p3",
            [],
            {},
            [[]],
            {"a": 1},
            "../x",
            "<b>",
            1e-320,
            float("inf"),
        )
        match rng.randrange(5):
            case 0 if isinstance(holder, dict):
                del holder[key]
            case 1 if isinstance(holder, list):
                holder.append(holder[key])
            case 2 if isinstance(holder[key], str):
                holder[key] = text_changed(holder[key], rng)
            case _:
                holder[key] = rng.choice(nasty)
        if not record:
            break
    if rng.random() < 0.8 and isinstance(record, dict):
        from ivsid.files.records import sealed
        from ivsid.files.seal import KEY

        record.pop(KEY, None)
        with suppress(TypeError, ValueError, OverflowError):
            record = sealed(record)
    return json.dumps(record)


@dataclass(frozen=True)
class Kind:
    """A kind of file: a sound one, its mutation, its reader, and the command line that reads it (``{}`` stands for the file)."""

    name: str
    data: bytes
    ending: str
    change: Callable[[bytes, random.Random], bytes]
    read: Callable[[Path], object]
    command: tuple[str, ...] = ()


def as_text(change: Callable[[str, random.Random], str]) -> Callable[[bytes, random.Random], bytes]:
    """A change of a text as one of its bytes; one change in five is of bytes."""

    def changed(data: bytes, rng: random.Random) -> bytes:
        if rng.random() < 0.2:
            return bytes_changed(data, rng)
        return change(data.decode(), rng).encode("utf-8", "surrogateescape")

    return changed


def repacked(data: bytes, rng: random.Random) -> bytes:
    """A change inside of a packed file, which is packed again, or of the packed bytes."""
    import gzip

    if rng.random() < 0.5:
        return bytes_changed(data, rng)
    return gzip.compress(as_text(text_changed)(gzip.decompress(data), rng), 1)


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


def index_changed(data: bytes, rng: random.Random) -> bytes:
    """Changes of the index of an MCAP file, half of them of a number in it."""
    begin = int.from_bytes(data[-28:-20], "little")
    if rng.random() < 0.5:
        return data[:begin] + bytes_changed(data[begin:], rng)
    made, at = bytearray(data), rng.randrange(begin, len(data) - 8)
    value = rng.choice((0, 1, -1, 1 << 62, len(data), begin, rng.randrange(len(data)), at))
    made[at : at + 8] = (value % (1 << 64)).to_bytes(8, "little")
    return bytes(made)


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
