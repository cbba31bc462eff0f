"""Tasks of two processes: their order, their faults, and the objects that no process can send."""

import multiprocessing
import os
import time

import numpy as np
import pytest
from tests.exam.cases import case

from diagnosis_logs import logs_of_case
from ivsid import diagnose
from ivsid.diagnosis.selection import parallel
from ivsid.effects import EFFECTS
from ivsid.intervals.apart import forks
from ivsid.intervals.turns import in_turns
from ivsid.vehicle import parse_vehicle

needs_two = pytest.mark.skipif(not forks(), reason="no second process: one processor, or no fork on this system")


def long(k, seconds=0.05):
    time.sleep(seconds)
    return k, os.getpid(), np.full(3, float(k))


@needs_two
def test_both_processes_take_tasks_and_results_keep_their_order():
    found = in_turns([lambda k=k: long(k) for k in range(8)])
    assert [k for k, _, _ in found] == list(range(8))
    assert len({pid for _, pid, _ in found}) == 2
    assert all((x == k).all() for k, _, x in found)


@needs_two
def test_common_objects_come_back_as_themselves_and_others_are_made_here():
    effect = EFFECTS["drag.cross_flow"]
    own = [lambda: 0]
    found = in_turns([lambda k=k: (long(k), effect, *own) for k in range(6)], [effect])
    assert all(e is effect for _, e, _ in found) and all(f is own[0] for _, _, f in found)
    # A function has no name that another process knows, so that such a task is done again here.
    assert {pid for (_, pid, _), _, _ in found} == {os.getpid()}
    assert len({pid for (_, pid, _), _ in in_turns([lambda k=k: (long(k), effect) for k in range(6)], [effect])}) == 2


def test_the_first_fault_in_order_is_raised():
    def fails(error):
        raise error

    tasks = [lambda: 1, lambda: fails(KeyError("first")), lambda: fails(ValueError("second"))]
    with pytest.raises(KeyError):
        in_turns(tasks)


def test_a_process_that_dies_loses_no_task():
    here = os.getpid()

    def dies(k):
        if os.getpid() != here:
            os._exit(3)
        time.sleep(0.02)
        return k

    assert in_turns([lambda k=k: dies(k) for k in range(5)]) == list(range(5))


def test_a_process_of_its_own_that_may_fork_none_uses_threads():
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        assert pool.apply(forks) is False


# Nightly: two whole diagnoses.
@pytest.mark.nightly
def test_threads_and_processes_find_the_same(monkeypatch):
    c = case(96090, duration=300.0)
    vehicle = parse_vehicle(c.text, "v.toml")
    one = diagnose(vehicle, *logs_of_case(c), null_logs=0).record()
    monkeypatch.setattr(parallel, "forks", lambda: False)
    assert diagnose(vehicle, *logs_of_case(c), null_logs=0).record() == one
