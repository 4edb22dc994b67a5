#!/usr/bin/env python3
"""The files and names that the developers' pages point to are there.

    names_test.py ROOT
"""

import pathlib
import re
import sys

PAGES = ("docs/developer/glossary.md", "docs/developer/architecture.md")
FILE = re.compile(r"(?<![\w/.*-])((?:[\w-]+/)*[\w-]+(?:\.inl)?\.(?:h|cpp))(?![\w])")
NAME = re.compile(r"`([A-Za-z_]\w*(?:::\w+)*)`")


def missing(root, pages):
    """(page, what it names) of everything that is not there."""
    sources = [p for folder in ("core", "volumes", "app") for p in (root / folder).rglob("*")
               if p.suffix in (".h", ".cpp", ".cxx")]
    paths = {"/" + p.relative_to(root).as_posix() for p in sources}
    words = set(re.findall(r"\w+", "\n".join(p.read_text() for p in sources)))
    for page in pages:
        text = (root / page).read_text()
        for name in FILE.findall(text):
            if name != "x_kernel.inl.h" and not any(path.endswith("/" + name) for path in paths):
                yield page, name
        if page.endswith("glossary.md"):
            for name in NAME.findall(text):
                if not set(name.split("::")) <= words and name != "BoundExitPupil":  # pbrt's
                    yield page, name


def main():
    root = pathlib.Path(sys.argv[1])
    found = list(missing(root, PAGES))
    for page, name in found:
        print(f"{page}: there is no {name}")
    named = sum(len(NAME.findall((root / page).read_text())) for page in PAGES)
    if named < 30:
        sys.exit(f"only {named} names: the pages are written otherwise than this test reads them")
    sys.exit(1 if found else 0)


main()
