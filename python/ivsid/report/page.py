"""Results as files: result.json, figures, and one self-contained HTML page."""

from __future__ import annotations

import base64
import re
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from importlib.metadata import version
from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

from jinja2 import Environment, FunctionLoader, StrictUndefined
from markupsafe import Markup

from ivsid.files.records import to_json
from ivsid.files.whole import write_together

if TYPE_CHECKING:
    from ivsid.report.figures import Drawing


# A paragraph, text to copy, a list, a figure or a table, as the template takes it.
Part: TypeAlias = Mapping[str, object]
# A row of a table.
Cells: TypeAlias = Sequence[object]


@dataclass(frozen=True)
class Section:
    """A section of the page: text, lists, code, tables and figures in order."""

    title: str
    parts: tuple[Part, ...]


@dataclass(frozen=True)
class Card:
    """One result on the first screen.

    Attributes:
        title: its name.
        words: what it is, in a sentence.
        facts: questions with their answers, as its size and how sure it is.
        link: name of the part of the page that shows it; empty without one.
    """

    title: str
    words: str
    facts: tuple[tuple[str, str], ...] = ()
    link: str = ""


@dataclass(frozen=True)
class First:
    """The first screen: what was found, how sure it is, and what to do next.

    Attributes:
        verdict: in a few words.
        tone: ``good``, ``bad`` or ``open``; a sign stands beside the colour.
        words: what follows from it, in one or two sentences.
        cards: the results.
        following: what to do next, one step an entry.
        warnings: what has to be known before the results are used.
    """

    verdict: str
    tone: str
    words: str
    cards: tuple[Card, ...] = ()
    following: tuple[str, ...] = ()
    warnings: tuple[str, ...] = ()


@dataclass(frozen=True)
class Report:
    """The results of a command.

    Attributes:
        title: title of the page.
        summary: the finding and its reliability in one or two sentences.
        record: the content of result.json.
        sections: sections of the page.
        drawings: all figures; each becomes two files, whether or not a section shows it.
        files: further files by name.
        lines: text for the terminal below the summary.
        first: the first screen of the page; the summary alone without one.
    """

    title: str
    summary: str
    record: dict[str, Any]
    sections: tuple[Section, ...] = ()
    drawings: tuple[Drawing, ...] = ()
    files: Mapping[str, str | bytes] = field(default_factory=dict)
    lines: tuple[str, ...] = ()
    first: First | None = None


def text(words: str) -> Part:
    """A paragraph."""
    return {"kind": "text", "text": words}


def code(words: str) -> Part:
    """Text to copy."""
    return {"kind": "code", "text": words}


def bullets(items: Iterable[str]) -> Part:
    """A list."""
    return {"kind": "list", "items": list(items)}


def drawing(d: Drawing) -> Part:
    """A figure."""
    return {"kind": "figure", "title": d.title, "caption": d.caption, "png": base64.b64encode(d.png).decode()}


def details(words: str, parts: Iterable[Part]) -> Part:
    """Parts that the reader opens; paper shows them open."""
    return {"kind": "details", "text": words, "parts": list(parts)}


def heading(words: str, name: str) -> Part:
    """A heading inside a section, to which links lead."""
    return {"kind": "heading", "text": words, "name": name}


def jump(words: str, links: Sequence[tuple[str, str, float, float]]) -> Part:
    """Links into a figure of time series.

    Args:
        words: what the links show.
        links: words, name of the figure, start and end [s] of each.
    """
    return {
        "kind": "jump",
        "text": words,
        "links": [dict(zip(("text", "to", "start", "end"), q, strict=True)) for q in links],
    }


def table(header: Sequence[str], rows: Iterable[Cells], caption: str = "") -> Part:
    """A table; numbers are aligned to the right, yes and no are coloured. One without rows is a sentence."""
    cells = [[_cell(c) for c in row] for row in rows]
    right = [any(c["style"] == "n" for c in column) for column in zip(*cells, strict=True)] or [False] * len(header)
    heads = [{"text": h, "style": "n" if r else ""} for h, r in zip(header, right, strict=True)]
    return {"kind": "table", "caption": caption, "header": heads, "rows": cells}


def _cell(value: object) -> dict[str, str]:
    if isinstance(value, bool):
        return {"text": "yes" if value else "no", "style": "yes" if value else "no"}
    if isinstance(value, float):
        return {"text": f"{value:.4g}", "style": "n"}
    if isinstance(value, int):
        return {"text": str(value), "style": "n"}
    return {"text": "–" if value is None else str(value), "style": ""}


def html(report: Report) -> str:
    """The page, with its figures, its style and its script inside: it loads nothing."""
    environment = Environment(
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        loader=FunctionLoader(_shipped),
    )
    # Files of the package alone stand in the page as they are; all else is escaped.
    environment.globals["shipped"] = lambda name: Markup(_shipped(name))
    taken = {"about", "result", "theme", "verdict", *(n for s in report.sections for p in s.parts for n in _names(p))}
    sections = []
    for section in (s for s in report.sections if s.parts):
        name = _free(section.title, taken)
        taken.add(name)
        sections.append({"name": name, "title": section.title, "parts": section.parts})
    return environment.get_template("page.html.j2").render(
        title=report.title,
        summary=report.summary,
        first=report.first,
        sections=sections,
        inputs=report.record.get("inputs", []),
        version=version("ivsid"),
        interactive=any(_interactive(p) for s in report.sections for p in s.parts),
    )


def _shipped(name: str) -> str:
    """Text of a file of the page that comes with the package, without a first line that is only its address."""
    text = files("ivsid").joinpath("data", "report", name).read_text(encoding="utf-8")
    return text.split("\n", 1)[1] if text.startswith("/*! http") else text


def _free(title: str, taken: Collection[str]) -> str:
    """A name of a section for links, which nothing else on the page has."""
    plain = re.sub(r"[^a-z0-9]+", "-", title.lower()).strip("-") or "section"
    return next(n for n in (f"{plain}{k or ''}" for k in range(len(taken) + 1)) if n not in taken)


def _inside(part: Part) -> list[Part]:
    inner = part.get("parts", ())
    return list(inner) if isinstance(inner, list) else []


def _names(part: Part) -> list[str]:
    """Names of a part and of those inside it, to which links lead."""
    own = [str(part["name"])] if "name" in part else []
    return own + [n for p in _inside(part) for n in _names(p)]


def _interactive(part: Part) -> bool:
    return part["kind"] == "series" or any(map(_interactive, _inside(part)))


def content(report: Report) -> dict[str, str | bytes]:
    """All files of a report by name."""
    files: dict[str, str | bytes] = {"result.json": to_json(report.record) + "\n", "report.html": html(report)}
    for d in report.drawings:
        files[f"{d.name}.png"], files[f"{d.name}.svg"] = d.png, d.svg
    files.update(report.files)
    return files


def write(report: Report, folder: str | Path, apart: Mapping[str, Path] | None = None) -> None:
    """Writes all files of a report, whole or not at all.

    Args:
        report: whose files are written.
        folder: of the files.
        apart: paths of files of the report that stand elsewhere, by name; they are there before the folder changes.

    Raises:
        IvsidError: a folder or a file that cannot be written.
    """
    files = content(report)
    folders: dict[Path, dict[str, str | bytes]] = {}
    for name, place in (apart or {}).items():
        folders.setdefault(place.parent, {})[place.name] = files.pop(name)
    folders.setdefault(Path(folder), {}).update(files)
    write_together(folders)
