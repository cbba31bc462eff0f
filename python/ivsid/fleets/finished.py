"""Finished logs: results of single logs under the hash of their inputs, so that none is made twice."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from importlib.metadata import version

from ivsid.diagnosis.null.cache import rules_digest
from ivsid.files.records import sealed, to_json
from ivsid.files.seal import KEY, seal_of
from ivsid.fleets import places


@dataclass(frozen=True)
class Finished:
    """The folder of finished logs.

    Attributes:
        folder: path or URL.
    """

    folder: str

    def _address(self, kind: str, key: str) -> str:
        return places.below(self.folder, kind, key[:2], f"{key}.json")

    def read(self, kind: str, key: str) -> dict[str, object] | None:
        """A finished result; None where there is none, or a damaged one."""
        content = places.read_bytes(self._address(kind, key))
        if content is None:
            return None
        try:
            text = content.decode()
            record = json.loads(text)
            whole = isinstance(record, dict) and record.get(KEY) == seal_of(text)
        except (ValueError, RecursionError):
            return None
        return record if whole else None

    def write(self, kind: str, key: str, record: Mapping[str, object]) -> None:
        """Keeps a result.

        Raises:
            IvsidError: the folder cannot be written.
        """
        places.write_bytes(self._address(kind, key), (to_json(sealed(record)) + "\n").encode())


def key_of(kind: str, logs: Sequence[str], vehicle: str, options: Mapping[str, object]) -> str:
    """The hash of all that a result depends on: the content of its logs, the text of the vehicle file, the options, the version and the code.

    A result of code that has been mended since is not taken for one of today's.
    """
    whole = [kind, version("ivsid"), _code(), list(logs), vehicle, dict(options)]
    return hashlib.sha256(json.dumps(whole, sort_keys=True).encode()).hexdigest()


@lru_cache(maxsize=1)
def _code() -> str:
    return rules_digest()
