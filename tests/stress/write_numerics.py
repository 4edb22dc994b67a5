#!/usr/bin/env python3
"""Writes docs/numerics.md from the stress suite.

    write_numerics.py --output docs/numerics.md STRESS_TEST...
    write_numerics.py --output docs/numerics.md --bounds bounds_of_examples EXAMPLES
    write_numerics.py --output docs/numerics.md --bounds-printed FILE

The second form measures in how many pictures the true error is below the stated bound, in every example of a folder, whose flames
(.vdb) must be there (tests/statistical/bounds_of_examples.cpp; minutes), and leaves the rest of the page as it is; the third takes what
that program printed, for runs in parts, each of a scene.
The first runs the executables, collects their lines "stress | area | case | reference | worst | bound | at"
(tests/stress/stress_table.h) and writes one table per area; draws the lines "order | ..." of the voxel
suite. Needs python3-matplotlib.
"""

import argparse
import os
import subprocess
import sys
import tempfile

HEAD = """# Numerical accuracy under stress

Made by `ninja -C build/release numerics` from the stress suite (`tests/stress`), which also runs with the other tests and
holds every line to its bound. Errors are the worst of all cases and of all instruction sets that the processor has; the
reference never shares code with what it judges. "ulp" is one unit in the last place of the exact value.
"""


ORDER = """
## Error of a grid against its spacing

A smooth flame in a cube of 16 mm (300 K of sines and a ramp around 1500 K, absorption varying by half), five oblique rays
across; sigma T^4. Full lines: what two nodes per cell and interval leave of the radiance of the trilinear fields, against
adaptive quadrature of the same fields: fourth order in the spacing. Broken lines: against the flame itself, by Runge-Kutta
integration of the transfer equation: what trilinear interpolation makes of it, second order. What bounds the accuracy of a
grid is its spacing, not the integration. Exact slopes are drawn in grey.

![Relative error against spacing](images/voxel-order.png)

| optical thickness | spacing [mm] | quadrature, relative RMS | grid, relative RMS |
|---|---|---|---|
"""


BOUNDS_TITLE = "\n## How often the stated bound of the error holds\n"

BOUNDS = BOUNDS_TITLE + """
Made by `write_numerics.py --bounds` (tests/stress) over all examples: pictures of that many seeds, one by one, each held against one of 64 times the
samples, in the brightest window of 48 x 48 and of 8 x 8 pixels. "below 95 % limit" is the share of them whose true relative RMSE lies below
the stated limit ([Errors](theory/errors.md)), with its standard error; shares below 93 % are bold. "wide" is the median of limit over true error. Rows
that would take more than SECONDS are named below the table.

| example | side [pixels] | samples | randomisations | pictures | below 95 % limit | wide |
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
    left_out = {}
    for line in printed.splitlines():
        if line.startswith("left out | "):
            scene, *row, reason = line.split(" | ")[1:]
            left_out.setdefault(scene, []).append((row, reason))
    if not rows:
        sys.exit("no pictures were made:\n" + printed[-2000:])
    text = BOUNDS.replace("SECONDS", f"{seconds:g} s")
    for scene, side, samples, replicates, pictures, share, wide in rows:
        share, error = float(share), 100 * (float(share) * (1 - float(share)) / int(pictures)) ** 0.5
        told = f"{100 * share:.1f} +- {error:.1f} %"
        text += f"| {scene} | {side} | {samples} | {replicates} | {pictures} | " \
                f"{'**' + told + '**' if share < 0.93 else told} | {wide} |\n"
    if left_out:
        text += "\nNot measured (side, samples, randomisations):\n\n"
    for scene, of_scene in left_out.items():
        text += f"- {scene}: " + "; ".join(f"{', '.join(row)}: {reason}" if row[0] != "-" else reason for row, reason in of_scene) + "\n"
    return text


def plot(orders, path):
    import matplotlib
    matplotlib.use("Agg")
    from matplotlib import pyplot
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
        axes.annotate(f"slope {order}", (ends[0], start), xytext=(6, 10), textcoords="offset points",
                      color="0.4")
    axes.set_xlabel("spacing of the samples [mm]")
    axes.set_ylabel("relative error of the radiance, RMS")
    axes.grid(True, which="major", color="0.9")
    axes.legend(fontsize="small", loc="center left", bbox_to_anchor=(1, 0.5), frameon=False)
    figure.savefig(path, dpi=110)


def collect(executable, orders):
    done = subprocess.run([executable], capture_output=True, text=True)
    rows = [line.split(" | ")[1:] for line in done.stdout.splitlines() if line.startswith("stress | ")]
    orders += [[float(v) for v in line.split(" | ")[1:]]
               for line in done.stdout.splitlines() if line.startswith("order | ")]
    if done.returncode != 0 or not rows:
        sys.exit(f"{os.path.basename(executable)} failed or printed no cases:\n{done.stdout[-2000:]}")
    return rows


def table(rows):
    lines = ["| case | reference | worst error | bound | at |", "|---|---|---|---|---|"]
    lines += ["| " + " | ".join(row) + " |" for row in rows]
    return "\n".join(lines)


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
        text += ORDER + "".join(f"| {t:g} | {1e3 * h:g} | {q:.2g} | {g:.2g} |\n" for t, h, q, g in orders)
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
