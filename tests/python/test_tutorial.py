"""The commands of docs/tutorial.md print what the page shows, in order."""

import re
import shlex
import subprocess
from dataclasses import dataclass
from pathlib import Path

import pytest

from command_line import run

PAGE = Path(__file__).resolve().parents[2] / "docs" / "tutorial.md"
BLOCK = re.compile(r"^```(\w+)\n(.*?)^```", re.S | re.M)
# Steps of a second or two.
QUICK = ("example", "head", "cat", "init", "identify mine.toml")


@dataclass(frozen=True)
class Step:
    """A command and the lines that the page shows, or a section of a file that the page has its reader write."""

    command: str
    lines: tuple[str, ...]
    section: str = ""


def steps() -> list[Step]:
    found = []
    for language, content in BLOCK.findall(PAGE.read_text()):
        if language == "toml":
            found.append(Step("", (), content))
        else:
            command, *lines = content.rstrip("\n").split("\n")
            assert command.startswith("$ ")
            found.append(Step(command.removeprefix("$ "), tuple(lines)))
    return found


def shown(lines: tuple[str, ...], printed: str) -> bool:
    """Whether the lines are printed, in order; ``...`` stands for any text."""
    parts = [re.escape(part.strip("\n")) for part in "\n".join(lines).split("...")]
    return re.fullmatch(r"\s*" + r"(?s:.*)".join(parts) + r"\s*", printed) is not None


def follow(step: Step) -> None:
    """Does a step in the working directory."""
    if step.section:
        head, _, keys = step.section.partition("\n")
        text = Path("trip/boat.toml").read_text()
        assert text.count(head) == 1
        Path("fixed.toml").write_text(text.replace(head, f"{head}\n{keys}"))
        return
    words = shlex.split(step.command)
    done = run(*words[1:]) if words[0] == "ivsid" else subprocess.run(words, capture_output=True, text=True, check=True)
    printed = done.stdout or done.stderr
    assert shown(step.lines, printed), f"{step.command}\n{printed}"


def test_ten_steps_stand_in_the_page():
    text = PAGE.read_text()
    assert [int(n) for n in re.findall(r"^## (\d+)\.", text, re.M)] == list(range(1, 11))
    commands = [s.command for s in steps() if s.command]
    assert len(commands) == 10
    for name in ("example", "diagnose", "identify", "verify", "init"):
        assert any(c.startswith(f"ivsid {name} ") for c in commands)


def test_lines_that_are_not_printed_are_noticed():
    assert shown(("a", "...", "c d ..."), "a\nb\nb\nc d e f\n")
    assert not shown(("a", "c"), "a\nb\nc\n") and not shown(("x", "..."), "a\n") and not shown(("a",), "a\nb\n")


def test_the_quick_steps_print_what_the_page_shows(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    quick = [s for s in steps() if s.command.removeprefix("ivsid ").startswith(QUICK)]
    assert len(quick) == 6
    for step in quick:
        follow(step)


@pytest.mark.nightly
def test_all_steps_print_what_the_page_shows(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    for step in steps():
        follow(step)
    # What the text says beside its blocks.
    import json

    truth = json.loads(Path("trip/truth/truth.json").read_text())["numbers"]
    (finding,) = json.loads(Path("found/result.json").read_text())["findings"]
    assert finding["effect"] == "sensor.velocity.lever_arm"
    assert all(finding["parameters"][k]["lower"] <= v <= finding["parameters"][k]["upper"] for k, v in truth.items())
    mass = json.loads(Path("fit/result.json").read_text())["parameters"]["mass.surge"]
    assert mass["lower"] <= 85.5 <= mass["upper"]
