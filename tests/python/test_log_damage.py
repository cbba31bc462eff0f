"""Damaged files of every format: a log or one sentence, and nothing that crashes."""

import os

import numpy as np
import polars as pl
import pytest
from scipy.io import savemat

import log_files
from ivsid import IvsidError, read_log
from ivsid.log.matlab_structure import StructureError, check_structure
from ivsid.log.polars_panics import panics_unprinted
from sampling import NIGHTLY
from test_log_formats import mapping, sentence

ENDINGS = {
    "csv": "log.csv",
    "parquet": "log.parquet",
    "mat": "log.mat",
    "mcap": "log.mcap",
    "db3": "log.db3",
    "bin": "log.bin",
}


HEADS = {
    "mat": b"MATLAB 5.0 MAT-file, Platform: GLNXA64" + b" " * 86 + b"\x00\x01IM",
    "mcap": b"\x89MCAP0\r\n",
    "db3": b"SQLite format 3\x00",
    "bin": b"\xa3\x95\x80",
    "parquet": b"PAR1",
    "csv": b"t,u\n",
}


@pytest.mark.parametrize("kind", list(ENDINGS))
@pytest.mark.parametrize("damage", ["empty", "noise", "head and noise", "head alone"])
def test_damaged_files_of_every_kind(tmp_path, kind, damage):
    noise = np.random.default_rng(3).integers(0, 256, 4096, dtype=np.uint8).tobytes()
    content = {"empty": b"", "noise": noise, "head and noise": HEADS[kind] + noise, "head alone": HEADS[kind]}[damage]
    path = tmp_path / ENDINGS[kind]
    path.write_bytes(content)
    assert any(
        w in sentence(path)
        for w in ("not a readable", "is empty", "binary file", "no timed message", "at least 2", "holds no")
    )


