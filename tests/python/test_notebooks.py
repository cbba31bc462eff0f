"""The notebooks under examples: small, without outputs, and their cells run in order."""

import ast
import json
from pathlib import Path

import pytest
from matplotlib import pyplot as plt
from matplotlib.axes import Axes

FOLDER = Path(__file__).resolve().parents[2] / "examples"
NOTEBOOKS = sorted(FOLDER.glob("*.ipynb"))
# A notebook without outputs is a few pages of text.
MOST_BYTES = 12_000


@pytest.fixture(autouse=True)
def _closed():
    yield
    plt.close("all")


def code(path: Path) -> list[str]:
    return ["".join(c["source"]) for c in json.loads(path.read_text())["cells"] if c["cell_type"] == "code"]


def executed(cell: str, names: dict) -> object:
    """Runs a cell as a notebook does; the value of its last line, if that is an expression."""
    tree = ast.parse(cell)
    last = tree.body.pop() if isinstance(tree.body[-1], ast.Expr) else None
    exec(compile(tree, "cell", "exec"), names)
    return None if last is None else eval(compile(ast.Expression(last.value), "cell", "eval"), names)


def test_there_are_two():
    assert [p.stem for p in NOTEBOOKS] == ["own_log", "paper"]


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda p: p.stem)
def test_notebooks_are_small_have_no_outputs_and_parse(path):
    book = json.loads(path.read_text())
    assert (book["nbformat"], book["nbformat_minor"]) == (4, 5) and path.stat().st_size < MOST_BYTES
    ids = [c["id"] for c in book["cells"]]
    assert len(set(ids)) == len(ids) and book["cells"][0]["cell_type"] == "markdown"
    for cell in book["cells"]:
        assert cell["cell_type"] in ("markdown", "code") and cell["metadata"] == {}
        if cell["cell_type"] == "code":
            assert cell["outputs"] == [] and cell["execution_count"] is None
    tree = ast.parse("\n".join(code(path)))
    names: dict = {}
    for node in tree.body:
        if isinstance(node, ast.Import | ast.ImportFrom):
            exec(compile(ast.Module([node], []), path.name, "exec"), names)
    # Every name of the package that a cell uses is there.
    for node in ast.walk(tree):
        if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name) and node.value.id == "ivsid":
            assert hasattr(names["ivsid"], node.attr), node.attr


def test_a_cell_gives_the_value_of_its_last_line():
    names: dict = {}
    assert executed("x = 2\nx + 1", names) == 3 and executed("y = x", names) is None and names["y"] == 2


@pytest.mark.nightly
@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda p: p.stem)
def test_notebooks_run_and_show_what_they_promise(path):
    names: dict = {}
    shown = []
    for cell in code(path):
        value = executed(cell, names)
        if hasattr(value, "_repr_html_"):
            page = value._repr_html_()
            assert "<table" in page and len(repr(value)) < 5000
            shown.append(type(value).__name__)
        if cell.startswith("axes = "):
            assert names["axes"] and all(isinstance(a, Axes) and (a.has_data() or a.texts) for a in names["axes"])
    if path.stem == "own_log":
        assert shown == ["Vehicle", "Log", "Identification", "Diagnosis", "Identification", "DataFrame", "Validation"]
        found = names["found"]
        assert found.verdict == "wrong" and [f.effect for f in found.findings] == [*names["hidden"]]
        for name, value in names["hidden"].items():
            p = names["fit"].parameters[name]
            assert p.lower <= value <= p.upper
        assert all(f.falsified == 0 for f in names["check"].forces)
    else:
        truth = names["truth"]
        assert shown[:2] == ["Log", "Identification"] and "Validation" in shown
        for name, p in names["feasible"].parameters.items():
            assert p.lower <= truth[name] <= p.upper
        assert not names["fits"]["published"].guaranteed and names["fits"]["published"].improper
        assert all(f.falsified == 0 for f in names["check"].forces)
