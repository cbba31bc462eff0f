"""Long logs in bounded memory: read, bounded and solved in small pieces and in files, with the bits of one piece in memory."""

import mmap
import os
import weakref
from dataclasses import fields, is_dataclass
from importlib.resources import files
from types import SimpleNamespace

import numpy as np
import polars as pl
import pytest

import ivsid
from ivsid.effects import terms_of
from ivsid.errors import IvsidError
from ivsid.files.log_map import LogMap
from ivsid.files.records import sealed, to_json
from ivsid.log import angles, quality, read_log, source
from ivsid.memory import order, pieces, room
from ivsid.programme.scenario import parse_scenario
from ivsid.propulsion.actuation import nominal_force
from ivsid.report import scaling, series
from ivsid.rows import build_rows
from ivsid.sensors import bounds
from ivsid.simulation import simulate
from ivsid.validation import checks
from ivsid.vehicle import parse_vehicle
from test_pieces import STEERED

SWAN = ("swan", "swan_train")
OTTER = ("otter", "otter_programme")
ROV = ("vectored_rov", "vectored_rov_programme")


def text(name):
    return (files("ivsid") / "data" / f"{name}.toml").read_text()


def small_pieces(monkeypatch):
    """Pieces of a few dozen rows, and every array in a file."""
    monkeypatch.setattr(pieces, "PIECE", 97)
    monkeypatch.setattr(room, "LARGE", 1)
    monkeypatch.setattr(order, "FEW", 64)
    monkeypatch.setattr(source, "AT_ONCE", 101)
    monkeypatch.setattr(checks, "TOGETHER", 250)
    monkeypatch.setattr(series, "PART", 128)


def written(folder, names, counted=False):
    """Forty seconds of a shipped vehicle with gaps at the borders of pieces, missing samples, and stamps since 1970."""
    vehicle = parse_vehicle(text(names[0]), names[0])
    scenario = parse_scenario(text(names[1]), names[1]).model_copy(update={"duration": 40.0, "rate": 20.0})
    made = simulate(vehicle, scenario, 3)
    t, columns = made.t.copy(), {k: x.copy() for k, x in made.columns.items()}
    t[97:] += 0.4
    t[101:] += 3.0
    columns["u"][300:304] = np.nan
    columns[next(c for c in columns if c.startswith("demand"))][400] = np.nan
    stamps = pl.Series(np.round(t * 1e9).astype(np.int64) + 1_700_000_000_000_000_000).cast(pl.Datetime("ns"))
    path = folder / "log.parquet"
    pl.DataFrame({"t": stamps if counted else t, **columns}).write_parquet(path, row_group_size=150)
    return vehicle, path


def bytes_of(value):
    """Every number of a result, bit by bit."""
    if is_dataclass(value) and not isinstance(value, type):
        return [bytes_of(getattr(value, f.name)) for f in fields(value) if f.name not in ("fit", "vehicle")]
    if isinstance(value, ivsid.IntervalArray):
        return [value.lower.tobytes(), value.upper.tobytes()]
    if isinstance(value, np.ndarray):
        return value.tobytes()
    if isinstance(value, tuple | list):
        return [bytes_of(v) for v in value]
    return repr(value)


