"""Names of files, vehicles, thrusters and columns: escaped in pages, kept inside the folder, and never run."""

import ast
import builtins
import re
from pathlib import Path

import numpy as np
import pytest

import ivsid
from command_line import run
from conftest import embedded
from ivsid import IvsidError, export, identify
from ivsid.exports.target import Exported
from ivsid.programme.scenario import parse_scenario
from ivsid.report import page
from ivsid.simulation import compiled, simulate
from ivsid.vehicle import parse_vehicle
from ivsid.workflow.log_files import csv

ROOT = Path(ivsid.__file__).parent
EVIL = "<script>alert(7)</script>\"'><img src=x onerror=alert(8)>{{7*7}}"
TARGETS = ("gz", "vrx", "mss", "pvs", "stonefish", "yaml")


def named(name, thruster="port"):
    """The swan's file with another name, and another name of its first thruster."""
    text = embedded("swan.toml")
    text = re.sub(r'name = "[^"]*"', lambda _: "name = " + repr_of(name), text, count=1)
    return text.replace('name = "port"', "name = " + repr_of(thruster))


def repr_of(word):
    return '"' + word.replace("\\", "\\\\").replace('"', '\\"') + '"'


@pytest.fixture(scope="module")
def short():
    return parse_scenario(embedded("swan_train.toml").replace("duration = 300.0", "duration = 20.0", 1), "train.toml")


def test_pages_show_names_and_run_none(short, tmp_path):
    """Every page of a fit, a validation and a simulation with a name that is a script."""
    vehicle = parse_vehicle(named(EVIL), "swan.toml")
    made = simulate(vehicle, short, 1)
    log = tmp_path / "run<script>alert(6)</script>.csv".replace("/", "")
    (tmp_path / "boat.toml").write_text(vehicle.text)
    log.write_text(csv(made.t, {**made.columns, "<script>alert(5)<b>": made.columns["u"]}))
    for words in (
        ("identify", tmp_path / "boat.toml", log, "--out", tmp_path / "fit"),
        ("validate", tmp_path / "fit", log, "--out", tmp_path / "check"),
        ("verify", tmp_path / "fit", log, "--out", tmp_path / "proof"),
    ):
        done = run(*words)
        assert done.returncode == 0, done.stderr
        text = (Path(words[-1]) / "report.html").read_text()
        assert "alert(" in text, "the names are shown"
        for raw in ("<script>alert", "<img src=x", "onerror=alert(8)>{{", "alert(5)<b>"):
            assert raw not in text, raw
        assert "{{49}}" not in text and "&lt;script&gt;alert" in text
        for drawing in Path(words[-1]).glob("*.svg"):
            assert "<script>alert" not in drawing.read_text()
    assert sorted(p.name for p in tmp_path.iterdir()) == sorted(["boat.toml", log.name, "fit", "check", "proof"])


@pytest.mark.parametrize(
    "name",
    ["../../evil", "/tmp/evil", "..", "a/b", "C:\\\\evil", "con", "-rf", "evil.toml", "$(id)", "`id`", "a\\u202eb"],
)
@pytest.mark.parametrize("target", [TARGETS[0], *(pytest.param(t, marks=pytest.mark.nightly) for t in TARGETS[1:])])
def test_exports_stay_in_their_folder(name, target, short, tmp_path):
    try:
        vehicle = parse_vehicle(named(name.replace("\\u202e", "\u202e")), "swan.toml")
    except IvsidError:
        return
    fit = identify(vehicle, log_of(vehicle, short), examine=False)
    made = export(fit, target)
    assert (
        Path(made.file).name == made.file
        and not made.file.startswith((".", "-"))
        and "/" not in made.file
        and "\\" not in made.file
    )
    inside = tmp_path / "inside"
    made.save(inside)
    assert [p.name for p in inside.iterdir()] == [made.file] and [p.name for p in tmp_path.iterdir()] == ["inside"]


LOGS = {}


def log_of(vehicle, scenario):
    """One log for all names: no name stands in it."""
    if "log" not in LOGS:
        made = simulate(parse_vehicle(embedded("swan.toml"), "swan.toml"), scenario, 1)
        from ivsid.log import Log

        LOGS["log"] = Log("run.csv", "0" * 64, made.t, made.columns)
    return LOGS["log"]


