"""The page docs/constants.md: every numeric constant of the package, with its reason and the source of its value.

``python docs/constants.py`` writes the page. A constant is a name in capitals that a module of python/ivsid binds to a number, or to a
tuple, list or mapping of numbers. The comment block directly above it, or above the group that it opens, gives the reason in a sentence and
ends with ``# Source: ...``. A constant that stands directly below another one, without a comment of its own, belongs to that one's group.
"""

from __future__ import annotations

import ast
import sys
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
PACKAGE = ROOT / "python" / "ivsid"
PAGE = ROOT / "docs" / "constants.md"
MARK = "Source:"
HEAD = """# Constants

The numbers of the Python package, each with its reason and the source of its value. The Rust core states its own numbers beside them, in
its files. `make constants-page` writes this page from the comments beside the constants, and a test holds the page and the comments
against each other.

The source is a theorem, a publication, a definition, a resource that the number bounds, the geometry of the matter, or a measurement that
the named command repeats. A number without a source fails a test; `none` marks one until `make constants` has measured it.

`make constants` halves and doubles each number that it is the source of, and counts the verdicts that change on a fixed set of logs and
tasks. It fills the page [constants_measured.md](constants_measured.md). A number that none of them
reads needs a case in `benches/constants_rare.py`.
"""


@dataclass(frozen=True)
class Constant:
    """One constant: the file below python/ivsid, line, name, value as written, reason and source (empty where there is none)."""

    file: str
    line: int
    name: str
    value: str
    reason: str
    source: str


def constants(package: Path = PACKAGE) -> list[Constant]:
    """All constants of the package, by file and line."""
    return [c for path in sorted(package.rglob("*.py")) for c in _of(path, package)]


def _of(path: Path, package: Path) -> list[Constant]:
    text = path.read_text()
    lines = text.splitlines()
    found: list[Constant] = []
    last_end, last = -1, ("", "")
    for node in ast.parse(text).body:
        name, value = _named(node)
        if name is None or value is None or not _numeric(value):
            continue
        block = _comment_above(lines, node.lineno - 1)
        said = _split(block) if block else (last if node.lineno - 1 == last_end else ("", ""))
        last_end, last = node.end_lineno or node.lineno, said
        written = " ".join((ast.get_source_segment(text, value) or "").split())
        found.append(Constant(path.relative_to(package).as_posix(), node.lineno, name, written, *said))
    return found


def _named(node: ast.stmt) -> tuple[str | None, ast.expr | None]:
    if isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name):
        name, value = node.target.id, node.value
    elif isinstance(node, ast.Assign) and len(node.targets) == 1 and isinstance(node.targets[0], ast.Name):
        name, value = node.targets[0].id, node.value
    else:
        return None, None
    return (name, value) if name.isupper() and not name.startswith("__") else (None, None)


def _numeric(value: ast.expr) -> bool:
    """Whether an expression is made of numbers: at least one, and no text beside the keys of a mapping."""
    if isinstance(value, ast.Dict):
        return bool(value.values) and all(_numeric(v) for v in value.values)
    if isinstance(value, ast.Tuple | ast.List | ast.Set):
        return any(_numeric(v) for v in value.elts) and all(_numeric(v) or _switch(v) for v in value.elts)
    if isinstance(value, ast.Call):
        called = ast.unparse(value.func)
        inner = [value.func.value] if isinstance(value.func, ast.Attribute) else []
        return called.startswith(("np.", "math.", "Fraction", "float", "int", "frozenset", "tuple")) and any(
            _numeric(a) for a in (*value.args, *inner)
        )
    if isinstance(value, ast.BinOp):
        return _numeric(value.left) or _numeric(value.right)
    if isinstance(value, ast.UnaryOp):
        return _numeric(value.operand)
    if isinstance(value, ast.Attribute):
        return ast.unparse(value) in ("math.pi", "np.pi", "math.tau", "math.inf")
    return (
        isinstance(value, ast.Constant) and isinstance(value.value, int | float) and not isinstance(value.value, bool)
    )


def _switch(value: ast.expr) -> bool:
    """Whether an expression is True or False, which stand beside numbers."""
    return isinstance(value, ast.Constant) and isinstance(value.value, bool)


def _comment_above(lines: list[str], at: int) -> list[str]:
    block: list[str] = []
    for line in reversed(lines[:at]):
        if not line.startswith("#"):
            break
        block.insert(0, line.lstrip("#").strip())
    return block


def _split(block: list[str]) -> tuple[str, str]:
    """The reason, and what stands after the mark."""
    for k, line in enumerate(block):
        if line.startswith(MARK):
            return " ".join(block[:k]), " ".join([line.removeprefix(MARK).strip(), *block[k + 1 :]])
    return " ".join(block), ""


def page(found: list[Constant]) -> str:
    """The page as Markdown: a table for each file."""
    out = [HEAD]
    for file in dict.fromkeys(c.file for c in found):
        out.append(f"\n## {file}\n\n| constant | value | reason | source |\n|---|---|---|---|\n")
        for c in (c for c in found if c.file == file):
            cells = (f"`{c.name}`", f"`{c.value}`", c.reason, c.source)
            out.append("| " + " | ".join(x.replace("|", "\\|") for x in cells) + " |\n")
    out.append(f"\n{len(found)} constants.\n")
    return "".join(out)


if __name__ == "__main__":
    every = constants()
    PAGE.write_text(page(every))
    for c in every:
        if not c.source or c.source == "none":
            sys.stdout.write(f"{c.file}:{c.line} {c.name} = {c.value}: no source\n")
