"""A digest of all that a result says, so that whoever reads it notices what was edited after it was written."""

from __future__ import annotations

import hashlib
import json
from typing import Any, Final

KEY: Final = "seal"


def seal_of(text: str) -> str:
    """SHA-256 of a JSON object without its seal; spaces and the order of keys do not count, every digit does.

    It shows an accident or a careless edit. Who edits on purpose can make it anew: what a result claims is proved by its
    certificates, not by this.
    """
    content = json.loads(text, parse_float=_Digits, parse_int=_Digits, parse_constant=_Digits)
    if isinstance(content, dict):
        content.pop(KEY, None)
    return hashlib.sha256(json.dumps(_plain(content), sort_keys=True).encode()).hexdigest()


class _Digits(str):
    """A number as it is written."""


def _plain(value: Any) -> Any:
    """Text that tells a number from a string of the same digits."""
    if isinstance(value, _Digits):
        return {"number": str(value)}
    if isinstance(value, dict):
        return [[k, _plain(v)] for k, v in sorted(value.items())]
    return [_plain(v) for v in value] if isinstance(value, list) else value
