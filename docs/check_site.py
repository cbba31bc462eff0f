"""Checks a built site without a network: every link leads to a file and an anchor of it, and no page loads from elsewhere.

Run: python docs/check_site.py FOLDER. Links to other sites are only held against the form of an address; `make links` asks them.
"""

import re
import sys
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

# Attributes that a browser loads as the page opens.
LOADED = {("script", "src"), ("link", "href"), ("img", "src"), ("iframe", "src"), ("source", "src"), ("object", "data")}
# Kinds of <link> that name a page and load nothing.
NAMED = {"next", "prev", "search", "index", "author", "copyright", "canonical", "alternate"}


class Page(HTMLParser):
    """Anchors of a page, its links, and what it loads."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.anchors: set[str] = set()
        self.links: list[str] = []
        self.loaded: list[str] = []
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Keeps ids, names of anchors, and addresses."""
        found = {k: v or "" for k, v in attrs}
        self.anchors |= {found[k] for k in ("id", "name") if k in found}
        for key in ("href", "src", "data"):
            if key not in found:
                continue
            self.links.append(found[key])
            if (tag, key) in LOADED and not set(found.get("rel", "").split()) & NAMED:
                self.loaded.append(found[key])


def faults(folder: Path, parts: tuple[str, ...]) -> list[str]:
    """Faults of the pages below some folders of a site; pages that are linked to may stand anywhere in it."""
    seen: dict[Path, Page] = {}

    def page(path: Path) -> Page:
        if path not in seen:
            seen[path] = Page(path.read_text(encoding="utf-8"))
        return seen[path]

    found = []
    for path in sorted(p for p in folder.rglob("*.html") if p.relative_to(folder).parts[0] not in parts):
        name = path.relative_to(folder)
        found += [f"{name} loads {a}" for a in page(path).loaded if urlsplit(a).scheme or a.startswith("//")]
        for link in dict.fromkeys(page(path).links):
            address = urlsplit(link)
            if address.scheme in ("http", "https"):
                found += [] if re.fullmatch(r"[\w.-]+(:\d+)?", address.netloc) else [f"{name}: {link} is no address"]
                continue
            if address.scheme or address.netloc:
                continue
            target = (path.parent / unquote(address.path)).resolve() if address.path else path
            target = target / "index.html" if target.is_dir() else target
            if not target.exists():
                found.append(f"{name}: {link} leads nowhere")
            elif target.suffix == ".html" and unquote(address.fragment) not in {"", *page(target).anchors}:
                found.append(f"{name}: {link} names no anchor")
    for path in folder.rglob("*.css"):
        for address in re.findall(r"(?:@import|url\()\s*['\"]?([^'\")\s;]+)", path.read_text(encoding="utf-8")):
            if re.match(r"(https?:)?//", address):
                found.append(f"{path.relative_to(folder)} loads {address}")
    return found


def main() -> int:
    """Prints the faults of a site; its pages by rustdoc, whose links rustdoc checks itself, are targets only."""
    folder = Path(sys.argv[1])
    found = faults(folder, ("rust",))
    sys.stdout.writelines(f"{fault}\n" for fault in found)
    sys.stdout.write(f"{sum(1 for _ in folder.rglob('*.html'))} pages, {len(found)} faults\n")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
