"""The shell: help, misspelt names, files in another order, progress, completion, and the summary on the terminal."""

import io
import json
import os
import pty
import re
import subprocess
import time
from pathlib import Path

import pytest

from command_line import COMMAND, run, run_process
from conftest import embedded
from ivsid import workflow
from ivsid.cli import recognition
from ivsid.cli.application import program
from ivsid.cli.arguments import SHIPPED
from ivsid.cli.progress import Watch, lines
from ivsid.effects import EFFECTS
from ivsid.identification import METHODS, read_identification
from ivsid.log import read_log
from ivsid.report.page import Report
from ivsid.workflow.log_files import csv as as_csv


@pytest.fixture(scope="module")
def place(tmp_path_factory, twin):
    folder = tmp_path_factory.mktemp("shell")
    (folder / "boat.toml").write_text(embedded("swan.toml"))
    (folder / "plan.toml").write_text(embedded("swan_train.toml").replace("duration = 300.0", "duration = 20.0", 1))
    (folder / "run.csv").write_text(as_csv(twin.t, twin.columns))
    made = run("identify", folder / "boat.toml", folder / "run.csv", "--out", folder / "fit")
    assert made.returncode == 0, made.stderr
    return folder


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


def test_kinds_of_files_are_known_by_their_content(place, tmp_path):
    for name in ("boat.toml", "plan.toml", "run.csv"):
        (tmp_path / name.rpartition(".")[0]).write_bytes((place / name).read_bytes())
    assert recognition.kinds(tmp_path / "boat") == {recognition.VEHICLE}
    assert recognition.kinds(tmp_path / "plan") == {recognition.SCENARIO}
    assert recognition.kinds(tmp_path / "run") == {recognition.LOG}
    assert recognition.kinds(place / "fit") == recognition.kinds(place / "fit" / "result.json") == {recognition.FIT}
    assert recognition.kinds("otter") == {recognition.VEHICLE, recognition.SCENARIO}
    assert recognition.kinds("swan") == {recognition.VEHICLE}
    (tmp_path / "broken.toml").write_text("[hull\nmass = 1")
    assert recognition.kinds(tmp_path / "broken.toml") == recognition.kinds(tmp_path / "nothing") == frozenset()
    (tmp_path / "other").mkdir()
    (tmp_path / "other" / "result.json").write_text(json.dumps({"command": "simulate"}))
    assert recognition.kinds(tmp_path / "other") == {recognition.RESULT, recognition.LOG}


def test_swapped_files_are_put_right_and_named(place):
    straight = (place / "fit" / "result.json").read_bytes()
    swapped = run("identify", place / "run.csv", place / "boat.toml", "--out", place / "swapped")
    assert swapped.returncode == 0
    assert swapped.stderr == (
        f"ivsid: taken as ivsid identify {place / 'boat.toml'} {place / 'run.csv'}, by the content of the files\n"
    )
    assert (place / "swapped" / "result.json").read_bytes() == straight
    again = run("verify", place / "run.csv", place / "fit", "--out", place / "proved", "--json")
    assert again.returncode == 0 and json.loads(again.stdout)["status"] == "proved"


def test_two_logs_keep_their_order():
    vehicle, log = frozenset({recognition.VEHICLE}), frozenset({recognition.LOG})
    needed = (vehicle, log, log)
    assert recognition.in_order((log, log, vehicle), needed) == (2, 0, 1)
    assert recognition.in_order((log, vehicle, log), needed) == (1, 0, 2)
    assert recognition.in_order((log, log, log), needed) is None
    assert recognition.in_order((vehicle, frozenset(), log), needed) is None


WRONG = {
    ("identify", "run.csv"): ("Missing argument VEHICLE", "needs a vehicle file and a log", "run.csv is a log"),
    ("identify", "boat.toml"): ("Missing argument LOG", "boat.toml is a vehicle file"),
    ("identify", "--json"): ("Missing argument VEHICLE", "nothing was given"),
    ("identify", "run.csv", "run.csv"): ("needs a vehicle file and a log", "run.csv is a log"),
    ("diagnose", "boat.toml", "run.csv"): ("Missing argument TEST", "another log"),
    ("diagnose", "run.csv", "run.csv"): ("Missing argument VEHICLE",),
    ("validate", "boat.toml", "run.csv"): (
        "needs the result of ivsid identify and a log",
        "boat.toml is a vehicle file",
    ),
    ("allan", "boat.toml"): ("needs a static recording", "boat.toml is a vehicle file"),
    ("thrust", "fit"): ("needs a bollard-pull table", "fit is the result of ivsid identify"),
    ("simulate", "boat.toml", "run.csv"): ("needs a vehicle file and a scenario", "run.csv is a log"),
    ("import", "cse1"): ("Missing argument DIR", "needs SET and DIR", "cse1 was given"),
}


