"""Files at the edges: records of results, their seals, units, sections of TOML files, and the section ``[log]``.

- ``records``: JSON whose bounds are rounded outward.
- ``whole``: files and folders that are written whole or not at all, into ``places`` that were checked, by a process that has them ``owned``.
- ``processor``: the mode in which numbers are read and printed.
- ``seal``: the digest of a result, which shows an edit.
- ``units``: factors from named units to SI.
- ``parsed``: text of TOML and JSON as tables.
- ``section``: the base of a section of a TOML file, and the kinds of numbers that its keys take.
- ``shipped``: files that come with the package, by the name of their vehicle.
- ``log_map``: the section ``[log]`` of a vehicle file, which maps foreign columns.

The chapter may use ``intervals`` (the outward decimal digits of a bound) and ``errors``. Import its modules by name: the checker of
``ivsid verify`` takes ``seal`` and ``units`` and must not load the arithmetic that ``records`` rests on.
"""
