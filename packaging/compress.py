#!/usr/bin/env python3
"""Compresses what Debian wants compressed, without names and times, so that the same input gives the same bytes.

    compress.py MAN_FOLDER FILE OUT [FILE OUT ...]

Manual pages in MAN_FOLDER are replaced by .gz; each FILE is written to OUT, compressed."""

import gzip
import pathlib
import sys


def compress(source, target):
    target.parent.mkdir(parents=True, exist_ok=True)
    target.write_bytes(gzip.compress(source.read_bytes(), 9, mtime=0))


folder = pathlib.Path(sys.argv[1])
for each in sorted(folder.glob("*.1")):
    compress(each, each.with_name(each.name + ".gz"))
    each.unlink()
for source, target in zip(sys.argv[2::2], sys.argv[3::2]):
    compress(pathlib.Path(source), pathlib.Path(target))
