"""The how-to pages are followed step by step; code of the other pages runs, and what they name exists."""

import re
import tomllib
from pathlib import Path

import numpy as np
import pytest
from typer.main import get_command

from command_line import run
from ivsid import regression
from ivsid.cli.application import app
from ivsid.programme.scenario import parse_scenario
from ivsid.vehicle import parse_vehicle
from pages_followed import follow_page, ivsid
from ros_bags import bag

ROOT = Path(__file__).resolve().parents[2]
HOWTO = ROOT / "docs" / "howto"
PAGES = [ROOT / "README.md", *sorted(p for p in (ROOT / "docs").rglob("*.md") if "_build" not in p.parts)]
FENCED = re.compile(r"^```(\w+)\n(.*?)^```", re.S | re.M)


def blocks(page: str, language: str) -> list[str]:
    return [content for kind, content in FENCED.findall((ROOT / page).read_text()) if kind == language]


def started(folder: Path) -> None:
    """What the readers of the pages have already: for one of them, a bag."""
    ivsid(["example", str(folder / "run")])
    bag(folder / "run" / "run1.csv", folder / "bag")


@pytest.mark.parametrize(
    "name",
    [
        "read_certificate",
        *(
            pytest.param(n, marks=pytest.mark.nightly)
            for n in ("bound_sensors", "bound_thrust", "choose_manoeuvre", "many_logs", "ros_bag")
        ),
    ],
)
def test_every_step_of_a_page_prints_what_the_page_shows(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    if name == "ros_bag":
        started(tmp_path)
    if name == "many_logs":
        pytest.importorskip("distributed")
    assert follow_page(HOWTO / f"{name}.md") >= 4


def test_every_how_to_page_is_followed():
    assert {p.stem for p in HOWTO.glob("*.md")} == {
        "bound_sensors", "bound_thrust", "choose_manoeuvre", "many_logs", "read_certificate", "ros_bag"
    }  # fmt: skip


def options(command) -> set[str]:
    return {o for p in command.params for o in (*p.opts, *p.secondary_opts)} | {"--help"}


def unknown(text: str) -> list[str]:
    """Commands and options in a text that the command line does not have."""
    program = get_command(app)
    found = []
    for line in re.findall(r"(?:^\$? ?|`)ivsid ([^`\n]*)", text, re.M):
        words = re.sub(r"#.*", "", line).split()
        known = options(program)
        name = next((w for w in words if w in program.commands), None)
        if name:
            known |= options(program.commands[name])
        elif words and re.fullmatch(r"[a-z]+", words[0]):
            found.append(words[0])
        given = [w.strip("[]();:,.|").partition("=")[0] for w in words]
        found += [w for w in given if re.fullmatch(r"--[a-z-]+", w) and w not in known]
    return found


@pytest.mark.parametrize("page", PAGES, ids=lambda p: p.stem)
def test_commands_and_options_that_a_page_names_exist(page):
    assert not unknown(page.read_text())


def test_lost_commands_and_options_are_noticed():
    page = "`ivsid fly boat.toml`, `ivsid identify --wings`\n```\n$ ivsid diagnose a b --tail 3\nivsid thrust T --out X\n```"
    assert unknown(page) == ["fly", "--wings", "--tail"]


NAMED = 'name = "boat"\n[hull]\nmass = 80.0\n'


def read_as_a_file(text: str) -> None:
    """A whole vehicle file, a scenario, or sections of a vehicle file."""
    keys = tomllib.loads(text)
    if "segments" in keys:
        parse_scenario(text, "page.toml")
    else:
        parse_vehicle(text if "name" in keys else NAMED + text, "page.toml")


@pytest.mark.parametrize("page", [p for p in PAGES if "```toml" in p.read_text()], ids=lambda p: p.stem)
def test_files_that_a_page_shows_are_read(page):
    for text in blocks(str(page.relative_to(ROOT)), "toml"):
        read_as_a_file(text)


def test_the_python_of_the_readme_runs(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    ivsid(["example", "."])
    (text,) = blocks("README.md", "python")
    names: dict = {}
    exec(compile(text, "README.md", "exec"), names)
    assert names["r"].guaranteed and names["fit"].guaranteed
    assert names["fit"].parameters["mass.surge"].lower < 85.5 < names["fit"].parameters["mass.surge"].upper


def test_the_rows_of_ones_own_of_the_guide_are_solved():
    (text,) = blocks("docs/guide.md", "python")
    rng = np.random.default_rng(1)
    A = rng.uniform(0.5, 1.5, (40, 3))
    right = A @ [1.0, 2.0, -1.0]
    right[[3, 7]] += 5.0
    from ivsid import IntervalArray

    names = {"regression": regression, "A": IntervalArray(A), "y": IntervalArray(right - 0.1, right + 0.1)}
    exec(compile(text, "guide.md", "exec"), names)
    hull = names["found"].value
    assert (hull.lower <= [1.0, 2.0, -1.0]).all() and (hull.upper >= [1.0, 2.0, -1.0]).all()


def test_the_arithmetic_of_its_page_runs():
    for text in blocks("docs/arithmetic.md", "python"):
        exec(compile(text, "arithmetic.md", "exec"), {})


# Commands of the README that need what no test has: a data set of others.
ELSEWHERE = ("ivsid import", "pip ")


@pytest.mark.nightly
def test_every_command_of_the_readme_does_its_job(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    ivsid(["example", "trip"])
    for name in ("boat.toml", "run1.csv", "run2.csv", "programme.toml"):
        (tmp_path / name).write_text((tmp_path / "trip" / name).read_text())
    (tmp_path / "my_log.csv").write_text((tmp_path / "run1.csv").read_text())
    (tmp_path / "season").mkdir()
    for name in ("run1.csv", "run2.csv"):
        (tmp_path / "season" / name).write_text((tmp_path / name).read_text())
    rng = np.random.default_rng(1)
    still = np.c_[np.arange(6000) / 20, 0.01 * rng.standard_normal((6000, 2))]
    np.savetxt("deck.csv", still, delimiter=",", header="t,ax,r", comments="")
    np.savetxt(
        "bollard.csv",
        [[-100, -60], [-50, -15], [0, 0], [50, 28], [100, 110]],
        delimiter=",",
        header="demand,thrust",
        comments="",
    )
    lines = [line for text in blocks("README.md", "console") for line in text.splitlines() if line.startswith("ivsid ")]
    commands = [re.sub(r"#.*", "", line).split()[1:] for line in lines if not line.startswith(ELSEWHERE)]
    assert len(commands) >= 10
    for words in commands:
        (tmp_path / "boat.toml").write_text((tmp_path / "trip" / "boat.toml").read_text())
        # A file that `ivsid init` proposes stands in a place of its own: it overwrites none.
        more = ["--yes", "--out", f"proposed{len(words)}.toml"] if words[0] == "init" else []
        done = run(*words, *more)
        assert done.returncode == 0, f"{words}\n{done.stdout}{done.stderr}"


@pytest.mark.nightly
def test_the_readme_shows_what_the_first_diagnosis_prints(tmp_path, monkeypatch):
    """Words are the same, and numbers to a hundredth: their last digits are those of a processor."""
    monkeypatch.chdir(tmp_path)
    ivsid(["example", "trip"])
    printed = run("diagnose", "trip/boat.toml", "trip/run1.csv", "trip/run2.csv").stdout.splitlines()
    (shown,) = (text for text in blocks("README.md", "console") if text.startswith("Otter: "))
    number = re.compile(r"-?\d+\.?\d*(?:e-?\d+)?")
    for line in shown.splitlines():
        wanted = line.removesuffix("...").strip()
        beside = [x.strip()[: len(wanted)] if line.endswith("...") else x.strip() for x in printed]
        alike = [x for x in beside if number.sub("0", x).split() == number.sub("0", wanted).split()]
        assert any(
            [float(q) for q in number.findall(x)] == pytest.approx([float(q) for q in number.findall(wanted)], rel=0.01)
            for x in alike
        ), line
