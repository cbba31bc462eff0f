"""Statements of a diagnosis, with their evidence.

- ``findings``, ``rejected``, ``hints``: causes that are named, those that are not, and structure inside declared errors.
- ``claims``, ``upper_limits``: numbers that the vehicle file claims, and how large causes that were not found may be.
- ``shallow_water``: a change of depth between the two logs.
- ``falsified``, ``proved``: contradictions and intervals with certificates.
- ``comparison``, ``extended``: what the extended model is worth on TEST, and its vehicle file.
- ``evidence``, ``binning``, ``prose``: figures' data and a paragraph for each finding.

The chapter may use ``selection`` and what is below it.
"""
