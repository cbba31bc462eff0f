"""The blocks of a page of the docs as steps that can be followed: commands, files to write, keys to change, Python.

Only the standard library is used, so that a wheel in an environment of its own can be tried with them.

- A ``console`` block holds commands behind ``$``, each with the lines that it prints; ``...`` stands for any text.
- A ``code-block`` with a caption is a file of that name. ``NAME, changed`` holds sections of a TOML file with the keys to
  change or to add; a section that the file does not have is put at its end.
- A ``python`` block is a program; a ``text`` block behind it is its output.
"""

from __future__ import annotations

import re
import shlex
import shutil
import subprocess
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

BLOCK = re.compile(r"^```(\S+)(?: (\w+))?\n(.*?)^```", re.S | re.M)
CAPTION = re.compile(r":caption: (.*)\n+")
CHANGED = ", changed"


@dataclass(frozen=True)
class Step:
    """``kind`` is command, file, change or python; ``text`` the command or the content, ``lines`` what is printed."""

    kind: str
    text: str
    lines: tuple[str, ...] = ()
    name: str = ""


def _commands(content: str) -> list[Step]:
    parts = re.split(r"^\$ ", content, flags=re.M)
    assert not parts[0], "a block of commands begins with one"
    steps = []
    for part in parts[1:]:
        command, *lines = part.rstrip("\n").split("\n")
        steps.append(Step("command", command, tuple(lines)))
    return steps


def steps(page: str) -> list[Step]:
    """All steps of a page, in order; blocks in other languages, or without a caption, are no steps."""
    found: list[Step] = []
    for language, _, content in BLOCK.findall(page):
        caption = "".join(CAPTION.findall(content)[:1])
        if language == "console":
            found += _commands(content)
        elif language == "{code-block}":
            body = CAPTION.sub("", content, count=1)
            kind = "change" if caption.endswith(CHANGED) else "file"
            found.append(Step(kind, body, name=caption.removesuffix(CHANGED)))
        elif language == "python":
            found.append(Step("python", content))
        elif language == "text":
            found[-1] = Step("python", found[-1].text, tuple(content.rstrip("\n").split("\n")))
    return found


def shown(lines: tuple[str, ...], printed: str) -> bool:
    """Whether the lines are printed, in order; ``...`` stands for any text."""
    parts = [re.escape(part.strip("\n")) for part in "\n".join(lines).split("...")]
    return re.fullmatch(r"\s*" + r"(?s:.*)".join(parts) + r"\s*", printed) is not None


def changed(text: str, sections: str) -> str:
    """A TOML file with the keys of some sections changed or added."""
    for part in re.split(r"^(?=\[)", sections, flags=re.M):
        head, _, keys = part.partition("\n")
        if not head.strip():
            continue
        # A table of an array is the one with its name, or a further one.
        named = re.search(r'^name *= *"[^"]*"', keys, re.M) if head.startswith("[[") else None
        first = f"{head}\n" if named is None else f"{head}\n{named[0]}"
        place = text.find(first)
        if (head.startswith("[[") and named is None) or place < 0:
            text = f"{text.rstrip()}\n\n{part.rstrip()}\n"
            continue
        start = place + len(head) + 1
        following = re.search(r"^\[", text[start:], re.M)
        end = start + following.start() if following else len(text)
        section = text[start:end]
        for line in keys.splitlines():
            key = line.partition("=")[0].strip()
            if key:
                own = re.compile(rf"^{re.escape(key)} *=.*\n", re.M)
                section = own.sub("", section)
                section = f"{line}\n{section}"
        text = text[:start] + section + text[end:]
    return text


def follow(step: Step, ivsid: Callable[[list[str]], str], python: Callable[[str], str]) -> None:
    """Does a step in the working directory; ``ivsid`` and ``python`` return what they print.

    Raises:
        AssertionError: something else is printed than the page shows.
    """
    if step.kind in ("file", "change"):
        path = Path(step.name)
        text = changed(path.read_text(encoding="utf-8"), step.text) if step.kind == "change" else step.text
        path.write_text(text, encoding="utf-8")
        return
    if step.kind == "python":
        printed = python(step.text)
        if not step.lines:
            return
    else:
        words = shlex.split(step.text)
        if words[0] == "ivsid":
            printed = ivsid(words[1:])
        else:
            # Windows would take the bash of its subsystem for Linux before that of the path.
            shell = [shutil.which("bash") or "bash", "-c", step.text]
            printed = subprocess.run(shell, capture_output=True, encoding="utf-8", check=True).stdout
    assert shown(step.lines, printed), f"{step.text}\nshown:\n" + "\n".join(step.lines) + f"\nprinted:\n{printed}"
