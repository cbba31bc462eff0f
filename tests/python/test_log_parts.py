"""Logs of which only some bytes are read: MCAP by its chunk index, Parquet by columns and row groups, from disks and from stores."""

import zlib
from pathlib import Path
from struct import Struct

import numpy as np
import polars as pl
import pytest
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin, Writer
from rosbags.rosbag2.storage_mcap import DECOMPRESSORS
from rosbags.typesys import Stores, get_typestore

import log_files
from ivsid import IvsidError, read_log
from ivsid.log import mcap_index, open_source
from ivsid.log.mcap_mend import mend
from ivsid.log.parts import PARTS, Parts
from ivsid.log.unpacked import bounded_chunks
from test_log_formats import mapping

LONG = Struct("<Q")
# 40 chunks of about a megabyte, with a picture beside each sample of the vehicle.
SAMPLES, PIXELS = 400, 105_000


def recording(folder, samples=SAMPLES, pixels=PIXELS, packing=""):
    """Velocities, rates and demands at 10 Hz beside pictures of another topic, in chunks of a megabyte."""
    store = get_typestore(Stores.ROS2_HUMBLE)
    kinds = store.types
    vector, twist = (kinds[f"geometry_msgs/msg/{k}"] for k in ("Vector3", "Twist"))
    number, array = (kinds[f"std_msgs/msg/{k}"] for k in ("Float64", "UInt8MultiArray"))
    layout = kinds["std_msgs/msg/MultiArrayLayout"](dim=[], data_offset=0)
    rng, still = np.random.default_rng(2), vector(x=0.0, y=0.0, z=0.0)
    writer = Writer(folder, version=9, storage_plugin=StoragePlugin.MCAP)
    if packing:
        writer.set_compression(CompressionMode.STORAGE, CompressionFormat.ZSTD)
    with writer:
        topics = {
            name: writer.add_connection(name, kind.__msgtype__, typestore=store)
            for name, kind in (("/dvl", twist), ("/gyro", twist), ("/port", number), ("/camera", array))
        }
        for k in range(samples):
            ns, t = 1_700_000_000_000_000_000 + k * 100_000_000, 0.1 * k
            picture = rng.integers(0, 256, pixels, dtype=np.uint8)
            sent = {
                "/dvl": twist(linear=vector(x=1.0 + np.sin(t), y=0.1 * np.cos(t), z=0.0), angular=still),
                "/gyro": twist(linear=still, angular=vector(x=0.0, y=0.0, z=0.2 * np.sin(t))),
                "/port": number(data=20.0 + k % 7),
                "/camera": array(layout=layout, data=picture),
            }
            for name, made in sent.items():
                writer.write(topics[name], ns, store.serialize_cdr(made, type(made).__msgtype__))
    return next(folder.glob("*.mcap"))


MAP = {
    "base": "u",
    "columns": {"u": "/dvl/linear.x", "v": "/dvl/linear.y", "r": "/gyro/angular.z", "demand_port": "/port/data"},
}


def spanned(begin, end):
    return mapping({**MAP, "span": None if begin is None else [begin, end]})


@pytest.fixture(scope="module")
def bag(tmp_path_factory):
    return recording(tmp_path_factory.mktemp("mcap") / "bag")


class Store:
    """A file elsewhere, which counts what it sends."""

    def __init__(self, content, tmp_path, name):
        self.content, self.sent, self.asked = content, 0, 0
        self.parts = Parts(tmp_path / name, f"store://{name}", self.fetch, len(content))

    def fetch(self, begin, end):
        self.sent += end - begin
        self.asked += 1
        return self.content[begin:end]


def same(a, b, digests=True):
    assert a.t.tobytes() == b.t.tobytes() and a.columns.keys() == b.columns.keys()
    assert all(a.columns[n].tobytes() == b.columns[n].tobytes() for n in a.columns)
    assert (a.notes, a.assumes, repr(a.quality)) == (b.notes, b.assumes, repr(b.quality))
    assert not digests or a.sha256 == b.sha256


def test_a_hundredth_of_a_recording_moves_few_per_cent_of_its_bytes(bag, tmp_path):
    """The rows of a span are those of the whole, from a disk and from a store, and so is their identity."""
    whole, span = read_log(bag, spanned(None, None)), spanned(20.0, 20.4)
    store = Store(bag.read_bytes(), tmp_path, "log.mcap")
    there, here = read_log(store.parts, span), read_log(bag, span)
    same(there, here)
    assert there.sha256.startswith(PARTS) and here.t.size == 5
    inside = slice(200, 205)
    assert all(here.columns[n].tobytes() == whole.columns[n][inside].tobytes() for n in ("u", "v", "r"))
    assert np.abs(here.t - (whole.t[inside] - whole.t[200])).max() < 1e-9
    # Two or three chunks of some forty: one is opened to see the fields of the topics, one or two hold the span.
    assert store.parts.moved == store.sent < 0.05 * len(store.content) and store.asked < 12


