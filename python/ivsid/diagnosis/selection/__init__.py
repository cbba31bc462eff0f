"""Selection of the causes that a log needs.

1. ``adequacy``: the structure that a generic ``dictionary`` of regressors finds in the innovations.
2. ``hulls``: numbers that a log asks for and no hull has.
3. ``rivals``: causes that are fitted in full in the place of one another, and compared by their merit.
4. ``rules``: what a cause has to keep in its full fit.
5. ``admission``: the best of the causes that pass the test, fitted under a noise that is learnt beside it.
6. ``review``: earlier causes taken out again, and dropped or swapped.
7. ``select``: the loop over the causes.
8. ``verdict``: what the structure that is left has to keep for a model to be adequate.
9. ``confirmation``: findings and structure close to their threshold have to pass simulated null logs.
10. ``parallel``: threads for rivals.
11. ``one_force`` and ``speed_curves``: causes that imitate a force which the catalogue lacks, ``in_their_place``.
12. ``both_logs``: causes that the other log refuses; ``shared_structure``: structure that both logs show, by how regressors are ``standing`` out of each.

Scores are linear in a cause and find candidates. A full fit decides between them, because lags, delays and limits are not linear, and
because the other parameters move with the cause. Causes whose merits cannot be told apart stay together as one finding. The chapter may
use ``null`` and the chapters below it.
"""
