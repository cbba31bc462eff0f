"""Manoeuvres that would tell more.

- ``isolability``: which causes a programme can show and tell apart.
- ``advice``: the manoeuvre that would separate the alternatives of a finding.

The chapter may use ``statements`` and what is below it.
"""
