"""The shell: help, misspelt names, completion, and the summary on the terminal."""

import json
import os
import re
import subprocess
from pathlib import Path

import pytest

from command_line import COMMAND, run, run_process, shell_files
from ivsid import workflow
from ivsid.cli.application import program
from ivsid.cli.arguments import SHIPPED
from ivsid.effects import EFFECTS
from ivsid.identification import METHODS, read_identification
from ivsid.log import read_log
from ivsid.report.page import Report


@pytest.fixture(scope="module")
def place(tmp_path_factory, twin):
    return shell_files(tmp_path_factory.mktemp("shell"), twin)


def shown(*words):
    """The help on one line: boxes and breaks taken out."""
    made = run(*words)
    return " ".join(re.sub(r"[│╭╮╰╯─]", " ", made.stdout).split())


@pytest.mark.parametrize("name", ["", *program().commands])
def test_every_bracket_of_the_source_stands_in_the_help(name):
    command = program().commands[name] if name else program()
    sources = [command.help, *(p.help for p in command.params if getattr(p, "help", None))]
    # Brackets are escaped for Rich by one backslash, which the help does not show.
    words = [w.replace("\\", "") for text in sources for w in re.findall(r"\\?\[[^\]]*\]", text)]
    text = shown(*([name] if name else []), "--help")
    for word in words:
        assert word in text, word
    assert not re.search(r" , | \.( |$)", text), "a word is missing before a stop"


def test_brackets_were_worth_a_test():
    found = "".join(shown(name, "--help") for name in ("identify", "diagnose"))
    assert "[s]" in found and "[model]" in found


def test_the_help_is_grouped_by_task_and_each_command_has_an_example_that_parses():
    listed = run("--help").stdout
    assert len(re.findall(r"╭─ (?!Options|Commands)", listed)) >= 4 and "╭─ Commands" not in listed
    for name, command in program().commands.items():
        example = re.search(r"Example: ivsid (\S+) ?(.*)", command.help)
        assert example and example[1] == name, name
        words = example[2].split()
        context = command.make_context(name, [*words], resilient_parsing=True)
        assert not context.args, name
        flags = {o for p in command.params for o in p.opts}
        assert {w for w in words if w.startswith("-")} <= flags, name


def test_the_help_of_every_vehicle_names_the_shipped_ones():
    from ivsid.files.shipped import shipped_names

    assert list(SHIPPED) == shipped_names()
    for name, command in program().commands.items():
        for p in command.params:
            if p.metavar == "VEHICLE":
                assert all(v in p.help for v in SHIPPED), name


@pytest.mark.parametrize("words", [(), ("identify",), ("import",)])
def test_nothing_at_all_shows_the_help(words):
    made = run(*words)
    assert made.returncode == 2 and "Usage" in made.stdout and made.stderr == ""


def test_exit_codes_stand_in_the_help():
    text = shown("--help")
    for code in ("0 done", "1 internal fault", "2 wrong usage or unusable input", "130 interrupted"):
        assert code in text


MISSPELT = {
    "effect": (("simulate", "boat.toml", "plan.toml", "--effect", "drag.surge.liner=4"), "drag.surge.linear"),
    "part": (("simulate", "boat.toml", "plan.toml", "--effect", "thruster.lag.prot=1"), "did you mean port?"),
    "method": (("identify", "boat.toml", "run.csv", "--method", "feasable"), "did you mean feasible?"),
    "bias": (("identify", "boat.toml", "run.csv", "--bias", "smaple"), "did you mean sample?"),
    "rows": (("identify", "boat.toml", "run.csv", "--rows", "integrals"), "did you mean integral?"),
    "form": (("identify", "boat.toml", "run.csv", "--form", "totl"), "did you mean total?"),
    "command": (("diagnos",), "Did you mean 'diagnose'"),
    "option": (("identify", "boat.toml", "run.csv", "--metod", "qr"), "--method"),
    "vehicle": (("identify", "oter", "run.csv"), "did you mean otter?"),
    "scenario": (("simulate", "otter", "oter"), "did you mean otter?"),
    "format": (("simulate", "boat.toml", "plan.toml", "--format", "parket"), "did you mean parquet?"),
    "channel": (("allan", "run.csv", "--columns", "axx"), "did you mean ax?"),
    "unit": (
        ("thrust", "run.csv", "--thrust-column", "u", "--demand-column", "ax", "--unit", "kgff"),
        "did you mean kgf or gf?",
    ),
    "set": (("import", "cse", "."), "did you mean cse1?"),
}


@pytest.mark.parametrize("kind", MISSPELT)
def test_a_misspelt_name_gets_its_neighbour(place, monkeypatch, kind):
    monkeypatch.chdir(place)
    words, hint = MISSPELT[kind]
    made = run(*words, *(() if kind == "command" else ("--out", place / "none")))
    assert made.returncode == 2 and hint in made.stderr, made.stderr
    assert len(made.stderr.splitlines()) == 1 and not (place / "none").exists()


def test_names_that_are_close_to_nothing_get_the_whole_list(place):
    made = run("identify", place / "boat.toml", place / "run.csv", "--method", "magic", "--out", place / "none")
    assert all(m in made.stderr for m in METHODS) and "did you mean" not in made.stderr


def test_a_misspelt_column_gets_its_neighbour(place):
    text = (place / "run.csv").read_text().replace("demand_port", "demnd_port", 1)
    (place / "column.csv").write_text(text)
    made = run("identify", place / "boat.toml", place / "column.csv", "--out", place / "none")
    assert made.returncode == 2 and "for demand_port, did you mean demnd_port?" in made.stderr


