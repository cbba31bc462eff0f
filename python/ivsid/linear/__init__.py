"""Interval matrices and interval rows: typed doors to the linear algebra of the core.

The mathematics and its proofs are in ``crates/interval-core``. A door checks shapes and names, passes arrays without a copy where their
layout allows it, and returns frozen values. Nothing here widens or narrows a bound, and nothing reads a file.

Doors, one a subject; only these five import the compiled core:

- ``linalg``: inverses, regularity, square systems and the norm of interval matrices, one by one or in batches.
- ``regression``: parameters of interval rows: the feasible set with its certificates, the normal equations (paper, eq. 14) and
  least squares.
- ``following``: bounds of parameters from rows that come one by one, in bounded memory.
- ``filters``: recursive filters and causal whitening in plain floats; estimates, and never a bound.
- ``trajectories``: bounds of every trajectory of a set of parameters, and trajectories of single members.

Values that they return:

- ``results``: statuses, results and batches of inverses, systems and regularity.
- ``certificate_kinds``: one record for each kind of proof that a matrix is regular or singular.
- ``certificates``: such a proof with its matrix; ``verify()`` checks it.
- ``exact_checks``: these checks in integers and fractions, without the core.

A numerical outcome is a value: ``status`` names it, ``guaranteed`` tells whether every step was proved, ``reason`` says in a sentence what
is missing. A failed proof leaves no bound and raises nothing. Misuse (shapes, NaN, reversed bounds, unknown names) is an ``IvsidError``.

The chapter may use ``intervals`` and ``errors``. Identification, the diagnosis and the demo's page use it. ``ivsid.linalg`` and
``ivsid.regression`` are the names that users call. Theory: docs/theory.md, "Regularity", "Inverses", "Square systems", "Least squares"
and "The feasible set".
"""
