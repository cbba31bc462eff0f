"""Polars prints a page about each fault inside it before Python hears of it; one sentence stands for that page."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Final

import polars as pl

STDERR: Final = 2


@contextmanager
def panics_unprinted() -> Iterator[None]:
    """Holds back what is written to the standard error; only where Polars panics is it dropped, else it is written afterwards."""
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
