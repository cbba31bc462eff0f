"""Errors of the checker."""

from __future__ import annotations


class UnprovedError(Exception):
    """A statement does not follow; the text is one sentence."""


class UncheckedError(Exception):
    """A part that the checker cannot recompute, in one sentence: neither proved nor wrong."""
