"""Start-up: which libraries a fresh interpreter loads, and that names which load late are the same names."""

import pickle
import subprocess
import sys

import pytest

import ivsid
from ivsid.intervals.apart import forks

HEAVY = {"allantools", "jinja2", "matplotlib", "polars", "pydantic", "scipy"}
PROBE = "\nimport sys\nprint('LOADED', *sorted(sys.modules), file=sys.stderr)"
COMMAND = """
import sys
from ivsid.cli import main
sys.argv = {}
try:
    main()
except SystemExit as end:
    assert end.code == {}
"""


def loaded(code: str) -> set[str]:
    """All modules that a fresh interpreter has loaded after the code."""
    made = subprocess.run(
        [sys.executable, "-c", code + PROBE], capture_output=True, text=True, timeout=120, check=False
    )
    assert made.returncode == 0, made.stderr
    return set(made.stderr.rpartition("LOADED ")[2].split())


def test_import_loads_no_library():
    found = loaded("import ivsid")
    assert not found & {*HEAVY, "numpy", "rich", "typer"}
    # The core refuses a changed rounding mode as soon as the package is imported.
    shown = {"ivsid.display", "ivsid.display.shown", "ivsid.display.table"}
    assert {m for m in found if m.startswith("ivsid")} == {"ivsid", "ivsid._core", "ivsid.errors", *shown}


def test_a_diagnosis_loads_neither_the_signals_nor_the_distributions_of_scipy():
    """Half a second of processor time on every command, for an error filter and a chi-squared that are one line each."""
    found = loaded("import ivsid.workflow.diagnosis")
    assert not found & {"scipy.signal", "scipy.stats"}
    # Figures are drawn by other processes, which load it while the model is fitted.
    assert "matplotlib" not in found


# Nightly: a whole diagnosis; the gate looks at what its modules import.
@pytest.mark.nightly
def test_a_whole_diagnosis_loads_neither_of_them(tmp_path):
    """From the example to its report, with a cause that the model takes in: nothing in it is worth another second."""
    first, said = tmp_path / "first", tmp_path / "said"
    lines = [
        ["ivsid", "example", first],
        ["ivsid", "diagnose", *(first / n for n in ("boat.toml", "run1.csv", "run2.csv"))],
    ]
    code = COMMAND.format([str(x) for x in lines[0]], 0)
    assert loaded(code)
    found = loaded(COMMAND.format([str(x) for x in [*lines[1], "--out", said]], 0))
    assert not found & {"scipy.signal", "scipy.stats"}
    # Where no process can be forked, this one draws.
    assert ("matplotlib" in found) != forks()
    assert (said / "model.toml").exists()


def test_arithmetic_loads_numpy_and_the_core_alone():
    found = loaded("from ivsid import EndpointPair, Interval, IntervalArray, IvsidError, linalg, regression")
    assert not found & HEAVY
    chapters = {m.split(".")[1] for m in found if m.startswith("ivsid.")}
    assert chapters <= {"_core", "display", "errors", "intervals", "linear"}


@pytest.mark.parametrize("line", ["--help", "--version"])
def test_help_loads_no_numerical_library(line):
    assert not loaded(COMMAND.format(["ivsid", line], 0)) & {*HEAVY, "numpy"}


@pytest.mark.parametrize(("line", "code"), [("identify --help", 0), ("fly", 2), ("identify", 2)])
def test_help_of_a_command_and_wrong_usage_load_no_numerical_library(line, code):
    # Typer itself reads the options of a command by Pydantic.
    assert not loaded(COMMAND.format(["ivsid", *line.split()], code)) & {*HEAVY, "numpy"} - {"pydantic"}


@pytest.mark.parametrize("command", ["identify", "verify"])
def test_a_command_waits_for_no_other(command):
    found = loaded(f"from ivsid import workflow\nworkflow.{command}")
    assert not found & {"ivsid.diagnosis", "ivsid.simulation", "scipy.optimize", "scipy.signal", "scipy.stats"}


def test_the_program_runs_as_a_module():
    made = subprocess.run(
        [sys.executable, "-m", "ivsid.cli", "--version"], capture_output=True, text=True, timeout=120, check=False
    )
    assert made.returncode == 0 and made.stdout == f"ivsid {ivsid.__version__}\n"


def test_every_public_name_loads_and_is_listed():
    loaded(
        "import ivsid\nassert set(ivsid.__all__) <= set(dir(ivsid))\nfrom ivsid import *\n"
        "assert identify is ivsid.identify and linalg is ivsid.linalg and __version__ == ivsid.__version__"
    )
    with pytest.raises(AttributeError, match="has no attribute 'nothing'"):
        getattr(ivsid, "nothing")  # noqa: B009


def test_commands_stay_functions_after_their_modules_were_loaded():
    loaded(
        "import importlib, pkgutil\nfrom ivsid import workflow\nassert set(workflow.__all__) <= set(dir(workflow))\n"
        "for m in pkgutil.iter_modules(workflow.__path__): importlib.import_module(f'ivsid.workflow.{m.name}')\n"
        "assert all(callable(getattr(workflow, name)) for name in workflow.__all__)"
    )


def test_late_names_are_the_same_objects_and_can_be_pickled():
    from ivsid.identification import Identification
    from ivsid.linear import linalg

    assert ivsid.Identification is Identification and ivsid.linalg is linalg
    found = ivsid.linalg.inverse(ivsid.IntervalArray([[2.0]], [[4.0]]), "exact")
    again = pickle.loads(pickle.dumps(found))
    assert again.status == found.status and again.value.lower == found.value.lower == 0.25
    assert pickle.loads(pickle.dumps(ivsid.Interval(1, 2))) == ivsid.Interval(1, 2)
    assert pickle.loads(pickle.dumps(ivsid.Vehicle)) is ivsid.Vehicle
