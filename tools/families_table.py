#!/usr/bin/env python3
"""Puts the table of errors and stated deviations over families of flames into docs/validation.md.

Usage: families_table.py build/release/tests/statistical_test [--page docs/validation.md]

Of each kind of unknowns the family with the largest pulls stands beside the mean of all. Without --page the table is printed. It runs the long form of the tests AllFlameFamilies.*, FlameFamilies.* and SootFamilies.*, hours of one processor.
"""

import argparse
import os
import pathlib
import subprocess
import sys

HEAD = "| flames | error [%] | stated [%] | pulls, RMS | within 1 [%] | within 1.96 [%] |\n|---|---|---|---|---|---|\n"


def worst_and_all(rows):
    kinds = {}
    for row in rows:
        if row.split(" | ")[0].endswith(", absorbing"):  # their emission
            continue
        kinds.setdefault(row.split(" | ")[0].strip("| *").partition(", ")[2], []).append(row)
    kept = []
    for of_kind in kinds.values():
        families = [row for row in of_kind if "**" not in row]
        kept += sorted(families, key=lambda row: float(row.split(" | ")[3]))[-1:]
        kept += [row for row in of_kind if "**" in row]
    return kept


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--page", help="whose table is written anew")
    options = parser.parse_args()
    done = subprocess.run([options.program, "--gtest_filter=AllFlameFamilies.*:FlameFamilies.DeviationsOfTemperatures:SootFamilies.*"], stdout=subprocess.PIPE, text=True, check=False,
                          env={**os.environ, "PLENOFLAME_LONG_TESTS": "1"})
    rows = worst_and_all([line for line in done.stdout.splitlines() if line.startswith("| ")])
    if not rows:
        sys.exit(f"families_table.py: {options.program} printed no rows")
    table = HEAD + "\n".join(rows) + "\n"
    if not options.page:
        print(table, end="")
        return
    page = pathlib.Path(options.page)
    before, head, after = page.read_text().partition(HEAD)
    if not head:
        sys.exit(f"families_table.py: {page} has no such table")
    rest = after.splitlines(keepends=True)
    while rest and rest[0].startswith("|"):
        del rest[0]
    page.write_text(before + table + "".join(rest))


if __name__ == "__main__":
    main()
