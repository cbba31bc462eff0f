"""The command line, in a process of its own or in this one, with what it leaves: exit code, stdout and stderr.

A process of its own takes seconds to start. One test of each kind has one; refusals and results are the same in both.
"""

import contextlib
import io
import subprocess
import sys
import warnings
from unittest import mock

from ivsid.cli import main

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
