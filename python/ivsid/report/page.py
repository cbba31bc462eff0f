"""Results as files: result.json, figures, and one self-contained HTML page."""

from __future__ import annotations

import base64
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from importlib.metadata import version
from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

from jinja2 import Environment, StrictUndefined

from ivsid.files.records import to_json, write_folder

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
    """

    title: str
    summary: str
    record: dict[str, Any]
    sections: tuple[Section, ...] = ()
    drawings: tuple[Drawing, ...] = ()
    files: Mapping[str, str | bytes] = field(default_factory=dict)
    lines: tuple[str, ...] = ()


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


def table(header: Sequence[str], rows: Iterable[Cells], caption: str = "") -> Part:
    """A table; numbers are aligned to the right, yes and no are coloured."""
    return {
        "kind": "table",
        "caption": caption,
        "header": list(header),
        "rows": [[_cell(c) for c in row] for row in rows],
    }


def _cell(value: object) -> dict[str, str]:
    if isinstance(value, bool):
        return {"text": "yes" if value else "no", "style": "yes" if value else "no"}
    if isinstance(value, float):
        return {"text": f"{value:.6g}", "style": "n"}
    if isinstance(value, int):
        return {"text": str(value), "style": "n"}
    return {"text": "–" if value is None else str(value), "style": ""}


def html(report: Report) -> str:
    """The page, with its figures inside."""
    environment = Environment(autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True)
    template = environment.from_string((files("ivsid") / "data" / "report.html.j2").read_text())
    inputs = "; ".join(f"{i['name']} (SHA-256 {i['sha256'][:16]}…)" for i in report.record.get("inputs", []))
    footer = f"ivsid {version('ivsid')}" + (f" · inputs: {inputs}" if inputs else "")
    return template.render(title=report.title, summary=report.summary, sections=report.sections, footer=footer)


def write(report: Report, folder: str | Path) -> None:
    """Writes all files of a report into a folder, whole or not at all.

    Raises:
        IvsidError: a folder that cannot be written.
    """
    content: dict[str, str | bytes] = {"result.json": to_json(report.record) + "\n", "report.html": html(report)}
    for d in report.drawings:
        content[f"{d.name}.png"], content[f"{d.name}.svg"] = d.png, d.svg
    content.update(report.files)
    write_folder(folder, content)
