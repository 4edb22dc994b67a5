#!/usr/bin/env python3
"""Writes docs/validation.md from the validation tests: published or computed numbers beside ours.

Usage: validation_page.py PROGRAM... [-o docs/validation.md]
       validation_page.py --check [-o docs/validation.md]
PROGRAM: tests/validation's validation_test, validation_long_test. Figures are the tests' properties. --check tells whether the
page has the texts of this file; the figures are those of when it was written.
"""

import argparse
import json
import pathlib
import subprocess
import sys
import tempfile

from reconstruction_views import TITLE

INTRODUCTION = """# Validation of the reconstruction

Cases of inverse problems with the numbers that were published, or computed by another program, beside ours. The numbers come from
the tests in `tests/validation`, which fail where they leave their tolerance; `tools/validation_page.py` writes this page from them.
"""

CASES = {
    "CaseA": ("Sun et al. 2017: chords of the cylinder",
              "Total radiation [W/(m^2 sr)] of a cylinder of 80 mm radius, kappa = 8 1/m, T = 1800 sin(r^2/(2 L^2) + z/H) + 273.15 K "
              "(the printed argument lacks a normalisation: this reading divides it by H). Within 1e-6. "
              "The source's claim, that one focus errs less than three, is not confirmed: both err alike. Its camera sees 40 of 10 x 10 rings of this flame; "
              "with data of 40 x 40 rings along other rays and LSQR at the iteration that is best by the truth, temperatures err by 12.4 (one focus) "
              "and 12.2 % (three) at 30 dB, and by 12.8 % (both) at 20 dB, in the mean of four draws of noise. `CaseA.OneFocusErrsAsThree` holds a quarter of its "
              "sensor and a picture of the renderer's against that, with blocks of 4 x 4 pixels: 12.5 % (both) at 30 dB, 12.8 % (both) at 20 dB. The source's bar heights are not readable, so that "
              "the size of its difference is not known."),
    "CaseB": ("Cylinder with a hot ring: chords",
              "Radiance [W/(m^3 sr)] of a cylinder of 20 mm radius, T = 900 + 1200 exp(-(3 (r^2/R^2 + z^2/H^2) - 0.9)^2) K. Within 1e-6."),
    "CaseC": ("Homogeneous cylinder in closed form",
              "S (1 - exp(-2 kappa sqrt(R^2 - b^2))) at 650 nm and 1700 K. Within 2e-6."),
    "CaseD": ("Signal trapping",
              "80 rings with self-absorption, 1 % noise, second differences: RMS error over the peak. Claims: below 0.04, and at least twice "
              "as bad where trapping is ignored."),
    "CaseE": ("What noise leaves unknown of temperature and absorption",
              "Cramer-Rao bounds of a cylinder in equal rings of one temperature (T) and one absorption (kappa) each: relative standard "
              "deviations in per cent, means of the rings above 1400 K, for 60 chords with noise of 1 % of each channel's peak. Within 3 % "
              "and half a unit of the last figure that is given."),
    "CaseF": ("Rings from one camera",
              "The hot ring's slice at 60 mm, 60 chords in 11 directions, least squares without a penalty, mean of 200 draws of noise: "
              "relative errors of emission (2-norm) and temperature (mean, weighted by emission). The optimum lies at 20 rings for 30 dB. "
              "The temperatures' weights are not told in full by the source: they are noted, not tested, and at 10 rings ours err twice as much."),
    "CaseG": ("One slice without symmetry",
              "30 x 30 nodes, x >= 0, first differences, the best strength of whole decades by the truth. One camera is far from enough "
              "whatever is done with its picture. The temperatures' weights are not told in full by the source: they are noted, not tested. Within "
              "15 % for one draw of noise and half a unit of the last figure. At 20 dB ours err more the more cameras there are, by 12 % with six "
              "and 17 % with twelve in the mean of six draws (single draws scatter by 7 %). Noise of the RMS over "
              "all 60 positions, dark ones included, leaves -1 and 3 % in the mean of six draws: that seems to be what the source took."),
    "ExportedMatrix": ("The matrix in other programs",
                       "Relative difference of the solutions of SciPy's lsqr (damped) and nnls, and of a sparse QR (Eigen), on the exported "
                       "matrix of a camera with microlenses from ours. Below 1e-6."),
}


def number(text):
    value = float(text)
    if value == 0:
        return "0"
    return f"{value:.7g}" if abs(value) >= 1e3 else f"{value:.3g}"


def figures_of(program):
    with tempfile.TemporaryDirectory() as folder:
        file = pathlib.Path(folder, "out.json")
        subprocess.run([program, f"--gtest_output=json:{file}"], check=True, stdout=subprocess.DEVNULL)
        suites = json.loads(file.read_text())["testsuites"]
    for suite in suites:
        for test in suite["testsuite"]:
            for key, value in test.items():
                words = str(value).split()
                if len(words) == 2 and all("e" in word for word in words):
                    yield suite["name"], key, words


def head_of(suite):
    title, text = CASES[suite]
    return f"\n## {title}\n{text}\n\n| case | expected | ours |\n|---|---|---|\n"


def check(page):
    """Ends with what the page lacks."""
    own, _, _ = page.partition("\n" + TITLE)
    missing = [title for suite, (title, _) in CASES.items() if own.count(head_of(suite)) != 1]
    if not own.startswith(INTRODUCTION):
        missing.insert(0, "the introduction")
    if missing or own.count("\n## ") != len(CASES):
        sys.exit("validation_page.py: docs/validation.md is not what this program writes: " + "; ".join(missing or ["a section too many"]))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("programs", nargs="*")
    parser.add_argument("--check", action="store_true")
    parser.add_argument("-o", "--output", default="docs/validation.md")
    arguments = parser.parse_args()
    if arguments.check:
        return check(pathlib.Path(arguments.output).read_text())
    if not arguments.programs:
        parser.error("give the programs whose figures are wanted")
    rows = {}
    for program in arguments.programs:
        for suite, key, words in figures_of(program):
            rows.setdefault(suite, {})[key] = words
    page = INTRODUCTION
    for suite in CASES:
        if suite not in rows:
            continue
        page += head_of(suite)
        for key, (expected, found) in rows[suite].items():
            page += f"| {key} | {number(expected)} | {number(found)} |\n"
    # Sections from that of tools/reconstruction_views.py on take minutes and stay as they were.
    output = pathlib.Path(arguments.output)
    if output.exists():
        _, title, after = output.read_text().partition("\n" + TITLE)
        if title:
            page += title + after.rstrip("\n") + "\n"
    output.write_text(page)
    return None


if __name__ == "__main__":
    main()
