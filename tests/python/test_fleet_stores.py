"""Logs and results behind URLs: the same tables as on disk."""

import json
from contextlib import contextmanager
from importlib.util import find_spec

import numpy as np
import polars as pl
import pytest

import ivsid
from command_line import run
from fleet_logs import seasons
from ivsid import IvsidError, read_log
from ivsid.fleets import parquet, tables
from ivsid.fleets.places import opened
from test_log_parts import recording, spanned

pytestmark = [
    pytest.mark.filterwarnings("ignore"),
    pytest.mark.skipif(find_spec("fsspec") is None, reason="the extra fleet is not installed"),
]
TABLES = ("changes", "contradictions", "findings", "logs", "parameters", "pooled")


def content(found):
    made = tables(found)
    return {name: parquet(made[name]) for name in TABLES}


@pytest.fixture(scope="module")
def on_disk(once, tmp_path_factory):
    logs = seasons(once) / "changed"
    return content(ivsid.fleet(logs, "swan", tmp_path_factory.mktemp("disk"), workers=0, diagnose=False))


def stored(system, where, once):
    """The logs, put into a store."""
    for path in sorted((seasons(once) / "changed").iterdir()):
        system.pipe_file(f"{where}/{path.name}", path.read_bytes())
    system.pipe_file(f"{where}/notes.txt", b"no log")


def test_logs_and_results_in_memory(once, on_disk):
    import fsspec

    system = fsspec.filesystem("memory")
    stored(system, "/season/logs", once)
    made = run(
        "fleet",
        "memory://season/logs/*.csv",
        "--vehicle",
        "swan",
        "--out",
        "memory://season/out",
        "--workers",
        0,
        "--no-diagnose",
    )
    try:
        assert made.returncode == 0, made.stderr
        assert {n: system.cat_file(f"/season/out/{n}.parquet") for n in TABLES} == on_disk
        record = json.loads(system.cat_file("/season/out/result.json"))
        assert record["command"] == "fleet" and len(system.find("/season/out/done")) == 6
        again = run(
            "fleet",
            "memory://season/logs",
            "--vehicle",
            "swan",
            "--out",
            "memory://season/out",
            "--workers",
            0,
            "--no-diagnose",
        )
        assert "6 of 6 logs were identified before" in again.stdout
    finally:
        system.rm("/season", recursive=True)


def as_parquet(once, folder):
    """The logs as Parquet files with thirty other columns, in one row group."""
    folder.mkdir()
    for k, path in enumerate(sorted((seasons(once) / "changed").iterdir())):
        log = pl.read_csv(path)
        rng = np.random.default_rng(k)
        others = [pl.Series(f"other_{j}", rng.normal(size=log.height)) for j in range(30)]
        log.with_columns(others).write_parquet(folder / f"{path.stem}.parquet")
    return folder


def test_logs_elsewhere_are_fetched_in_parts_and_verified_from_a_disk(once, tmp_path):
    """The columns that are needed travel; bounds and drift are those of the whole files, and the checker finds the logs by their parts."""
    import fsspec

    folder = as_parquet(once, tmp_path / "logs")
    system = fsspec.filesystem("memory")
    for path in folder.iterdir():
        system.pipe_file(f"/parts/{path.name}", path.read_bytes())
    try:
        found = ivsid.fleet("memory://parts", "swan", tmp_path / "out", workers=0, diagnose=False)
        here = ivsid.fleet(folder, "swan", tmp_path / "here", workers=0, diagnose=False)
        assert {n: x for n, x in content(found).items() if n != "logs"} == {
            n: x for n, x in content(here).items() if n != "logs"
        }
        digests = tables(found)["logs"]["sha256"]
        assert all(d.startswith("parts:") for d in digests) and set(digests).isdisjoint(tables(here)["logs"]["sha256"])
        whole = sum(p.stat().st_size for p in folder.iterdir())
        assert 0 < tables(found)["times"]["bytes"].sum() < 0.4 * whole
        again = ivsid.fleet("memory://parts", "swan", tmp_path / "out", workers=0, diagnose=False)
        assert tables(again)["times"]["reused"].all()
        run("fleet", "memory://parts", "--vehicle", "swan", "--out", tmp_path / "out", "--workers", 0, "--no-diagnose")
        checked = ivsid.verify(tmp_path / "out", folder)
        assert checked.status == "proved", checked.failures
        path = next(iter(sorted(folder.iterdir())))
        pl.read_parquet(path).with_columns(pl.col("u") + 1.0).write_parquet(path)
        with pytest.raises(IvsidError, match="are not there"):
            ivsid.verify(tmp_path / "out", folder)
    finally:
        system.rm("/parts", recursive=True)


