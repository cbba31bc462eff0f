"""Causes that a fitted model may lack: how much each explains, and its numbers.

A *family* is a cause with all its columns. Its score is the fall of chi-squared that its best columns bring beside the model and all declared
errors.

- ``families``: the scores of all families, best first. A cause may be linear in its numbers, a claim that is fitted after all, a column for each
  value that is tried (lags, delays, dead bands, limits), or a step at a block of the log.
- ``searched``: causes whose columns are found by a search: periods by one Fourier transform (``waves``), anchors on a grid (``tethers``).
- ``scored``: a family at its best.
- ``profile``: chi-squared as a function of a number in which the errors bend or jump.
- ``intervals``: the interval of each number of a cause that was found.

The chapter may use ``estimation`` and the chapters below it.
"""
