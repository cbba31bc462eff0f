"""A result to the file of a target."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Final, TypeAlias

from ivsid.diagnosis import Diagnosis
from ivsid.errors import IvsidError
from ivsid.exports import gazebo, mss, plain, pvs, stonefish, vrx
from ivsid.exports.planar import planar_of
from ivsid.exports.target import Exported, Target, exported
from ivsid.files.parsed import json_value
from ivsid.identification import Identification, read_identification
from ivsid.vehicle import Vehicle, read_vehicle

TARGETS: Final[tuple[Target, ...]] = (gazebo.TARGET, vrx.TARGET, mss.TARGET, pvs.TARGET, stonefish.TARGET, plain.TARGET)
Result: TypeAlias = Identification | Diagnosis | Vehicle | str | os.PathLike[str]


def export(result: Result, to: str) -> Exported:
    """A model in the names and signs of another simulator.

    Args:
        result: of ``identify`` or ``diagnose``, or its folder, or a vehicle with numbers in its model, or the path of its file.
        to: gz, vrx, mss, pvs, stonefish or yaml.

    Returns:
        The file's text with mid-values and intervals, and sentences on what it does not hold.

    Raises:
        IvsidError: an unknown target, an unreadable result, or a model without numbers.
    """
    target = next((t for t in TARGETS if t.name == to), None)
    if target is None:
        raise IvsidError(f"'{to}' is no target; use {', '.join(t.name for t in TARGETS)}")
    if isinstance(result, str | os.PathLike):
        result = read_result(Path(result))
    return exported(target, planar_of(result))


def read_result(path: Path) -> Identification | Vehicle:
    """The result in a folder, or a vehicle file; a diagnosis gives the vehicle file of its extended model.

    Raises:
        IvsidError: neither, in one sentence.
    """
    if path.suffix == ".toml" or not path.exists():
        return read_vehicle(path)
    record = path / "result.json" if path.is_dir() else path
    try:
        found = json_value(record.read_text())
    except OSError as error:
        raise IvsidError(
            f"{record} cannot be read ({error.strerror}); give the folder of ivsid identify or diagnose, or a vehicle file"
        ) from None
    except ValueError:
        raise IvsidError(
            f"{record} is no result; give the folder of ivsid identify or diagnose, or a vehicle file"
        ) from None
    command = found.get("command") if isinstance(found, dict) else None
    if command == "identify":
        return read_identification(path)
    if command != "diagnose":
        raise IvsidError(
            f"{record} is a result of {command or 'nothing that ivsid knows'}; give one of identify or diagnose"
        )
    model = record.parent / "model.toml"
    if not model.exists():
        raise IvsidError(
            f"{record.parent} has no model.toml, so the diagnosis gave no model to export; result.json says why"
        )
    return read_vehicle(model)
