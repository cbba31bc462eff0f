"""All steps from logs to a proposed vehicle file."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from ivsid.errors import IvsidError
from ivsid.log import Log, open_source, read_log
from ivsid.proposal.angles import angles_of
from ivsid.proposal.blanks import Answers, Demand, demand_of
from ivsid.proposal.columns import Columns, columns_of
from ivsid.proposal.folders import runs_in, short
from ivsid.proposal.found import Found, si_unit
from ivsid.proposal.mapping import Mapped, mapping_of, usable
from ivsid.proposal.noise import Number, Run, Stretch, sensors_of, unbounded
from ivsid.proposal.places import is_earthbound
from ivsid.proposal.signs import settled


@dataclass(frozen=True)
class Proposal:
    """What the logs say about a vehicle.

    Attributes:
        columns: by their names.
        channels: that are taken, with units and signs.
        mapped: the section ``[log]``.
        demands: of the thrusters.
        angles: of rudders and azimuth thrusters, by channel.
        sensors: numbers by section below ``[sensors]``.
        still: the stretch at rest behind the noise of inertial sensors, or None.
        logs: as the section ``[log]`` reads them.
        questions: that the names and the readings leave open.
        paths: of the logs that were looked at; the first one gives the columns.
        left: files of folders that were not taken, each with the reason.
        assumed: sentences on bounds that the logs do not show, and how to state them.
    """

    columns: Columns
    channels: dict[str, Found]
    mapped: Mapped
    demands: tuple[Demand, ...]
    angles: dict[str, Found]
    sensors: dict[str, list[Number]]
    still: Stretch | None
    logs: tuple[Log, ...]
    questions: tuple[str, ...]
    paths: tuple[Path, ...] = ()
    left: tuple[tuple[Path, str], ...] = ()
    assumed: tuple[str, ...] = ()

    @property
    def gravity(self) -> bool:
        """Whether the accelerations hold gravity."""
        return "ax" in self.channels and self.channels["ax"].meaning.gravity

    @property
    def unread(self) -> dict[str, Found]:
        """Channels and angles whose header states a unit that is not known, and that nobody has told."""
        return {n: f for n, f in {**self.channels, **self.angles}.items() if f.unread}

    def blanks(self, answers: Answers) -> tuple[str, ...]:
        """Keys of the file that stay open under these answers."""
        keys = [] if answers.mass is not None else ["hull.mass"]
        for d in self.demands:
            keys += [] if d.name in answers.positions else [f"thrusters.{d.name}.position"]
            keys += [f"thrusters.{d.name}.rudder"] if f"rudder_{d.name}" in self.angles else []
            keys += [] if d.name in answers.thrusts else [f"thrusters.{d.name}.quadratic"]
        keys += [f"log.columns.{n}.scale" for n in self.unread]
        return tuple(keys)


def propose(paths: Sequence[str | Path], scales: Mapping[str, float] | None = None) -> Proposal:
    """Looks at logs of one vehicle; the first one gives the columns, and all give ranges and noise.

    Args:
        paths: of logs, or of folders of runs. A file that is given has to be usable; one that a folder holds is left out with the reason.
        scales: SI units in one unit of a channel whose header states an unknown one, by channel.

    Raises:
        IvsidError: a log that is unusable, or whose columns have no known name.
    """
    named, searched, left = _searched(paths)
    ordered = [*named, *searched]
    with open_source(ordered[0]) as source:
        columns = _scaled(columns_of(source), scales or {})
        channels, frame, questions = settled(columns)
        channels, dropped = usable(channels)
        angles, unread, words = angles_of(columns.angles, channels)
        mapped = mapping_of(source, columns, channels, angles, frame)
    runs = [Run(Path(ordered[0]).name, channels, columns.demands)]
    demands = dict(columns.demands)
    looked = [ordered[0]]
    for path in ordered[1:]:
        try:
            run = _like(path, channels, columns)
        except IvsidError as error:
            if path not in searched:
                raise
            left.append((path, short(error, path)))
            continue
        looked.append(path)
        runs.append(run)
        demands = {n: _joined(f, run.demands.get(n)) for n, f in demands.items()}
    sensors, still = sensors_of(runs)
    logs = tuple(read_log(p, mapped.checked) for p in ordered[:1])
    return Proposal(
        columns=columns,
        channels=channels,
        mapped=mapped,
        demands=tuple(demand_of(n, f) for n, f in demands.items()),
        angles=angles,
        sensors=sensors,
        still=still,
        logs=logs,
        questions=(
            *questions,
            *filter(None, [columns.program.question]),
            *words,
            *dropped,
            *_earthbound(channels),
            *filter(None, map(_unknown_unit, {**channels, **angles}.items())),
            *_further(columns, (*columns.loose, *unread), logs[0]),
        ),
        assumed=tuple(unbounded(runs, sensors, still)),
        paths=tuple(looked),
        left=tuple(left),
    )


def _scaled(columns: Columns, scales: Mapping[str, float]) -> Columns:
    """The columns with the scales that the user knows."""

    def told(found: Mapping[str, Found]) -> dict[str, Found]:
        return {
            n: replace(f.with_meaning(scale=scales[n]), unread="") if f.unread and n in scales else f
            for n, f in found.items()
        }

    return replace(columns, channels=told(columns.channels), angles=told(columns.angles))


def _unknown_unit(named: tuple[str, Found]) -> str:
    """The question that an unknown unit of a header raises; nothing for a known one."""
    name, f = named
    if not f.unread:
        return ""
    return (
        f"the header {f.match.column} states the unit '{f.unread}', which is not known: how many {si_unit(name)} is one of it? "
        f"write that as scale of {name} under [log.columns]; its numbers under [sensors] are in '{f.unread}' as well"
    )


def _searched(paths: Sequence[str | Path]) -> tuple[list[Path], list[Path], list[tuple[Path, str]]]:
    """The logs that are named, those that the named folders hold, and what else those hold."""
    named: list[Path] = []
    searched: list[Path] = []
    left: list[tuple[Path, str]] = []
    for path in map(Path, paths):
        found = runs_in(path) if path.is_dir() else None
        if found is None:
            named.append(path)
        else:
            searched += found.runs
            left += found.left
    return named, searched, left


def _like(path: str | Path, channels: dict[str, Found], columns: Columns) -> Run:
    """Another log, with the meanings that the first one settled.

    Raises:
        IvsidError: a log without any of the columns.
    """
    with open_source(path) as source:
        found = columns_of(source)
    wanted = {f.match.column: (n, f) for n, f in channels.items()}
    there = {n: f for n, f in found.channels.items() if f.match.column in wanted}
    if not there:
        raise IvsidError(
            f"{path} has none of the columns {', '.join(list(wanted)[:8])} of the first log; give logs of one vehicle in one form, or propose a file for each"
        )
    same = {
        wanted[f.match.column][0]: f.with_meaning(**wanted[f.match.column][1].meaning.model_dump())
        for f in there.values()
    }
    names = {f.match.column: n for n, f in columns.demands.items()}
    return Run(
        Path(path).name, same, {names[f.match.column]: f for f in found.demands.values() if f.match.column in names}
    )


def _joined(a: Found, b: Found | None) -> Found:
    """The demands of a thruster in two logs, for their range."""
    if b is None:
        return a
    return Found(a.match, a.table, np.r_[a.t, b.t], np.r_[a.values, b.values], a.stated)


def _earthbound(channels: dict[str, Found]) -> list[str]:
    """The question that a position from latitude and longitude raises."""
    columns = [f.match.column for f in channels.values() if is_earthbound(f)]
    if not columns:
        return []
    return [
        f"{' and '.join(columns)} are read as metres from the first fix, on a plane that is 0.1 m off at 1 km from it and 10 m at 10 km: does the run stay near it?"
    ]


def _further(columns: Columns, loose: Sequence[str], log: Log) -> list[str]:
    """Questions about what the log lacks."""
    words = []
    posed = all(c in log.columns for c in ("x", "y", "psi"))
    lacking = [c for c in ("u", "v", "r") if c not in log.columns]
    if lacking and not posed:
        words.append(
            f"no column is known for {', '.join(lacking)}: which column holds it (add it to [log.columns])? identify and diagnose need u, v and r, or a pose x, y, psi"
        )
    elif lacking:
        words.append(
            f"no column is known for {', '.join(lacking)}: the velocities follow from the pose under [sensors.limits], and are wide"
        )
    if not columns.demands:
        words.append(
            "no column is known for the thrusters' demands: which columns hold them (demand_NAME under [log.columns], and [[thrusters]])?"
        )
    if loose:
        words.append(
            f"{', '.join(loose)} may be the angle of a rudder or an azimuth thruster: if so, add rudder_NAME or azimuth_NAME to [log.columns] and "
            "rudder or steering to the thruster NAME"
        )
    return words
