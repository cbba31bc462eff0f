"""The command line: arguments, progress, exit codes. 0: did its job; 2: wrong usage or unusable input, in one sentence."""

from ivsid.cli.application import main

__all__ = ["main"]
