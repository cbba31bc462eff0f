"""Logs that hold samples of one run: what the second says of the first is no evidence of its own."""

import os
from dataclasses import replace

import numpy as np
import pytest
from tests.exam.cases import case
from tests.exam.seal import seal

from diagnosis_logs import logs_of, vehicle_of
from ivsid import diagnose
from ivsid.diagnosis import search
from ivsid.diagnosis.data.one_run import note, one_run, shared_rows
from ivsid.log import Log, read_log
from ivsid.vehicle import read_vehicle

RNG = np.random.default_rng(int(os.environ.get("IVSID_SEED", "0")))
T = np.arange(5000) * 0.1


def log_of(name, columns, t=T):
    return Log(name, "0" * 64, t, columns)


def measured():
    """Noise to three decimals: values come again, rows do not."""
    return {k: np.round(RNG.normal(size=T.size), 3) for k in ("u", "v", "r", "demand_a")}


WHOLE = log_of("1.csv", measured())


def part(rows, shift=0.0):
    return log_of("2.csv", {k: x[rows] for k, x in WHOLE.columns.items()}, T[rows] + shift)


@pytest.mark.parametrize(
    ("other", "share"),
    [
        (log_of("2.csv", measured()), 0.0),
        (part(slice(None), 100.0), 1.0),
        # A window, every second row, and a window that reaches beyond the other's end.
        (part(slice(1000, 3000), -7.0), 1.0),
        (part(slice(None, None, 2)), 1.0),
        (log_of("2.csv", {k: np.r_[x[3000:], RNG.normal(size=3000)] for k, x in WHOLE.columns.items()}), 0.4),
        # Missing samples and the sign of a zero are no other run.
        (log_of("2.csv", {**WHOLE.columns, "psi": np.full(T.size, np.nan)}), 1.0),
        (log_of("2.csv", {"psi": T}), 0.0),
    ],
)
def test_the_share_is_of_rows_that_stand_in_both(other, share):
    assert shared_rows(WHOLE, other) == shared_rows(other, WHOLE) == pytest.approx(share, abs=0.04)
    assert one_run(WHOLE, other) is (share > 0.1) and bool(note(WHOLE, other)) is (share > 0.1)


def test_rows_at_rest_stand_in_any_run():
    """A simulation without noise is at rest for two fifths of both runs, and one log is at rest throughout."""
    first, second = (
        log_of(name, {k: np.where(T < 200.0, 0.0, x) for k, x in measured().items()}) for name in ("1.csv", "2.csv")
    )
    assert not one_run(first, second) and one_run(first, first) and not note(first, second)
    still = log_of("3.csv", {k: np.zeros(T.size) for k in WHOLE.columns})
    assert not one_run(first, still) and not one_run(still, first)


def test_rows_with_holes_and_zeros_of_either_sign_are_the_same():
    columns = {"u": np.where(T % 3 < 1, np.nan, 0.0), "v": RNG.normal(size=T.size)}
    again = {"u": np.where(T % 3 < 1, np.nan, -0.0), "v": columns["v"]}
    assert shared_rows(log_of("1.csv", columns), log_of("2.csv", again)) == 1.0


def test_the_note_says_what_is_shared():
    assert "2.csv has the same samples as 1.csv: what" in note(WHOLE, part(slice(None)))
    said = note(WHOLE, part(slice(1000, 3000)))
    assert "2.csv and 1.csv have 100 % of the shorter one's rows in common: what" in said and "another run" in said


@pytest.mark.parametrize("same", [True, False])
def test_no_cause_is_asked_of_the_same_run(monkeypatch, same):
    """The falls of one run, counted twice, would be an evidence that nobody has."""
    vehicle = vehicle_of()
    train, test = logs_of(vehicle, {"drag.yaw.linear": 8.0})
    asked = []

    class Asked(Exception):
        pass

    def select(*given, **_):
        asked.append(given[3])
        # What the search does with it is no matter here.
        raise Asked

    monkeypatch.setattr(search, "select", select)
    rows = slice(100, None)
    again = replace(train, name="2.csv", t=train.t[rows], columns={k: x[rows] for k, x in train.columns.items()})
    with pytest.raises(Asked):
        diagnose(vehicle, train, again if same else test, null_logs=0)
    assert [run is None for run in asked] == [same]


# Nightly: a whole diagnosis. The wind on a house shows in this log together with another one of the same vessel, and not with itself.
@pytest.mark.nightly
def test_a_log_beside_itself_shows_no_more_than_alone(tmp_path):
    folder = seal(case(300533, what="outside", sea="any", sensors="any"), tmp_path, tmp_path / "answers")
    vehicle = read_vehicle(folder / "vehicle.toml")
    train = read_log(folder / "1.csv", vehicle.log)
    assert diagnose(vehicle, train, train, null_logs=0).verdict == "adequate"