def test_a_file_url_is_a_path(once, on_disk, tmp_path):
    logs = seasons(once) / "changed"
    found = ivsid.fleet(f"file://{logs}", "swan", f"file://{tmp_path}/out", workers=0, diagnose=False)
    assert content(found) == on_disk and len(list((tmp_path / "out" / "done").rglob("*.json"))) == 6


@pytest.mark.parametrize("url", ["memory://nothing/here", "nosuchstore://a/b", "memory://empty/*.csv"])
def test_a_url_without_logs_is_a_sentence(url, tmp_path):
    with pytest.raises(IvsidError) as error:
        ivsid.fleet(url, "swan", tmp_path, workers=0)
    assert url in str(error.value) and "\n" not in str(error.value)


def test_a_store_that_cannot_be_written_is_a_sentence(once):
    with pytest.raises(IvsidError, match="nosuchstore"):
        ivsid.fleet(seasons(once) / "calm", "swan", "nosuchstore://a/b", workers=0, diagnose=False)


@contextmanager
def s3(monkeypatch):
    """A local server of S3 with a bucket."""
    import fsspec
    from moto.server import ThreadedMotoServer

    server = ThreadedMotoServer(port=0, verbose=False)
    server.start()
    try:
        _, port = server.get_host_and_port()
        monkeypatch.setenv("AWS_ACCESS_KEY_ID", "anyone")
        monkeypatch.setenv("AWS_SECRET_ACCESS_KEY", "anything")
        monkeypatch.setenv("AWS_ENDPOINT_URL", f"http://127.0.0.1:{port}")
        monkeypatch.setenv("AWS_DEFAULT_REGION", "us-east-1")
        fsspec.filesystem("s3").clear_instance_cache()
        system = fsspec.filesystem("s3")
        if not system.exists("fleet"):
            system.mkdir("fleet")
        yield system
    finally:
        server.stop()


IN_S3 = pytest.mark.skipif(
    find_spec("moto") is None or find_spec("s3fs") is None, reason="moto and s3fs are not installed"
)


@pytest.mark.nightly
@IN_S3
def test_a_hundredth_of_a_recording_in_s3_moves_few_per_cent_of_its_bytes(tmp_path, monkeypatch):
    bag, span = recording(tmp_path / "bag"), spanned(20.0, 20.4)
    with s3(monkeypatch) as system:
        system.pipe_file("fleet/long.mcap", bag.read_bytes())
        with opened("s3://fleet/long.mcap") as parts:
            found = read_log(parts, span)
        assert found.sha256 == read_log(bag, span).sha256 and found.t.size == 5
        assert parts.moved < 0.05 * bag.stat().st_size


@pytest.mark.nightly
@IN_S3
def test_logs_and_results_in_an_s3_store_by_two_processes(once, on_disk, monkeypatch):
    """The workers read logs and write finished ones themselves."""
    with s3(monkeypatch) as system:
        stored(system, "fleet/season", once)
        made = run(
            "fleet",
            "s3://fleet/season",
            "--vehicle",
            "swan",
            "--out",
            "s3://fleet/out",
            "--workers",
            2,
            "--no-diagnose",
        )
        assert made.returncode == 0, made.stderr
        assert {n: system.cat_file(f"fleet/out/{n}.parquet") for n in TABLES} == on_disk
        assert len(system.find("fleet/out/done")) == 6
        assert pl.read_parquet(system.cat_file("fleet/out/times.parquet"))["reused"].sum() == 0
