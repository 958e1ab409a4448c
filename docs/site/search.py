#!/usr/bin/env python3
"""search.py SITE: writes SITE/search/from_disk.js, with which the search works in pages that are opened from a disk.

A browser lets such pages load scripts but read no files: the theme's worker and the index go into one script, which the
theme asks for them (its variable __search).
"""
import json
import sys
from pathlib import Path


def main():
    site = Path(sys.argv[1])
    workers = list(site.glob("assets/javascripts/workers/search.*.min.js"))
    if len(workers) != 1:
        sys.exit(f"{site}: {len(workers)} search workers of the theme, must be one")
    worker = workers[0].read_text(encoding="utf-8").rsplit("//# sourceMappingURL", 1)[0]
    index = (site / "search/search_index.json").read_text(encoding="utf-8")
    script = (
        f"__search = {{index: Promise.resolve({index}),\n"
        f"  worker: URL.createObjectURL(new Blob([{json.dumps(worker)}], {{type: 'text/javascript'}}))}};\n"
    )
    (site / "search/from_disk.js").write_text(script, encoding="utf-8")


if __name__ == "__main__":
    main()
