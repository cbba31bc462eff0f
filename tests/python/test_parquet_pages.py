"""Damaged sizes in Parquet files: a sentence before Polars takes memory for them, and sound files read as before.

The files are written here field by field, so that each size can be another one than that of the page.
"""

import io
import time

import numpy as np
import polars as pl
import pytest

from ivsid import IvsidError, read_log
from ivsid.log.parquet_pages import check_pages

N = 100
T, U = np.arange(N) / 10, np.sin(np.arange(N) / 30)
# What a damaged integer of four bytes asks for.
HUGE = 2**31 - 1


def varint(number):
    made = b""
    while number >= 0x80:
        made += bytes([number & 0x7F | 0x80])
        number >>= 7
    return made + bytes([number])


def whole(number):
    return varint(number * 2 if number >= 0 else -2 * number - 1)


def struct(**fields):
    """Fields f1, f2, ... of a structure: integers (those of 64 bits in a tuple), texts, structures, and lists of them."""
    made, last = b"", 0
    for name, value in fields.items():
        number = int(name[1:])
        kind, data = (6, whole(value[0])) if isinstance(value, tuple) else of_kind(value)
        made += bytes([number - last << 4 | kind]) + data
        last = number
    return made + b"\x00"


def of_kind(value):
    match value:
        case int():
            return 5, whole(value)
        case str():
            return 8, varint(len(value)) + value.encode()
        case bytes():
            return 12, value
    items = [of_kind(v) for v in value]
    return 9, bytes([0xF0 | items[0][0]]) + varint(len(items)) + b"".join(data for _, data in items)


