"""Packed files that become far larger than any log: refused by a stated limit, before memory or disk is full."""

import gzip
import tracemalloc

import numpy as np
import polars as pl
import pytest
from scipy.io import savemat

import log_files
from ivsid import IvsidError, read_log
from ivsid.log import parquet, plain, unpacked
from test_log_formats import mapping


@pytest.fixture
def small(monkeypatch):
    """Limits of a megabyte, so that the tests need no gigabytes: the rule is the same."""
    monkeypatch.setattr(unpacked, "SMALL", 1 << 20)
    monkeypatch.setattr(unpacked, "CHUNK", 1 << 20)


def test_the_limits_are_those_of_the_guide():
    assert unpacked.most_unpacked(10) == 2**30 and unpacked.most_unpacked(2**30) == 100 * 2**30
    assert unpacked.CHUNK == 2**28 and unpacked.MOST_ROWS == 2**29


def test_a_gzip_bomb_is_refused_with_the_disk_as_it_was(tmp_path, small, monkeypatch):
    path = tmp_path / "log.csv.gz"
    path.write_bytes(gzip.compress(b"t,u\n" + b"0" * 20_000_000))
    assert path.stat().st_size < 60_000
    written = []
    most = plain.most_unpacked

    def told(size):
        written.append(most(size))
        return written[-1]

    monkeypatch.setattr(plain, "most_unpacked", told)
    with pytest.raises(IvsidError, match=r"unpacks to more than [0-9,]+ bytes, which no log of its size does"):
        read_log(path)
    assert written[0] < 3_000_000
    # A log that grows a little is read.
    t = np.arange(60_000) / 10
    path.write_bytes(gzip.compress(pl.DataFrame({"t": t, "u": np.sin(t)}).write_csv().encode()))
    assert read_log(path).t.size == 60_000


def test_a_matlab_bomb_is_refused(tmp_path, small):
    path = tmp_path / "log.mat"
    savemat(path, {"t": np.zeros(2_000_000), "u": np.zeros(2_000_000)}, do_compression=True)
    assert path.stat().st_size < 100_000
    with pytest.raises(IvsidError, match="a variable unpacks to more than"):
        read_log(path)


@pytest.mark.parametrize("kind", ["zstd", "lz4", "bz2"])
def test_a_chunk_stops_at_its_limit(kind, small):
    """The packers' own unpackers would make megabytes of some kilobytes."""
    import bz2

    import lz4.frame
    from rosbags.rosbag1 import reader as ros_1
    from rosbags.rosbag2 import storage_mcap

    unpacked.bounded_chunks()
    pack = {"zstd": storage_mcap.zstd.compress, "lz4": lz4.frame.compress, "bz2": bz2.compress}[kind]
    own = {
        "zstd": lambda data: storage_mcap.DECOMPRESSORS["zstd"](data, 0),
        "lz4": lambda data: storage_mcap.DECOMPRESSORS["lz4"](data, 0),
        "bz2": ros_1.decompressors["bz2"],
    }[kind]
    bomb = pack(bytes(24 << 20))
    tracemalloc.start()
    with pytest.raises(ValueError, match="unpacks to more than"):
        own(bomb)
    assert tracemalloc.get_traced_memory()[1] < 12 << 20
    tracemalloc.stop()
    data = np.random.default_rng(1).bytes(1 << 19)
    assert own(pack(data)) == data
    for broken in (pack(data)[:-9], b"no frame"):
        with pytest.raises(Exception):  # noqa: B017 - whatever the packer raises becomes a sentence of the reader
            own(broken)


@pytest.mark.parametrize("how", ["STORAGE", "MESSAGE", "FILE"])
def test_a_bag_with_a_bomb_gets_a_sentence(tmp_path, small, how):
    """Chunks of an MCAP file, messages of SQLite and whole files, each of some kilobytes of zeros."""
    from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin, Writer
    from rosbags.typesys import Stores, get_typestore

    store = get_typestore(Stores.ROS2_HUMBLE)
    text = store.types["std_msgs/msg/String"]
    plugin = StoragePlugin.MCAP if how == "STORAGE" else StoragePlugin.SQLITE3
    writer = Writer(tmp_path / "bag", version=9, storage_plugin=plugin)
    writer.set_compression(CompressionMode[how], CompressionFormat.ZSTD)
    with writer:
        topic = writer.add_connection("/words", "std_msgs/msg/String", typestore=store)
        writer.write(topic, 1, store.serialize_cdr(text(data=" " * (30 << 20)), "std_msgs/msg/String"))
    assert sum(p.stat().st_size for p in (tmp_path / "bag").iterdir()) < 100_000
    with pytest.raises(IvsidError, match="unpacks to more than"):
        read_log(tmp_path / "bag")
    # Sound bags are read as before.
    assert read_log(log_files.bag(tmp_path / "sound", "mcap"), mapping(log_files.BAG_MAP)).t.size == log_files.N


def test_a_parquet_file_of_endless_rows_is_refused(tmp_path, monkeypatch):
    """A constant column takes some bytes, however long it is."""
    monkeypatch.setattr(parquet, "MOST_ROWS", 1_000_000)
    path = tmp_path / "log.parquet"
    pl.select(t=pl.repeat(1.0, 3_000_000), u=pl.repeat(2.0, 3_000_000)).write_parquet(path)
    assert path.stat().st_size < 100_000
    with pytest.raises(IvsidError, match="has 3,000,000 rows; logs of up to 1,000,000 are read"):
        read_log(path)


def test_a_stream_that_never_ends_is_cut_at_the_limit(tmp_path, small):
    """Many members of gzip behind each other count together."""
    member = gzip.compress(bytes(1 << 20))
    path = tmp_path / "log.csv.gz"
    path.write_bytes(member * 300)
    with pytest.raises(IvsidError, match="unpacks to more than"):
        read_log(path)
