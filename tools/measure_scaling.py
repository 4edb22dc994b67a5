#!/usr/bin/env python3
"""Measures how pictures, sweeps and reconstructions scale with ranks of one thread, for docs/scale.md: paired runs, medians.

    tools/measure_scaling.py PLENOFLAME [--pairs N] [--parts runs pictures sweeps reconstructions]

Standard library only.
"""

import argparse
import csv
import json
import os
import pathlib
import resource
import statistics
import subprocess
import tempfile
import time

EXAMPLES = pathlib.Path(__file__).resolve().parents[1] / "examples"
SCENE = EXAMPLES / "paper-flame-1m.toml"
ENVIRONMENT = {**os.environ, "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}


class Runs:
    def __init__(self, command, folder, pairs):
        self.command, self.folder, self.pairs = os.path.abspath(command), folder, pairs

    def run(self, ranks, *arguments):
        """What the command prints, with the time on the clock, and that of all processors, from its start to its end."""
        start = ["mpirun", "--oversubscribe", "--bind-to", "none", "-n", str(ranks)] if ranks > 1 else []
        before, begin = resource.getrusage(resource.RUSAGE_CHILDREN), time.monotonic()
        printed = subprocess.run([*start, self.command, *map(str, arguments)], env=ENVIRONMENT, check=True, capture_output=True, text=True,
                                 cwd=self.folder).stdout
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        return printed, time.monotonic() - begin, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime

    def quotients(self, first, second):
        """Medians and extremes of the quotients of two kinds of run, one after the other."""
        pairs = [list(zip(first(), second())) for _ in range(self.pairs)]
        texts = []
        for k in range(len(pairs[0])):
            values = [pair[k][0] / pair[k][1] for pair in pairs]
            texts.append(f"{statistics.median(values):.3f} ({min(values):.3f} to {max(values):.3f})")
        return "; of processors ".join(texts)


def pictures(runs):
    def seconds(ranks, threads, samples):
        """Of rendering, as the command says; without compiling the scene and starting processes."""
        printed, _, _ = runs.run(ranks, "render", SCENE, "--window", "1300,1300,700,700", "--samples", samples, "--threads", threads,
                                 "--json", "-o", "x.exr")
        return [json.loads(printed)["seconds"]]

    def say(what, first, second):
        print(f"pictures, {what}:", runs.quotients(lambda: seconds(*first), lambda: seconds(*second)), flush=True)
    samples = 32
    say("2 ranks of one thread to 2 threads", (2, 1, samples), (1, 2, samples))
    for ranks in (2, 3, 4):
        say(f"{ranks} ranks to 1, the same work", (ranks, 1, samples), (1, 1, samples))
    for ranks in (2, 4):
        say(f"{ranks} ranks to 1, work as the ranks", (ranks, 1, ranks * samples), (1, 1, samples))


def sweeps(runs):
    number = 0

    def times(ranks, threads, count):
        """From the start of the processes to the packed set."""
        nonlocal number
        number += 1
        path = pathlib.Path(runs.folder, f"{number}.csv")
        path.write_text("flames[0].brightness\n" + "".join(f"{1 + k / count}\n" for k in range(count)), encoding="utf-8")
        return runs.run(ranks, "sweep", EXAMPLES / "lenslets-30.toml", "--table", path, "--format", "hdf5", "--samples", 16,
                        "--lattice", 32, "--threads", threads, "--quiet", "-o", f"set{number}")[1:]

    def say(what, first, second):
        print(f"sweeps, {what}:", runs.quotients(lambda: times(*first), lambda: times(*second)), flush=True)
    count = 120
    say("2 ranks of one thread to 2 threads", (2, 1, count), (1, 2, count))
    for ranks in (2, 4):
        say(f"{ranks} ranks to 1, the same work", (ranks, 1, count), (1, 1, count))
    say("2 ranks to 1, work as the ranks", (2, 1, 2 * count), (1, 1, count))


def reconstructions(runs):
    runs.run(1, "render", EXAMPLES / "lenslets-30.toml", "--samples", 16, "--quiet", "-o", "p.exr")

    def times(ranks, threads):
        """With a single iteration: rays and matrix are nearly all of it."""
        return runs.run(ranks, "reconstruct", EXAMPLES / "lenslets-30.toml", "--images", "p.exr", "--grid", 32, "--rays", 256,
                        "--strength", 1, "--iterations", 1, "--draws", 0, "--probes", 0, "--threads", threads, "--quiet", "-o", "x.vdb")[1:]

    def say(what, first, second):
        print(f"reconstructions, {what}:", runs.quotients(lambda: times(*first), lambda: times(*second)), flush=True)
    say("2 ranks of one thread to 2 threads", (2, 1), (1, 2))
    for ranks in (2, 4):
        say(f"{ranks} ranks to 1, the same work", (ranks, 1), (1, 1))


def runs_of_sets(runs):
    """What one run of a set takes of the processors, without the start of the command: the difference of sets of 61 runs and of 1."""
    scene = EXAMPLES / "lenslets-30.toml"
    number = 0

    def seconds(count, form):
        nonlocal number
        number += 1
        path = pathlib.Path(runs.folder, f"runs{number}.csv")
        path.write_text("flames[0].brightness\n" + "".join(f"{1 + k / count}\n" for k in range(count)), encoding="utf-8")
        return runs.run(1, "sweep", scene, "--table", path, "--lattice", 32, "--threads", 1, "--quiet", "-o", f"of{number}", "--samples", 64,
                        "--format", form)[2]

    for form in ("exr", "hdf5"):
        values = [(seconds(61, form) - seconds(1, form)) / 60 for _ in range(runs.pairs)]
        print(f"sets, {form}: {statistics.median(values):.3f} s a run ({min(values):.3f} to {max(values):.3f})", flush=True)
        folder = pathlib.Path(runs.folder, f"of{number - 1}")
        with open(folder / "index.csv", newline="", encoding="utf-8") as file:
            errors = [float(row["relative_error"]) for row in csv.DictReader(file)]
        size = sum(path.stat().st_size for path in folder.rglob("*") if path.is_file()) / 61
        print(f"  error {100 * statistics.mean(errors):.2f} %, {size / 1e6:.2f} MB a run", flush=True)
    start = [runs.run(2, "--version")[2] for _ in range(runs.pairs)]
    own = [runs.run(1, "render", scene, "--window", "150,150,8,8", "--samples", 2, "--quiet", "-o", "x.exr")[2] for _ in range(runs.pairs)]
    print(f"mpirun -n 2 and the end of MPI: {statistics.median(start):.2f} s; a rank's own scene: {statistics.median(own):.2f} s", flush=True)


PARTS = {"runs": runs_of_sets, "pictures": pictures, "sweeps": sweeps, "reconstructions": reconstructions}


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("command")
    parser.add_argument("--pairs", type=int, default=5)
    parser.add_argument("--parts", nargs="+", choices=PARTS, default=list(PARTS))
    options = parser.parse_args()
    for part in options.parts:
        with tempfile.TemporaryDirectory() as folder:
            PARTS[part](Runs(options.command, folder, options.pairs))


if __name__ == "__main__":
    main()