@pytest.mark.parametrize(
    ("names", "counted", "options"),
    [
        (SWAN, True, {"bias": "log", "physical": True}),
        *(
            pytest.param(*case, marks=pytest.mark.nightly)
            for case in (
                (SWAN, False, {}),
                (SWAN, False, {"rows": "both", "window": (0.5, 2.0)}),
                (SWAN, False, {"rows": "integral", "method": "qr"}),
                (OTTER, True, {}),
                (ROV, False, {"rows": "integral"}),
            )
        ),
    ],
)
def test_a_log_in_pieces_and_in_files_has_the_bits_of_one_in_memory(tmp_path, monkeypatch, names, counted, options):
    vehicle, path = written(tmp_path, names, counted)
    whole = ivsid.identify(vehicle, path, **options)
    checked = ivsid.validate(whole, path, tubes=False) if names != OTTER and "method" not in options else None
    log = read_log(path, vehicle.log)
    small_pieces(monkeypatch)
    again = read_log(path, vehicle.log)
    assert (
        bytes_of(again.t) == bytes_of(log.t) and repr(again.quality) == repr(log.quality) and again.notes == log.notes
    )
    parts = ivsid.identify(vehicle, path, **options)
    assert to_json(sealed(parts.record())) == to_json(sealed(whole.record()))
    assert sum(whole.rows.values()) > 600
    if checked is None:
        return
    split = ivsid.validate(whole, path, tubes=False)
    # Means over rows are sums, which round by their parts; every bound is the same.
    for a, b in zip(split.forces, checked.forces, strict=True):
        assert bytes_of([a.time, a.measured, a.predicted, a.falsified]) == bytes_of(
            [b.time, b.measured, b.predicted, b.falsified]
        )
        assert a.coverage == b.coverage and a.sigma == pytest.approx(b.sigma, rel=1e-12)
        assert np.allclose([a.mean, a.mean_absolute], [b.mean, b.mean_absolute], rtol=1e-9, atol=1e-12)
    assert split.motion.reason == checked.motion.reason
    assert np.allclose(split.motion.simulated, checked.motion.simulated, rtol=1e-9, atol=1e-12)
    assert split.motion.rms == pytest.approx(checked.motion.rms, rel=1e-9)


def test_a_validation_gives_its_rows_back_before_it_simulates(tmp_path, monkeypatch):
    """The rows and the bounded log lay on the disk beside the simulated motion: 607 bytes a row where 448 are enough."""
    vehicle, path = written(tmp_path, SWAN)
    fit = ivsid.identify(vehicle, path)
    log = read_log(path, vehicle.log)
    small_pieces(monkeypatch)
    held, most, there = [0], [0], []

    def mapped(file, size):
        made = mmap.mmap(file, size)
        held[0] += size
        most[0] = max(most[0], held[0])
        weakref.finalize(made, lambda: held.__setitem__(0, held[0] - size))
        return made

    def simulated(*given):
        there.append((held[0], most[0]))
        return simulate_windows(*given)

    simulate_windows = checks.simulate_windows
    monkeypatch.setattr(room, "mmap", SimpleNamespace(mmap=mapped))
    monkeypatch.setattr(checks, "simulate_windows", simulated)
    ivsid.validate(fit, log, tubes=False)
    ((left, peak),) = there
    assert 0 < left < 0.6 * peak


