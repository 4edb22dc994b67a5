#!/usr/bin/python3
"""Draws docs/images/candle-temperature.png: a candle in its own colours, its two-colour temperature, and the true mean temperature.

    tools/draw_temperature.py [FOLDER]     flame and light field stay in FOLDER (out/candle) and are used again

The scene is examples/candle-colours.toml. Needs matplotlib, and the built command and Python package
(PLENOFLAME: build/release/app/cli/plenoflame).
"""

import os
import pathlib
import shutil
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[1]
COMMAND = pathlib.Path(os.environ.get("PLENOFLAME", ROOT / "build/release/app/cli/plenoflame")).resolve()
sys.path.insert(0, str(COMMAND.parents[2] / "lib/python3/dist-packages"))

try:
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    import numpy
    import plenoflame
except ImportError as missing:
    sys.exit(f"draw_temperature.py: {missing}: tools/setup.sh python dev, and cmake --build build/release")

PIXEL = 22e-3 * 650 / 100  # [mm] in the flame: the lens of 100 mm reduces 6.5 times
SIDE, FOOT = 8, 16         # [mm] to the sides of the axis, and the axis of the lens above the wick


def computed(folder):
    folder.mkdir(parents=True, exist_ok=True)
    shutil.copy(ROOT / "examples/candle-colours.toml", folder)
    for file, command in (("candle.vdb", "flame candle -o candle.vdb"),
                          ("candle.exr", "render candle-colours.toml --truth --samples 64 --quiet -o candle.exr"),
                          ("candle.png", "develop candle.exr --colour -o candle.png"),
                          ("temperature.exr", "pyrometry candle.exr --channels 650nm,850nm -o temperature.exr")):
        if not (folder / file).exists():
            subprocess.run([str(COMMAND), *command.split()], cwd=folder, check=True, stdout=subprocess.DEVNULL)


def main():
    folder = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ROOT / "out/candle").resolve()
    computed(folder)
    field = plenoflame.read_light_field(folder / "temperature.exr")
    found = numpy.where(field["temperature"] > 0, field["temperature"], numpy.nan)
    true = numpy.where(field["temperature"] > 0, field["truth.temperature"], numpy.nan)
    rows, columns = found.shape
    extent = (-columns / 2 * PIXEL, columns / 2 * PIXEL, FOOT - rows / 2 * PIXEL, FOOT + rows / 2 * PIXEL)
    plt.rcParams.update({"font.family": "DejaVu Sans", "font.size": 13, "axes.titlesize": 14})
    figure, axes = plt.subplots(1, 4, figsize=(14, 8), layout="constrained", sharey=True)
    axes[0].imshow(plt.imread(folder / "candle.png"), extent=extent, interpolation="bilinear")
    axes[0].set_title("own colours")
    axes[0].set_ylabel("height above the wick (mm)")
    kelvin = {"cmap": "inferno", "vmin": 1650, "vmax": 1850, "extent": extent}
    axes[1].imshow(found, **kelvin)
    axes[1].set_title("two-colour temperature")
    shown = axes[2].imshow(true, **kelvin)
    axes[2].set_title("true mean temperature")
    figure.colorbar(shown, ax=axes[1:3], location="bottom", label="temperature (K)", shrink=0.7, aspect=35, pad=0.02)
    empty = figure.colorbar(shown, ax=axes[0], location="bottom", label=" ", aspect=17, pad=0.02)
    empty.ax.set_visible(False)  # keeps the panels level
    reach = numpy.nanpercentile(numpy.abs(found - true), 99)
    shown = axes[3].imshow(found - true, cmap="RdBu_r", vmin=-reach, vmax=reach, extent=extent)
    axes[3].set_title("their difference")
    figure.colorbar(shown, ax=axes[3], location="bottom", label="difference (K)", aspect=17, pad=0.02)
    for axis in axes:
        axis.set_facecolor("black" if axis is axes[0] else "#808080")
        axis.set_xlim(-SIDE, SIDE)
        axis.set_ylim(-2, 36)
        axis.set_xticks((-5, 0, 5))
        axis.set_xlabel("y (mm)")
    target = ROOT / "docs/images/candle-temperature.png"
    figure.savefig(target, dpi=120)
    print(target)


if __name__ == "__main__":
    main()
