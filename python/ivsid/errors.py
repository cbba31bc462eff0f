"""The error for faults of the user's input, and the names that a misspelt one may have meant.

Its text is one sentence: what was given, what is needed, what to do.
"""

import re
from collections.abc import Iterable
from difflib import get_close_matches
from typing import Final

# Control characters that can do more to a terminal than move to a new place: C0 but tab, line feed and carriage return, DEL and C1.
# Source: definition: ISO 6429
CONTROL: Final = re.compile("[\x00-\x08\x0b\x0c\x0e-\x1f\x7f-\x9f]")
# All of them, for a text on one line, with the separators of lines and paragraphs.
# Source: definition: ISO 6429, and the line boundaries of Unicode
ANY_CONTROL: Final = re.compile("[\x00-\x1f\x7f-\x9f\u2028\u2029]")


class IvsidError(ValueError):
    """Unusable input. The text is one sentence for the user; the command line prints it and exits with 2.

    Control characters and line breaks, which names and cells of a file can bring along, stand in it as escapes that show them.
    """

    def __init__(self, text: str = "") -> None:
        super().__init__(ANY_CONTROL.sub(_escape, str(text)))


def visible(text: str) -> str:
    """The text with each control character as an escape that shows it; tabs and line breaks stay."""
    return CONTROL.sub(_escape, text)


def _escape(found: re.Match[str]) -> str:
    code = ord(found[0])
    return {"\n": "\\n", "\r": "\\r", "\t": "\\t"}.get(found[0], f"\\x{code:02x}" if code < 256 else f"\\u{code:04x}")


def meant(given: object, names: Iterable[str]) -> str:
    """The question in a sentence about an unknown name, with a blank behind it: at most three names that it is close to; empty without any."""
    known = list(names)
    if not isinstance(given, str):
        return ""
    close = get_close_matches(given, known, 3) or [n for n in known if n.lower() == given.lower()]
    return f"did you mean {' or '.join(close)}? " if close else ""


def choice(given: object, names: Iterable[str]) -> str:
    """The end of a sentence about an unknown name: the names that it is close to, or else all."""
    known = list(names)
    return meant(given, known).rstrip() or f"choose one of {', '.join(known)}"