def summary_of(page: str) -> str:
    """The page's first sentences."""
    from html import unescape

    return unescape(re.search(r'<p class="(?:sign )?verdict"[^>]*>(.*?)</p>', page, re.S)[1])


def test_the_terminal_begins_as_the_page(place, monkeypatch, tmp_path):
    monkeypatch.chdir(place)
    Path("table.csv").write_text("PWM (us),Force (Kg f)\n1100,-2\n1300,-1\n1480,0\n1520,0\n1700,1.2\n1900,2.4\n")
    for words in (
        ("simulate", "boat.toml", "plan.toml"),
        ("allan", "run.csv", "--columns", "ax"),
        ("thrust", "table.csv"),
        ("identify", "boat.toml", "run.csv"),
        ("verify", "fit", "run.csv"),
        ("validate", "fit", "run.csv"),
    ):
        out = tmp_path / words[0]
        made = run(*words, "--out", out)
        assert made.returncode == 0, made.stderr
        said = made.stdout.splitlines()
        assert said[0] == summary_of((out / "report.html").read_text()), words
        assert said.count(said[0]) == 1


# A proposal is a vehicle file, without a page: test_init.py.
@pytest.mark.parametrize("name", [n for n in program().commands if n != "init"])
def test_every_command_begins_with_the_summary_and_prints_its_record(name, monkeypatch, tmp_path):
    """Each command by its own example; the work behind it is replaced."""
    monkeypatch.chdir(tmp_path)
    made = Report(
        "Title",
        "The finding, in a sentence.",
        {"command": name, "bound": 0.1},
        files={"truth.json": "{}"},
        lines=("  a number",),
    )
    for work in workflow.__all__:
        monkeypatch.setattr(workflow, work, lambda *_, **__: made)
    words = re.search(r"Example: ivsid (.*)", program().commands[name].help)[1].split()
    folder = words[words.index("--out") + 1] if "--out" in words else words[1] if name == "example" else f"ivsid-{name}"
    said = run(*words)
    assert said.returncode == 0, said.stderr
    assert said.stdout.splitlines()[:2] == ["The finding, in a sentence.", "  a number"]
    assert summary_of(Path(folder, "report.html").read_text()) == said.stdout.splitlines()[0]
    said = run(*words, "--json")
    assert said.stderr == "" and said.stdout == Path(folder, "result.json").read_text()
    assert json.loads(said.stdout) == made.record


def test_summaries_do_not_stand_in_the_lines_below_them(place):
    from ivsid.workflow.identification import identification_report

    fit = read_identification(place / "fit")
    report = identification_report(fit, read_log(place / "run.csv", fit.vehicle.log))
    assert report.summary not in report.lines and "guaranteed under the stated assumptions" in report.summary


# Nightly: without steps the output is that of the JSON test above.
@pytest.mark.parametrize("words", [(), pytest.param(("--json",), marks=pytest.mark.nightly)])
def test_a_command_tells_its_steps_and_json_does_not(place, monkeypatch, words):
    monkeypatch.setattr("ivsid.cli.progress.EVERY", 0.002)
    made = run("allan", place / "run.csv", "--columns", "u,r", "--out", place / "told", *words)
    assert made.returncode == 0
    assert (made.stderr == "") == bool(words)
    assert words or re.search(r"^ivsid allan: channels \d of \d: \w+, 0:0\d", made.stderr, re.M)


def complete(line: str) -> list[str]:
    """What a shell gets for the last word of a line."""
    words = line.split(" ")
    made = subprocess.run(
        [COMMAND[0], "-c", "import sys; sys.argv[0] = 'ivsid'; from ivsid.cli import main; main()"],
        capture_output=True,
        text=True,
        env={
            **os.environ,
            "_IVSID_COMPLETE": "complete_bash",
            "COMP_WORDS": line,
            "COMP_CWORD": str(len(words) - 1),
        },
        timeout=60,
        check=False,
    )
    return made.stdout.split()


def test_the_shell_completes_vehicles_effects_and_methods():
    assert "swan" in complete("ivsid identify sw")
    assert complete("ivsid simulate otter vec") == ["vectored_rov"]
    assert complete("ivsid identify a b --method hansen") == ["hansen-bliek-rohn"]
    found = complete("ivsid simulate otter otter --effect drag.surge")
    assert found and {*found} == {f"{e}=" for e in EFFECTS if e.startswith("drag.surge")}
    assert {"identify", "import", "isolability"} <= {*complete("ivsid i")}


def test_completion_of_a_vehicle_takes_files_too(tmp_path, monkeypatch):
    from ivsid.cli import completion

    monkeypatch.chdir(tmp_path)
    (tmp_path / "otto.toml").write_text("")
    (tmp_path / "ottolog.csv").write_text("")
    (tmp_path / "otters").mkdir()
    assert completion.vehicles("ott") == ["otter", "otters/", "otto.toml"]


def test_completion_can_be_installed(monkeypatch):
    # Whatever the shell of the test is, the program writes the script of the one that is named.
    monkeypatch.setenv("_TYPER_COMPLETE_TEST_DISABLE_SHELL_DETECTION", "1")
    made = run_process("--show-completion", "bash")
    assert made.returncode == 0 and "complete -o default -F" in made.stdout and "COMP_WORDS" in made.stdout
    assert "--install-completion" in shown("--help")
