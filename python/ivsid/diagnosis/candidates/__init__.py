"""Causes and their numbers.

- ``families``: candidates of a cause, their scores, and the best of them.
- ``profile``: chi-squared of a number that no column is proportional to.
- ``intervals``: the interval of each number of a cause.

The chapter may use ``estimation`` and what is below it.
"""
