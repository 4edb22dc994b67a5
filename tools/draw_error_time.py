#!/usr/bin/python3
"""Draws docs/images/error-time.png: error against processor time for the paper's flame, from the tables of docs/benchmarks.md.

    tools/draw_error_time.py

Nothing is measured. The paper gives 20 threads, 10 hours and 2e10 rays, and no error. Its point has the error of the forward estimator
with as many bundles. Needs what drawing.py says.
"""

import re

from drawing import ROOT, save

import matplotlib.pyplot as plt
import numpy

PAGE = (ROOT / "docs/benchmarks.md").read_text(encoding="utf-8")
PAPER_TIME, PAPER_RAYS = 20 * 10 * 3600, 2e10   # [s] of a processor, rays: Opt. Express 25 (2017) 8274, section 3
INK, GREY = "#202020", "#707070"


def rows(title):
    """Cells of the first table below this heading, as lists of texts."""
    section = PAGE.split(f"\n## {title}\n")[1].split("\n## ")[0]
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in section.splitlines() if line.startswith("|")][2:]


def whole(name):
    """(processor time [s], error [%]) of the whole picture in the rows whose first cell begins with this."""
    points = []
    for what, times, _, error in rows("The paper's flame, whole image"):
        if re.fullmatch(name, what):
            one, two = times.split(", ")
            points.append((float(one) if one != "-" else 2 * float(two), float(error.split()[0])))
    return numpy.array(sorted(points)).T


def main():
    plt.rcParams.update({"font.family": "DejaVu Sans", "font.size": 11})
    figure, axes = plt.subplots(figsize=(9, 5.2), layout="constrained")
    for name, words, colour, marker in ((r"closed form, (\d+ samples|to 1 %)", "Plenoflame, layers in closed form", "#0072b2", "o"),
                                        (r"grid, (\d+ samples|to 1 %)", "Plenoflame, voxels of 0.23 mm", "#009e73", "s")):
        axes.loglog(*whole(name), marker=marker, color=colour, label=words)
    forward = [row for row in rows("paper-flame-1m") if row[0] == "forward"]
    bundles = numpy.array([float(row[1]) for row in forward])
    time = numpy.array([2 * float(row[3].split()[0]) for row in forward])  # two threads
    error = numpy.array([float(row[2].split()[0]) for row in forward])
    last = numpy.array([1, PAPER_RAYS / bundles[-1]])
    axes.loglog(time, error, marker="^", color="#d55e00", label="Plenoflame, forward estimator (the paper's method)")
    axes.loglog(time[-1] * last, error[-1] / numpy.sqrt(last), "--", color="#d55e00", label="the same, by the law of the error, to $2\\cdot10^{10}$ bundles")
    paper = error[-1] / numpy.sqrt(last[-1])
    axes.loglog(PAPER_TIME, paper, marker="*", markersize=15, linestyle="none", color=INK, label="the paper's program, 20 threads for 10 hours")
    axes.axhline(1, color=GREY, linewidth=0.8, linestyle=":")
    axes.text(0.13, 1.07, "1 %", color=GREY)
    axes.set_xlim(0.1, 3e6)
    axes.set_ylim(0.3, 200)
    axes.set_xlabel("processor time (s)")
    axes.set_ylabel("relative RMS error of the flux (%)")
    axes.xaxis.set_major_formatter("{x:g}")
    axes.yaxis.set_major_formatter("{x:g}")
    axes.set_xticks([0.1, 1, 10, 100, 1e3, 1e4, 1e5, 1e6], ["0.1", "1", "10", "100", "1000", "$10^4$", "$10^5$", "$10^6$"])
    axes.grid(which="major", color="#e0e0e0", linewidth=0.7)
    axes.legend(frameon=False, loc="upper right")
    axes.spines[["top", "right"]].set_visible(False)
    save(figure, "error-time.png", 180)


if __name__ == "__main__":
    main()
