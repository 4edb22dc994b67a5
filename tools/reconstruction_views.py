#!/usr/bin/env python3
"""A flame without symmetry from one, three and six cameras: the section of docs/validation.md.

    tools/reconstruction_views.py PLENOFLAME [--grid 32 64] [--rays 64] [--samples 1024] [--page docs/validation.md]

The flame is that of the page's "One slice without symmetry" in three dimensions: nested shells of an ellipsoid, each of one
temperature, which are rendered exactly; the cameras are those of examples/ring-of-six.toml, with the noise of a sensor of
20000 electrons. Neither the shells nor the rays of the pictures are those of the reconstruction. Standard library only.
"""

import argparse
import json
import math
import os
import pathlib
import subprocess
import sys
import tempfile
import textwrap

ROOT = pathlib.Path(__file__).resolve().parents[1]
TITLE = "## An asymmetric flame from one, three and six cameras"
CAMERAS = {1: ("at0",), 3: ("at0", "at60", "at120"), 6: ("at0", "at60", "at120", "at210", "at270", "at330")}
# Errors [per cent] of emission and temperature in one slice, with the best strength by the truth, at 30 and 20 dB.
SLICE = {1: ("71, 75", "7.4, 8.2"), 3: ("13, 16", "3.3, 2.5"), 6: ("4.5, 7.3", "0.9, 1.1")}
SHELLS = 64
SEMI_AXES = (14, 16, 20)  # mm


def scene_text():
    """The ring of six with a sensor's noise, around shells of T = 900 + 1200 exp(-(3 (q + 0.09) - 0.9)^2) K."""
    example = (ROOT / "examples" / "ring-of-six.toml").read_text(encoding="utf-8")
    cameras, rest = example.split("[[flames]]", 1)
    cameras = cameras.replace('pixel_pitch = "100 um"', 'pixel_pitch = "100 um"\nfull_well = 20000\nread_noise = 8')
    flame = '[[flames]]\nkind = "layered"\nname = "eccentric"\nposition = ["3 mm", "-4 mm", "0 mm"]\n'
    for k in range(1, SHELLS + 1):
        axes = ", ".join(f'"{axis * math.sqrt(k / SHELLS):.6f} mm"' for axis in SEMI_AXES)
        q = (k - 0.5) / SHELLS
        temperature = 900 + 1200 * math.exp(-(3 * (q + 0.09) - 0.9) ** 2)
        flame += f'\n[[flames.layers]]\nsemi_axes = [{axes}]\ntemperature = "{temperature:.4f} K"\nabsorption = "8 1/m"\n'
    return cameras + flame + "\n" + rest[rest.index("[[channels]]"):]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("command")
    parser.add_argument("--grid", nargs="+", default=["32", "64"], help="voxels along the longest side; 64 want 16 cores and 60 GB")
    parser.add_argument("--rays", default="64")
    parser.add_argument("--samples", default="1024")
    parser.add_argument("--memory", default="12000")
    parser.add_argument("--cameras", type=int, nargs="+", default=[1, 3, 6], choices=list(CAMERAS))
    parser.add_argument("--page", help="whose section is written anew; without it, it is printed")
    options = parser.parse_args()
    command = os.path.abspath(options.command)

    def run(*arguments):
        done = subprocess.run([command, *arguments], cwd=folder, stdout=subprocess.PIPE, check=False)
        if done.returncode:
            sys.exit(f"reconstruction_views.py: failed: {' '.join(arguments)}")
        return done.stdout

    with tempfile.TemporaryDirectory() as folder:
        pathlib.Path(folder, "six.toml").write_text(scene_text(), encoding="utf-8")
        run("render", "six.toml", "--samples", options.samples, "--seed", "99", "-o", "x.exr", "--quiet")
        for name in CAMERAS[6]:
            run("develop", f"x-{name}.exr", "--sensor", "-o", f"{name}.exr")
        rows = ""
        for grid, count in ((grid, count) for grid in options.grid for count in options.cameras):
            chosen = [word for name in CAMERAS[count] for word in ("--camera", name)]
            found = json.loads(run("reconstruct", "six.toml", *chosen, "--images", *[f"{name}.exr" for name in CAMERAS[count]],
                                   "--absorption", "scene", "--grid", grid, "--rays", options.rays, "--memory", options.memory,
                                   "--draws", "0", "--probes", "0", "--truth", "--quiet", "--json", "-o", "x.vdb"))
            emission, temperature = SLICE[count]
            rows += (f"| {grid} | {count} | {found['rows']} | {found['chi_squared']:.2f} | {emission} | "
                     f"{100 * found['truth_emission_error']:.1f} | {temperature} | {100 * found['truth_temperature_error']:.1f} |\n")
            print(rows.splitlines()[-1], flush=True)
    text = (f"`tools/reconstruction_views.py` uses the flame of the slice, as an ellipsoid of {2 * SEMI_AXES[0]} x {2 * SEMI_AXES[1]} x "
            f"{2 * SEMI_AXES[2]} mm in {SHELLS} exact shells. Cameras like those of `examples/ring-of-six.toml`, 1 m away, have 100 x 180 "
            "pixels and a sensor of 20000 electrons. Voxels are counted along the longest side, with "
            f"{options.rays} rays a pixel and microlens. Errors in per cent stand beside those of one slice with the best strength by the "
            "truth at 30 and 20 dB.")
    if "64" not in options.grid:
        text += " Finer grids were not measured."
    section = f"""{TITLE}
{textwrap.fill(text, 140, break_on_hyphens=False)}

The aim for six cameras is less than 8 % of emission and 1.5 % of temperature.

| voxels | cameras | rows | chi^2 per row | emission, slice | emission, ours | temperature, slice | temperature, ours |
|---|---|---|---|---|---|---|---|
{rows}"""
    if not options.page:
        print(section)
        return
    page = pathlib.Path(options.page)
    before, _, after = page.read_text(encoding="utf-8").partition(TITLE)
    rest = after.partition("\n## ")
    page.write_text(before.rstrip("\n") + "\n\n" + section + ("\n## " + rest[2] if rest[1] else ""), encoding="utf-8")


if __name__ == "__main__":
    main()
