"""A vehicle however it is given: checked, by the path of its file, or by the name of a shipped one."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TypeAlias

from ivsid.errors import IvsidError
from ivsid.vehicle.vehicle import Vehicle, read_vehicle

GivenVehicle: TypeAlias = Vehicle | str | os.PathLike[str]


def vehicle_of(given: GivenVehicle) -> Vehicle:
    """The checked vehicle.

    Args:
        given: a checked vehicle, the path of its file, or the name of a shipped one (otter, vectored_rov, swan).

    Raises:
        IvsidError: the first fault of the file, in one sentence, or something that is no vehicle.
    """
    if isinstance(given, Vehicle):
        return given
    if isinstance(given, str | os.PathLike):
        return read_vehicle(Path(given))
    raise IvsidError(
        f"a vehicle is given as {type(given).__name__}; give the path of its file, or ivsid.read_vehicle(path)"
    )
