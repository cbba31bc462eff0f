"""Changes of sound files for ``fuzz_files.py``: of bytes, of text, of JSON, inside of packed files and of an MCAP index."""

from __future__ import annotations

import json
import random
import re
from collections.abc import Callable
from contextlib import suppress

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


def index_changed(data: bytes, rng: random.Random) -> bytes:
    """Changes of the index of an MCAP file, half of them of a number in it."""
    begin = int.from_bytes(data[-28:-20], "little")
    if rng.random() < 0.5:
        return data[:begin] + bytes_changed(data[begin:], rng)
    made, at = bytearray(data), rng.randrange(begin, len(data) - 8)
    value = rng.choice((0, 1, -1, 1 << 62, len(data), begin, rng.randrange(len(data)), at))
    made[at : at + 8] = (value % (1 << 64)).to_bytes(8, "little")
    return bytes(made)
