"""The seal of a result: a digest of its content, which shows a later edit."""

from __future__ import annotations

import hashlib
import json
from typing import Final

KEY: Final = "seal"


def seal_of(text: str) -> str:
    """SHA-256 of a JSON object without its seal; spaces and the order of keys do not count, every digit does.

    The seal shows an accident or a careless edit. Whoever edits on purpose can make it anew: the statements of a result are
    proved by its certificates.
    """
    content = json.loads(text, parse_float=_Digits, parse_int=_Digits, parse_constant=_Digits)
    if isinstance(content, dict):
        content.pop(KEY, None)
    return hashlib.sha256(json.dumps(_plain(content), sort_keys=True).encode()).hexdigest()


class _Digits(str):
    """A number as it is written."""


def _plain(value: object) -> object:
    """The value with each number marked, to tell it from a string of the same digits."""
    if isinstance(value, _Digits):
        return {"number": str(value)}
    if isinstance(value, dict):
        return [[k, _plain(v)] for k, v in sorted(value.items())]
    return [_plain(v) for v in value] if isinstance(value, list) else value