@pytest.mark.parametrize(
    "claim",
    [
        'steering = "azimuth"\nadvance_loss = 0.05',
        'time_constant = 0.4\nlag = "thrust"',
        "rudder = { area = 0.02, aspect_ratio = 2.0, position = -0.6 }",
    ],
)
def test_thrusters_with_a_history_push_the_same_in_pieces_and_in_files(tmp_path, monkeypatch, claim):
    vehicle = parse_vehicle(STEERED.replace("{claim}", claim), "a.toml")
    rng, n = np.random.default_rng(5), 900
    t = np.arange(n) * 0.05
    t[194:] += 1.0
    names = ("u", "v", "r", "ax", "ay", "psi", "azimuth_stern", "rudder_stern")
    columns = {c: rng.uniform(-0.3, 0.3, n) for c in names}
    columns["psi"] = np.angle(np.exp(0.1j * np.arange(n)))
    columns["psi"][90:110] = np.nan
    columns["demand_stern"] = np.repeat(rng.uniform(-90, 90, n // 9), 9)
    path = tmp_path / "log.parquet"
    pl.DataFrame({"t": t, **columns}).write_parquet(path, row_group_size=150)

    def made():
        bounded = bounds.bound_log(read_log(path), vehicle)
        rows = build_rows(bounded, vehicle, terms_of(vehicle), kind="both")
        return bytes_of(
            [bounded.channels["psi"], rows.matrix, rows.right, rows.time, nominal_force(vehicle, bounded.log)]
        )

    whole = made()
    small_pieces(monkeypatch)
    assert made() == whole


def cells(rows=700):
    rng = np.random.default_rng(4)
    t, u = 0.05 * np.arange(rows), rng.normal(size=(4, rows))
    return t, dict(zip(("u", "v", "r", "demand_port"), u, strict=True))


def in_text(t, columns, *, comma=False, padded=False, others=True):
    """A CSV file; numbers with decimal commas, or with blanks around some of them."""
    sign = ";" if comma else ","
    shown = [[*(f"{x}" for x in row)] for row in zip(t, *columns.values(), strict=True)]
    if comma:
        shown = [[c.replace(".", ",") for c in row] for row in shown]
    if padded:
        shown[650][2] = f" {shown[650][2]} "
    lines = [sign.join([*row, f'"words{sign}{k}"'] if others else row) for k, row in enumerate(shown)]
    return "\n".join([sign.join(["t", *columns, *(["remark"] if others else [])]), *lines]) + "\n"


def both(path, monkeypatch, mapping=None):
    """A log, or the sentence about it, as a short file and as a long one."""

    def read():
        try:
            return bytes_of(read_log(path, mapping)), ""
        except IvsidError as error:
            return None, str(error)

    short = read()
    with monkeypatch.context() as patch:
        small_pieces(patch)
        return short, read()


DATES = [f"2024-05-31T12:{k // 60:02}:{k % 60:02}.125Z" for k in range(700)]
TEXTS = {
    "numbers": in_text(*cells()),
    "no other column": in_text(*cells(), others=False),
    "a padded cell": in_text(*cells(), padded=True),
    "decimal commas": in_text(*cells(), comma=True),
    "dates": in_text(DATES, cells()[1]),
    "an epoch": in_text([f"{1_700_000_000 + k // 20}.{50 * (k % 20):03}" for k in range(700)], cells()[1]),
    "nanoseconds": in_text([1_700_000_000_000_000_123 + 50_000_000 * k for k in range(700)], cells()[1]),
    "missing cells": in_text(*cells()).replace(".1", "nan", 3).replace("\n1.0,", "\n1.0,null,", 0),
    "a word": in_text(*cells()).replace("\n30.0,", "\n30.0,soon", 1),
    "an infinite cell": in_text(*cells()).replace("\n30.0,", "\n30.0,inf,,,,\n30.01,", 1),
    "a row with more cells": in_text(*cells()).replace("\n30.0,", "\n30.0,1,2,3,4,5,6,7,", 1),
    "commas and points": in_text(*cells(), comma=True).replace("\n30,0;", "\n30,0;1.5;1,5;1,5;1,5;a\n30,01;", 1),
    "disorder": in_text(*cells()).replace("\n30.0,", "\n29.0,", 1),
}


@pytest.mark.parametrize("kind", TEXTS)
def test_a_long_text_is_the_log_of_a_short_one(tmp_path, monkeypatch, kind):
    """Read a part at a time, with the types of the whole file: the same numbers, or the same sentence."""
    path = tmp_path / "log.csv"
    path.write_text(TEXTS[kind])
    short, long = both(path, monkeypatch)
    assert long == short and (short[0] is not None) != bool(short[1])
    if not short[1]:
        part = LogMap.model_validate({"span": [5.0, 9.0]})
        short, long = both(path, monkeypatch, part)
        assert long == short and short[0] is not None


def numbers():
    rng = np.random.default_rng(7)
    yield rng.normal(size=1001)
    yield np.diff(0.001 * np.arange(1002))
    yield np.round(rng.normal(size=1000), 1)
    yield np.where(rng.random(999) < 0.5, -0.0, 0.0)
    yield np.where(rng.random(500) < 0.4, np.inf, -1.0)


@pytest.mark.parametrize("x", [*numbers()])
def test_ranks_are_those_of_a_sort(monkeypatch, x):
    monkeypatch.setattr(order, "FEW", 37)
    assert order.median(x.size, lambda s: x[s]) == np.median(x)
    ranks = np.linspace(0, x.size - 1, 40).astype(int).tolist()
    assert (order.places(x.size, lambda s: x[s], ranks) == np.argsort(x, kind="stable")[ranks]).all()
    assert order.places(x.size, lambda s: x[s], []).size == 0


def test_steps_turns_and_outliers_do_not_depend_on_pieces(monkeypatch):
    monkeypatch.setattr(pieces, "PIECE", 41)
    rng = np.random.default_rng(8)
    t = np.cumsum(0.05 + 0.01 * rng.random(1000))
    log = ivsid.log.Log("a", "0" * 64, t, {})
    steps = np.diff(t)
    closest = np.minimum(np.minimum(np.r_[steps[0], steps], np.r_[steps, steps[-1]]), np.median(steps))
    assert (bounds._sampling_interval(log) == closest).all()
    psi = np.angle(np.exp(1j * np.cumsum(rng.normal(scale=0.4, size=1000))))
    followed = psi - np.r_[0.0, np.cumsum(np.round(np.diff(psi) / angles.TURN))] * angles.TURN
    assert np.abs(angles.unwrapped(psi)[0] - followed).max() < 1e-12
    u = np.cumsum(0.01 * rng.normal(size=1000))
    u[[40, 41 * 3, 500]] += 9.0
    assert (quality._spikes("u", u) == [40, 123, 500]).all()
    # A force that turns round makes a corner, wherever a piece ends.
    for k in (2, 81, 82, 83, 300, 997):
        u += np.maximum(6.0 - 3.0 * np.abs(np.arange(1000) - k), 0.0)
        assert (quality._spikes("u", u) == [40, 123, 500]).all()
    held = np.repeat(rng.normal(size=100), 10)
    held[[3, 40, 41]] = np.nan
    assert quality._repeats(held) and not quality._repeats(np.r_[1.0, np.nan, 2.0, np.nan])
    assert quality._repeats(np.r_[1.0, np.full(90, np.nan), 1.0])


def test_thinned_series_keep_every_peak(monkeypatch):
    x = np.random.default_rng(9).normal(size=(3, 10_007))
    x[1, 100:200] = np.nan
    t = np.arange(10_007.0)
    whole = series.thinned(t, x, 600)
    monkeypatch.setattr(series, "PART", 500)
    for a, b in zip(whole, series.thinned(t, list(x), 600), strict=True):
        assert np.array_equal(a, b, equal_nan=True)
    assert np.nanmax(whole[1]) == np.nanmax(x) and np.nanmin(whole[1]) == np.nanmin(x)
    monkeypatch.setattr(scaling, "SAMPLES", 100)
    low, high = scaling.robust_range(list(x))
    assert low <= np.nanmin(x) and high >= np.nanmax(x)


def test_a_large_array_ends_with_its_file(monkeypatch, tmp_path):
    monkeypatch.setattr(room, "LARGE", 1 << 16)
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    monkeypatch.setattr("tempfile.tempdir", None)
    x = room.room((2, 1 << 13), room.DOUBLE)
    x[:] = 1.0
    assert x.sum() == 1 << 14 and x.flags.writeable and not list(tmp_path.iterdir())
    monkeypatch.setattr(os, "posix_fallocate", lambda *_: (_ for _ in ()).throw(OSError(28, "No space left on device")))
    with pytest.raises(IvsidError, match=r"cannot be had in .*No space left on device.*TMPDIR"):
        room.room(1 << 14, room.DOUBLE)
