#!/usr/bin/env python3
"""links.py SITE: every relative link, picture and anchor in the pages of the finished site exists."""
import re
import sys
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

SITE = Path(sys.argv[1]).resolve()


class Page(HTMLParser):
    """What a page links to, and the anchors that it has."""

    def __init__(self, path):
        super().__init__()
        self.links, self.anchors = [], set()
        self.feed(path.read_text(encoding="utf-8"))

    def handle_starttag(self, tag, attrs):
        values = dict(attrs)
        self.anchors.update(values[name] for name in ("id", "name") if values.get(name))
        # A head names where the page is to be found one day; nobody follows that.
        if tag != "link" or "stylesheet" in (values.get("rel") or "") or "icon" in (values.get("rel") or ""):
            self.links += [values[name] for name in ("href", "src") if values.get(name)]


def main():
    pages = {path: Page(path) for path in sorted(SITE.rglob("*.html"))}
    dead, count = [], 0
    for path, page in pages.items():
        for link in page.links:
            parts = urlsplit(link)
            if parts.scheme or parts.netloc:
                continue
            count += 1
            name = unquote(parts.path)
            goal = path if not name else SITE / name.lstrip("/") if name.startswith("/") else path.parent / name
            goal = goal.resolve()
            if goal.is_dir():
                goal = goal / "index.html"
            anchor = unquote(parts.fragment)
            known = pages[goal].anchors if goal in pages else {anchor}
            if not goal.exists() or (anchor and anchor not in known and not anchor.startswith("__")):
                dead.append(f"{path.relative_to(SITE)}: {link}")
    print("\n".join(dead) or f"{len(pages)} pages: all {count} links hold")
    sys.exit(bool(dead))


if __name__ == "__main__":
    main()
