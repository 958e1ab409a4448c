"""The part of a page that a script writes: between two lines with its name."""
from pathlib import Path


def parts(page, name):
    before, rest = Path(page).read_text().split(f"<!-- {name} -->\n")
    inside, after = rest.split(f"<!-- end of {name} -->")
    return before, inside, after


def read(page, name):
    return parts(page, name)[1]


def write(page, name, text):
    before, _, after = parts(page, name)
    Path(page).write_text(f"{before}<!-- {name} -->\n{text}<!-- end of {name} -->{after}")
