#!/usr/bin/env python3
"""Writes docs/numerics.md from the stress suite.

    write_numerics.py --output docs/numerics.md STRESS_TEST...

Runs the executables, collects their lines "stress | area | case | reference | worst | bound | at"
(tests/stress/stress_table.h) and writes one table per area. Standard library only.
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


def collect(executable):
    done = subprocess.run([executable], capture_output=True, text=True)
    rows = [line.split(" | ")[1:] for line in done.stdout.splitlines() if line.startswith("stress | ")]
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
    parser.add_argument("tests", nargs="+", metavar="STRESS_TEST")
    options = parser.parse_args()
    areas = {}
    for test in options.tests:
        for area, *row in collect(test):
            areas.setdefault(area, []).append(row)
    text = HEAD + "".join(f"\n## {area}\n\n{table(rows)}\n" for area, rows in areas.items())
    folder = os.path.dirname(os.path.abspath(options.output))
    with tempfile.NamedTemporaryFile("w", dir=folder, delete=False) as file:
        file.write(text)
    os.chmod(file.name, 0o644)
    os.replace(file.name, options.output)


if __name__ == "__main__":
    main()
