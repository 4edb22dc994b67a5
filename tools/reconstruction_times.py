#!/usr/bin/env python3
"""Time and memory of reconstructions, for docs/reconstruct.md.

    tools/reconstruction_times.py PLENOFLAME [--grid 64,64,64] [--columns 500] [--rows 900] [--threads 1 2]

Three cameras of examples/ring-of-six.toml with sensors of that many pixels. Iterations of CGLS are told from all that comes
before them by two runs that differ in their number alone. Processor time is of all threads; on a machine with other work
look at it rather than at the clock. Standard library only.
"""

import argparse
import json
import os
import pathlib
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parents[1]
CAMERAS = ("at0", "at60", "at120")
BYTES_OF_AN_ENTRY = 8  # a float and a column of 32 bits


def measured(arguments, folder):
    """Output as JSON, seconds on the clock, seconds of processors, and peak memory in MB of one run."""
    out = os.path.join(folder, "out.json")
    begin = time.monotonic()
    child = os.fork()
    if child == 0:
        os.chdir(folder)
        os.dup2(os.open(out, os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o600), 1)
        os.execv(arguments[0], arguments)
    _, status, usage = os.wait4(child, 0)
    if status:
        raise SystemExit(f"reconstruction_times.py: failed: {' '.join(arguments)}")
    text = pathlib.Path(out).read_text(encoding="utf-8")
    return (json.loads(text) if text.startswith("{") else {}, time.monotonic() - begin, usage.ru_utime + usage.ru_stime,
            usage.ru_maxrss / 1024)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("command")
    parser.add_argument("--grid", default="64,64,64")
    parser.add_argument("--columns", type=int, default=500)
    parser.add_argument("--rows", type=int, default=900)
    parser.add_argument("--rays", type=int, default=2)
    parser.add_argument("--threads", type=int, nargs="+", default=[1, 2])
    parser.add_argument("--iterations", type=int, default=51)
    options = parser.parse_args()
    command = os.path.abspath(options.command)
    scene = [str(ROOT / "examples" / "ring-of-six.toml")]
    for name in CAMERAS:
        scene += ["--camera", name]
    for value in (f"columns={options.columns}", f"rows={options.rows}", f"pixel_pitch={10000 / options.columns} um"):
        scene += ["--set", f"cameras[0].sensor.{value}"]

    with tempfile.TemporaryDirectory() as folder:
        measured([command, "render", *scene, "--samples", "1", "--seed", "7", "-o", "x.exr", "--quiet"], folder)
        images = [f"x-{name}.exr" for name in CAMERAS]
        print("| threads | rows | voxels | iterations | s a step, clock | s a step, processors | s before, clock | s before, processors "
              "| matrix MB | peak MB |\n|---|---|---|---|---|---|---|---|---|---|", flush=True)
        for threads in options.threads:
            def run(iterations):
                return measured([command, "reconstruct", *scene, "--images", *images, "--grid", options.grid, "--rays",
                                 str(options.rays), "--solver", "cgls", "--noise", "0.01", "--strength", "1e-6", "--iterations",
                                 str(iterations),
                                 "--draws", "0", "--probes", "0", "--memory", "12000", "--threads", str(threads), "--quiet", "--json",
                                 "-o", "x.vdb"], folder)
            one, clock, processors, _ = run(1)
            many, long_clock, long_processors, memory = run(options.iterations)
            steps = max(1, many["iterations"] - one["iterations"])
            print(f"| {threads} | {many['rows']} | {many['unknowns']} | {steps} | {(long_clock - clock) / steps:.3f} | "
                  f"{(long_processors - processors) / steps:.3f} | {clock:.1f} | {processors:.1f} | "
                  f"{1e-6 * many['matrix_bytes']:.0f} | {memory:.0f} |", flush=True)
            if not many["stored"]:
                print("the matrix is not stored: rays are followed again in each step", flush=True)


if __name__ == "__main__":
    main()
