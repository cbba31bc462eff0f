"""Statements of a diagnosis, with their evidence.

About the causes:

- ``findings``: causes that are named, with intervals and alternatives.
- ``unknown``: the finding for structure that no cause explains.
- ``rules``: what a cause that the extended model holds has to keep to be named.
- ``probability``: how often findings like these were right in the examination.
- ``rejected``: candidates that are no findings, each with the rule that refused it.
- ``hints``: structure that declared errors explain.
- ``not_tested``: effects that the log cannot test.
- ``claims``: numbers that the vehicle file states, against the log.
- ``upper_limits``: how large causes that are no findings may be.
- ``shallow_water``: masses and drags that change by one factor between the two logs, by the joint estimate of ``estimation.two_logs``.

About the model:

- ``residuals``: unexplained energy, missing force and falsified rows, before and after.
- ``falsified``: rows that a hypothesis contradicts.
- ``proved``: contradictions and intervals with certificates.
- ``share``: the error in position that a cause explains on TEST.
- ``comparison``, with the simulations in ``windows``: the gain of the extended model on TEST.
- ``losses``: quantities in which it is worse there.
- ``carried``: whether it fails there, so that its causes are no findings.
- ``trial``: both models on TEST, with ``without``: the model without some of its causes.
- ``extended``: the extended model as a vehicle file.

For the reader:

- ``diagnosis``: the result as one value.
- ``evidence``, with the means in ``binning``: the data of a figure for each finding.
- ``prose``: a paragraph for each finding.

Statistical statements and proofs stand beside each other, and neither is derived from the other. The chapter may use ``selection`` and the
chapters below it.
"""
