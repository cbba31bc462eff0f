"""The constants that a run reads: the lines of the package that it executes, held against the lines that name a constant."""

from __future__ import annotations

import ast
import sys
import threading
from collections.abc import Callable
from pathlib import Path
from types import FrameType
from typing import Any

Lines = dict[str, set[int]]


def executed(package: Path, work: Callable[[], object], only: frozenset[str] | None = None) -> Lines:
    """Lines of each module of a package, or of some of them, that ``work`` executes, by path below the package."""
    root, found = str(package) + "/", {}

    def trace(frame: FrameType, event: str, _: Any) -> Any:
        name = frame.f_code.co_filename
        if not name.startswith(root) or (only is not None and name.removeprefix(root) not in only):
            return None
        lines = found.setdefault(name.removeprefix(root), set())

        def local(inner: FrameType, event: str, _: Any) -> Any:
            if event == "line":
                lines.add(inner.f_lineno)
            return local

        lines.add(frame.f_lineno)
        return local

    threading.settrace(trace)
    sys.settrace(trace)
    try:
        work()
    finally:
        sys.settrace(None)
        threading.settrace(None)  # type: ignore[arg-type]
    return found


def reached(package: Path, lines: Lines) -> set[str]:
    """The constants, as ``file NAME``, that an executed statement of a function reads, or a constant that is read rests on."""
    found: set[str] = set()
    rests: dict[str, set[str]] = {}
    for path in package.rglob("*.py"):
        file = str(path.relative_to(package))
        if file not in lines:
            continue
        tree = ast.parse(path.read_text())
        homes = _homes(tree, file, package)
        for function in ast.walk(tree):
            if isinstance(function, ast.FunctionDef):
                found |= _read(function, homes, lines[file])
        for statement in tree.body:
            name = _bound(statement)
            if name is not None:
                rests[f"{file} {name}"] = {f"{homes[n]} {n}" for n in _names(_own(statement)) & homes.keys()}
    while more := {base for name in found for base in rests.get(name, ())} - found:
        found |= more
    return found


def _read(function: ast.FunctionDef, homes: dict[str, str], lines: set[int]) -> set[str]:
    """The constants that the executed statements of a function read; its defaults, if any statement of it was executed."""
    found: set[str] = set()
    for statement in (n for part in function.body for n in ast.walk(part) if isinstance(n, ast.stmt)):
        if lines.intersection(range(statement.lineno, _last(statement) + 1)):
            found |= _names(_own(statement))
    if lines.intersection(range(function.body[0].lineno, (function.end_lineno or 0) + 1)):
        found |= _names([n for d in (*function.args.defaults, *function.args.kw_defaults) if d for n in ast.walk(d)])
    return {f"{homes[n]} {n}" for n in found & homes.keys()}


def _names(nodes: list[ast.AST]) -> set[str]:
    return {n.id for n in nodes if isinstance(n, ast.Name) and isinstance(n.ctx, ast.Load)}


def _bound(statement: ast.stmt) -> str | None:
    """The name in capitals that a statement of a module binds."""
    target = getattr(statement, "target", None) or (getattr(statement, "targets", None) or [None])[0]
    return target.id if isinstance(target, ast.Name) and target.id.strip("_").isupper() else None


def _homes(tree: ast.Module, file: str, package: Path) -> dict[str, str]:
    """Names in capitals of a module, and the file that binds each."""
    homes = {}
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("ivsid"):
            module = "/".join((node.module or "").split(".")[1:])
            home = f"{module}.py" if (package / f"{module}.py").exists() else f"{module}/__init__.py"
            homes |= {a.asname or a.name: home for a in node.names if a.name.isupper()}
    return homes | {name: file for name in map(_bound, tree.body) if name is not None}


def _own(statement: ast.stmt) -> list[ast.AST]:
    """The nodes of a statement without those of the statements inside it."""
    found: list[ast.AST] = []
    todo: list[ast.AST] = [statement]
    while todo:
        for child in ast.iter_child_nodes(todo.pop()):
            if not isinstance(child, ast.stmt):
                found.append(child)
                todo.append(child)
    return found


def _last(statement: ast.stmt) -> int:
    """The last line of a statement's own text, before the block below it."""
    body = getattr(statement, "body", None)
    return body[0].lineno - 1 if isinstance(body, list) and body else statement.end_lineno or statement.lineno
