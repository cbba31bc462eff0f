"""The commands of docs/tutorial.md print what the page shows, in order."""

import json
import re
from pathlib import Path

import pytest
from tests.page_steps import changed, shown, steps

from pages_followed import follow_page

PAGE = Path(__file__).resolve().parents[2] / "docs" / "tutorial.md"
# Steps of a second or two.
QUICK = ("ivsid example", "head", "cat", "ivsid init", "ivsid identify mine.toml")


def test_ten_steps_stand_in_the_page():
    text = PAGE.read_text()
    assert [int(n) for n in re.findall(r"^## (\d+)\.", text, re.M)] == list(range(1, 11))
    found = steps(text)
    commands = [s.text for s in found if s.kind == "command"]
    assert len(commands) == 11 and [s.kind for s in found].count("change") == 1
    for name in ("example", "diagnose", "identify", "verify", "init"):
        assert any(c.startswith(f"ivsid {name} ") for c in commands)


def test_lines_that_are_not_printed_are_noticed():
    assert shown(("a", "...", "c d ..."), "a\nb\nb\nc d e f\n")
    assert not shown(("a", "c"), "a\nb\nc\n") and not shown(("x", "..."), "a\n") and not shown(("a",), "a\nb\n")


def test_keys_are_changed_in_their_section_and_sections_are_added():
    text = "[a]\nx = 1\n[b]\nx = 2\ny = 3\n"
    assert changed(text, "[b]\nx = 9\nz = 4\n[c]\nw = 5\n") == "[a]\nx = 1\n[b]\nz = 4\nx = 9\ny = 3\n\n[c]\nw = 5\n"
    both = '[[t]]\nname = "a"\nx = 1\n[[t]]\nname = "b"\nx = 2\n'
    assert changed(both, '[[t]]\nname = "b"\nx = 3\n') == '[[t]]\nname = "a"\nx = 1\n[[t]]\nx = 3\nname = "b"\n'
    assert changed("[[t]]\nn = 1\n", "[[t]]\nn = 2\n") == "[[t]]\nn = 1\n\n[[t]]\nn = 2\n"


def test_the_quick_steps_print_what_the_page_shows(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert follow_page(PAGE, lambda step: step.text.startswith(QUICK)) == 6


@pytest.mark.nightly
def test_all_steps_print_what_the_page_shows(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    assert follow_page(PAGE) == 12
    # What the text says beside its blocks.
    truth = json.loads(Path("trip/truth/truth.json").read_text())["numbers"]
    (finding,) = json.loads(Path("found/result.json").read_text())["findings"]
    assert finding["effect"] == "sensor.velocity.lever_arm"
    assert all(finding["parameters"][k]["lower"] <= v <= finding["parameters"][k]["upper"] for k, v in truth.items())
    mass = json.loads(Path("fit/result.json").read_text())["parameters"]["mass.surge"]
    assert mass["lower"] <= 85.5 <= mass["upper"]
