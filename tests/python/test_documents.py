"""Modules and files that the documents name exist."""

from __future__ import annotations

import re
from importlib import import_module
from pathlib import Path

import pytest

import ivsid

ROOT = Path(__file__).resolve().parents[2]
PACKAGE = ROOT / "python" / "ivsid"
CORE = ROOT / "crates" / "interval-core" / "src"
# Folders that a document may leave out before a path.
BASES = (ROOT, PACKAGE, PACKAGE / "diagnosis", CORE, ROOT / "docs", ROOT / "tests" / "python", ROOT / "tests" / "rust")
DOCUMENTS = [
    *(ROOT / name for name in ("ARCHITECTURE.md", "CONTRIBUTING.md", "DESIGN.md", "README.md")),
    *sorted(p for p in (ROOT / "docs").rglob("*.md") if "_build" not in p.parts),
]
# Files of a user in examples.
EXAMPLES = {"my_effects.py"}
# Folders that commands make and git ignores.
MADE = (".venv/", "dist/", "docs/_build/", "out/", "target/")
# Files that commands read and write: their first word may be that of a chapter.
RESULTS = (".csv", ".html", ".json", ".md", ".parquet", ".py", ".rs", ".toml")
# Roots of dotted names: the package, the chapters without ``ivsid``, the stages without ``ivsid.diagnosis``.
CHAPTERS = {p.name for p in PACKAGE.iterdir() if (p / "__init__.py").exists()}
STAGES = {p.name for p in (PACKAGE / "diagnosis").iterdir() if (p / "__init__.py").exists()}
QUOTED = re.compile(r"`([^`\n]+)`")
DOTTED = re.compile(r"[A-Za-z_]\w*(\.\w+)+")
PATH = re.compile(r"[\w.-]+(/[\w.-]+)*/?")


def quoted(text: str) -> list[str]:
    """All inline code of a page; fenced blocks are examples."""
    return QUOTED.findall(re.sub(r"^```.*?^```", "", text, flags=re.S | re.M))


def has(module: str, names: list[str]) -> bool:
    """Whether a module has a name, and that name the next one; fields of a class count."""
    found: object = import_module(module)
    for name in names:
        if name in getattr(found, "__annotations__", {}):
            return True
        if not hasattr(found, name):
            return False
        found = getattr(found, name)
    return True


def names_nothing(name: str) -> bool:
    """Whether a dotted name begins like a module of the package and is neither a module nor a name in one."""
    first = name.split(".", maxsplit=1)[0]
    if name.endswith(RESULTS) or first not in {"ivsid", *STAGES, *CHAPTERS, *ivsid.__all__}:
        return False
    prefix = "" if first == "ivsid" else "ivsid.diagnosis." if first in STAGES else "ivsid."
    parts = (prefix + name).split(".")
    module = 1
    while module < len(parts):
        base = PACKAGE.joinpath(*parts[1 : module + 1])
        if not (base.is_dir() or base.with_name(base.name + ".py").exists()):
            break
        module += 1
    return not has(".".join(parts[:module]), parts[module:])


def leads_nowhere(path: str) -> bool:
    """Whether text that looks like a path of this repository has no file or folder behind it."""
    if path in EXAMPLES or path.startswith(MADE) or re.search(r"(^|/)[A-Z]+(\.\w+)?$", path):
        return False
    if "/" not in path:
        return path.endswith((".py", ".rs")) and not any(
            next((ROOT / top).rglob(path), None) for top in ("python", "crates", "tests", "docs", "benches", "examples")
        )
    first = path.split("/", maxsplit=1)[0]
    source = path.endswith((".py", ".rs", ".md")) or "." not in path
    starts = [base for base in BASES if (base / first).is_dir() and (base == ROOT or source)]
    if not starts:
        return path.endswith((".py", ".rs", ".md"))
    return not any((base / (path + ending)).exists() for base in starts for ending in ("", ".rs", ".py"))


def faults(text: str) -> list[str]:
    """Names and paths of a page that are not in the tree."""
    found = []
    for token in quoted(text):
        if (DOTTED.fullmatch(token) and "/" not in token and names_nothing(token)) or (
            PATH.fullmatch(token) and leads_nowhere(token)
        ):
            found.append(token)
    return found


@pytest.mark.parametrize("page", DOCUMENTS, ids=lambda p: p.name)
def test_modules_and_files_that_a_document_names_exist(page):
    assert not faults(page.read_text())


