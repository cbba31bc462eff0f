"""Folders of results under faults: generations of files, and what a reader sees of them."""

import os

import pytest

NAMES = [*(f"figure_{k}.png" for k in range(9)), "result.json", "report.html"]
posix = pytest.mark.skipif(os.name != "posix", reason="signals, locks and limits of POSIX")


def content(mark, size=40_000):
    """Files whose bytes name their generation, each with a length of its own."""
    return {n: f"{mark} {n}\n".encode() * (1 + (size + 997 * k) // 20) for k, n in enumerate(NAMES)}


def seen(folder):
    """The files that a reader sees: all but what the writer hides."""
    return {
        str(p.relative_to(folder)): p.read_bytes() for p in folder.rglob("*") if p.is_file() and ".ivsid-" not in str(p)
    }


def leftovers(folder):
    return sorted(p.name for p in folder.rglob(".*"))


def whole_ones(folder):
    """Generations of the files in a folder; a file that is not whole fails."""
    found = {}
    for name, data in seen(folder).items():
        mark = data.split(b" " + name.encode())[0].decode()
        assert data == content(mark)[name], f"{name} is half written"
        found[name] = mark
    return found
