"""Logs of one vehicle over a season, and the rows of all of them in one piece."""

import shutil

import numpy as np

from ivsid.effects import terms_of
from ivsid.files.shipped import shipped
from ivsid.intervals import IntervalArray
from ivsid.linear import regression
from ivsid.log import read_log
from ivsid.programme.scenario import read_scenario
from ivsid.rows import build_rows
from ivsid.sensors.bounds import bound_log
from ivsid.simulation import simulate
from ivsid.vehicle import read_vehicle
from ivsid.workflow.log_files import csv

DAY = 86400.0
FIRST = 1.7e9


def season(folder, number, changed=None, duration=60.0, effects=None, scenario=None):
    """Logs of the same Swan, one a day; from log ``changed`` on it has the effects."""
    folder.mkdir(parents=True, exist_ok=True)
    vehicle = read_vehicle("swan")
    programme = read_scenario(scenario or shipped("swan_train", "_programme")).model_copy(update={"duration": duration})
    for k in range(number):
        hidden = (effects or {}) if changed is not None and k >= changed else {}
        made = simulate(vehicle, programme, k + 1, hidden, thrusters=7)
        (folder / f"day{k:03d}.csv").write_text(csv(made.t + FIRST + DAY * k, made.columns))
    return folder


def rows_of(path, vehicle, **options):
    """The rows of one log, as an identification makes them."""
    log = read_log(path, vehicle.log)
    return build_rows(bound_log(log, vehicle), vehicle, terms_of(vehicle), **options)


def in_one_piece(paths, vehicle, columns, **options):
    """The feasible set of the rows of all logs, one after the other, for some columns that no other column shares a row with."""
    lower, upper, low, high = [], [], [], []
    for path in paths:
        rows = rows_of(path, vehicle, **options)
        kept = (rows.matrix.lower[:, columns] != 0) | (rows.matrix.upper[:, columns] != 0)
        mine = kept.any(axis=1)
        if columns[0] == 0:
            mine |= ~((rows.matrix.lower != 0) | (rows.matrix.upper != 0)).any(axis=1)
        lower.append(rows.matrix.lower[mine][:, columns])
        upper.append(rows.matrix.upper[mine][:, columns])
        low.append(rows.right.lower[mine])
        high.append(rows.right.upper[mine])
    matrix = IntervalArray(np.vstack(lower), np.vstack(upper))
    return regression.feasible_set(matrix, IntervalArray(np.concatenate(low), np.concatenate(high)))


def seasons(once):
    """Folders ``calm``, three logs without a change, and ``changed``, six logs whose drag grows by a sixth before the fourth."""

    def make(folder):
        season(folder / "changed", 6, 3, effects={"drag.surge.quadratic": 40.0})
        (folder / "calm").mkdir()
        for path in sorted((folder / "changed").iterdir())[:3]:
            shutil.copy(path, folder / "calm")
        return folder

    return once("seasons", make)
