#!/usr/bin/env python3
"""stage.py OUT: gathers the pages of the site in OUT: docs/, measured results of bench/, and the pages at the root.

Links between them are made to hold there; those to sources become plain text. Pages of the gallery that are there are linked.
"""
import os
import re
import shutil
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent.parent
LINK = re.compile(r"(!?)\[([^]]*)\]\(([^)\s#]*)(#[^)\s]*)?\)")

LIVE = re.compile(r"<!-- live: (\w+) -->")


def moved(path):
    """Where a file of the repository lies on the site, or None."""
    relative = path.relative_to(ROOT)
    if str(relative) == "docs/README.md":
        return Path("pages.md")  # the list of pages; one starts at the root's
    if relative.parts[0] == "docs":
        return Path(*relative.parts[1:])
    if relative.parts[:2] == ("bench", "results"):
        return Path("bench", *relative.parts[2:])
    if relative.name in ("CONTRIBUTING.md", "CHANGELOG.md", "CITATION.cff", "LICENSE") and len(relative.parts) == 1:
        return relative
    if str(relative) == "README.md":
        return Path("index.md")
    return None


def page_with_links(source, target):
    def link(match):
        image, text, path, anchor = match.groups()
        if not path or re.match(r"[a-z]+:", path):
            return match[0]
        goal = moved((source.parent / path).resolve())
        if goal is None:
            return text
        return f"{image}[{text}]({os.path.relpath(goal, target.parent)}{anchor or ''})"

    # Blocks of code stay as they are.
    parts = re.split(r"(^```.*?^```$)", source.read_text(encoding="utf-8"), flags=re.M | re.S)
    return "".join(part if i % 2 else LINK.sub(link, part) for i, part in enumerate(parts))


def with_live_pages(text, out):
    """Links of the gallery to pages that `make gallery` has left in out/gallery/, copied beside it."""
    def link(match):
        page = ROOT / "out/gallery" / f"{match[1]}.html"
        if not page.exists():
            return ""
        (out / "gallery/live").mkdir(parents=True, exist_ok=True)
        shutil.copy(page, out / "gallery/live" / page.name)
        return f'<a href="live/{page.name}">Turn it, cut it, measure it</a>'

    return LIVE.sub(link, text)


def main():
    out = Path(sys.argv[1])
    shutil.rmtree(out, ignore_errors=True)
    files = [p for p in (ROOT / "docs").rglob("*") if p.is_file() and "site" not in p.relative_to(ROOT).parts]
    files += sorted((ROOT / "bench/results").iterdir())
    files += [ROOT / name for name in ("README.md", "CONTRIBUTING.md", "CHANGELOG.md", "CITATION.cff", "LICENSE")]
    shutil.copytree(ROOT / "docs/site", out, ignore=shutil.ignore_patterns("*.py", "*.mjs", "Doxyfile", "*.md", "theme"))
    for source in files:
        target = moved(source)
        (out / target).parent.mkdir(parents=True, exist_ok=True)
        if source.suffix == ".md":
            (out / target).write_text(with_live_pages(page_with_links(source, target), out), encoding="utf-8")
        else:
            shutil.copy(source, out / target)


if __name__ == "__main__":
    main()
