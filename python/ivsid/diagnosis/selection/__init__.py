"""Selection of the causes that a log needs.

- ``adequacy``: structure that a generic dictionary of regressors finds in the residual.
- ``select``: causes are added while one stands, rivals are fitted side by side.
- ``parallel``: rivals on all processors.
- ``confirmation``: findings close to their threshold have to pass simulated null logs.

The chapter may use ``null`` and what is below it.
"""
