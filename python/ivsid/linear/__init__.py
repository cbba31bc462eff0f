"""Typed doors to the linear algebra of the core.

- ``linalg``: inverses, regularity and square systems of interval matrices.
- ``regression``: parameters of interval rows: the feasible set, and interval least squares.
- ``certificates``: certificates checked with fractions, without the core.
- ``filters``: recursive filters in plain floats, for estimates only.

The chapter may use ``intervals`` and ``errors``. ``ivsid.linalg`` and ``ivsid.regression`` are the names that users call.
"""
