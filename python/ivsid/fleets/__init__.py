"""Many logs of a vehicle: one by one, together, and what changed between them, on this machine or on a cluster.

- ``run``: the steps in order.
- ``places``: logs and results by path, pattern or URL; ``finished``: results of single logs under the hash of their inputs.
- ``one_log``: the work of a process on one log; ``crew``: the processes, by Dask where there are several; ``extra``: optional packages.
- ``log_rows``: interval rows that know their log; ``scan``: the rows that points violate; ``working_set``: bounds that few rows prove.
- ``consistency``: constraint generation over the logs; ``drift``: periods, and least sets of logs that contradict each other.
- ``result``, ``tables``: the result as a value, as a record and as Parquet.

The chapter may use ``identification``, ``diagnosis`` and the chapters below them. A bound or a contradiction rests on its certificate
alone, and never on which process did what.
"""

from ivsid.fleets.result import Fleet
from ivsid.fleets.run import fleet
from ivsid.fleets.tables import parquet, tables

__all__ = ["Fleet", "fleet", "parquet", "tables"]
