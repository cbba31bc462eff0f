"""The checker of ``ivsid verify``: what an identification claims, proved once more in fractions.

It shares no code with what made the result: not the core, not the intervals, not the rows, not the physics. From the log (as
``ivsid.log`` reads it) and the vehicle file's text it recomputes every row that a certificate uses, proves that the row lies in the
stored one, solves the multipliers exactly, and compares the bounds. ``rational`` and ``angles`` are its arithmetic, ``decimals`` and ``readings``
what the files say, ``refused`` what no row can be made of, ``pose``, ``mounted``, ``gravity``, ``rates``, ``curves``, ``rudders``, ``thrusters``,
``physics``, ``columns``, ``weak`` and ``rows`` the equations, ``multipliers`` and ``signs`` the linear programs, ``outliers`` and ``counted`` the rows that
may be wrong, ``checker`` the certificates and ``claims`` what is claimed of them.
What it does not recompute (``unchecked``) makes a verdict ``not_checked``, never ``proved``.
"""

from ivsid.verification.verify import NOT_PROVED, Verification, verify

__all__ = ["NOT_PROVED", "Verification", "verify"]
