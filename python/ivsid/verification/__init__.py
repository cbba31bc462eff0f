"""The checker of ``ivsid verify``: an identification proved a second time, in exact arithmetic.

From the log (as ``ivsid.log`` reads it) and the vehicle file's text, the checker recomputes every row that a certificate uses, proves
that it lies in the stored row, solves the multipliers exactly, and compares the bounds. A part that it cannot recompute makes the
verdict ``not_checked``, never ``proved``.

- ``rational``, ``angles``: exact ranges, roots, angles, exponentials.
- ``decimals``, ``readings``: decimals of the files, and readings with the errors of their sensors; ``refused`` names logs without rows.
- ``carried``: causes of ``[model.fitted]`` in readings and thrusts.
- ``pose``, ``rates``, ``lever_arms``, ``gravity``: velocities from a pose, accelerations from velocities, sensors off the origin.
- ``curves``, ``rudders``, ``thrusters``: demands to forces.
- ``physics``, ``columns``, ``rows``, ``weak``: the equations of motion and their rows; ``unchecked`` names rows that are not recomputed.
- ``multipliers``, ``cells``, ``signs``: linear programs, and the orthants that they cover.
- ``outliers``, ``counted``: rows that may be wrong.
- ``tubes``: parts of steps of a tube.
- ``fleet``: the same of many logs.
- ``result``, ``checker``, ``statements``, ``verify``: a result, its certificates, its statements, and the verdict.

The chapter may use ``log``, ``vehicle``, ``files.seal``, ``files.units`` and ``errors``. It shares no code with what it checks: not the
core, not the intervals, not the rows, not the physics.
"""

from ivsid.verification.verify import NOT_PROVED, Verification, verify

__all__ = ["NOT_PROVED", "Verification", "verify"]
