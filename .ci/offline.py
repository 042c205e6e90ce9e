"""Check that a built site asks nothing from elsewhere: ``python .ci/offline.py out/docs``.

Every page, style sheet and script is scanned for what a browser would fetch by itself: sources of pictures, scripts,
frames and fonts, style sheets, imports. Links that a reader may click are left alone. Scripts may name addresses that
they do not fetch; those are listed in `NAMED`, and any other ends the check.
"""

from __future__ import annotations

import re
import sys
from html.parser import HTMLParser
from pathlib import Path

FETCHED = {"src", "srcset", "poster", "data", "background", "xlink:href", "action", "formaction"}
"""Attributes whose address a browser fetches, or sends something to, in whichever element."""

LINKING = {"a", "area", "base"}
"""Elements whose href is for the reader to click; `base` is judged apart."""

ELSEWHERE = re.compile(r"^\s*(?:[a-z][a-z0-9+.-]*:)?//|^\s*(?:https?|wss?|ftp):", re.IGNORECASE)
IN_STYLE = re.compile(r"""(?:url\(\s*|@import\s+)["']?\s*((?:https?:)?//[^"')\s;]+)""", re.IGNORECASE)
IN_SCRIPT = re.compile(r"""["'`]((?:https?:|wss?:)?//[\w-]+(?:\.[\w-]+)+[^"'`\s]*)""", re.IGNORECASE)
COMMENT = re.compile(r"/\*.*?\*/", re.DOTALL)

NAMED = (
    "http://www.w3.org/",  # names of kinds of XML
    "https://www.mathjax.org",  # the author, in a box that the menu would show
    # Speech for formulas, which MathJax loads only on a reader's wish, from a menu that docs/conf.py leaves out.
    "https://cdn.jsdelivr.net/npm/speech-rule-engine@",
    "https://cdn.jsdelivr.net/npm/sre-mathmaps-ie@",
    "https://cdn.jsdelivr.net/npm/wicked-good-xpath@",
)


class Page(HTMLParser):
    """Collects the addresses that a page would have fetched."""

    def __init__(self) -> None:
        super().__init__(convert_charrefs=True)
        self.found: list[str] = []
        self._inside = ""

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Judge the attributes."""
        self._inside = tag
        for name, value in attrs:
            text = value or ""
            asks = name in FETCHED or (name == "href" and tag not in LINKING - {"base"})
            parts = text.split(",") if name == "srcset" else [text]
            if asks and any(ELSEWHERE.match(part) for part in parts):
                self.found.append(f"<{tag} {name}={text[:80]!r}>")
            if name == "style":
                self.found += [f"<{tag} style> {address}" for address in in_style(text)]
            if tag == "meta" and name == "content" and re.search(r"url\s*=\s*(https?:)?//", text, re.IGNORECASE):
                self.found.append(f"<meta content={text[:80]!r}>")

    handle_startendtag = handle_starttag

    def handle_endtag(self, tag: str) -> None:
        """Text that follows is not inside it."""
        self._inside = ""

    def handle_data(self, data: str) -> None:
        """Judge what stands between the tags of a script or a style."""
        if self._inside == "style":
            self.found += in_style(data)
        if self._inside == "script":
            self.found += in_script(data)


def in_page(text: str) -> list[str]:
    """What a page fetches from elsewhere."""
    page = Page()
    page.feed(text)
    page.close()
    return page.found


def in_style(text: str) -> list[str]:
    """What a style sheet fetches from elsewhere."""
    return IN_STYLE.findall(COMMENT.sub("", text))


def in_script(text: str) -> list[str]:
    """Addresses in the strings of a script, but for those known to be fetched by nothing."""
    return [address for address in IN_SCRIPT.findall(text) if not address.startswith(NAMED)]


JUDGES = {".html": in_page, ".svg": in_page, ".css": in_style, ".js": in_script}


def main() -> None:
    """Judge all files below the folder named on the command line."""
    folder = Path(sys.argv[1])
    paths = [path for path in sorted(folder.rglob("*")) if path.suffix in JUDGES]
    if not (folder / "index.html").exists():
        sys.exit(f"{folder}: has no index.html; build the site first, with make docs")
    found = [
        f"{path}: fetches {address}" for path in paths
        for address in JUDGES[path.suffix](path.read_text(encoding="utf-8"))
    ]  # fmt: skip
    if found:
        sys.exit("\n".join(found))
    print(f"{folder}: {len(paths)} pages, style sheets and scripts fetch nothing from elsewhere")


if __name__ == "__main__":
    main()
