"""Kinds of candidates: how a cause that a fit may lack is looked for, one file a kind.

The form that an effect declares (``ivsid.effects.forms``) chooses its kind. All kinds answer the same questions, so that nobody else asks for a
kind: which columns, which fall of chi-squared, which fall by chance, how large it has to be to be seen, and which hypothesis follows.

- ``candidate``: the questions, with the answers that most kinds share; ``Scored``, a candidate at its best.
- ``linear``: a column a number. ``claim``: a number of the vehicle file that is fitted after all.
- ``grid``: a column for each value that is tried, as of a delay, a dead band or a limit.
- ``step``: an effect that starts at a time.
- ``searched``: causes whose columns are found by a search: ``harmonic`` by the period, ``tether`` by the anchor.
"""
