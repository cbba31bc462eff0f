"""Parts of a stored result, checked: a file that was edited or damaged gets a sentence, whatever stands in it."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Final, TypeAlias

from ivsid.rows import KINDS

Check: TypeAlias = Callable[[object], bool]
STATUSES: Final = ("enclosed", "empty", "unbounded", "not_applicable", "not_proved")


def _text(value: object) -> bool:
    return isinstance(value, str)


def _whole(value: object) -> bool:
    return isinstance(value, int) and not isinstance(value, bool)


def _flag(value: object) -> bool:
    return isinstance(value, bool)


def _number(value: object) -> bool:
    """A number that is a double: infinite ones stand in a file as null."""
    try:
        return isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)
    except OverflowError:
        return False


def _missing_or(check: Check) -> Check:
    return lambda value: value is None or check(value)


def _among(*names: str) -> Check:
    return lambda value: isinstance(value, str) and value in names


def _list_of(check: Check) -> Check:
    return lambda value: isinstance(value, list) and all(map(check, value))


def _table_of(check: Check) -> Check:
    return lambda value: isinstance(value, dict) and all(map(check, value.values()))


def _table(**parts: Check) -> Check:
    return lambda value: isinstance(value, dict) and all(k in value and check(value[k]) for k, check in parts.items())


def _length(value: object) -> bool:
    return _number(value) and float(value) > 0  # type: ignore[arg-type]  # it is a number


def _window(value: object) -> bool:
    return _length(value) or (isinstance(value, list) and bool(value) and all(map(_length, value)))


def _anything(_: object) -> bool:
    return True


_BOUND: Final = _missing_or(_number)
PARAMETER: Final = _table(lower=_BOUND, upper=_BOUND, unit=_text, symbol=_text)
OPTIONS: Final[dict[str, Check]] = {
    "partitions": _missing_or(_whole),
    "form": _among("total", "added"),
    "rows": _among(*KINDS),
    "window": _window,
    "bias": _among("sample", "log"),
    "outliers": _whole,
    "physical": _flag,
}
# Parts of a result by name; those that older results lack may be missing.
PARTS: Final[dict[str, Check]] = {
    "method": _text,
    "status": _among(*STATUSES),
    "guaranteed": _flag,
    "assumes": _list_of(_text),
    "parameters": _table_of(PARAMETER),
    "estimate": _table_of(_number),
    "inflation": _missing_or(_number),
    "improper": _whole,
    "reason": _missing_or(_text),
    "directions": _list_of(_table_of(_number)),
    "certificates": _list_of(_table_of(_anything)),
    "contradictions": _list_of(_whole),
    "rows": _table_of(_whole),
    "notes": _list_of(_text),
    "ignored": _list_of(_text),
    "options": _table(**OPTIONS),
    "vehicle": _text,
    "vehicle_source": _text,
    "inputs": _list_of(_table(name=_text, sha256=_text)),
    "determined": _list_of(_table_of(_number)),
    "claims": _list_of(_table(parameter=_text, value=_number, contradicted=_flag)),
    "outliers": _list_of(_table_of(_anything)),
    "physical": _list_of(_table(says=_text)),
    "setup": _list_of(_table(id=_text, sentence=_text, evidence=_table_of(_number), remedy=_text, certain=_flag)),
}


def check_record(record: Mapping[str, object]) -> None:
    """Checks the kinds of all parts that a record has.

    Raises:
        TypeError: a part of another kind.
    """
    for name, check in PARTS.items():
        if name in record and not check(record[name]):
            raise TypeError(f"{name} is of another kind")
