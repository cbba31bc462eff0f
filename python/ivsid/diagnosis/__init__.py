"""Diagnosis: the causes of a simulation's errors, and the gain of a better model.

A diagnosis takes a vehicle file and two logs. On TRAIN it looks for the effects of the catalogue that the vehicle file's model lacks. On TEST
it measures how much better the extended model predicts forces and motion. The vocabulary is that of system identification: a hypothesis
is a model with its parameters, an innovation is the error of a one-step prediction, a signature is the change of the innovations by one
effect, and a fall of chi-squared is the improvement of a fit by a cause.

The stages follow each other, one chapter a stage, and each may use only the stages before it:

1. ``data``: a log on one uniform clock, with the noise of its sensors.
2. ``plant``: accelerations and readings from states and demands, under a hypothesis.
3. ``prediction``: filtered states and innovations of a hypothesis.
4. ``estimation``: noise and whitening of a log, and the fit of a hypothesis together with the declared errors.
5. ``candidates``: causes that a fit may lack, with their scores and intervals.
6. ``null``: scores of logs without an effect, and the threshold that follows from them.
7. ``selection``: the causes that pass the threshold, each compared with its rivals.
8. ``statements``: findings, proofs, the gain on TEST, and the sentences and figures for the reader.
9. ``planning``: the effects that a programme can show, and the manoeuvre that would show more.

``stages`` calls them in order. A stage is a function with a frozen result. No stage reads files, prints or draws, except the cache of null
logs (``null.cache``).

Two kinds of results stand side by side. Findings and their intervals are statistical: they rest on a noise model that is learnt from the
log. Proofs rest on the declared bounds alone, and carry certificates that ``ivsid verify`` checks.

Source: docs/theory.md, "Diagnosis" and "Isolability"; docs/diagnosis.md for users; docs/examination.md for the measured rates of errors.
"""

from ivsid.diagnosis.candidates.intervals import Bound
from ivsid.diagnosis.null.cache import cache_folder
from ivsid.diagnosis.planning.advice import advised
from ivsid.diagnosis.planning.isolability import Advice, Choice, Isolability, isolability
from ivsid.diagnosis.selection.confirmation import NULL_LOGS
from ivsid.diagnosis.stages import diagnose
from ivsid.diagnosis.statements.claims import Claim
from ivsid.diagnosis.statements.diagnosis import Diagnosis, extended_vehicle, model_files
from ivsid.diagnosis.statements.evidence import Evidence, evidence
from ivsid.diagnosis.statements.findings import Finding
from ivsid.diagnosis.statements.prose import diverging, explain, grown, lost, worth
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
    "diverging",
    "evidence",
    "explain",
    "extended_vehicle",
    "grown",
    "isolability",
    "lost",
    "model_files",
    "worth",
]
