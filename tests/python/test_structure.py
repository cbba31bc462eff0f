"""The shape of the package: who may touch the core, and what the tests may see."""

import ast
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
