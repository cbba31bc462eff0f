"""Causes that a fitted model may lack: how much each explains, and its numbers.

A *candidate* is a cause with all its columns (``estimation.kinds``). Its score is the fall of chi-squared that its best columns bring beside the
model and all declared errors.

- ``families``: the scores of all candidates, best first, whatever their kinds.
- ``searched``: exact columns for causes that are found by a search.
- ``profile``: chi-squared as a function of a number in which the errors bend or jump.
- ``starts``: starts of a cause to a sample, proposed by running sums.
- ``intervals``: the interval of each number of a cause that was found.

The chapter may use ``estimation`` and the chapters below it.
"""
