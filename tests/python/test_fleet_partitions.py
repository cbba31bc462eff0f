"""Partitions of one inverse over the workers of a cluster: the bits of one machine."""

from importlib.util import find_spec

import numpy as np
import pytest

from ivsid import IntervalArray, IvsidError, linalg
from ivsid.linear import spread

ORDERS = (2, 3, 5)


class Threads:
    """A client without a cluster: tasks are done when they are submitted, and counted."""

    def __init__(self, threads=3):
        self.threads, self.tasks = threads, 0

    def nthreads(self):
        return {"worker": self.threads} if self.threads else {}

    def submit(self, task, *given, **_):
        self.tasks += 1
        return task(*given)

    def gather(self, futures):
        return futures


def matrix(n, radius=0.02, seed=1):
    rng = np.random.default_rng(seed)
    middle = np.eye(n) + 0.3 * rng.uniform(-1, 1, (n, n))
    return IntervalArray(middle - radius, middle + radius)


def same(a, b):
    assert (a.status, a.reason, a.gap) == (b.status, b.reason, b.gap)
    for x, y in zip((a.value.lower, a.value.upper), (b.value.lower, b.value.upper), strict=True):
        assert x.tobytes() == y.tobytes()


@pytest.mark.parametrize("n", ORDERS)
@pytest.mark.parametrize("method", ["published", "published-hull"])
def test_a_sweep_in_parts_has_the_bits_of_one_sweep(n, method, monkeypatch):
    monkeypatch.setattr(spread, "LEAST", 700)
    client = Threads()
    same(linalg.inverse(matrix(n), method, 30_011, client=client), linalg.inverse(matrix(n), method, 30_011))
    assert client.tasks == 24


@pytest.mark.parametrize(("n", "radius"), [(2, 0.2), (3, 0.1), (5, 0.05)])
def test_cells_in_parts_have_the_bits_of_one_machine(n, radius):
    client = Threads()
    for seed in range(6):
        a = matrix(n, radius, seed)
        one, parts = linalg.inverse(a, "partitioned", 600), linalg.inverse(a, "partitioned", 600, client=client)
        assert (one.status, one.reason, one.gap) == (parts.status, parts.reason, parts.gap)
        if one.value is not None:
            same(one, parts)


def test_cells_are_shared_where_there_are_many():
    client = Threads()
    # Order 6 takes no vertices: a wide matrix is halved again and again.
    a = matrix(6, 0.09)
    same(linalg.inverse(a, "partitioned", 2000, client=client), linalg.inverse(a, "partitioned", 2000))
    assert client.tasks > 3


def test_singular_members_and_what_does_not_apply(monkeypatch):
    monkeypatch.setattr(spread, "LEAST", 10)
    wide = IntervalArray(np.array([[-1.0, 0.0], [0.0, 1.0]]), np.array([[1.0, 0.0], [0.0, 1.0]]))
    for a, n in ((wide, 100), (IntervalArray(np.eye(65)), 100), (matrix(2), 1)):
        for method in ("published", "partitioned"):
            one, parts = linalg.inverse(a, method, n), linalg.inverse(a, method, n, client=Threads())
            assert (one.status, one.reason) == (parts.status, parts.reason)


@pytest.mark.parametrize(
    ("given", "sentence"),
    [
        ({"method": "exact"}, "no partitions to share"),
        ({"method": "published", "sweep": "extrema"}, "no partitions to share"),
        ({"method": "published", "client": "tcp://host:1"}, "distributed.Client"),
        ({"method": "published", "client": Threads(0)}, "no workers"),
    ],
)
def test_wrong_use_is_a_sentence(given, sentence):
    with pytest.raises(IvsidError, match=sentence):
        linalg.inverse(matrix(3), **{"client": Threads(), **given})
    with pytest.raises(IvsidError, match="batch"):
        linalg.inverse(IntervalArray(np.stack([np.eye(2)] * 2)), client=Threads())


@pytest.mark.nightly
@pytest.mark.filterwarnings("ignore")
@pytest.mark.skipif(find_spec("distributed") is None, reason="the extra fleet is not installed")
def test_two_processes_have_the_bits_of_one():
    from ivsid.fleets.crew import crew_of

    with crew_of(None, 2) as crew:
        for method, number in (("published", 2_000_003), ("published-hull", 2_000_003), ("partitioned", 3000)):
            a = matrix(6 if method == "partitioned" else 3, 0.09 if method == "partitioned" else 0.02)
            same(linalg.inverse(a, method, number, client=crew._client), linalg.inverse(a, method, number))
