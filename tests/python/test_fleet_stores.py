"""Logs and results behind URLs: the same tables as on disk."""

import json
from importlib.util import find_spec

import polars as pl
import pytest

import ivsid
from command_line import run
from fleet_logs import seasons
from ivsid import IvsidError
from ivsid.fleets import parquet, tables

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


@pytest.mark.nightly
@pytest.mark.skipif(find_spec("moto") is None or find_spec("s3fs") is None, reason="moto and s3fs are not installed")
def test_logs_and_results_in_an_s3_store_by_two_processes(once, on_disk, monkeypatch):
    """A local server of S3: the workers read logs and write finished ones themselves."""
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
        system = fsspec.filesystem("s3")
        system.mkdir("fleet")
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
    finally:
        server.stop()
