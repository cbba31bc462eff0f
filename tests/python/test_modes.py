"""Every public operation refuses a changed mode of the processor, and results depend on no thread, process or back end.

The operations are enumerated (``modes.py``), so that one which joins is asked, too.
"""

import json
import os
import platform
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import modes
from ivsid import IvsidError
from ivsid.files.processor import check_rounding, rounds_to_nearest
from sampling import NIGHTLY, spaced

# A process of its own finds the modules of the tests.
HERE = {
    "PYTHONPATH": os.pathsep.join([str(Path(__file__).parent), os.environ.get("PYTHONPATH", "")]).rstrip(os.pathsep)
}
mxcsr = pytest.mark.skipif(
    sys.platform != "linux" or platform.machine() != "x86_64", reason="sets the control register of SSE"
)


@pytest.fixture(scope="module")
def outcomes(tmp_path_factory):
    """The outcome of each operation in each mode, from a process that may set them."""
    words = [sys.executable, modes.__file__, str(tmp_path_factory.mktemp("modes"))]
    done = subprocess.run(words, capture_output=True, text=True, check=True, timeout=300)
    return json.loads(done.stdout)


@mxcsr
def test_no_operation_computes_in_a_changed_mode(outcomes):
    """Refused, or a rearrangement with the same bits; nothing panics, and nothing differs."""
    assert len(outcomes) > 280
    bad = {name: found for name, found in outcomes.items() if not set(found.values()) <= {"refused", "same"}}
    assert not bad


@mxcsr
def test_all_that_computes_refuses_every_mode(outcomes):
    """What passes has nothing to round: shapes, views, copies, and the empty set."""
    passing = {n.split(" of ")[0].split(".")[-1] for n, found in outcomes.items() if "same" in found.values()}
    harmless = {
        *("lower", "upper", "empty", "empty_set", "entire", "shape", "ndim", "size", "T", "reshape", "concatenate", "stack", "iteration"),
        *("vstack", "hstack", "where", "ravel", "transpose", "squeeze", "broadcast_to", "moveaxis", "swapaxes", "expand_dims", "flip", "roll"),
        *("repeat", "tile", "take", "diagonal", "partition_count", "threads", "copy"),
    }  # fmt: skip
    assert {n for n in passing if not n.startswith("__")} <= harmless
    special = {n for n in passing if n.startswith("__")}
    assert special <= {
        *("__getitem__", "__len__", "__iter__", "__pos__", "__hash__", "__reduce__", "__reduce_ex__", "__getstate__", "__copy__", "__deepcopy__"),
        *("__lt__", "__le__", "__gt__", "__ge__", "__contains__", "__class_getitem__", "__array_priority__", "__weakref__", "__annotations__"),
    }, special  # fmt: skip


@mxcsr
@pytest.mark.sampled
def test_import_is_refused_in_a_changed_mode():
    program = "import modes; modes.set_mode(modes.MODES[{!r}])\ntry:\n    import ivsid\nexcept ImportError as error:\n    modes.set_mode(modes.DEFAULT); print(error)"
    for mode in modes.MODES if NIGHTLY else spaced(list(modes.MODES), 2):
        words = [sys.executable, "-c", program.format(mode)]
        done = subprocess.run(words, env=os.environ | HERE, capture_output=True, text=True, check=True)
        assert "round to nearest" in done.stdout, mode


@mxcsr
def test_the_arithmetic_itself_tells_every_mode():
    """The question that the checker asks without the core."""
    assert rounds_to_nearest()
    for name, value in modes.MODES.items():
        modes.set_mode(value)
        try:
            found = rounds_to_nearest()
        finally:
            modes.set_mode(modes.DEFAULT)
        assert not found, name
        modes.set_mode(value)
        try:
            check_rounding()
        except IvsidError:
            modes.set_mode(modes.DEFAULT)
        else:
            modes.set_mode(modes.DEFAULT)
            pytest.fail(name)


# The bits of results of every kind, printed by a process: large enough that the core shares them out.
DIGEST = """
import hashlib, json, os
import numpy as np
import ivsid
from modes import bits
rng = np.random.default_rng(5)
around = ivsid.IntervalArray.around
m = around(rng.normal(size=(200, 200)), 1e-9)
x = around(rng.normal(size=100_000), 1e-3)
small = around(np.eye(6) * 3 + rng.normal(size=(6, 6)) * 0.3, 1e-3)
many = ivsid.IntervalArray.stack([small] * 100)
rows = around(rng.normal(size=(10_000, 4)), 1e-3)
right = around(rows.midpoint @ np.array([1.0, -2.0, 0.5, 3.0]), 0.02)
def digest():
    batch = ivsid.linalg.inverse_batch(many)
    parts = [m @ m, x * x + x, np.sin(x), np.exp(x), x.sum(), ivsid.linalg.inverse(small).value,
             batch.lower, batch.upper, ivsid.linalg.solve(small, x[:6]).value, ivsid.regression.feasible_set(rows, right).value]
    return hashlib.sha256(json.dumps([bits(p) for p in parts]).encode()).hexdigest()
print(digest(), flush=True)
"""
FORKED = """
pid = os.fork()
if not pid:
    print(digest(), flush=True)
    os._exit(0)
os._exit(os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1]))
"""


def digests(extra="", **environment):
    """What the program prints; a process that waits for ever fails."""
    words = [sys.executable, "-c", DIGEST + extra]
    done = subprocess.run(
        words, env=os.environ | HERE | environment, capture_output=True, text=True, check=True, timeout=120
    )
    return done.stdout.split()


def threads(n):
    return {"RAYON_NUM_THREADS": str(n), "OPENBLAS_NUM_THREADS": str(n)}


@pytest.mark.sampled
def test_threads_and_forks_change_no_bit():
    """1, 2 and 8 threads of the core and of BLAS, and a copy of a process whose threads have started, which has none of them."""
    (plain,) = digests(**threads(1))
    if NIGHTLY:
        assert digests(**threads(2)) == [plain]
    assert digests(FORKED, **threads(8)) == [plain, plain]


def test_a_difference_of_arrays_is_entrywise():
    from ivsid import Interval, IntervalArray

    a, b = IntervalArray([1.0, 2.0]), IntervalArray([1.0, 3.0])
    np.testing.assert_array_equal(a != b, [False, True])
    np.testing.assert_array_equal(a == b, [True, False])
    np.testing.assert_array_equal(np.not_equal(a, b), [False, True])
    np.testing.assert_array_equal(a != Interval(1.0), [False, True])
    assert (a != "text") is True and (a == "text") is False
