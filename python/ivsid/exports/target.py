"""Targets: the form of a file, and the sentences on what it cannot say."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from ivsid.exports.number import one_line
from ivsid.exports.planar import Planar
from ivsid.files.whole import write_folder

# Numbers that every target but yaml takes through its masses.
INERTIA: Final = frozenset(("mass.surge", "mass.sway", "inertia.yaw", "coupling.cg_x", "coupling.cg_y"))


@dataclass(frozen=True)
class Body:
    """The content of a file.

    Attributes:
        text: without its head.
        says: ids of the numbers that it holds.
        unstated: sentences on what it cannot say beside the other numbers.
    """

    text: str
    says: frozenset[str]
    unstated: tuple[str, ...] = ()


@dataclass(frozen=True)
class Target:
    """A simulator.

    Attributes:
        name: as in ``--to``.
        title: in words.
        file: name of the file of a model.
        write: makes the body.
        comment: opening and closing of a comment of one line.
        opening: line before everything else.
    """

    name: str
    title: str
    file: Callable[[Planar], str]
    write: Callable[[Planar], Body]
    comment: tuple[str, str]
    opening: str = ""


@dataclass(frozen=True)
class Exported:
    """A model in the form of a target.

    Attributes:
        target: its name.
        file: name of the file.
        text: of the file.
        unstated: sentences on what the file does not hold; they stand in its head, too.
    """

    target: str
    file: str
    text: str
    unstated: tuple[str, ...]

    def save(self, folder: str | Path) -> Path:
        """Writes the file into a folder, and returns its path."""
        path = Path(folder) / self.file
        write_folder(folder, {self.file: self.text})
        return path


def exported(target: Target, model: Planar) -> Exported:
    """The file of a target, with a head that says what it does not hold."""
    body = target.write(model)
    left = [f"{k} = {n.value:.6g} {n.unit} ({n.words})" for k, n in model.numbers.items() if k not in body.says]
    unstated = (*body.unstated, *left)
    head = [
        f"{model.title} for {target.title}, made by ivsid from {Path(model.source).name}.",
        "Numbers are mid-values; their intervals stand beside them.",
        *(["Not in this file:"] if unstated else ["Every number of the model is in this file."]),
        *(f"- {sentence}" for sentence in unstated),
    ]
    opening = [target.opening] if target.opening else []
    lines = [*opening, *commented(head, target.comment), body.text.rstrip("\n"), ""]
    return Exported(target.name, target.file(model), "\n".join(lines), unstated)


def commented(lines: Iterable[str], comment: tuple[str, str]) -> list[str]:
    """Each line as a comment of one line; two hyphens would end a comment of XML."""
    first, last = comment
    words = [one_line(line) for line in lines]
    return [f"{first} {re.sub('-(?=-)', '- ', line) if last else line} {last}".rstrip() for line in words]


def steering_sentences(model: Planar) -> tuple[str, ...]:
    """Sentences on rudders and azimuth thrusters, which only the vehicle file moves."""
    out = []
    for t in model.vehicle.thrusters:
        if t.rudder is not None:
            out.append(f"the rudder of {t.name}: its thruster stands without it")
        if t.steering == "azimuth":
            out.append(f"the steering of {t.name}: it points along azimuth = {t.azimuth:g} rad")
    return tuple(out)
