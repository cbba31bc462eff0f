"""Diagnosis: the causes of what a simulation gets wrong, and what a better model is worth.

The stages follow each other, one chapter a stage, and each may use only those before it:

1. ``data``: a log on one uniform clock.
2. ``plant``: states and demands to accelerations and readings, under a hypothesis.
3. ``prediction``: states and innovations of a hypothesis.
4. ``estimation``: noise, whitening, the fit of a hypothesis with the declared errors beside it.
5. ``candidates``: the causes that a fit may lack, their scores and numbers.
6. ``null``: how large scores grow where nothing is hidden.
7. ``selection``: the causes that stand.
8. ``statements``: what is said of them, with proofs, figures' data and sentences.
9. ``planning``: the programme that would show more.

``stages`` calls them in order. Every stage is a function with a frozen result; none reads files, prints or draws.
"""

from ivsid.diagnosis.candidates.intervals import Bound
from ivsid.diagnosis.null.cache import cache_folder
from ivsid.diagnosis.planning.advice import advised
from ivsid.diagnosis.planning.isolability import Advice, Choice, Isolability, isolability
from ivsid.diagnosis.selection.confirmation import NULL_LOGS
from ivsid.diagnosis.stages import diagnose
from ivsid.diagnosis.statements.claims import Claim
from ivsid.diagnosis.statements.diagnosis import Diagnosis, extended_vehicle
from ivsid.diagnosis.statements.evidence import Evidence, evidence
from ivsid.diagnosis.statements.findings import Finding
from ivsid.diagnosis.statements.prose import explain, worth
from ivsid.diagnosis.statements.proved import GUARANTEED, REFUTED, Proof

__all__ = [
    "GUARANTEED",
    "NULL_LOGS",
    "REFUTED",
    "Advice",
    "Bound",
    "Choice",
    "Claim",
    "Diagnosis",
    "Evidence",
    "Finding",
    "Isolability",
    "Proof",
    "advised",
    "cache_folder",
    "diagnose",
    "evidence",
    "explain",
    "extended_vehicle",
    "isolability",
    "worth",
]
