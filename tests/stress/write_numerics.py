#!/usr/bin/env python3
"""Writes docs/numerics.md from the stress suite.

    write_numerics.py --output docs/numerics.md STRESS_TEST...
    write_numerics.py --output docs/numerics.md --bounds bounds_of_examples EXAMPLES
    write_numerics.py --output docs/numerics.md --bounds-printed FILE

The first form runs the executables and writes one table for each area of their lines
"stress | area | case | reference | worst | bound | at" (tests/stress/stress_table.h). It draws the lines "order | ..." of the voxel
suite. Needs python3-matplotlib.
The second form measures in how many pictures the true error is below the stated bound, in every example of a folder
(tests/statistical/bounds_of_examples.cpp; minutes). The flames (.vdb) must be there. The rest of the page stays.
The third form takes the output of that program, for runs in parts, each of a scene.
"""

import argparse
import os
import re
import statistics
import subprocess
import sys
import tempfile

HEAD = """# Numerical accuracy

This page shows the largest errors of the formulas for extreme values, and how often the stated error of a picture holds.
`ninja -C build/release numerics` makes it from the stress suite (`tests/stress`). The tests fail if an error exceeds its bound.

Each error is the largest of all cases and instruction sets. A reference shares no code with the formula. The unit of an error stands in
brackets; "ulp" is one unit in the last place of the exact value. The first of two numbers is of single, the second of double precision.
"""


ORDER = """
## Error of a voxel grid against its spacing

The flame fills a cube of 16 mm. Its temperature varies around 1500 K by 300 K (sines and a ramp), its absorption by half. Five oblique
rays cross it; the source function is sigma T^4.

- *Quadrature* (full lines): error of two nodes per cell, against adaptive quadrature of the same trilinear fields. It is of fourth order.
- *Grid* (broken lines): error of trilinear interpolation, against the smooth flame. It is of second order, and limits the accuracy.

Grey lines have the exact slopes.

![Relative error against spacing](images/voxel-order.png)

"""


BOUNDS_TITLE = "\n## How often the stated limit of the error holds\n"

BOUNDS = BOUNDS_TITLE + """
The table has the share of pictures whose true relative RMSE lies below the stated [95 % limit](theory/errors.md#upper-limit-of-the-error). The
true error is the difference from a picture of 64 times the samples, in the brightest window. Each example has LEAST or more pictures with their
own seeds, so shares have standard errors of at most MOST %. Examples that take longer than SECONDS are left out
(`write_numerics.py --bounds` in `tests/stress`).

| window [pixels] | samples | replicates | examples | lowest share | median share | limit over true error, median |
|---|---|---|---|---|---|---|
"""


def bounds_section(program, folder, seconds):
    done = subprocess.run([program, folder, str(seconds)], capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"{program} failed:\n{done.stderr[-2000:]}")
    return bounds_text(done.stdout, seconds)


def bounds_text(printed, seconds):
    """The section of the page, of what the program printed."""
    rows = [line.split(" | ")[1:] for line in printed.splitlines() if line.startswith("coverage | ")]
    if not rows:
        sys.exit("no pictures were made:\n" + printed[-2000:])
    found, errors = {}, []
    for scene, side, samples, replicates, pictures, share, wide in rows:
        found.setdefault((int(side), int(samples), int(replicates)), []).append((100 * float(share), scene, float(wide)))
        errors.append(100 * (float(share) * (1 - float(share)) / int(pictures)) ** 0.5)
    text = BOUNDS.replace("SECONDS", f"{seconds:g} s").replace("MOST", f"{max(errors):.1f}").replace("LEAST", str(min(int(row[4]) for row in rows)))
    for (side, samples, replicates), cases in sorted(found.items()):
        lowest = min(cases)
        text += line_of([f"{side} x {side}", str(samples), str(replicates), str(len(cases)), f"{lowest[0]:.1f} % ({lowest[1]})",
                         f"{statistics.median(case[0] for case in cases):.1f} %", f"{statistics.median(case[2] for case in cases):.2f}"])
    return text


def plot(orders, path):
    import matplotlib
    matplotlib.use("Agg")
    from matplotlib import pyplot, ticker
    figure, axes = pyplot.subplots(figsize=(7.2, 4.8), layout="constrained")
    thicknesses = sorted({row[0] for row in orders})
    for thickness, colour in zip(thicknesses, ("#0072b2", "#d55e00", "#009e73")):
        rows = [row for row in orders if row[0] == thickness]
        step = [1e3 * row[1] for row in rows]
        axes.loglog(step, [row[2] for row in rows], "o-", color=colour,
                    label=f"quadrature, optical thickness {thickness:g}")
        axes.loglog(step, [row[3] for row in rows], "s--", color=colour,
                    label=f"grid, optical thickness {thickness:g}")
    ends = [1e3 * min(row[1] for row in orders), 1e3 * max(row[1] for row in orders)]
    for order, start in ((4, 1e-11), (2, 4e-4)):
        axes.loglog(ends, [start, start * (ends[1] / ends[0]) ** order], color="0.6", lw=1)
        axes.annotate(f"slope {order}", (1, start / ends[0] ** order), xytext=(0, 8 if order == 2 else -8), textcoords="offset points",
                      color="0.4", ha="right" if order == 2 else "left", va="bottom" if order == 2 else "top")
    axes.xaxis.set_major_locator(ticker.FixedLocator([0.25, 0.5, 1, 2, 4]))
    axes.xaxis.set_major_formatter(ticker.FormatStrFormatter("%g"))
    axes.xaxis.set_minor_locator(ticker.NullLocator())
    axes.set_xlabel("spacing of the samples [mm]")
    axes.set_ylabel("relative error of the radiance, RMS")
    axes.grid(True, which="major", color="0.9")
    axes.legend(fontsize="small", loc="center left", bbox_to_anchor=(1, 0.5), frameon=False)
    figure.savefig(path, dpi=150)


