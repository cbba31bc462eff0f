"""Values in a terminal and in a notebook: short texts, tables in HTML, data frames, plots.

- ``table``: text and HTML of a few rows; escaped, in the colours of the page around it, the same for the same value.
- ``shown``: bases of the classes that show themselves: ``Shown`` has a text and a table, ``Result`` data frames and a plot as well.

The chapter stands below all others and uses the standard library and ``errors`` alone. Plots are drawn by ``report.figures``, far above: the root of the
package, which knows both, hands that function down once (``Result.drawn_by``).
"""
