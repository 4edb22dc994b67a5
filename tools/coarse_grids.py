#!/usr/bin/env python3
"""Deviations of a candle on grids from coarse to fine against its errors: a table of docs/validation.md.

    PYTHONPATH=.../dist-packages tools/coarse_grids.py PLENOFLAME [--rings 8 12 16 24] [--voxels 12 24 36] [--page docs/validation.md]

The pictures are those of docs/reconstruct.md's first commands. The truth is the flame's file, read with Planck's law. Needs SciPy.
"""

import argparse
import os
import pathlib
import shutil
import subprocess
import tempfile

import numpy
import plenoflame
from scipy import constants, ndimage

ROOT = pathlib.Path(__file__).resolve().parents[1]
HEAD = "| grid | chi^2 | error [%] | stated [%] | pulls, RMS | within 1.96 [%] | pulls of temperature | within 1.96 [%] |\n|---|---|---|---|---|---|---|---|\n"
WAVELENGTH, WIDTH = 650e-9, 10e-9  # m
FOOT = (1, 0, -0.016)  # m; of the flame in the scene
LIT = 0.05  # of the largest emission


def planck(temperature):
    """Spectral radiance, integrated over the channel [W/(m^2 sr)]."""
    nodes, weights = numpy.polynomial.legendre.leggauss(5)
    band = 0
    for node, weight in zip(nodes, weights):
        at = WAVELENGTH + 0.5 * WIDTH * node
        exponent = constants.h * constants.c / (at * constants.k * temperature)
        band = band + 0.5 * WIDTH * weight * 2 * constants.h * constants.c**2 / at**5 / numpy.expm1(exponent)
    return band


def truth_at(flame, places):
    """Emission [W/(m^3 sr)] and temperature [K]."""
    at = ((places - numpy.array(FOOT) - flame.origin) / flame.spacing).reshape(-1, 3).T
    temperature, absorption = (ndimage.map_coordinates(numpy.asarray(flame[name], float), at, order=1, cval=outside).reshape(places.shape[:-1])
                               for name, outside in (("temperature", 293.15), ("absorption", 0)))
    return absorption * planck(temperature), temperature


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("command")
    parser.add_argument("--rings", type=int, nargs="+", default=[8, 12, 16, 24])
    parser.add_argument("--voxels", type=int, nargs="+", default=[12, 24, 36], help="along the longest side, before two cameras")
    parser.add_argument("--page", help="whose table is written anew")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        flame = plenoflame.make_flame("candle")
        plenoflame.write_flame(pathlib.Path(folder, "candle.vdb"), flame)
        command = os.path.abspath(options.command)
        scenes, pictures = [], []
        for name in ("front", "side"):
            scene, picture = pathlib.Path(folder, f"{name}.toml"), pathlib.Path(folder, f"{name}-electrons.exr")
            shutil.copy(ROOT / f"examples/reconstruct-{name}.toml", scene)
            for words in (("render", scene, "--samples", "512", "-o", f"{name}.exr", "--quiet"),
                          ("develop", f"{name}.exr", "--sensor", "-o", picture)):
                subprocess.run([command, *words], cwd=folder, check=True, stdout=subprocess.DEVNULL)
            scenes.append(plenoflame.Scene(scene))
            pictures.append(picture)
        rows = ""
        for name, cameras, unknowns, grid in ([(f"{n} x {2 * n} rings", 1, "rings", (n, 2 * n)) for n in options.rings] +
                                              [(f"{n} voxels, 2 cameras", 2, "voxels", n) for n in options.voxels]):
            found = plenoflame.reconstruct(scenes[:cameras], pictures[:cameras], unknowns=unknowns, grid=grid, absorption="scene")
            emission, temperature = truth_at(flame, numpy.asarray(found.places).reshape(*found.shape, 3))
            lit = emission > LIT * emission.max()
            row = f"| {name} | {found.figures['chi_squared']:.2f} |"
            for true, back, deviation, norm in ((emission, found.emission, found.emission_deviation, True),
                                                (temperature, found.temperature, found.temperature_deviation, False)):
                true, back, deviation = (numpy.asarray(a).reshape(found.shape)[lit] for a in (true, back, deviation))
                size = numpy.linalg.norm(true)
                if norm:
                    row += f" {100 * numpy.linalg.norm(back - true) / size:.1f} | {100 * numpy.linalg.norm(deviation) / size:.1f} |"
                pulls = (back - true) / deviation
                row += f" {numpy.sqrt(numpy.mean(pulls**2)):.2f} | {100 * numpy.mean(abs(pulls) < 1.96):.0f} |"
            print(row, flush=True)
            rows += row + "\n"
    if options.page:
        page = pathlib.Path(options.page)
        before, head, after = page.read_text(encoding="utf-8").partition(HEAD)
        if not head:
            raise SystemExit(f"coarse_grids.py: {page} has no such table")
        rest = after.split("\n\n", 1)[1]
        page.write_text(before + head + rows + "\n" + rest, encoding="utf-8")


if __name__ == "__main__":
    main()
