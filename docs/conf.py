"""Sphinx configuration: Markdown pages, no theme to fetch."""

project = "ivsid"
author = "The ivsid developers"
extensions = ["myst_parser"]
exclude_patterns = ["_build"]
html_theme = "alabaster"
myst_heading_anchors = 3
