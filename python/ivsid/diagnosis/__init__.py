"""What a simulation gets wrong, and why: one stage a file, each a function with a frozen result (EFFECTS.md 4)."""

from ivsid.diagnosis.advice import advised
from ivsid.diagnosis.claims import Claim
from ivsid.diagnosis.confirmation import NULL_LOGS
from ivsid.diagnosis.diagnose import Diagnosis, Finding, diagnose
from ivsid.diagnosis.evidence import Evidence, evidence
from ivsid.diagnosis.explain import explain, worth
from ivsid.diagnosis.extended import extended_vehicle
from ivsid.diagnosis.intervals import Bound
from ivsid.diagnosis.isolability import Advice, Choice, Isolability, isolability
from ivsid.diagnosis.null_cache import cache_folder
from ivsid.diagnosis.proved import GUARANTEED, REFUTED, Proof

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
