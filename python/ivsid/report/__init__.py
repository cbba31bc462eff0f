"""Results for a reader.

- ``page``: sections to a self-contained HTML page, written with the results in one folder.
- ``tables``: the tables of the page from what the stages return.
- ``figures``: the only place that draws.

The chapter may use what every stage returns; no stage uses it.
"""
