"""Writes LICENSE-THIRD-PARTY: the crates that are compiled into a wheel, with their licences; python -m tests.licences.

MIT, BSD and Apache ask that their texts go with every copy, a compiled one included. Where a crate leaves the choice, its
MIT text is taken. Crates of a build for every platform are listed, also those that one platform leaves out.
"""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[1]
PAGE = ROOT / "LICENSE-THIRD-PARTY"
HEAD = """Crates that are compiled into a wheel of ivsid
==============================================

Written by tests/licences.py (make licences) from the files of each crate. A crate that ships no text of its own is listed
under the licence that its manifest states.
"""
RULE = "-" * 100


def shipped() -> set[tuple[str, str]]:
    """Name and version of every crate whose code a wheel may hold: no macros, no build scripts."""
    command = [
        "cargo",
        "tree",
        "--locked",
        "-p",
        "pyivsid",
        "--edges",
        "normal,no-proc-macro",
        "--target",
        "all",
        "--prefix",
        "none",
        "--format",
    ]
    lines = subprocess.run([*command, "{p}"], cwd=ROOT, capture_output=True, text=True, check=True).stdout.splitlines()
    # A crate that was shown before has "(*)" at its end.
    words = [line.removesuffix(" (*)").split() for line in lines if line]
    return {(w[0], w[1].removeprefix("v")) for w in words if not w[-1].startswith(f"({ROOT}")}


def text_of(package: dict[str, Any]) -> str:
    """The licence text in a crate's folder, MIT before others; empty where it ships none."""
    folder = Path(package["manifest_path"]).parent
    files = sorted(p for p in folder.iterdir() if p.name.upper().startswith(("LICENSE", "LICENCE", "COPYING")))
    chosen = [p for p in files if "MIT" in p.name.upper()] or files
    return "\n\n".join(p.read_text(encoding="utf-8").strip("\n") for p in chosen)


def page() -> str:
    """The whole file: a list, then each text once, with the crates that it covers."""
    command = ["cargo", "metadata", "--locked", "--format-version", "1"]
    made = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True).stdout
    wanted = shipped()
    packages = [p for p in json.loads(made)["packages"] if (p["name"], p["version"]) in wanted]
    rows, texts = [], {}
    for package in sorted(packages, key=lambda p: (p["name"], p["version"])):
        name = f"{package['name']} {package['version']}"
        rows.append(f"{name}: {package['license']} ({', '.join(package['authors']) or 'no author is stated'})")
        text = text_of(package)
        if text:
            # Copies that differ in line breaks alone are one text.
            texts.setdefault(" ".join(text.split()), (text, []))[1].append(name)
    blocks = [f"{RULE}\n{', '.join(names)}\n{RULE}\n\n{text}\n" for text, names in texts.values()]
    return "\n".join([HEAD, *rows, "", *blocks])


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
    sys.stdout.write(f"{PAGE.name}: {len(page())} characters\n")