def test_cut_files_of_every_kind_are_said_or_shorter(tmp_path):
    """A copy that broke off: either a sentence, or, where the format allows it, the samples before the break."""
    for kind, (write, table) in log_files.FORMATS.items():
        place = tmp_path / kind
        place.mkdir()
        path = write(place)
        if path.is_dir():
            path = next(p for p in path.iterdir() if p.suffix in (".db3", ".mcap", ".parquet"))
        data = path.read_bytes()
        path.write_bytes(data[: len(data) // 2])
        try:
            log = read_log(path, mapping(table))
        except IvsidError as error:
            assert "\n" not in str(error)
        else:
            assert 2 <= log.t.size < log_files.N, kind
            np.testing.assert_array_equal(log.columns["u"][:-1], log_files.U[: log.t.size - 1])


def mutated(data, rng):
    """Some bytes changed, a piece taken out, or the end gone."""
    made = bytearray(data)
    match rng.integers(3):
        case 0:
            for at in rng.integers(0, len(made), rng.integers(1, 8)):
                made[at] = rng.integers(256)
        case 1:
            del made[rng.integers(len(made)) :]
        case _:
            at = rng.integers(len(made))
            del made[at : at + rng.integers(1, 200)]
    return bytes(made)


@pytest.mark.parametrize("kind", list(log_files.FORMATS))
def test_any_damage_is_a_log_or_one_sentence(tmp_path, kind, capfd):
    """Nothing else may come out, whatever the libraries underneath think of the bytes."""
    write, table = log_files.FORMATS[kind]
    path = write(tmp_path)
    files = sorted(p for p in path.rglob("*") if p.is_file()) if path.is_dir() else [path]
    rng = np.random.default_rng(list(log_files.FORMATS).index(kind))
    sound = read_log(path, mapping(table)).notes
    told = 0
    for _ in range(40):
        target = files[rng.integers(len(files))]
        whole = target.read_bytes()
        target.write_bytes(mutated(whole, rng))
        try:
            log = read_log(path, mapping(table))
        except IvsidError as error:
            assert "\n" not in str(error)
            told += 1
        else:
            assert (np.diff(log.t) > 0).all() and all(v.size == log.t.size for v in log.columns.values())
            # A damaged stamp among many is left out with a note.
            told += log.notes != sound
        target.write_bytes(whole)
    assert told > 5
    if kind == "dataflash":
        assert capfd.readouterr() == ("", "")


def matlab(path, **variables):
    savemat(path, variables or {"t": log_files.T, "u": log_files.U})
    return path


# The gate changes each ninth byte, the nightly run each third.
@pytest.mark.sampled
def test_a_damaged_matlab_file_never_reaches_a_reader_that_follows_it(tmp_path):
    """One byte at a time in tags and sizes: SciPy alone ends the process on some of these."""
    whole = matlab(
        tmp_path / "whole.mat", t=np.arange(8.0), u=np.arange(8.0), s={"t": np.arange(8.0), "v": np.arange(8.0)}
    ).read_bytes()
    packed = tmp_path / "packed.mat"
    savemat(packed, {"t": np.arange(8.0), "u": np.arange(8.0)}, do_compression=True)
    for data in (whole, packed.read_bytes()):
        for at in range(124, len(data), 3 if NIGHTLY else 9):
            for byte in (0, 15, 255):
                path = tmp_path / "damaged.mat"
                path.write_bytes(data[:at] + bytes([byte]) + data[at + 1 :])
                try:
                    check_structure(path)
                    read_log(path)
                except StructureError:
                    assert "\n" not in sentence(path)
                except IvsidError:
                    pass


def test_whole_matlab_files_of_every_class_pass(tmp_path):
    import scipy.sparse

    cell = np.empty((2, 2), dtype=object)
    cell[:] = [["a", np.arange(3)], [{"b": 1.0}, 1 + 2j]]
    content = {
        "t": np.arange(9.0),
        "u": np.sin(np.arange(9.0)),
        "count": np.arange(9, dtype=np.uint8),
        "flags": np.arange(9) > 4,
        "words": "text",
        "cell": cell,
        "wave": np.arange(4) * 1j,
        "sparse": scipy.sparse.csc_matrix(np.diag([1.0, 0.0, 2.0])),
        "nested": {"deep": {"deeper": np.arange(9.0)}},
        "empty": np.zeros((0, 0)),
    }
    for packed in (False, True):
        path = tmp_path / "all.mat"
        savemat(path, content, do_compression=packed)
        check_structure(path)
        assert set(read_log(path, mapping({"columns": {"u": "u"}})).columns) == {"u"}


@pytest.mark.parametrize("cut", [b"\x00" * 40, b""])
def test_a_packed_matlab_file_that_cannot_be_unpacked(tmp_path, cut):
    path = tmp_path / "packed.mat"
    savemat(path, {"t": log_files.T, "u": log_files.U}, do_compression=True)
    data = path.read_bytes()
    path.write_bytes(data[:200] + cut + data[240:])
    assert "not a readable MATLAB v4 or v5 file" in sentence(path)


def test_a_damaged_parquet_file_prints_nothing(tmp_path, capfd):
    """Polars prints a page where its own reader panics."""
    path = tmp_path / "log.parquet"
    pl.DataFrame({"t": log_files.T, "u": log_files.U}).write_parquet(path)
    data, said = path.read_bytes(), 0
    rng = np.random.default_rng(1)
    for _ in range(60):
        at = int(rng.integers(len(data) - 600, len(data) - 8))
        path.write_bytes(data[:at] + data[at + int(rng.integers(1, 32)) :])
        try:
            read_log(path)
        except IvsidError as error:
            said += 1
            assert "\n" not in str(error) and "unwrap" not in str(error)
    assert said > 30 and capfd.readouterr().err == ""


def test_other_words_on_the_standard_error_are_not_lost(capfd):
    with panics_unprinted():
        os.write(2, b"something else\n")
    assert capfd.readouterr().err == "something else\n"


def test_lines_that_end_with_carriage_returns_and_open_quotes(tmp_path):
    path = tmp_path / "log.csv"
    path.write_bytes(b"t,u,v\r0,1,1\r1,1,1\r")
    assert "carriage returns alone" in sentence(path)
    path.write_text('t,"u,v\n0,1,1\n1,1,1\n')
    assert "a header that cannot be read" in sentence(path)
    path.write_text("t,u\n0,1\n1,0,5,5\n2,0,5\n")
    words = sentence(path)
    assert "a row has more cells than the 2 of the header" in words and "schema" not in words.lower()


def test_a_file_that_breaks_off_in_a_number_is_refused(tmp_path):
    path = tmp_path / "log.csv"
    rows = "t,u,v\n" + "".join(f"{k / 10},0.9{k:02d},0.1\n" for k in range(20))
    path.write_text(rows + "2.0,0.9")
    assert "breaks off in its last row, after 2 of 3 cells" in sentence(path)
    path.write_text(rows + "2.0,0.9,0.1")
    assert read_log(path).t.size == 21
    path.write_text(rows + "2.0,0.9\n")
    assert np.isnan(read_log(path).columns["v"][-1])
