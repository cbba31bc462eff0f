"""Interval rows to parameter intervals, with their status, assumptions and certificates.

- ``method``: identification by the name of a method; it calls the others in order.
- ``blocks``: parameters that share rows, solved block by block.
- ``bias``: the bias of an accelerometer as one unknown of the whole log.
- ``assumptions``: the sentences that the guarantee relies on.
- ``certificates``: the rows and multipliers that prove each bound, as records.
- ``combinations``: combinations of parameters that the data determine where single parameters stay open.
- ``result``: the identification as a value and as a file, whose parts ``stored`` checks.
- ``narrower``: what would narrow the intervals: further rows, which are tried, and the physical bounds.
- ``following``: the same intervals row by row, in bounded memory; ``followed`` is their result.
- ``constriction``: the paper's heuristic, which guarantees nothing.

The chapter may use ``rows``, ``linear`` and the chapters below them. The mathematics is in the core; nothing here widens or narrows a
proved bound.
"""

from ivsid.identification.assumptions import left_out
from ivsid.identification.combinations import in_words
from ivsid.identification.followed import Change, Following, Moment
from ivsid.identification.following import follow
from ivsid.identification.method import METHODS, checked_claims, identify, identify_rows
from ivsid.identification.narrower import Narrower, narrower
from ivsid.identification.result import Identification, Parameter, read_identification

__all__ = [
    "METHODS",
    "Change",
    "Following",
    "Identification",
    "Moment",
    "Narrower",
    "Parameter",
    "checked_claims",
    "follow",
    "identify",
    "identify_rows",
    "in_words",
    "left_out",
    "narrower",
    "read_identification",
]
