"""The command line: ``ivsid COMMAND`` or ``python -m ivsid.cli COMMAND``.

- ``application``: the program, its commands in the order of ``ivsid --help``, and the options before a command.
- ``command``: help as plain text, and files in the order that a command needs, by their ``recognition``.
- ``preparation``: commands that make or examine data: demo, simulate, allan, thrust, import.
- ``parameters``: commands about parameter intervals: identify, verify, validate.
- ``causes``: commands about what the simulation gets wrong: diagnose, isolability.
- ``arguments``: options that commands share, and values that they parse.
- ``completion``: words that the shell completes.
- ``run``: one command from its folder to its written results; ``progress``: the step and the time left, on stderr.
- ``terminal``: words to the terminal, with control characters made visible.
- ``entry``: exit codes, and one sentence in place of a traceback.

Exit codes: 0, the command did its job; 1, an internal fault; 2, wrong usage or unusable input; 130, interrupted.

The chapter may use every other; nothing uses it. Its modules load Typer only: what a command needs is imported when it runs, so
that ``ivsid --help`` does not wait for NumPy, SciPy, Polars, Pydantic or Matplotlib.
"""

from ivsid.cli.entry import main

__all__ = ["main"]
