"""The error for faults of the user's input, and the names that a misspelt one may have meant.

Its text is one sentence: what was given, what is needed, what to do.
"""

from collections.abc import Iterable
from difflib import get_close_matches


class IvsidError(ValueError):
    """Unusable input. The text is one sentence for the user; the command line prints it and exits with 2."""


def meant(given: str, names: Iterable[str]) -> str:
    """The question in a sentence about an unknown name, with a blank behind it: at most three names that it is close to; empty without any."""
    known = list(names)
    close = get_close_matches(given, known, 3) or [n for n in known if n.lower() == given.lower()]
    return f"did you mean {' or '.join(close)}? " if close else ""


def choice(given: str, names: Iterable[str]) -> str:
    """The end of a sentence about an unknown name: the names that it is close to, or else all."""
    known = list(names)
    return meant(given, known).rstrip() or f"choose one of {', '.join(known)}"