def test_the_identity_of_parts_is_that_of_what_is_read_and_of_nothing_else(bag, tmp_path):
    content, span = bytearray(bag.read_bytes()), spanned(20.0, 20.4)
    before = read_log(bag, span).sha256
    chunks = mcap_index.read_index(Parts(bag, "bag")).chunks
    first, at = chunks[0], next(c for c in chunks if c.last >= 1_700_000_020_200_000_000)
    changed = tmp_path / "log.mcap"
    for chunk, same_log in ((chunks[-1], True), (at, False)):
        made = content.copy()
        made[chunk.end - 1] ^= 1  # of a picture
        changed.write_bytes(made)
        assert (read_log(changed, span).sha256 == before) == same_log
    assert first.begin < at.begin and read_log(bag, spanned(20.0, 22.0)).sha256 != before


def bytes_read():
    """By this process, from the system."""
    lines = Path("/proc/self/io").read_text().splitlines()
    return int(next(line for line in lines if line.startswith("rchar")).split()[1])


def test_a_hundredth_of_a_local_recording_reads_few_per_cent_of_its_bytes(bag):
    read_log(bag, spanned(20.0, 20.4))
    before = bytes_read()
    read_log(bag, spanned(20.0, 20.4))
    part = bytes_read() - before
    read_log(bag, spanned(None, None))
    # Each topic opens the chunks that hold it, and a first one shows its fields: seven times a megabyte of 42.
    assert part < 0.25 * bag.stat().st_size < bytes_read() - before


def summary(content):
    """Where the summary begins."""
    return LONG.unpack_from(content, len(content) - 28)[0]


def without_index(content):
    made = bytearray(content)
    made[len(made) - 28 : len(made) - 12] = bytes(16)
    return made


def chunk_indexes(content):
    """Places of the contents of the records that index chunks."""
    at, found = summary(content), []
    while content[at] != mcap_index.FOOTER:
        if content[at] == mcap_index.CHUNK_INDEX:
            found.append(at + 9)
        at += 9 + LONG.unpack_from(content, at + 1)[0]
    return found


def patched(offset, value):
    """The third chunk with another number in its index."""

    def change(content):
        made = bytearray(content)
        at = chunk_indexes(content)[2] + offset
        made[at : at + 8] = LONG.pack(value % (1 << 64))
        return made

    return change


def with_checksum(content):
    """A checksum of another summary."""
    made, begin = bytearray(content), summary(content)
    end = len(made) - 37
    made[end + 25 : end + 29] = zlib.crc32(made[begin : end + 25]).to_bytes(4, "little")
    made[begin + 20] ^= 1
    return made


DAMAGED = {
    "missing": without_index,
    "no end": lambda content: content[: summary(content)],
    "checksum": with_checksum,
    "out of the file": patched(16, 1 << 62),
    "negative": patched(16, -5),
    "of another chunk": patched(16, 30),
    "overlapping": lambda content: patched(16, LONG.unpack_from(content, chunk_indexes(content)[1] + 16)[0])(content),
    "huge": patched(24, (1 << 63) - 1),
    "other times": patched(0, 1),
    "summary outside": lambda content: content[:-28] + LONG.pack(1 << 60) + content[-20:],
    "summary in a chunk": lambda content: content[:-28] + LONG.pack(5000) + content[-20:],
}


@pytest.fixture(scope="module")
def small(tmp_path_factory):
    return recording(tmp_path_factory.mktemp("mcap") / "small", 120, 60_000)


@pytest.mark.parametrize("damage", DAMAGED)
def test_a_damaged_index_is_replaced_by_a_full_read(small, tmp_path, damage):
    """The rows are those of the sound file, on a disk and from a store, with a span and without."""
    content = bytes(DAMAGED[damage](small.read_bytes()))
    path = tmp_path / "log.mcap"
    path.write_bytes(content)
    for span in (spanned(None, None), spanned(0.0, 11.0)):
        found, store = read_log(path, span), Store(content, tmp_path, "copy.mcap")
        same(found, read_log(small, span), digests=False)
        same(read_log(store.parts, span), found)
        assert not found.sha256.startswith(PARTS) and store.sent <= len(content) + 3 * (1 << 20)


