"""The command line, in a process of its own or in this one, with what it leaves: exit code, stdout and stderr.

A process of its own takes seconds to start. One test of each kind has one; refusals and results are the same in both.
"""

import contextlib
import io
import subprocess
import sys
import warnings
from unittest import mock

from conftest import embedded
from ivsid.cli import main
from ivsid.workflow.log_files import csv

COMMAND = [sys.executable, "-c", "from ivsid.cli import main; main()"]


def run_process(*arguments, cwd=None):
    """The command in a process of its own."""
    return subprocess.run(
        [*COMMAND, *map(str, arguments)], capture_output=True, text=True, cwd=cwd, timeout=300, check=False
    )


def run(*arguments):
    """The command in this process: the same entry point, which always ends by ``SystemExit``."""
    words, out, err = [*map(str, arguments)], io.StringIO(), io.StringIO()
    # The entry point silences warnings of overflows for the rest of its process.
    with (
        warnings.catch_warnings(),
        mock.patch.object(sys, "argv", ["ivsid", *words]),
        contextlib.redirect_stdout(out),
        contextlib.redirect_stderr(err),
    ):
        try:
            main()
        except SystemExit as end:
            code = end.code
        else:
            raise AssertionError("the command line came back")
    return subprocess.CompletedProcess(words, code, out.getvalue(), err.getvalue())


def shell_files(folder, twin):
    """A folder with a vehicle file, a scenario, a log and a fit of it."""
    (folder / "boat.toml").write_text(embedded("swan.toml"))
    (folder / "plan.toml").write_text(embedded("swan_train.toml").replace("duration = 300.0", "duration = 20.0", 1))
    (folder / "run.csv").write_text(csv(twin.t, twin.columns))
    made = run("identify", folder / "boat.toml", folder / "run.csv", "--out", folder / "fit")
    assert made.returncode == 0, made.stderr
    return folder
