#!/usr/bin/env python3
"""Computes the table of docs/scale.md: how long pictures and reconstructions take on many machines, by a model.

    tools/scale_model.py            prints the tables
    tools/scale_model.py --check    compares them with docs/scale.md

Times are for ranks of one thread. Standard library only.
"""

import pathlib
import sys

PAGE = pathlib.Path(__file__).resolve().parent.parent / "docs" / "scale.md"

RAYS_PER_SECOND = 2.0e6  # of one thread, a grid of which every ray is integrated (docs/benchmarks.md: 2.6e6)
TILE = 64 * 64  # pixels
SUM_BYTES = 2 * 8  # a pixel and channel: two randomisations in double precision
NETWORK = 1.0e9 / 8  # [B/s] gigabit Ethernet at rank 0
TILE_OVERHEAD = 20e-6  # [s] of rank 0 for a tile: message, sums, picture
COMPILE = 1.0  # [s] that every rank takes to compile the scene
LENSES = 1.3  # microlenses that light a pixel


def picture(ranks, lit_pixels, samples, network):
    """Seconds of a picture at a fixed number of samples, seconds that rank 0's network and processor are busy, efficiency."""
    work = lit_pixels * LENSES * samples / RAYS_PER_SECOND
    tiles = lit_pixels / TILE
    sent = tiles * TILE * SUM_BYTES * (ranks - 1) / ranks / network
    served = tiles * TILE_OVERHEAD
    last = work / tiles / 2 if ranks > 1 else 0  # the others wait for the last tile
    time = COMPILE + max(work / ranks + last, sent, served)
    return time, max(sent, served), (COMPILE + work) / (time * ranks)


def matrix(voxels, cameras, pixels_lit, rays):
    """Rows, entries, bytes of the matrix of a reconstruction; a ray crosses about 1.5 n cells of n^3, which touch 4 samples each."""
    side = round(voxels ** (1 / 3))
    rows = cameras * pixels_lit
    # Rays of a pixel stay within about two voxels of each other.
    entries = rows * 1.5 * side * 6
    return rows, entries, 8 * entries


def tables():
    lines = ["| ranks | 1 million pixels, 64 samples | efficiency | 42 million, 256 samples | efficiency |", "|---:|---:|---:|---:|---:|"]
    for ranks in (1, 16, 64, 1000):
        cells = []
        for pixels, samples in ((1e6, 64), (42e6, 256)):
            time, _, efficiency = picture(ranks, pixels, samples, NETWORK)
            cells.append(f"{time:.3g} s | {100 * efficiency:.0f} %")
        lines.append(f"| {ranks} | " + " | ".join(cells) + " |")
    lines.append("")
    _, _, size = matrix(128 ** 3, 12, 1e6, 64)
    lines.append(f"The matrix of 128^3 voxels and 12 cameras of 1 million lit pixels takes {size / 1e9:.3g} GB.")
    return "\n".join(lines)


def main():
    text = tables()
    if "--check" not in sys.argv[1:]:
        print(text)
        return
    page = PAGE.read_text()
    missing = [line for line in text.splitlines() if line and line not in page]
    if missing:
        sys.exit("docs/scale.md differs from tools/scale_model.py:\n" + "\n".join(missing))


if __name__ == "__main__":
    main()
