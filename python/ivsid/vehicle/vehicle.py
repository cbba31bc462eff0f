"""The vehicle file: TOML with units in its names, checked key by key (INTERFACE.md)."""

from __future__ import annotations

import difflib
import hashlib
import tomllib
from pathlib import Path
from types import UnionType
from typing import Annotated, Any, Literal, Self, TypeVar, get_args

from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

from ivsid.errors import IvsidError
from ivsid.files import units
from ivsid.files.log_map import LogMap
from ivsid.vehicle.actuator import Quadratic, Rudder, expand_units
from ivsid.vehicle.mount import Mounted

_T = TypeVar("_T", bound=BaseModel)
Positive = Annotated[float, Field(gt=0, allow_inf_nan=False)]
NonNegative = Annotated[float, Field(ge=0, allow_inf_nan=False)]
Finite = Annotated[float, Field(allow_inf_nan=False)]
Probability = Annotated[float, Field(gt=0, lt=1)]
Pair = tuple[Finite, Finite]


class _Section(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class Hull(_Section):
    """The rigid body: ``mass`` [kg], ``length``, ``beam``, ``draught`` [m], ``centre_of_gravity`` [m] from the origin."""

    mass: Positive
    length: Positive | None = None
    beam: Positive | None = None
    draught: Positive | None = None
    centre_of_gravity: Pair = (0.0, 0.0)


class ThrustTable(_Section):
    """Bollard pull: ``thrust`` [``unit``] at each ``demand``."""

    demand: tuple[Finite, ...] = Field(min_length=2)
    thrust: tuple[Finite, ...] = Field(min_length=2)
    unit: str = "N"

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        units.factor(self.unit, units.FORCE, "a thrust table")
        if len(self.demand) != len(self.thrust):
            raise IvsidError(f"{len(self.demand)} demands but {len(self.thrust)} thrusts; a table needs one for each")
        if any(b <= a for a, b in zip(self.demand, self.demand[1:], strict=False)):
            raise IvsidError("the demands of a table must increase strictly")
        return self


class Accuracy(_Section):
    """The bound on the thrust error, ``absolute`` [N] + ``relative`` times the thrust."""

    absolute: NonNegative = 0.0
    relative: NonNegative = 0.0


class Thruster(_Section):
    """One thruster: where it stands, where it pushes, and one of ``table``, ``polynomial``, ``gain``, ``quadratic``.

    ``dead_band`` [demand], ``limit`` [N], ``reverse_factor``, ``time_constant`` [s] and ``advance_loss`` [s/m] are what the
    simulation claims beyond the curve. A first-order lag acts on the thrust, or with ``lag = "demand"`` on the demand (a shaft's
    speed). ``steering = "azimuth"`` takes the direction from the column ``azimuth_NAME``, which turns at most by
    ``steering_rate`` [rad/s]; ``rudder`` stands behind the propeller. ``demand_range`` ends a curve without a table.
    """

    name: str = Field(pattern=r"^[A-Za-z0-9_]+$")
    position: Pair = (0.0, 0.0)
    azimuth: Finite = 0.0
    table: ThrustTable | None = None
    polynomial: tuple[Finite, ...] | None = Field(default=None, min_length=1, max_length=10)
    gain: Finite | None = None
    quadratic: Quadratic | None = None
    accuracy: Accuracy = Accuracy()
    neutral: Finite = 0.0
    outside: Literal["refuse", "hold"] = "refuse"
    demand_range: Pair | None = None
    time_constant: NonNegative | None = None
    dead_band: NonNegative | None = None
    limit: Positive | None = None
    reverse_factor: Positive | None = None
    advance_loss: NonNegative | None = None
    lag: Literal["thrust", "demand"] = "thrust"
    steering: Literal["fixed", "azimuth"] = "fixed"
    steering_rate: Positive | None = None
    rudder: Rudder | None = None

    @model_validator(mode="after")
    def _one_curve(self) -> Self:
        given = [k for k in ("table", "polynomial", "gain", "quadratic") if getattr(self, k) is not None]
        if len(given) != 1:
            raise IvsidError(
                f"has {' and '.join(given) or 'no thrust curve'}; give one of table, polynomial, gain, quadratic"
            )
        if self.demand_range is not None and (
            self.table is not None or not self.demand_range[0] < self.demand_range[1]
        ):
            raise IvsidError(
                "demand_range = [lowest, highest] ends a curve that has no table; a table ends with its own demands"
            )
        return self


class VelocitySensor(Mounted):
    """u, v: ``accuracy`` [m/s] is a bound, ``scale_factor_error`` bounds |s| of a reading (1 + s) times the truth."""

    accuracy: NonNegative
    scale_factor_error: Annotated[float, Field(ge=0, lt=1)] = 0.0
    scale_factor_sign: Literal[-1, 0, 1] = 0


class InertialSensor(_Section):
    """An accelerometer or gyro: random walk [unit/sqrt(s)], bias instability [unit], bias time [s], hard bound [unit]."""

    random_walk: NonNegative = 0.0
    rate_random_walk: NonNegative = 0.0
    bias_instability: NonNegative | Annotated[tuple[NonNegative, NonNegative], Field()] = 0.0
    bias_time: Positive | tuple[Positive, Positive] = 300.0
    accuracy: NonNegative = 0.0
    sampling: Literal["instantaneous", "averaged"] = "instantaneous"

    def axis(self, index: int) -> tuple[float, float]:
        """Bias instability and bias time of one axis."""
        b, t = self.bias_instability, self.bias_time
        return (b[index] if isinstance(b, tuple) else b), (t[index] if isinstance(t, tuple) else t)


class AccelerationSensor(InertialSensor, Mounted):
    """An accelerometer; ``random_walk`` may be two values [x, y].

    With ``gravity`` the columns ax, ay still hold it: true, or its size [m/s^2]. It is taken away by the attitude.
    """

    gravity: bool | Positive = False
    random_walk: NonNegative | tuple[NonNegative, NonNegative] = 0.0  # type: ignore[assignment]

    def walk(self, index: int) -> float:
        """Random walk of one axis."""
        n = self.random_walk
        return n[index] if isinstance(n, tuple) else n


class AccuracySensor(_Section):
    """A sensor with a plain bound, in the unit of its quantity."""

    accuracy: NonNegative


class Limits(_Section):
    """What the vessel cannot exceed: ``acceleration`` [m/s^2], ``yaw_acceleration`` [rad/s^2], and how fast both change.

    ``jerk`` [m/s^3] bounds the rates of udot and vdot, ``yaw_jerk`` [rad/s^3] that of rdot: they have none where a thrust jumps.
    """

    acceleration: Positive | None = None
    yaw_acceleration: Positive | None = None
    jerk: Positive | None = None
    yaw_jerk: Positive | None = None


class Sensors(_Section):
    """Sensor bounds and the rule that turns noise into bounds: ``confidence`` (default 0.999) or ``sigmas``.

    ``attitude`` bounds roll and pitch [rad]. ``from_pose`` says how velocities that are not measured come from the pose: enclosed
    under the stated limits, or by a smoothing spline whose band is calibrated on its residuals and proves nothing.
    """

    confidence: Probability | None = None
    sigmas: Positive | None = None
    velocity: VelocitySensor | None = None
    acceleration: AccelerationSensor | None = None
    yaw_rate: InertialSensor | None = None
    yaw_acceleration: AccuracySensor | None = None
    heading: AccuracySensor | None = None
    attitude: AccuracySensor | None = None
    position: AccuracySensor | None = None
    wind: AccuracySensor | None = None
    force: AccuracySensor | None = None
    moment: AccuracySensor | None = None
    limits: Limits = Limits()
    from_pose: Literal["enclosed", "spline"] = "enclosed"

    @model_validator(mode="after")
    def _one_rule(self) -> Self:
        if self.confidence is not None and self.sigmas is not None:
            raise IvsidError("has both confidence and sigmas; give one")
        return self


class Ambient(_Section):
    """Random force that nobody models: rms ``force`` [N], rms ``moment`` [N m], correlation ``time`` [s]."""

    force: NonNegative = 0.0
    moment: NonNegative = 0.0
    time: Positive = 2.0


class Model(_Section):
    """The simulation under examination: ids of the catalogue, or "paper"; claimed values are not fitted."""

    terms: Literal["paper"] | tuple[str, ...] | None = None
    values: dict[str, Finite] = {}


class Vehicle(_Section):
    """A checked vehicle file. ``text`` is the file itself, ``source`` its name."""

    name: str = Field(min_length=1)
    hull: Hull
    thrusters: tuple[Thruster, ...] = ()
    sensors: Sensors = Sensors()
    ambient: Ambient | None = None
    model: Model = Model()
    log: LogMap = LogMap()
    text: str = Field(default="", exclude=True)
    source: str = Field(default="", exclude=True)

    @model_validator(mode="before")
    @classmethod
    def _units(cls, table: Any) -> Any:
        return expand_units(table)

    @model_validator(mode="after")
    def _distinct(self) -> Self:
        names = [t.name for t in self.thrusters]
        if len(set(names)) != len(names):
            raise IvsidError(f"thruster names {names} repeat; each needs its own")
        return self

    @property
    def sha256(self) -> str:
        """Hash of the file's bytes."""
        return hashlib.sha256(self.text.encode()).hexdigest()


def read_vehicle(path: str | Path) -> Vehicle:
    """Reads and checks a vehicle file.

    Raises:
        IvsidError: naming the file, the key, what was given and what is allowed.
    """
    path = Path(path)
    try:
        data = path.read_bytes()
    except OSError as error:
        raise IvsidError(
            f"vehicle file {path} cannot be read ({error.strerror}); give the path of a TOML file"
        ) from None
    try:
        text = data.decode()
    except UnicodeDecodeError:
        raise IvsidError(f"{path} is not a text file; a vehicle file is TOML, see the user's guide") from None
    return parse_vehicle(text, str(path))


def parse_vehicle(text: str, source: str) -> Vehicle:
    """Checks the text of a vehicle file; ``source`` names it in messages."""
    try:
        table = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise IvsidError(f"{source} is not valid TOML: {error}; mend that line") from None
    if not table:
        raise IvsidError(f"vehicle file {source} is empty; it needs at least name and [hull] with mass")
    return validated(Vehicle, table, source).model_copy(update={"text": text, "source": source})


def validated(model: type[_T], table: dict[str, Any], source: str) -> _T:
    """The table as a checked model, or one sentence about its first fault."""
    try:
        return model.model_validate(table)
    except ValidationError as error:
        # A misspelt key also shows as a missing one, and a wrong table as "not a string": say what is most particular.
        order = ("extra_forbidden", "value_error")
        faults = sorted(error.errors(), key=lambda f: order.index(f["type"]) if f["type"] in order else len(order))
        raise IvsidError(_sentence(model, faults[0], table, source)) from None


def _sentence(model: type[BaseModel], fault: Any, table: dict[str, Any], source: str) -> str:
    path = _path(fault["loc"], table, keep_last=fault["type"] in ("extra_forbidden", "missing"))
    if path[:2] == ["model", "terms"]:
        return f'{source}: model.terms = {fault["input"]!r} is not usable; give "paper" or a list of ids, ["mass.surge", ...]'
    key = ".".join(str(p) for p in path) or "the file"
    given = fault.get("input")
    match fault["type"]:
        case "extra_forbidden":
            allowed = _keys(model, path[:-1])
            close = difflib.get_close_matches(str(path[-1]), allowed, 1)
            hint = f"did you mean {close[0]}? " if close else ""
            return f"{source}: key {key} is unknown; {hint}allowed here: {', '.join(allowed)}"
        case "missing":
            return f"{source}: key {key} is missing; add it"
        case "value_error":
            return f"{source}: {key}: {fault['ctx']['error']}"
        case _:
            return f"{source}: {key} = {given!r} is not usable: {fault['msg'][0].lower()}{fault['msg'][1:]}"


def _path(location: tuple[Any, ...], table: Any, *, keep_last: bool) -> list[Any]:
    """The location without the names of union members, which are no keys of the file."""
    path: list[Any] = []
    here = table
    for k, step in enumerate(location):
        inside = (isinstance(here, dict) and step in here) or (
            isinstance(here, (list, tuple)) and isinstance(step, int)
        )
        if inside:
            path.append(step)
            here = here[step] if not isinstance(step, int) or step < len(here) else None
        elif keep_last and k == len(location) - 1:
            path.append(step)
    return path


def _keys(model: type[BaseModel], path: list[Any]) -> list[str]:
    """The keys allowed at a path of the model."""
    here: type[BaseModel] = model
    for step in path:
        if isinstance(step, int) or step not in here.model_fields:
            continue
        inner = _inner_model(here.model_fields[step].annotation)
        if inner is not None:
            here = inner
    return [f.alias or n for n, f in here.model_fields.items() if n not in ("text", "source")]


def _inner_model(annotation: Any) -> type[BaseModel] | None:
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return annotation
    if isinstance(annotation, UnionType) or get_args(annotation):
        found = (_inner_model(a) for a in get_args(annotation))
        return next((f for f in found if f is not None), None)
    return None
