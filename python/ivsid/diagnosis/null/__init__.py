"""Scores where nothing is hidden: the causes that a log can show, and the threshold that a finding has to pass.

1. ``visibility``: the size at which each cause stands out in this log, and whether its signature is more than noise.
2. ``thresholds``: Gaussian draws of all scores at once, from the Gram matrix of this log.
3. ``family_wise``: the test of all families against one threshold, by the rules in ``screening`` (a ``rule`` is an object), among them a
   ``second_opinion`` from half-minutes of the log and ``any_curve``, the worst of all thrust errors inside their bounds;
   ``reached``: what curves inside their bounds reach of the errors at knots; ``boxed``: errors of thrusts and readings that leave their bounds.
4. ``detection``: the size at which each cause stands out beside the worst declared errors.
5. ``feedback``: the feedback behind the logged demands.
6. ``simulated_logs``, with the motion in ``closed_loop``: logs of the same programme and feedback without an effect.
7. ``calibration``: the parametric bootstrap, which examines simulated logs like the log (``examination``); the ``tail`` of their scores
   gives the stricter threshold.
8. ``looks``: null logs until they decide, with their scores in the user's ``cache``.
9. ``levels``: the parts of the probability of a wrong verdict.

Gaussian draws come first because they cost a tenth of a second. Simulated logs cost about a minute, and are asked only where a finding or
structure is close to its threshold (``selection.confirmation``). The chapter may use ``candidates`` and the chapters below it.
"""