def collect(executable, orders):
    done = subprocess.run([executable], capture_output=True, text=True)
    rows = [line.split(" | ")[1:] for line in done.stdout.splitlines() if line.startswith("stress | ")]
    orders += [[float(v) for v in line.split(" | ")[1:]]
               for line in done.stdout.splitlines() if line.startswith("order | ")]
    if done.returncode != 0 or not rows:
        sys.exit(f"{os.path.basename(executable)} failed or printed no cases:\n{done.stdout[-2000:]}")
    return rows


def line_of(cells):
    return "| " + " | ".join(cells) + " |\n"


def table(rows):
    """A line for each case: rows that differ in precision share one, of several that differ in nothing but place the worst counts."""
    cases = {}
    for case, reference, worst, bound, _ in rows:
        precision = re.search(r", (single|double)(?=[ ,])", case)
        name = case.replace(precision[0], "", 1) if precision else case
        found = cases.setdefault((name, reference), {})
        key = precision[1] if precision else ""
        if key not in found or float(worst) > float(found[key][0]):
            found[key] = (worst, bound)
    references = list(dict.fromkeys(reference for _, reference in cases if not reference.startswith("none")))
    text = f"References: {'; '.join(references)}.\n\n" if references else ""
    text += line_of(["case", "largest error", "bound"]) + "|---|---|---|\n"
    for (name, _), found in cases.items():
        order = [key for key in ("single", "double", "") if key in found]
        if len(order) == 1 and order[0]:
            name = re.sub(r"( \[[^\]]*\])?$", f", {order[0]}\\1", name, count=1)
        text += line_of([name, *("; ".join(found[key][i] for key in order) for i in (0, 1))])
    return text.rstrip("\n")


def order_table(orders):
    """A line for each spacing [mm]; errors of quadrature and grid for each optical thickness."""
    thicknesses = sorted({row[0] for row in orders})
    found = {(t, h): (f"{q:.2g}", f"{g:.2g}") for t, h, q, g in orders}
    text = line_of(["spacing [mm]", *(f"{what}, tau {t:g}" for t in thicknesses for what in ("quadrature", "grid"))])
    text += "|---" * (2 * len(thicknesses) + 1) + "|\n"
    for h in sorted({row[1] for row in orders}, reverse=True):
        text += line_of([f"{1e3 * h:g}", *(cell for t in thicknesses for cell in found[t, h])])
    return text


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--output", required=True)
    parser.add_argument("--bounds", nargs=2, metavar=("PROGRAM", "EXAMPLES"))
    parser.add_argument("--bounds-printed", metavar="FILE")
    parser.add_argument("--seconds", type=float, default=20, help="for a row of the table of bounds, at most")
    parser.add_argument("tests", nargs="*", metavar="STRESS_TEST")
    options = parser.parse_args()
    before = open(options.output).read() if os.path.exists(options.output) else ""
    rest, title, bounds = before.partition(BOUNDS_TITLE)
    if options.bounds:
        return write(options.output, rest + bounds_section(*options.bounds, options.seconds))
    if options.bounds_printed:
        with open(options.bounds_printed) as file:
            return write(options.output, rest + bounds_text(file.read(), options.seconds))
    if not options.tests:
        parser.error("no STRESS_TEST")
    areas, orders = {}, []
    for test in options.tests:
        for area, *row in collect(test, orders):
            areas.setdefault(area, []).append(row)
    text = HEAD + "".join(f"\n## {area}\n\n{table(rows)}\n" for area, rows in areas.items())
    if orders:
        text += ORDER + order_table(orders)
        images = os.path.join(os.path.dirname(os.path.abspath(options.output)), "images")
        plot(orders, os.path.join(images, "voxel-order.png"))
    write(options.output, text + title + bounds)


def write(path, text):
    folder = os.path.dirname(os.path.abspath(path))
    with tempfile.NamedTemporaryFile("w", dir=folder, delete=False) as file:
        file.write(text)
    os.chmod(file.name, 0o644)
    os.replace(file.name, path)


if __name__ == "__main__":
    main()
