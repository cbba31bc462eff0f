"""Many logs on a local cluster of two processes: the bytes of one process, whoever dies on the way."""

import os
import signal
from importlib.util import find_spec

import pytest

import ivsid
from fleet_logs import season, seasons
from ivsid.fleets import parquet, tables

pytestmark = [
    pytest.mark.filterwarnings("ignore"),
    pytest.mark.skipif(find_spec("distributed") is None, reason="the extra fleet is not installed"),
]

TABLES = ("changes", "contradictions", "findings", "logs", "parameters", "pooled")


def content(found):
    made = tables(found)
    return {name: parquet(made[name]) for name in TABLES}


def client_pids(client):
    return list(client.run(os.getpid).values())


def killing(client, when, times):
    """A progress function that kills a worker at some of the steps, and counts."""
    killed = []

    def progress(step):
        if len(killed) < times and when(step):
            pids = [p for p in client.run(os.getpid).values() if p not in killed]
            if pids:
                os.kill(pids[0], signal.SIGKILL)
                killed.append(pids[0])

    return progress, killed


@pytest.fixture(scope="module")
def undisturbed(once, tmp_path_factory):
    logs = seasons(once) / "changed"
    return content(ivsid.fleet(logs, "swan", tmp_path_factory.mktemp("one"), workers=0, diagnose=False))


@pytest.mark.nightly
def test_two_processes_of_which_one_is_killed_give_the_bytes_of_one(once, undisturbed, tmp_path):
    from ivsid.fleets.crew import crew_of

    logs = seasons(once) / "changed"
    with crew_of(None, 2) as crew:
        progress, killed = killing(crew._client, lambda s: s.startswith("periods: 3"), 1)
        found = ivsid.fleet(logs, "swan", tmp_path, scheduler=crew._client, diagnose=False, progress=progress)
        assert len(killed) == 1 and content(found) == undisturbed and not found.failed


@pytest.mark.nightly
def test_a_cluster_without_any_worker_left_gets_new_ones(once, undisturbed, tmp_path):
    """The cluster gives its nannies up at once, as on a machine that is too busy to start a worker in time."""
    # The defaults of distributed join those of dask when it is first imported, and would leave with the block below.
    import dask
    import distributed  # noqa: F401

    from ivsid.fleets.crew import crew_of

    logs = seasons(once) / "changed"
    with dask.config.set({"distributed.deploy.lost-worker-timeout": "1ms"}), crew_of(None, 2) as crew:
        victims = client_pids(crew._client)
        for pid in victims:
            os.kill(pid, signal.SIGKILL)
        found = ivsid.fleet(logs, "swan", tmp_path, scheduler=crew._client, diagnose=False)
        assert content(found) == undisturbed and not set(client_pids(crew._client)) & set(victims)


@pytest.mark.nightly
def test_workers_killed_at_every_step(tmp_path):
    from ivsid.fleets.crew import crew_of

    logs = season(tmp_path / "logs", 40, 20, effects={"drag.surge.quadratic": 40.0})
    expected = content(ivsid.fleet(logs, "swan", tmp_path / "one", workers=0, diagnose=False))
    with crew_of(None, 2) as crew:
        steps = ("identifying 1 ", "identifying 20 ", "all logs", "periods: 20", "least sets")
        for k, step in enumerate(steps):
            out = tmp_path / f"out{k}"
            progress, killed = killing(crew._client, lambda s, step=step: s.startswith(step), 2)
            found = ivsid.fleet(logs, "swan", out, scheduler=crew._client, diagnose=False, progress=progress)
            assert len(killed) in (1, 2), step
            assert content(found) == expected and not found.failed
            again = ivsid.fleet(logs, "swan", out, scheduler=crew._client, diagnose=False)
            assert all(e.outcome.reused for e in again.entries) and content(again) == expected


@pytest.mark.nightly
def test_a_log_that_ends_every_worker_is_reported_and_not_fatal(once, tmp_path, monkeypatch):
    """A task that loses its worker again and again is given up; the others are done."""
    from ivsid.fleets.crew import LostError, crew_of

    def task(number):
        if number == 1:
            os.kill(os.getpid(), signal.SIGKILL)
        return number

    with crew_of(None, 2) as crew:
        found = dict(crew.each(task, [(k,) for k in range(4)]))
    assert isinstance(found.pop(1), LostError) and found == {0: 0, 2: 2, 3: 3}
