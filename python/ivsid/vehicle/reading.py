"""TOML tables to checked values; the first fault of a table becomes one sentence."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from types import UnionType
from typing import Any, Final, TypeVar, get_args

from pydantic import BaseModel, ValidationError

from ivsid.errors import IvsidError, meant

_T = TypeVar("_T", bound=BaseModel)
# The value of a key that `ivsid init` leaves to the user.
TODO: Final = "TODO"


def validated(model: type[_T], table: Mapping[str, object], source: str) -> _T:
    """The table as a checked value of ``model``.

    Args:
        model: the type of the value.
        table: as TOML gives it.
        source: name of the file, for messages.

    Raises:
        IvsidError: one sentence about the first fault: the file, the key, what was given and what is allowed.
    """
    if blanks := list(_blanks(table)):
        others = f" (and of {', '.join(blanks[1:])})" if len(blanks) > 1 else ""
        raise IvsidError(
            f"{source}: {blanks[0]} is still {TODO}; write its value{others} in place of the mark, the comment beside it says which"
        )
    try:
        return model.model_validate(table)
    except ValidationError as error:
        # A misspelt key also shows as a missing one, and a wrong table as "not a string": the most particular fault is reported.
        order = ("extra_forbidden", "value_error")
        faults = sorted(error.errors(), key=lambda f: order.index(f["type"]) if f["type"] in order else len(order))
        raise IvsidError(_sentence(model, faults[0], table, source)) from None


def _blanks(table: object, key: str = "") -> Iterator[str]:
    """Keys that still hold the mark, those of a thruster by its name."""
    if table == TODO:
        yield key
    elif isinstance(table, Mapping):
        for k, v in table.items():
            yield from _blanks(v, f"{key}.{k}" if key else str(k))
    elif isinstance(table, list):
        for k, v in enumerate(table):
            name = v.get("name", k) if isinstance(v, Mapping) else k
            yield from _blanks(v, f"{key}.{name}")


def _sentence(model: type[BaseModel], fault: Mapping[str, Any], table: Mapping[str, object], source: str) -> str:
    path = _path(fault["loc"], table, keep_last=fault["type"] in ("extra_forbidden", "missing"))
    if path[:2] == ["model", "terms"]:
        return f'{source}: model.terms = {fault["input"]!r} is not usable; give "paper" or a list of ids, ["mass.surge", ...]'
    key = ".".join(str(p) for p in path) or "the file"
    given = fault.get("input")
    match fault["type"]:
        case "extra_forbidden":
            allowed = _keys(model, path[:-1])
            return f"{source}: key {key} is unknown; {meant(str(path[-1]), allowed)}allowed here: {', '.join(allowed)}"
        case "missing":
            return f"{source}: key {key} is missing; add it"
        case "value_error":
            return f"{source}: {key}: {fault['ctx']['error']}"
        case _:
            return f"{source}: {key} = {given!r} is not usable: {fault['msg'][0].lower()}{fault['msg'][1:]}"


def _path(location: tuple[int | str, ...], table: object, *, keep_last: bool) -> list[int | str]:
    """The location of a fault without the names of union members, which are no keys of the file."""
    path: list[int | str] = []
    here = table
    for k, step in enumerate(location):
        if isinstance(here, dict) and step in here:
            path.append(step)
            here = here[step]
        elif isinstance(here, (list, tuple)) and isinstance(step, int):
            path.append(step)
            here = here[step] if step < len(here) else None
        elif keep_last and k == len(location) - 1:
            path.append(step)
    return path


def _keys(model: type[BaseModel], path: list[int | str]) -> list[str]:
    """The keys allowed at a path of the model."""
    here: type[BaseModel] = model
    for step in path:
        if isinstance(step, int) or step not in here.model_fields:
            continue
        inner = _inner_model(here.model_fields[step].annotation)
        if inner is not None:
            here = inner
    return [f.alias or n for n, f in here.model_fields.items() if n not in ("text", "source")]


def _inner_model(annotation: object) -> type[BaseModel] | None:
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return annotation
    if isinstance(annotation, UnionType) or get_args(annotation):
        found = (_inner_model(a) for a in get_args(annotation))
        return next((f for f in found if f is not None), None)
    return None