def file(change=None, to=HUGE):
    """Two columns of doubles without nulls, the second with a dictionary; one size is changed."""
    size = {"rows": N, "group": N, "values": N, "page": N, "packed": 8 * N, "unpacked": 8 * N, "words": N, "at": 0}
    if change is not None:
        size[change] = to
    out = io.BytesIO(b"PAR1")
    out.seek(4)
    chunks = []
    for name, column in (("t", T), ("u", U)):
        begin, data = out.tell(), column.tobytes()
        damaged = size if name == "u" else dict.fromkeys(size, N) | {"packed": 8 * N, "unpacked": 8 * N, "at": 0}
        first = {}
        if name == "u":
            out.write(struct(f1=2, f2=8 * N, f3=8 * N, f7=struct(f1=size["words"], f2=0)) + data)
            first = {"f11": (begin,)}
            indices = np.packbits(
                (np.arange(N)[:, None] >> np.arange(8) & 1).astype(np.uint8).ravel(), bitorder="little"
            )
            data = bytes([8]) + varint((N + 7) // 8 << 1 | 1) + indices.tobytes() + bytes(4)
        packed = damaged["packed"] if damaged["packed"] != 8 * N else len(data)
        unpacked = damaged["unpacked"] if damaged["unpacked"] != 8 * N else len(data)
        page = out.tell()
        head = struct(f1=damaged["page"], f2=0 if name == "t" else 8, f3=3, f4=3)
        out.write(struct(f1=0, f2=unpacked, f3=packed, f5=head) + data)
        length = out.tell() - begin
        described = struct(
            f1=5, f2=[0, 8], f3=[name], f4=0, f5=(damaged["values"],), f6=(length,), f7=(length,),
            f9=(page + damaged["at"],), **first,
        )  # fmt: skip
        chunks.append(struct(f2=(begin,), f3=described))
    schema = [struct(f4="schema", f5=2), *(struct(f1=5, f3=0, f4=n) for n in ("t", "u"))]
    group = struct(f1=chunks, f2=(16 * N,), f3=(size["group"],))
    footer = struct(f1=1, f2=schema, f3=(size["rows"],), f4=[group])
    return out.getvalue() + footer + len(footer).to_bytes(4, "little") + b"PAR1"


def read(path):
    return read_log(path)


def test_the_written_file_is_sound(tmp_path):
    path = tmp_path / "log.parquet"
    path.write_bytes(file())
    log = read(path)
    assert np.array_equal(log.t, T) and np.array_equal(log.columns["u"], U)


@pytest.mark.parametrize(
    ("change", "to", "words"),
    [
        ("unpacked", HUGE, "a page states 2,147,483,647 unpacked bytes"),
        ("packed", HUGE, "a page states 2,147,483,647 bytes"),
        ("page", HUGE, "a page states 2,147,483,647 values, and its column has 100 left"),
        ("page", N + 1, "a page states 101 values"),
        ("words", HUGE, "a dictionary states 2,147,483,647 values in 800 bytes"),
        ("values", 2**40, "a column states 1,099,511,627,776 values in 100 rows"),
        ("values", N - 1, "a column states 99 values in 100 rows"),
        ("group", 2**40, "a column states 100 values in 1,099,511,627,776 rows"),
        ("rows", 2**62, "it states 4,611,686,018,427,387,904 rows, and its row groups 100"),
        *((c, -1, "a size is missing or below zero") for c in ("unpacked", "packed", "page", "words", "values")),
        *((c, -1, "a size is missing or below zero") for c in ("group", "rows")),
    ],
)
def test_a_damaged_size_gets_a_sentence_of_its_own(tmp_path, change, to, words):
    path = tmp_path / "log.parquet"
    path.write_bytes(file(change, to))
    with pytest.raises(IvsidError, match="is not a readable CSV or Parquet table") as told:
        read(path)
    assert words in str(told.value) and "\n" not in str(told.value)


def test_no_change_of_a_byte_of_the_headers_leaves_the_check_with_another_error(tmp_path):
    """Every byte of the footer and of the headers, and every length of the file."""
    path, sound = tmp_path / "log.parquet", file()
    path.write_bytes(sound)
    check_pages(path)
    data = {*range(30, 780), *range(870, 1650)}
    refused = 0
    for k in sorted(set(range(len(sound))) - data):
        for byte in (0x00, 0x7F, 0xFF, 0xFC, 0x0C, 0x19):
            path.write_bytes(sound[:k] + bytes([byte]) + sound[k + 1 :])
            try:
                check_pages(path)
            except ValueError:
                refused += 1
    for k in range(9, len(sound), 7):
        path.write_bytes(sound[:k])
        with pytest.raises(ValueError, match="its end is missing"):
            check_pages(path)
    assert refused > 200


@pytest.mark.parametrize("packing", ["zstd", "snappy", "gzip", "uncompressed", "lz4", "brotli"])
def test_sound_files_are_read_as_before(tmp_path, packing):
    """Nulls, words, dictionaries, lists, structures, constants and empty columns, in one row group and in several, in large and in small pages."""
    n = range(3000)
    frame = pl.DataFrame(
        {
            "t": [k / 10 for k in n],
            "u": [None if k % 7 == 0 else float(np.sin(k)) for k in n],
            "word": [None if k % 11 == 0 else f"mode {k % 13}" for k in n],
            "flag": [k % 2 == 0 for k in n],
            "list": [[k] * (k % 4) for k in n],
            "structure": [{"a": k, "b": [str(k)]} for k in n],
            "constant": [1.0] * 3000,
            "kind": pl.Series([f"k{k % 3}" for k in n], dtype=pl.Categorical),
            "empty": pl.Series([None] * 3000, dtype=pl.Float64),
        }
    )
    path = tmp_path / "log.parquet"
    for rows in (None, 700):
        for page in (None, 2000):
            frame.write_parquet(path, compression=packing, row_group_size=rows, data_page_size=page)
            check_pages(path)
    log = read(path)
    seen = frame["u"].is_not_null().to_numpy()
    assert log.t.size == 3000
    assert np.array_equal(log.columns["u"][seen], frame["u"].drop_nulls().to_numpy())
    assert np.isnan(log.columns["u"][~seen]).all()
    frame.head(0).write_parquet(path)
    check_pages(path)


@pytest.mark.nightly
def test_the_check_costs_a_fiftieth_of_the_reading(tmp_path):
    """Processor time for a million rows of 12 columns."""
    rng = np.random.default_rng(1)
    path = tmp_path / "log.parquet"
    names = ("u", "v", "r", "ax", "ay", "psi", "x", "y", "demand_port", "demand_starboard", "extra")
    columns = {c: rng.standard_normal(1_000_000) for c in names}
    pl.DataFrame({"t": np.arange(1_000_000) / 100, **columns}).write_parquet(path)

    def spent(task):
        begin = time.process_time()
        task(path)
        return time.process_time() - begin

    assert min(spent(check_pages) for _ in range(5)) < 0.02 * min(spent(read_log) for _ in range(3))
