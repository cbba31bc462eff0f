"""A report page, read as a browser reads it, and what is wrong with it."""

import re
from html.parser import HTMLParser

# Elements that have no end.
VOID = {"br", "circle", "col", "hr", "img", "input", "line", "link", "meta", "polyline", "wbr"}
LARGEST = 3_000_000


class Page(HTMLParser):
    """Ids, links, headings, figures, tables and text of a page."""

    def __init__(self, html):
        super().__init__()
        self.html = html
        self.open, self.ids, self.links, self.loads, self.headings, self.wordless, self.tables = (
            [],
            [],
            [],
            [],
            [],
            [],
            [],
        )
        self.said, self.unclosed, self.script_data, self.handlers = [], [], [], []
        self.feed(html)
        self.close()

    def handle_starttag(self, tag, attrs):
        given = dict(attrs)
        self.handlers += [name for name in given if name.startswith("on")]
        self.ids += [given["id"]] if "id" in given else []
        self.links += [given["href"]] if "href" in given and tag == "a" else []
        self.loads += [
            v
            for k, v in attrs
            if k in ("src", "srcset", "action", "poster", "xlink:href") or (k == "href" and tag != "a")
        ]
        if re.fullmatch(r"h[1-6]", tag):
            self.headings.append(int(tag[1]))
        if tag in ("img", "svg") and not (given.get("alt") or given.get("aria-label")):
            self.wordless.append(given)
        if tag == "div" and given.get("class") == "panels" and not given.get("aria-label"):
            self.wordless.append(given)
        if tag == "table":
            self.tables.append(0)
        if tag == "td":
            self.tables[-1] += 1
        if tag not in VOID:
            self.open.append((tag, given))

    def handle_endtag(self, tag):
        if tag in VOID:
            return
        held, _ = self.open.pop()
        if held != tag:
            self.unclosed.append(held)

    def handle_data(self, data):
        tag, given = self.open[-1] if self.open else ("", {})
        if tag == "script" and given.get("type") == "application/json":
            self.script_data.append(data)
        elif tag not in ("script", "style"):
            self.said.append(data)

    @property
    def text(self):
        return re.sub(r"\s+", " ", " ".join(self.said))


def faults(html):
    """What is wrong with a page, in words; nothing for a good one."""
    page = Page(html)
    found = []
    if len(html.encode()) > LARGEST:
        found.append(f"{len(html.encode())} bytes")
    found += [f"id {i} twice" for i in {i for i in page.ids if page.ids.count(i) > 1}]
    found += [f"loads {x[:40]}" for x in page.loads if not x.startswith("data:image/png;base64,")]
    found += [f"leads out: {x}" for x in page.links if not x.startswith("#")]
    found += [f"leads nowhere: {x}" for x in page.links if x.startswith("#") and x[1:] not in page.ids]
    if page.headings[:1] != [1] or page.headings.count(1) != 1:
        found.append("not one first heading")
    found += [f"heading {a} before {b}" for a, b in zip(page.headings, page.headings[1:], strict=False) if b > a + 1]
    found += [f"a figure without words: {x}" for x in page.wordless]
    found += ["an empty table" for n in page.tables if n == 0]
    found += [f"{x} is not closed" for x in (*page.unclosed, *(t for t, _ in page.open))]
    found += [f"a handler: {x}" for x in page.handlers]
    # Styles load nothing either.
    found += re.findall(r"(?:@import|url\()[^;)]{0,40}", " ".join(re.findall(r"<style>(.*?)</style>", html, re.S)))
    return found
