#!/usr/bin/env python3
"""Compresses what Debian wants compressed, without names and times, so that the same input gives the same bytes.

    compress.py MAN_FOLDER CHANGELOG CHANGELOG_OUT PAGE PAGE_FOLDER

Manual pages in MAN_FOLDER are replaced by .gz; CHANGELOG is written to CHANGELOG_OUT, PAGE to PAGE_FOLDER/PAGE.gz."""

import gzip
import pathlib
import sys


def compress(source, target):
    target.parent.mkdir(parents=True, exist_ok=True)
    target.write_bytes(gzip.compress(source.read_bytes(), 9, mtime=0))


folder, changelog, changelog_out, page, page_folder = map(pathlib.Path, sys.argv[1:])
for each in sorted(folder.glob("*.1")):
    compress(each, each.with_name(each.name + ".gz"))
    each.unlink()
compress(changelog, changelog_out)
compress(page, page_folder / (page.name + ".gz"))
