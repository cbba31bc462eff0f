"""What a simulation gets wrong, and why: one stage a file, each a function with a frozen result (EFFECTS.md 4)."""

from ivsid.diagnosis.advice import advised
from ivsid.diagnosis.diagnose import Diagnosis, Finding, diagnose
from ivsid.diagnosis.evidence import Evidence, evidence
from ivsid.diagnosis.explain import explain, worth
from ivsid.diagnosis.extended import extended_vehicle
from ivsid.diagnosis.intervals import Bound
from ivsid.diagnosis.isolability import Advice, Choice, Isolability, isolability

__all__ = [
    "Advice",
    "Bound",
    "Choice",
    "Diagnosis",
    "Evidence",
    "Finding",
    "Isolability",
    "advised",
    "diagnose",
    "evidence",
    "explain",
    "extended_vehicle",
    "isolability",
    "worth",
]
