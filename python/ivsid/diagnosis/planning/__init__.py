"""Planning: the effects that a programme can show and tell apart, and the manoeuvre that would add most.

1. ``isolability``: sizes and distances of the causes by a log, before any diagnosis.
2. ``joint_information``: the cross-products of a log and a manoeuvre, as of one log.
3. ``advice``: the manoeuvres of a library, ranked for each set of causes that the log does not tell apart.

A log is never simulated together with a manoeuvre: information adds, so one survey for each manoeuvre is enough. The chapter may use
``statements`` and the chapters below it.
"""
