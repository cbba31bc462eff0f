"""Keeps the page that Polars prints about an internal fault off the terminal; the error's own sentence stands for it."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Final

import polars as pl

# The file descriptor of the standard error.
# Source: definition: POSIX
STDERR: Final = 2


@contextmanager
def panics_unprinted() -> Iterator[None]:
    """Delays the standard error to the end of the block, and drops it where Polars panics."""
    try:
        kept = os.dup(STDERR)
    except OSError:
        # Without a standard error nothing is printed.
        yield
        return
    panicked = False
    with tempfile.TemporaryFile() as page:
        os.dup2(page.fileno(), STDERR)
        try:
            yield
        except pl.exceptions.PanicException:
            panicked = True
            raise
        finally:
            os.dup2(kept, STDERR)
            os.close(kept)
            page.seek(0)
            if not panicked and (words := page.read()):
                os.write(STDERR, words)
