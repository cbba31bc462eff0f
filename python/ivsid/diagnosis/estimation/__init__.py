"""Numbers of a hypothesis from a log, with the declared errors beside them.

A hypothesis is fitted by generalised least squares of its prediction errors. Every parameter, every declared error and every candidate has a
column: the prediction errors that one unit of it would leave, its *signature*. Errors and columns are whitened by the same causal filter and
crossed in blocks of ten seconds; fits, falls of chi-squared and their scatter are small linear algebra from there.

- ``signatures``: the columns of the parameters of a model, of sensor effects and of forces; ``columns`` collects them by name.
- ``declared_errors``: the columns of the errors of readings, thrusts and rudders that the vehicle file declares, with their priors.
- ``candidate_columns``: the candidates that a log can show, with their columns; ``kinds`` holds one file a kind of candidate.
- ``cross_products`` of columns by block of time, and ``projection``: least squares with soft priors on them.
- ``problem``: what of a log stays the same while hypotheses are compared on it.
- ``noise``: the ambient force, the samples that count, and filters that forget quickly; ``roughness``: the ambient force beyond the
  declared one; ``whitening``: the whitening filter.
- ``first_values``: numbers to start from. ``gauss_newton``: steps from there. ``fit``: the result, with all signatures around it.
- ``angles``: whether thrusters and rudders turn between two samples.
- ``learning``: the order of all this for a log. The noise is learnt from errors from which every candidate was taken out, so that no effect is
  taken for noise.

The chapter may use ``data``, ``plant`` and ``prediction``.
"""
