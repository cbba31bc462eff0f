"""The site: links of its pages, requests to other sites, the reference and the navigation."""

import importlib.util
import re
from pathlib import Path

import ivsid

ROOT = Path(__file__).resolve().parents[2]


def check_site():
    spec = importlib.util.spec_from_file_location("check_site", ROOT / "docs" / "check_site.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_lost_links_and_requests_to_other_sites_are_noticed(tmp_path):
    (tmp_path / "a.html").write_text('<h1 id="top"></h1><a href="b.html#x">b</a><a href="https://e.org/">e</a>')
    (tmp_path / "b.html").write_text('<a id="x" href="a.html#top">a</a><link rel="stylesheet" href="s.css">')
    (tmp_path / "s.css").write_text("a { background: url(data:abc) }")
    assert check_site().faults(tmp_path, ()) == []
    (tmp_path / "a.html").write_text(
        '<a href="b.html#y">b</a><a href="c.html">c</a><script src="//e.org/s.js"></script>'
    )
    (tmp_path / "s.css").write_text("@import 'https://fonts.org/f.css';")
    assert check_site().faults(tmp_path, ()) == [
        "a.html loads //e.org/s.js",
        "a.html: b.html#y names no anchor",
        "a.html: c.html leads nowhere",
        "b.html: a.html#top names no anchor",
        "s.css loads https://fonts.org/f.css",
    ]


def test_every_public_name_stands_in_the_reference():
    page = (ROOT / "docs" / "reference" / "python.md").read_text()
    listed = re.findall(r"^\.\. auto(?:class|function|exception):: (\w+)$", page, re.M)
    modules = re.findall(r"^\.\. automodule:: ivsid\.(?:linear|intervals)\.(\w+)$", page, re.M)
    assert len(listed) == len(set(listed)) and {*listed, *modules, "__version__"} == set(ivsid.__all__)


def test_every_page_stands_in_the_navigation():
    entries = re.findall(r"^([a-z_/]+)$", (ROOT / "docs" / "index.md").read_text(), re.M)
    found = [p.relative_to(ROOT / "docs").with_suffix("") for p in (ROOT / "docs").rglob("*.md")]
    pages = {p.as_posix() for p in found if p.parts[0] != "_build"}
    assert len(entries) == len(set(entries)) and set(entries) == pages - {"index"}
