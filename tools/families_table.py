#!/usr/bin/env python3
"""Writes the table of errors and stated deviations over families of flames into docs/validation.md.

Usage: families_table.py build/release/tests/statistical_test [--page docs/validation.md]

Without --page it is printed. It runs the long form of the tests FlameFamilies.*, an hour of one processor.
"""

import argparse
import os
import pathlib
import subprocess
import sys

TITLE = "## Errors and stated deviations\n"
TEXT = """Families of flames that are drawn at random (`tests/statistical/flame_families.h`): three of each, with 20000, 5000 and 1000 electrons in the
brightest pixel. Pictures of 40 x 60 pixels are rendered of a grid that is four times finer than what is solved for, along other rays, and get the noise of a sensor. 14 x 22 rings, or
14 x 14 x 16 voxels; everything else is the default. Places count that emit more than 5 % of the brightest. Errors and deviations are 2-norms over them, relative to the truth; pulls are
(found - true) / stated. Deviations that hold have pulls of 1, 68 % within one of them, and 95 % within 1.96. `flame_families_test` holds a few of the flames against bounds in every run.

| flames | error [%] | stated [%] | pulls, RMS | within 1 [%] | within 1.96 [%] |
|---|---|---|---|---|---|
"""


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--page", help="whose section is written anew")
    options = parser.parse_args()
    done = subprocess.run([options.program, "--gtest_filter=FlameFamilies.DeviationsAreTheErrors:FlameFamilies.DeviationsOfTemperatures"], stdout=subprocess.PIPE, text=True, check=False,
                          env={**os.environ, "PLENOFLAME_LONG_TESTS": "1"})
    rows = [line for line in done.stdout.splitlines() if line.startswith("| ")]
    if not rows:
        sys.exit(f"families_table.py: {options.program} printed no rows")
    section = TITLE + TEXT + "\n".join(rows) + "\n"
    if not options.page:
        print(section)
        return
    page = pathlib.Path(options.page)
    before, title, after = page.read_text().partition(TITLE)
    if not title:
        sys.exit(f"families_table.py: {page} has no section {TITLE.strip()!r}")
    rest = after.partition("\n## ")
    page.write_text(before + section + (rest[1] + rest[2] if rest[1] else ""))


if __name__ == "__main__":
    main()
