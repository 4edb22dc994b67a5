#!/usr/bin/env python3
"""Error against time of compiled cameras beside the plain renderer, and how true the errors are that they state.

    tools/compiled_benchmark.py PLENOFLAME OUT.json [--window X,Y,W,H] [--flames 20]

tools/make_benchmarks.sh calls it (PARTS=compiled), and tools/benchmark_page.py makes the section of docs/benchmarks.md. Times are of
the processors, all threads together, so that other work on the machine matters little. Standard library only.
"""

import argparse
import json
import os
import pathlib
import subprocess
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[1]
SCENE = str(ROOT / "examples" / "paper-flame-1m.toml")
# Places, temperatures and soot of flames within 2 mm around that of the scene.
RULES = """runs = {flames}
[[random]]
key = "flames[0].position"
uniform = [["0.998 m", "-2 mm", "-31 mm"], ["1.002 m", "2 mm", "-27 mm"]]
[[random]]
key = "flames[0].layers[0].temperature"
uniform = ["1200 K", "1600 K"]
[[random]]
key = "flames[0].layers[1].temperature"
uniform = ["1600 K", "1850 K"]
[[random]]
key = "flames[0].layers[1].absorption"
log_uniform = ["10 1/m", "80 1/m"]
[[random]]
key = "flames[0].layers[2].temperature"
uniform = ["1700 K", "2000 K"]
"""


class Runs:
    """Commands in a folder of their own."""

    def __init__(self, command, folder):
        self.command, self.folder = os.path.abspath(command), folder

    def figures(self, *arguments):
        """What the command prints as JSON, and the processors' time that it took."""
        before = os.times()
        text = subprocess.run([self.command, *map(str, arguments), "--json"], cwd=self.folder, check=True, capture_output=True,
                              text=True).stdout
        after = os.times()
        seconds = after.children_user + after.children_system - before.children_user - before.children_system
        return json.loads(text), seconds

    def truth(self, picture, reference):
        """Error and bias against a picture whose own error is taken off."""
        figures = self.figures("compare", picture, reference)[0]
        noise = self.reference_error if reference == "reference.exr" else 0
        return {"true": max(0, figures["relative_rmse"] ** 2 - noise ** 2) ** 0.5, "bias": figures["relative_bias"],
                "bias_error": figures["relative_bias_error"]}


def against_time(runs, window):
    """Rows of the first table."""
    reference, _ = runs.figures("render", SCENE, "--window", window, "--samples", 8192, "--seed", 77, "-o", "reference.exr")
    runs.reference_error = reference["relative_error"]
    pixels = int(window.split(",")[2]) * int(window.split(",")[3])
    rows = []
    for samples in (16, 64, 256, 1024):
        figures, seconds = runs.figures("render", SCENE, "--window", window, "--samples", samples, "-o", "a.exr")
        rows.append({"what": f"plain, {samples} samples", "rays": figures["rays"] / pixels, "compile": 0, "seconds": seconds,
                     "stated": figures["relative_error"], **runs.truth("a.exr", "reference.exr")})
    for error in ("4.5%", "2.2%", "1.2%", "0.65%", "0.36%"):
        bundle, compiling = runs.figures("compile", SCENE, "--window", window, "--error", error, "-o", "a.bundle")
        figures, seconds = runs.figures("render", SCENE, "--compiled", "a.bundle", "-o", "a.exr")
        rows.append({"what": f"compiled, --error {error}", "rays": bundle["rays"] / pixels, "compile": compiling,
                     "seconds": seconds, "stated": figures["relative_error"], **runs.truth("a.exr", "reference.exr")})
    return rows


def many_flames(runs, window, flames, error):
    """Of each flame the error that is stated over the true one, and the bias."""
    pathlib.Path(runs.folder, "rules.toml").write_text(RULES.format(flames=flames), encoding="ascii")
    runs.figures("compile", SCENE, "--window", window, "--error", error, "--margin", "3mm", "-o", "b.bundle")
    sweep = ("sweep", SCENE, "--random", "rules.toml", "--quiet")
    runs.figures(*sweep, "--compiled", "b.bundle", "-o", "few")
    runs.figures(*sweep, "--window", window, "--samples", 1024, "-o", "many")
    rows = []
    for run in range(flames):
        figures = runs.figures("compare", f"few/runs/{run:06}.exr", f"many/runs/{run:06}.exr")[0]
        rows.append({"ratio": figures["expected_rmse"] / figures["relative_rmse"], "rmse": figures["relative_rmse"],
                     "bias": figures["relative_bias"], "bias_error": figures["relative_bias_error"]})
    return {"error": error, "flames": rows}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("command")
    parser.add_argument("output")
    parser.add_argument("--window", default="1000,1100,1000,6")
    parser.add_argument("--flames", type=int, default=20)
    parser.add_argument("--flames-window", default="1000,1100,1000,2")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        runs = Runs(options.command, folder)
        result = {"window": options.window, "flames_window": options.flames_window,
                  "sets": [many_flames(runs, options.flames_window, options.flames, "2.2%")],
                  "rows": against_time(runs, options.window)}
    pathlib.Path(options.output).write_text(json.dumps(result, indent=1) + "\n", encoding="ascii")


if __name__ == "__main__":
    main()
