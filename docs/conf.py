"""Sphinx configuration: Markdown pages, the Python reference from docstrings, and a theme that loads nothing from elsewhere."""

from importlib.metadata import version as version_of

project = "ivsid"
author = "The ivsid developers"
version = release = version_of("ivsid")
extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon"]
exclude_patterns = ["_build"]
myst_heading_anchors = 3

# Signatures name their types once, beside the argument.
autodoc_typehints = "signature"
autodoc_type_aliases = {name: name for name in ("ArrayLike", "FloatArray", "NDArray", "Record", "TableInMemory")}
autodoc_default_options = {"exclude-members": "model_config"}
autodoc_member_order = "bysource"
autodoc_class_signature = "mixed"
# A name that several chapters export is written as the user writes it.
add_module_names = False
napoleon_google_docstring = True
napoleon_numpy_docstring = False
napoleon_use_ivar = True

html_theme = "alabaster"
html_static_path = ["_static"]
html_css_files = ["site.css"]
html_title = f"ivsid {version}"
html_theme_options = {
    "description": "Guaranteed system identification for marine vehicles",
    "fixed_sidebar": True,
    "page_width": "1180px",
    "sidebar_width": "260px",
    "show_powered_by": False,
}
html_sidebars = {"**": ["about.html", "searchfield.html", "navigation.html"]}
html_show_sourcelink = False
html_copy_source = False
