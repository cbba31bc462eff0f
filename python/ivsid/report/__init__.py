"""Results for a reader.

- ``page``: sections of a report, written as a self-contained HTML page with result.json and the figures in one folder.
- ``series``, ``drawn``, ``scaling``: time series, bars and curves that the page draws itself, and the ends of their axes.
- ``tables``: records for result.json from the values that the stages return.
- ``figures``: drawings; the only chapter that loads Matplotlib.

The chapter may use the values that every stage returns; no stage uses it.
"""
