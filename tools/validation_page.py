#!/usr/bin/env python3
"""Writes docs/validation.md from the validation tests: published or computed numbers beside ours.

Usage: validation_page.py PROGRAM... [-o docs/validation.md]
       validation_page.py --check [-o docs/validation.md]
PROGRAM: statistical_test, which runs in full. Figures are the tests' properties. --check compares the texts of
the page with those of this file; it leaves the figures aside.
"""

import argparse
import json
import os
import pathlib
import subprocess
import sys
import tempfile

from reconstruction_views import TITLE

INTRODUCTION = """# Validation

This page compares the program with published inverse problems and other programs. The tests in `tests/validation` compute the
numbers and fail outside the tolerance. `tools/validation_page.py` writes the page.
"""


class Case:
    """A section. `quantities` are the ends of the figures' names that become columns; figures with other ends are left out. None: one line
    sums all figures up."""

    def __init__(self, title, text, quantities):
        self.title, self.text, self.quantities = title, text, quantities

    def head(self):
        text = f"\n## {self.title}\n\n{self.text}\n\n"
        if self.quantities is None:
            return text
        names = [f"{quantity}: expected, ours" if quantity else "expected, ours" for quantity in self.quantities]
        return text + "| case | " + " | ".join(names) + " |\n" + "|---" * (1 + len(names)) + "|\n"

    def body(self, rows):
        """The lines below the head, of {name: (expected, ours)}."""
        if self.quantities is None:
            figures = [(float(expected), float(ours)) for expected, ours in rows.values()]
            largest = max(abs(ours - expected) / (abs(expected) or 1) for expected, ours in figures)
            found = f"the largest difference is {largest:.1g}" if largest > 0 else "all 7 digits agree"
            return f"{len(figures)} values; {found}.\n"
        cells = {}
        for name, pair in rows.items():
            quantity = next((quantity for quantity in self.quantities if name.endswith(quantity)), None)
            if quantity is None:
                continue
            cells.setdefault(name.removesuffix(quantity).strip(), {})[quantity] = ", ".join(map(number, pair))
        return "".join("| " + " | ".join([name, *(found.get(quantity, "") for quantity in self.quantities)]) + " |\n"
                       for name, found in cells.items())


CASES = {
    "CaseA": Case("Sun et al. 2017: chords of the cylinder",
                  """Total radiation [W/(m^2 sr)] of a cylinder of 80 mm radius with kappa = 8 1/m and T = 1800 sin(r^2/(2 L^2) + z/H) + 273.15 K. The
printed argument lacks a normalisation; here it is divided by H. Tolerance 1e-6, relative.

The source claims that a camera with one focus has smaller errors than one with three. This is not confirmed. Mean temperature errors of
four draws of noise are 12.4 % (one focus) and 12.2 % (three) at 30 dB, 12.8 % (both) at 20 dB. `CaseA.OneFocusErrsAsThree` tests a quarter
of the sensor: 12.5 and 12.8 % (both). The camera sees 40 of the 10 x 10 rings. The data are from 40 x 40 rings along other rays, and LSQR
stops at the best iteration by the truth.""", None),
    "CaseB": Case("Cylinder with a hot ring: chords",
                  """Radiance [W/(m^3 sr)] of a cylinder of 20 mm radius with T = 900 + 1200 exp(-(3 (r^2/R^2 + z^2/H^2) - 0.9)^2) K. Five
chords in the heights 40, 100 and 160 mm pass the axis at 0 or 10 mm. They are computed for kappa = 8 and 30 1/m, at 610 and 650 nm.
Tolerance 1e-6, relative.""", None),
    "CaseC": Case("Homogeneous cylinder in closed form",
                  """S (1 - exp(-2 kappa sqrt(R^2 - b^2))) at 650 nm and 1700 K, for kappa = 0.5, 8 and 100 1/m. Tolerance 2e-6, relative.""", None),
    "CaseD": Case("Signal trapping",
                  """80 rings with self-absorption, 1 % noise, second differences: RMS error over the peak. The error has to be below 0.04, and at least twice
as large if trapping is ignored.""", ("",)),
    "CaseE": Case("Smallest possible errors of temperature and absorption",
                  """Cramer-Rao bounds: relative standard deviations in per cent, means of the rings above 1400 K. A cylinder has equal rings. A case gives the
numbers of temperatures (T) and absorptions (kappa), and the wavelengths [nm]. There are 60 chords with noise of 1 % of each channel's peak.
The true absorption is 8 or 30 1/m. Tolerance 3 % and half a unit of the last printed figure.""", ("kappa at 8 per m", "T at 8 per m", "kappa at 30 per m", "T at 30 per m")),
    "CaseF": Case("Rings from one camera",
                  """The hot ring's slice at 60 mm, 60 chords in 11 directions, least squares without a penalty, mean of 200 draws of noise. Errors are
relative: emission in the 2-norm, temperature as a mean weighted by emission. The optimum lies at 20 rings for 30 dB. The source does not
give all weights of its temperatures, so these are not tested. At 10 rings they differ by a factor of two.""",
                  ("30 dB emission", "20 dB emission", "30 dB temperature", "20 dB temperature")),
    "CaseG": Case("One slice without symmetry",
                  """30 x 30 nodes, x >= 0, first differences, the best strength of whole decades by the truth. One camera is not enough with any method.
Errors are relative. Tolerance: 15 % for one draw of noise, and half a unit of the last printed figure.

At 20 dB our mean errors of six draws exceed the source's by 12 % with six cameras and by 17 % with twelve. Single draws scatter by 7 %. With
noise relative to the RMS over all 60 positions, dark ones included, the differences are -1 and 3 %. The source seems to use this definition.""", ("30 dB emission", "20 dB emission")),
    "ExportedMatrix": Case("The matrix in other programs",
                           """The matrix of a camera with microlenses is exported and solved by SciPy's lsqr (damped) and nnls and by a sparse QR (Eigen). The
numbers are relative differences between their solutions and ours. Tolerance 1e-6.""", None),
}


def number(text):
    value = float(text)
    if value == 0:
        return "0"
    return f"{value:.7g}" if abs(value) >= 1e3 else f"{value:.3g}"


def figures_of(program):
    with tempfile.TemporaryDirectory() as folder:
        file = pathlib.Path(folder, "out.json")
        subprocess.run([program, "--gtest_filter=Case*:ExportedMatrix*", f"--gtest_output=json:{file}"], check=True, stdout=subprocess.DEVNULL,
                       env={**os.environ, "PLENOFLAME_LONG_TESTS": "1"})
        suites = json.loads(file.read_text())["testsuites"]
    for suite in suites:
        for test in suite["testsuite"]:
            for key, value in test.items():
                words = str(value).split()
                if len(words) == 2 and all("e" in word for word in words):
                    yield suite["name"], key, words


def check(page):
    """Ends with what the page lacks."""
    own, _, _ = page.partition("\n" + TITLE)
    missing = [case.title for case in CASES.values() if own.count(case.head()) != 1]
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
    for suite, case in CASES.items():
        if suite in rows:
            page += case.head() + case.body(rows[suite])
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
