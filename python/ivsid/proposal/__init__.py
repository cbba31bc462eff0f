"""A vehicle file proposed from a log, for its user to complete (``ivsid init``).

- ``names``: the names that other programs give to columns, from a table of the package.
- ``found``: a column that is taken for a channel.
- ``thrusters``: demands and angles of thrusters by the words of their names; ``angles``: units and signs of these angles.
- ``places``: a position from latitude and longitude.
- ``folders``: the runs that a folder holds.
- ``columns``: the column of each channel, of the demands and of the stamps.
- ``signs``: units and signs that names leave open, from the ranges of the readings.
- ``mapping``: the section ``[log]`` that follows.
- ``noise``: bounds of the sensors and limits of the motion, from a still stretch or from the scatter.
- ``blanks``: numbers that no log states.
- ``text``, ``propose``: the file, and all steps in order.

The chapter may use ``log``, ``vehicle``, ``sensors`` and below. What it proposes is a guess with its reason beside it.
"""

from ivsid.proposal.blanks import Answers
from ivsid.proposal.found import si_unit
from ivsid.proposal.propose import Proposal, propose
from ivsid.proposal.text import vehicle_file

__all__ = ["Answers", "Proposal", "propose", "si_unit", "vehicle_file"]