@pytest.mark.parametrize("packing", ["", "zstd"])
def test_a_new_index_is_that_of_the_recorder(tmp_path, packing):
    bounded_chunks()
    file = recording(tmp_path / "bag", 30, 70_000, packing)
    mend(file, tmp_path / "copy.mcap", DECOMPRESSORS)
    sound, made = (mcap_index.read_index(Parts(p, "log")) for p in (file, tmp_path / "copy.mcap"))
    assert len(sound.chunks) > 1 and made == sound


def test_a_broken_record_is_a_sentence(small, tmp_path):
    content = small.read_bytes()
    path = tmp_path / "log.mcap"
    for made in (content[: summary(content) // 2], content[:44] + b"\xff" * 8 + content[52:]):
        path.write_bytes(made)
        with pytest.raises(IvsidError, match="is not a readable ROS bag|cannot be read") as error:
            read_log(path, spanned(None, None))
        assert "\n" not in str(error.value)


def columns_of(path, rows=4000):
    t = 0.05 * np.arange(rows)
    columns = {"u": 1 + np.sin(t), "v": np.cos(t), "r": 0.1 * np.sin(t), "demand_port": 20.0 + np.arange(rows) // 50}
    others = {f"picture_{k}": np.random.default_rng(k).normal(size=rows) for k in range(40)}
    pl.DataFrame({"t": t, **columns, **others}).write_parquet(path, row_group_size=200, compression="uncompressed")
    return path


def test_parquet_is_fetched_by_columns_and_row_groups(tmp_path):
    path = columns_of(tmp_path / "log.parquet")
    content = path.read_bytes()
    for span, most in ((None, 0.2), ((100.0, 102.0), 0.12)):
        chosen = mapping({"span": span})
        store = Store(content, tmp_path, "copy.parquet")
        found = read_log(store.parts, chosen)
        same(found, read_log(path, chosen, parts=True))
        assert found.sha256.startswith(PARTS) and store.sent < most * len(content)
    whole = read_log(path)
    inside = (whole.t >= 100.0) & (whole.t <= 102.0)
    assert found.t.tobytes() == whole.t[inside].tobytes() and found.t.size == 41
    assert all(found.columns[n].tobytes() == whole.columns[n][inside].tobytes() for n in whole.columns)


@pytest.mark.parametrize("kind", ["csv", "gzip", "parquet", "matlab5", "sqlite_file", "mcap", "dataflash", "folder"])
def test_a_span_of_every_format_has_the_rows_of_the_whole(tmp_path, kind):
    make, table = log_files.FORMATS[kind]
    path = make(tmp_path)
    whole, part = read_log(path, mapping(table)), read_log(path, mapping({**table, "span": [2.0, 5.0]}))
    first = int(np.argmin(np.abs(whole.t - 2.0)))
    assert 0 < part.t.size < whole.t.size
    for n in whole.columns:
        assert np.array_equal(part.columns[n], whole.columns[n][first : first + part.t.size], equal_nan=True), n


def test_a_span_without_samples_and_one_that_goes_back_are_sentences(bag, tmp_path):
    with pytest.raises(IvsidError, match="from 900 to 901 s, the span of .log."):
        read_log(bag, spanned(900.0, 901.0))
    with pytest.raises(IvsidError, match=r"has 0 samples of t from 900 to 901 s, the span of \[log\]"):
        read_log(log_files.csv(tmp_path / "a.csv"), mapping({"span": [900.0, 901.0]}))
    with pytest.raises(ValueError, match="its second time is the later one"):
        mapping({"span": [2.0, 1.0]})


def test_a_store_that_sends_less_is_a_sentence(bag, tmp_path):
    content = bag.read_bytes()
    parts = Parts(tmp_path / "log.mcap", "store://log.mcap", lambda a, b: content[a : b - 1], len(content))
    with pytest.raises(IvsidError, match="does not send parts"):
        read_log(parts, spanned(1.0, 2.0))


def test_any_other_file_elsewhere_is_fetched_as_a_whole(tmp_path):
    content = log_files.csv(tmp_path / "a.csv").read_bytes()
    store = Store(content, tmp_path, "copy.csv")
    assert read_log(store.parts).sha256 == read_log(tmp_path / "a.csv").sha256 and store.sent == len(content)
    with open_source(tmp_path / "a.csv") as source:
        assert not source.spanned
