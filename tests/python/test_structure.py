"""The shape of the package: who may touch the core, and what the tests may see."""

import ast
import re
import tomllib
from pathlib import Path

import ivsid

PACKAGE = Path(ivsid.__file__).parent
DOORS = {"__init__.py", "intervals/array.py", "linear/filters.py", "linear/linalg.py", "linear/regression.py"}


def imports(path: Path) -> set[str]:
    found = set()
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            found |= {a.name for a in node.names}
        elif isinstance(node, ast.ImportFrom):
            found |= {f"{node.module}.{a.name}" for a in node.names}
    return found


def test_only_the_doors_import_the_core():
    users = {p.relative_to(PACKAGE).as_posix() for p in PACKAGE.rglob("*.py") if any("_core" in i for i in imports(p))}
    assert users == DOORS


def test_only_figures_draws_and_only_the_edge_reads_and_writes():
    for path in PACKAGE.rglob("*.py"):
        names = imports(path)
        if "figures" not in path.parts:
            assert not any(n.startswith("matplotlib") for n in names), path
        if "cli" not in path.parts:
            assert not any(n.startswith(("typer", "click", "rich")) for n in names), path
        assert "print(" not in path.read_text(), path


def test_files_stay_readable():
    for path in PACKAGE.rglob("*.py"):
        assert len(path.read_text().splitlines()) <= 560, f"{path} has more than one subject"


def test_every_command_of_the_makefile_has_a_recipe():
    text = (PACKAGE.parents[1] / "Makefile").read_text()
    named = re.search(r"^\.PHONY: ((?:.*\\\n)*.*)", text, re.M)
    assert named
    phony = set(named.group(1).replace("\\", " ").split())
    assert phony == set(re.findall(r"^([a-z][a-z0-9-]*):", text, re.M))


def test_no_chapter_holds_one_file():
    for folder in (p.parent for p in PACKAGE.rglob("__init__.py")):
        inside = [p for p in folder.iterdir() if p.suffix == ".py" or (p / "__init__.py").exists()]
        assert len(inside) > 2, folder


def test_every_chapter_stands_in_the_layers_contract():
    contract = tomllib.loads((PACKAGE.parents[1] / "pyproject.toml").read_text())["tool"]["importlinter"]["contracts"][
        0
    ]
    assert len(contract["layers"]) <= 10
    listed = {name.strip().removeprefix("ivsid.") for row in contract["layers"] for name in row.split("|")}
    assert listed == {p.parent.name for p in PACKAGE.glob("*/__init__.py")}
