"""What the checker says no to."""

from __future__ import annotations


class UnprovedError(Exception):
    """What does not follow, in a sentence."""


class UncheckedError(Exception):
    """What the checker does not know how to recompute, in a sentence: neither proved nor wrong."""