@pytest.mark.parametrize("words", WRONG, ids=" ".join)
def test_wrong_files_get_one_sentence(place, monkeypatch, words):
    monkeypatch.chdir(place)
    made = run(*words, "--out", "none")
    assert made.returncode == 2 and made.stdout == "" and len(made.stderr.splitlines()) == 1
    for part in WRONG[words]:
        assert part in made.stderr, made.stderr
    assert not Path("none").exists()


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


def test_a_pipe_may_be_any_file(tmp_path):
    os.mkfifo(tmp_path / "pipe")
    assert recognition.kinds(tmp_path / "pipe") == frozenset()


class Clock:
    def __init__(self):
        self.now = 0.0

    def __call__(self):
        return self.now


def test_time_left_is_the_rest_of_a_counted_step():
    clock = Clock()
    watch = Watch("diagnose", clock)
    watch("fitting the model")
    clock.now = 70.0
    assert watch.words() == "diagnose: fitting the model, 1:10"
    watch("null logs 0 of 400")
    assert watch.words() == "diagnose: null logs 0 of 400, 1:10"
    clock.now = 90.0
    watch("null logs 100 of 400")
    # A hundred in twenty seconds: three hundred are left.
    assert watch.words() == "diagnose: null logs 100 of 400, 1:30, about 1:00 left in this step"
    clock.now = 100.0
    assert watch.words() == "diagnose: null logs 100 of 400, 1:40, about 0:50 left in this step"
    watch("null logs 300 of 400: last")
    assert watch.words() == "diagnose: null logs 300 of 400: last, 1:40, about 0:10 left in this step"
    # A second count of the same words begins anew.
    watch("null logs 0 of 400")
    assert "left" not in watch.words()
    clock.now = 4000.0
    watch("drawing")
    assert watch.words() == "diagnose: drawing, 1:06:40"


def test_lines_come_at_their_rate_and_end_with_the_work():
    stream, watch = io.StringIO(), Watch("verify")
    watch("certificates 1 of 9")
    with lines(watch, stream, 0.05):
        time.sleep(0.28)
    said = stream.getvalue().splitlines()
    assert 2 <= len(said) <= 6 and all(s.startswith("ivsid verify: certificates 1 of 9, 0:0") for s in said)
    time.sleep(0.12)
    assert stream.getvalue().splitlines() == said
    quick = io.StringIO()
    with lines(watch, quick, 30.0):
        pass
    assert quick.getvalue() == ""


SLOW = """
import time
from ivsid.cli import progress
progress.EVERY = 0.1
with progress.shown("thrust", quiet=False) as told:
    for k in range(5):
        told(f"pieces {k} of 5")
        time.sleep(0.15)
print("done")
"""


def test_a_pipe_gets_plain_lines():
    made = subprocess.run([COMMAND[0], "-c", SLOW], capture_output=True, text=True, timeout=60, check=False)
    said = made.stderr.splitlines()
    assert made.returncode == 0 and made.stdout == "done\n"
    assert len(said) >= 3 and all(re.match(r"ivsid thrust: pieces \d of 5, 0:0\d", s) for s in said), said
    assert "\x1b" not in made.stderr and any("left in this step" in s for s in said)


def test_a_terminal_gets_a_line_that_changes_and_goes():
    reader, writer = pty.openpty()
    with subprocess.Popen(
        [COMMAND[0], "-c", SLOW],
        stdout=subprocess.PIPE,
        stderr=writer,
        env={**os.environ, "TERM": "xterm", "COLUMNS": "120"},
    ) as process:
        os.close(writer)
        said = b""
        while True:
            try:
                part = os.read(reader, 4096)
            except OSError:
                break
            if not part:
                break
            said += part
        out = process.stdout.read()
    os.close(reader)
    assert process.returncode == 0 and out == b"done\n"
    assert b"thrust: pieces 3 of 5" in said and b"left in this step" in said and b"\x1b[2K" in said


@pytest.mark.parametrize("words", [(), ("--json",)])
def test_a_command_tells_its_steps_and_json_does_not(place, monkeypatch, words):
    monkeypatch.setattr("ivsid.cli.progress.EVERY", 0.002)
    made = run("allan", place / "run.csv", "--out", place / "told", *words)
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