def test_an_export_that_names_another_folder_is_refused(tmp_path):
    with pytest.raises(IvsidError, match="plain name"):
        Exported("yaml", "../evil.yaml", "text", ()).save(tmp_path / "inside")
    assert not (tmp_path / "evil.yaml").exists()


# Functions that make a program or an object of any kind of a text or of bytes, and modules that exist for that.
RUNS = {"exec", "eval", "compile", "__import__"}
LOADS = {
    "pickle",
    "cPickle",
    "_pickle",
    "marshal",
    "shelve",
    "dill",
    "cloudpickle",
    "joblib",
    "runpy",
    "code",
    "codeop",
    "imp",
}
# The user's own file of effects, which ``--own-effects`` names, and formulas that this package writes itself.
ALLOWED = {
    ("effects/registration.py", "exec"),
    ("effects/registration.py", "compile"),
    ("simulation/compiled.py", "exec"),
    ("simulation/compiled.py", "compile"),
}


def test_nothing_loads_a_pickle_or_runs_the_text_of_a_file():
    """By the syntax of every file of the package."""
    found, modules, tolerant = set(), set(), set()
    for path in ROOT.rglob("*.py"):
        where = path.relative_to(ROOT).as_posix()
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Call):
                name = node.func.id if isinstance(node.func, ast.Name) else ""
                method = node.func.attr if isinstance(node.func, ast.Attribute) else ""
                if name in RUNS:
                    found.add((where, name))
                owner = (
                    node.func.value.id
                    if isinstance(node.func, ast.Attribute) and isinstance(node.func.value, ast.Name)
                    else ""
                )
                if (owner, method) in {
                    ("np", "load"),
                    ("np", "fromfile"),
                    ("yaml", "load"),
                    ("os", "system"),
                    ("os", "popen"),
                    ("builtins", "eval"),
                    ("builtins", "exec"),
                }:
                    found.add((where, f"{owner}.{method}"))
                tolerant |= {
                    where
                    for k in node.keywords
                    if k.arg in ("allow_pickle", "shell")
                    and not (isinstance(k.value, ast.Constant) and k.value.value is False)
                }
            if isinstance(node, ast.Import):
                modules |= {(where, a.name.split(".")[0]) for a in node.names}
            if isinstance(node, ast.ImportFrom) and node.module:
                modules.add((where, node.module.split(".")[0]))
    assert found == ALLOWED
    assert not {m for m in modules if m[1] in LOADS | {"subprocess"}} and not tolerant


def test_the_formulas_that_are_compiled_hold_no_word_of_a_file(short, monkeypatch):
    """Names that are programs: of the vehicle, and of a thruster."""
    seen = []
    monkeypatch.setattr(
        compiled,
        "compile",
        lambda source, *words: (seen.append(source), builtins.compile(source, *words))[1],
        raising=False,
    )
    word = "zz9); __import__('os').abort(); f("
    made = simulate(parse_vehicle(named(word, "zz9"), "swan.toml"), short, 1)
    assert made.t.size > 100 and np.isfinite(made.exact["u"]).all()
    # A name of a thruster is a word of letters and digits, and even that stays outside.
    with pytest.raises(IvsidError, match="should match pattern"):
        parse_vehicle(named("boat", word), "swan.toml")
    assert seen and not any("zz9" in s or "import" in s or "abort" in s for s in seen)


def test_a_page_escapes_whatever_a_part_holds():
    """Each kind of part that a section can hold, and the first screen."""
    card = page.Card(EVIL, EVIL, ((EVIL, EVIL),), "link")
    first = page.First(EVIL, "good", EVIL, (card,), (EVIL,), (EVIL,))
    parts = (
        page.text(EVIL),
        page.code(EVIL),
        page.bullets([EVIL]),
        page.heading(EVIL, "link"),
        page.table([EVIL], [[EVIL]], EVIL),
        page.details(EVIL, [page.text(EVIL)]),
    )
    record = {"inputs": [{"name": EVIL, "sha256": EVIL}]}
    text = page.html(page.Report(EVIL, EVIL, record, (page.Section(EVIL, parts),), first=first))
    assert text.count("&lt;script&gt;alert(7)") > 10
    for raw in ("<script>alert", "<img src=x", "49"):
        assert raw not in re.sub(
            r"<style>.*?</style>|<script>.*?</script>|base64,[A-Za-z0-9+/=]*", "", text, flags=re.DOTALL
        ), raw
