#!/usr/bin/env python3
"""Measures how a picture scales with ranks of one thread, for docs/scale.md: paired runs, medians.

    tools/measure_scaling.py PLENOFLAME [--pairs N]

Standard library only.
"""

import argparse
import json
import os
import statistics
import subprocess
import tempfile

SCENE = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "examples", "paper-flame-1m.toml")
ENVIRONMENT = {**os.environ, "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}


def seconds(command, ranks, threads, samples, folder):
    """Of rendering, as the command says; without compiling the scene and starting processes."""
    start = ["mpirun", "--oversubscribe", "--bind-to", "none", "-n", str(ranks)] if ranks > 1 else []
    result = subprocess.run([*start, command, "render", SCENE, "--window", "1300,1300,700,700", "--samples", str(samples), "--threads",
                             str(threads), "--json", "-o", os.path.join(folder, "x.exr")], env=ENVIRONMENT, check=True,
                            capture_output=True, text=True)
    return json.loads(result.stdout)["seconds"]


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("command")
    parser.add_argument("--pairs", type=int, default=5)
    options = parser.parse_args()
    command = os.path.abspath(options.command)

    def ratio(first, second):
        """Median and extremes of the quotient of two kinds of run, one after the other."""
        with tempfile.TemporaryDirectory() as folder:
            quotients = [seconds(command, *first, folder) / seconds(command, *second, folder) for _ in range(options.pairs)]
        return f"{statistics.median(quotients):.3f} ({min(quotients):.3f} to {max(quotients):.3f})"

    samples = 32
    print("2 ranks of one thread to 2 threads:", ratio((2, 1, samples), (1, 2, samples)), flush=True)
    for ranks in (2, 3, 4):
        print(f"{ranks} ranks to 1, the same work:", ratio((ranks, 1, samples), (1, 1, samples)), flush=True)
    for ranks in (2, 4):
        print(f"{ranks} ranks to 1, work as the ranks:", ratio((ranks, 1, ranks * samples), (1, 1, samples)), flush=True)


if __name__ == "__main__":
    main()
