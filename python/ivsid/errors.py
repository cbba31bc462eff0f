"""Errors of use, each in one sentence: the input that was given, the input that is needed, the remedy."""


class IvsidError(ValueError):
    """Unusable input. The text is one sentence for the user; the command line prints it and exits with 2."""
