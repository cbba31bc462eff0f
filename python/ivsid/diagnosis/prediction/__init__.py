"""Prediction errors (innovations) of a hypothesis on a log.

A log is compared with a model by one-step prediction: from all readings up to a sample, the model predicts the readings of the next one.
Under a true model the errors depend on the past alone, and so does every signature that is made of filtered states. Their product has mean
zero, with or without a feedback that reads the logged sensors (Ljung 1999; docs/theory.md, "Diagnosis").

- ``kalman``: a steady Kalman filter of each axis, with position (heading), velocity and ambient acceleration as its states.
  The filters are linear and do not depend on the hypothesis, so that data and signatures pass through the same recursion.
- ``axes``: the filters of a log, by the sensors that it has.
- ``states``: the filtered states of a hypothesis on a log, which carry the hypothesis, and its prediction errors there.
- ``innovations``: how the errors answer to forces, to readings, and to another hypothesis.

The chapter may use ``data`` and ``plant``.
"""
