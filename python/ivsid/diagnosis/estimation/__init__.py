"""Numbers of a hypothesis from a log, with what is declared beside them.

- ``noise``: the ambient force and the whitening filters learnt from a log.
- ``projection``: cross-products of whitened columns, and least squares with soft priors on them.
- ``signatures``: the column of each parameter and each candidate.
- ``declared_errors``: columns of the errors that a vehicle file declares.
- ``first_values``: where a fit starts; ``fit``: Gauss-Newton steps, and all signatures around the result.

The chapter may use ``data``, ``plant`` and ``prediction``.
"""
