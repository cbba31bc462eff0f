"""The vehicle file as one value: hull, thrusters, sensors, ambient force, model, and the map of its logs."""

from __future__ import annotations

import hashlib
import tomllib
from pathlib import Path
from typing import Literal, Self

from pydantic import Field, model_validator

from ivsid.display.shown import Shown
from ivsid.display.table import Cells
from ivsid.errors import IvsidError
from ivsid.files.log_map import LogMap
from ivsid.files.parsed import toml_table
from ivsid.files.section import Finite, NonNegative, Pair, Positive, Section
from ivsid.files.shipped import near_shipped, shipped
from ivsid.vehicle.reading import validated
from ivsid.vehicle.sensors import Sensors
from ivsid.vehicle.thrusters import Thruster
from ivsid.vehicle.voith_schneider import expand_units


class Hull(Section):
    """The rigid body.

    Attributes:
        mass: [kg].
        length: [m].
        beam: [m].
        draught: [m].
        centre_of_gravity: from the body origin, forward and to starboard [m].
    """

    mass: Positive
    length: Positive | None = None
    beam: Positive | None = None
    draught: Positive | None = None
    centre_of_gravity: Pair = (0.0, 0.0)


class Ambient(Section):
    """Random force and moment outside the model.

    Attributes:
        force: rms of the force in surge and in sway [N].
        moment: rms of the moment in yaw [N m].
        time: correlation time of both [s].
    """

    force: NonNegative = 0.0
    moment: NonNegative = 0.0
    time: Positive = 2.0


class Fitted(Section):
    """A number that a log gave, with its interval; a plain number in the file is the value alone.

    Attributes:
        value: None where a key of a thruster states the number.
        lower: end of the interval.
        upper: end of the interval.
    """

    value: Finite | None = None
    lower: Finite | None = None
    upper: Finite | None = None

    @model_validator(mode="before")
    @classmethod
    def _plain(cls, given: object) -> object:
        return {"value": given} if isinstance(given, (int, float)) and not isinstance(given, bool) else given

    @model_validator(mode="after")
    def _ordered(self) -> Self:
        if self.value is None and self.lower is None and self.upper is None:
            raise IvsidError("is empty; give a number, or a table with value, lower and upper")
        if self.lower is not None and self.upper is not None and self.lower > self.upper:
            raise IvsidError(f"lower = {self.lower:g} lies above upper = {self.upper:g}; exchange them")
        return self


class Model(Section):
    """The simulation under examination.

    Attributes:
        terms: ids of the catalogue of effects, or ``paper`` for the paper's model.
        values: claims, numbers of parameters by id. ``identify`` compares them with its intervals; ``diagnose`` takes them as given
            and fits only the rest.
        fitted: numbers of terms and of other effects, by id or id.part. ``simulate`` takes them where the scenario states none;
            fits begin at them.
    """

    terms: Literal["paper"] | tuple[str, ...] | None = None
    values: dict[str, Finite] = Field(default_factory=dict)
    fitted: dict[str, Fitted] = Field(default_factory=dict)

    @property
    def numbers(self) -> dict[str, float]:
        """The fitted values, by id or id.part."""
        return {k: f.value for k, f in self.fitted.items() if f.value is not None}


class Setup(Section):
    """What the examination of the set-up is told.

    Attributes:
        accept: ids of findings that are right for this vehicle: they are reported, and refuse nothing.
    """

    accept: tuple[str, ...] = ()


class Vehicle(Shown, Section):
    """A checked vehicle file.

    Attributes:
        name: of the vehicle.
        hull: the rigid body.
        thrusters: all of them; without any, the log holds the forces.
        sensors: bounds of readings, and limits of the motion.
        ambient: random force outside the model, or None.
        model: the simulation under examination.
        log: the map of foreign logs.
        setup: findings of the examination of the set-up that are accepted.
        text: the text of the file.
        source: its name.
    """

    name: str = Field(min_length=1)
    hull: Hull
    thrusters: tuple[Thruster, ...] = ()
    sensors: Sensors = Sensors()
    ambient: Ambient | None = None
    model: Model = Model()
    log: LogMap = LogMap()
    setup: Setup = Setup()
    text: str = Field(default="", exclude=True)
    source: str = Field(default="", exclude=True)

    @model_validator(mode="before")
    @classmethod
    def _units(cls, table: object) -> object:
        return expand_units(table)

    @model_validator(mode="after")
    def _distinct(self) -> Self:
        names = [t.name for t in self.thrusters]
        if len(set(names)) != len(names):
            raise IvsidError(f"thruster names {names} repeat; each needs its own")
        return self

    def _heading(self) -> str:
        return f"{self.name}: {self.hull.mass:g} kg, {len(self.thrusters)} thrusters"

    def _cells(self) -> Cells:
        hull = [f"{name} {value:g} m" for name in ("length", "beam", "draught") if (value := getattr(self.hull, name))]
        terms = self.model.terms if isinstance(self.model.terms, str) else ", ".join(self.model.terms or ()) or None
        parts = {
            "hull": ", ".join([f"{self.hull.mass:g} kg", *hull]),
            **{
                f"thruster {t.name}": f"at {t.position[0]:g}, {t.position[1]:g} m, azimuth {t.azimuth:g} rad"
                for t in self.thrusters
            },
            "sensors": ", ".join(sorted(self.sensors.model_fields_set)) or None,
            "model": terms or "the default terms",
            "file": self.source or None,
        }
        return {"part": list(parts), "as stated": list(parts.values())}

    @property
    def sha256(self) -> str:
        """SHA-256 of the text of the file."""
        return hashlib.sha256(self.text.encode()).hexdigest()


def read_vehicle(path: str | Path) -> Vehicle:
    """Reads and checks a vehicle file.

    Args:
        path: of the TOML file, or the name of a shipped vehicle.

    Raises:
        IvsidError: one sentence that names the file, the key, what was given and what is allowed.
    """
    path = shipped(path)
    try:
        data = path.read_bytes()
    except OSError as error:
        raise IvsidError(
            f"vehicle file {path} cannot be read ({error.strerror}); {near_shipped(path)}give the path of a TOML file, or a shipped vehicle's name"
        ) from None
    try:
        text = data.decode()
    except UnicodeDecodeError:
        raise IvsidError(f"{path} is not a text file; a vehicle file is TOML, see the user's guide") from None
    return parse_vehicle(text, str(path))


def parse_vehicle(text: str, source: str) -> Vehicle:
    """Checks the text of a vehicle file.

    Args:
        text: TOML.
        source: name of the file, for messages.

    Raises:
        IvsidError: as ``read_vehicle``.
    """
    try:
        table = toml_table(text)
    except tomllib.TOMLDecodeError as error:
        raise IvsidError(f"{source} is not valid TOML: {error}; mend that line") from None
    if not table:
        raise IvsidError(f"vehicle file {source} is empty; it needs at least name and [hull] with mass")
    return validated(Vehicle, table, source).model_copy(update={"text": text, "source": source})
