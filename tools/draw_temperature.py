#!/usr/bin/python3
"""Draws docs/images/candle-temperature.png: a candle in its own colours, its two-colour temperature, and the true mean temperature.

    tools/draw_temperature.py [FOLDER]     flame and light field stay in FOLDER (out/candle) and are used again

The scene is examples/candle-colours.toml. Needs what drawing.py says.
"""

import shutil

from drawing import ROOT, make, save, working_folder

import matplotlib.pyplot as plt
import numpy
import plenoflame

PIXEL = 22e-3 * 650 / 100  # [mm] in the flame: the lens of 100 mm reduces 6.5 times
SIDE, FOOT = 8, 16         # [mm] to the sides of the axis, and the axis of the lens above the wick


def main():
    place = working_folder("candle")
    shutil.copy(ROOT / "examples/candle-colours.toml", place)
    make(place, {"candle.vdb": "flame candle -o candle.vdb",
                 "candle.exr": "render candle-colours.toml --truth --samples 64 --quiet -o candle.exr",
                 "candle.png": "develop candle.exr --colour -o candle.png",
                 "temperature.exr": "pyrometry candle.exr --channels 650nm,850nm -o temperature.exr"})
    field = plenoflame.read_light_field(place / "temperature.exr")
    found = numpy.where(field["temperature"] > 0, field["temperature"], numpy.nan)
    true = numpy.where(field["temperature"] > 0, field["truth.temperature"], numpy.nan)
    rows, columns = found.shape
    extent = (-columns / 2 * PIXEL, columns / 2 * PIXEL, FOOT - rows / 2 * PIXEL, FOOT + rows / 2 * PIXEL)
    plt.rcParams.update({"font.family": "DejaVu Sans", "font.size": 13, "axes.titlesize": 14})
    figure, axes = plt.subplots(1, 4, figsize=(12, 8), layout="constrained", sharey=True)
    axes[0].imshow(plt.imread(place / "candle.png"), extent=extent, interpolation="bilinear")
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
    save(figure, "candle-temperature.png", 120)


if __name__ == "__main__":
    main()