LINK = re.compile(r"\]\(([^)#\s]*)(?:#([^)\s]*))?\)")


def anchors(text: str) -> set[str]:
    """Anchors of the headings of a page, as GitHub and MyST make them: words in small letters, joined by hyphens."""
    found: dict[str, int] = {}
    for title in re.findall(r"^#{1,6} (.*)$", re.sub(r"^```.*?^```", "", text, flags=re.S | re.M), re.M):
        slug = re.sub(r"[^\w\- ]", "", title.strip().lower()).replace(" ", "-")
        found[slug] = found.get(slug, -1) + 1
    return {slug if not k else f"{slug}-{k}" for slug, last in found.items() for k in range(last + 1)}


def broken(page: Path, text: str) -> list[str]:
    """Links of a page to files or headings that do not exist, and addresses that are none."""
    found = []
    for target, anchor in LINK.findall(re.sub(r"`[^`\n]*`", "", text)):
        if "://" in target:
            if not re.fullmatch(r"https?://[\w.-]+(/\S*)?", target):
                found.append(target)
            continue
        file = page.parent / target if target else page
        if not file.exists():
            found.append(target)
        elif anchor and (file.suffix != ".md" or anchor not in anchors(text if file == page else file.read_text())):
            found.append(f"{target}#{anchor}")
    return found


@pytest.mark.parametrize("page", DOCUMENTS, ids=lambda p: p.name)
def test_links_to_files_and_headings_lead_somewhere(page):
    assert not broken(page, page.read_text())


def test_broken_links_are_noticed():
    page = ROOT / "docs" / "index.md"
    text = "# A `b`, c\n[x](lost.md) [y](#a-b-c) [z](#lost) [w](theory.md#rows) [v](theory.md#lost) [u](ftp://a)\n"
    assert broken(page, text) == ["lost.md", "#lost", "theory.md#lost", "ftp://a"]


def chapter_tables(text: str) -> dict[str, list[str]]:
    """Folder below python/ivsid and the modules that the tables of ARCHITECTURE.md name in its row."""
    python, stages = text.split("## The Python package")[1].split("## The diagnosis")
    rows = dict(re.findall(r"^\| `(\w+)` \| (.*) \|$", python, re.M))
    rows |= {f"diagnosis/{name}": cell for name, cell in re.findall(r"^\| \d\. `(\w+)` \| (.*) \|$", stages, re.M)}
    return {name: [t for t in quoted(cell) if re.fullmatch(r"[a-z_]+", t)] for name, cell in rows.items()}


def test_the_tables_of_the_architecture_name_every_chapter_and_only_modules_of_it():
    tables = chapter_tables((ROOT / "ARCHITECTURE.md").read_text())
    assert set(tables) - {"_core", "errors"} == CHAPTERS | {f"diagnosis/{s}" for s in STAGES}
    lost = [
        f"{folder}: {name}"
        for folder, names in tables.items()
        for name in names
        if not ((PACKAGE / folder / f"{name}.py").exists() or (PACKAGE / folder / name).is_dir())
    ]
    assert not lost
    # Each stage of the diagnosis is listed whole.
    for stage in STAGES:
        held = {p.stem for p in (PACKAGE / "diagnosis" / stage).glob("*.py")} - {"__init__"}
        assert held <= set(tables[f"diagnosis/{stage}"]), stage


def test_a_page_that_names_lost_files_is_refused():
    page = (
        "`ivsid.rows.lost` `rows.lost` `null.lost` `ivsid.log.Lost` `Log.lost` `linalg.lost` `python/ivsid/rows/lost.py` `lost.py` `inverse/lost` "
        "`tests/lost.toml` `lost/page.md`"
    )
    assert faults(page) == quoted(page) != []
    good = (
        "`ivsid.rows.weak` `null.cache` `ivsid.log.Log` `Log.over` `linalg.inverse` `report.html` `python/ivsid/rows/` `inverse/krawczyk` `signs.rs` "
        "`rows/NAME.py` `np.sqrt` `mass.surge` `result.json` `nav/gyro.z`\n```\n`ivsid.rows.lost`\n```"
    )
    assert faults(good) == []
    assert chapter_tables(
        "## The Python package\n| `log` | a `clocks`, `Log` |\n## The diagnosis\n| 1. `data` | `clock` |\n"
    ) == {
        "log": ["clocks"],
        "diagnosis/data": ["clock"],
    }
