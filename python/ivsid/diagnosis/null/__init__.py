"""Logs with nothing hidden, and how large scores grow on them.

- ``visibility``: which causes this log can show, and the threshold of each score.
- ``thresholds``: Gaussian draws of all scores at once.
- ``null_logs``, ``feedback``: simulated logs of the same programme, with the controller's answer to their motion.
- ``calibration``: the scores of those logs; ``cache``: scores that are kept.

The chapter may use ``candidates`` and what is below it.
"""
