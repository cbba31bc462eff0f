"""Results of ``ivsid identify``, edited on purpose and sealed again."""

import json
from pathlib import Path

from ivsid.files.records import Lower, Upper, sealed, to_json
from ivsid.files.seal import seal_of


def outward(p):
    """Ends with decimals on their outer side, as ``identify`` prints them."""
    kinds = {"lower": Lower, "upper": Upper}
    return {k: kinds[k](v) if k in kinds and isinstance(v, float) else v for k, v in p.items()}


def written(place: Path, record) -> Path:
    """The record with the seal of its content: an edit on purpose."""
    content = {k: v for k, v in record.items() if k != "seal"}
    if isinstance(content.get("parameters"), dict):
        content["parameters"] = {k: outward(p) for k, p in content["parameters"].items()}
    place.write_text(to_json(sealed(content)))
    return place


def resealed(text: str) -> str:
    """A result's text with the seal of what it says now."""
    return text.replace(json.loads(text)["seal"], seal_of(text))
