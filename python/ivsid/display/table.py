"""Text and HTML of a table with a heading."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from html import escape
from typing import Final, TypeAlias

# Cells by the heading of their column; all columns have one length.
Cells: TypeAlias = Mapping[str, Sequence[object]]

# Characters of a text.
# Source: resource: a dozen lines of a terminal
MOST_CHARACTERS: Final = 1000
# Rows of a table in a notebook.
# Source: resource: one screen
MOST_ROWS: Final = 24
# Characters of a name that a file gives.
# Source: resource: one line of a terminal
MOST_NAME: Final = 60

# The colours of the page count: light or dark.
_LINE = "border: 0; border-bottom: 1px solid; padding: .15rem .7rem; background: transparent; color: inherit"
_HEAD = f'<th style="{_LINE}; text-align: left">'
_WORD = f'<td style="{_LINE}; text-align: left">'
_NUMBER = f'<td style="{_LINE}; text-align: right; font-variant-numeric: tabular-nums">'


def text(heading: str, cells: Cells) -> str:
    """The heading, names of the columns and a line for each row, in at most ``MOST_CHARACTERS``; rows that have no place are counted."""
    rows = list(zip(*([_cell(c) for c in column] for column in cells.values()), strict=True))
    if not rows:
        return _short(heading, 2 * MOST_NAME)
    rows.insert(0, tuple(_short(name, MOST_NAME) for name in cells))
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    lines = [_short(heading, 2 * MOST_NAME)]
    left = MOST_CHARACTERS - len(lines[0]) - len("\n  and 1000000 more rows")
    for k, row in enumerate(rows):
        line = "  " + "  ".join(c.ljust(w) for c, w in zip(row, widths, strict=True)).rstrip()
        left -= len(line) + 1
        if left < 0:
            lines.append(f"  and {len(rows) - k} more rows")
            break
        lines.append(line)
    return "\n".join(lines)


def html(heading: str, cells: Cells) -> str:
    """The heading above a table of at most ``MOST_ROWS`` rows."""
    rows = list(zip(*cells.values(), strict=True))
    head = "".join(f"{_HEAD}{escape(name)}</th>" for name in cells)
    body = "".join(f"<tr>{''.join(map(_td, row))}</tr>" for row in rows[:MOST_ROWS])
    more = f"<div>and {len(rows) - MOST_ROWS} more rows</div>" if len(rows) > MOST_ROWS else ""
    table = (
        f'<table style="border-collapse: collapse; color: inherit"><thead><tr>{head}</tr></thead>'
        f"<tbody>{body}</tbody></table>"
    )
    return f"<div><div>{escape(_short(heading, 2 * MOST_NAME))}</div>{table if rows else ''}{more}</div>"


def _td(value: object) -> str:
    number = isinstance(value, (int, float)) and not isinstance(value, bool)
    return f"{_NUMBER if number else _WORD}{escape(_cell(value))}</td>"


def _cell(value: object) -> str:
    if value is None:
        return "–"
    if isinstance(value, bool):
        return "yes" if value else "no"
    return f"{value:.6g}" if isinstance(value, float) else _short(str(value), MOST_NAME)


def _short(words: str, most: int) -> str:
    words = " ".join(words.split())
    return words if len(words) <= most else f"{words[: most - 1]}…"
