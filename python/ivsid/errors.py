"""The error for faults of the user's input.

Its text is one sentence: what was given, what is needed, what to do.
"""


class IvsidError(ValueError):
    """Unusable input. The text is one sentence for the user; the command line prints it and exits with 2."""
