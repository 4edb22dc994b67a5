#!/usr/bin/python3
"""Draws docs/images/white-lattice.png, a white picture with its fitted lattice, and bayer-raw.png, a raw picture behind colour filters.

    tools/draw_calibration.py [FOLDER]     the pictures stay in FOLDER (out/calibration) and are used again

The white picture is that of docs/real-cameras.md. The Bayer picture is a part of the one in README.md, with the filters of a colour
sensor. Needs what drawing.py says.
"""

import csv
import re

from drawing import ROOT, run, save, turbulent_flame, working_folder

import matplotlib.pyplot as plt
import numpy
import plenoflame
from matplotlib.patches import Circle
from PIL import Image

TYPES = ("#56b4e9", "#e69f00", "#00b377")
FILTERS = {"red": (0, 0), "green": (0, 1), "blue": (1, 1)}  # a row and a column of each in the pattern rggb
WINDOW = (6576 - 3188, 1010, 120, 120)                      # of the raw picture


def white(folder):
    """(the white picture's numbers, the rows of the table of micro-images), by the commands of docs/real-cameras.md."""
    nominal = (ROOT / "examples/lab/nominal.toml").read_text()
    (folder / "nominal.toml").write_text(nominal)
    real = 'pitch = "127.4 um"\nrotation = "0.8 deg"\noffset = ["20 um", "0 um"]'
    (folder / "real.toml").write_text(re.sub("^pitch.*", real, nominal, flags=re.MULTILINE))
    run("render", "real.toml", "--white", "--samples", "64", "--quiet", "-o", "white.exr", where=folder)
    run("develop", "white.exr", "--exposure", "auto", "-o", "white.tif", where=folder)
    run("calibrate", "white", "white.tif", "--camera", "nominal.toml", "--centres", "centres.csv", where=folder)
    with open(folder / "centres.csv") as file:
        return numpy.asarray(Image.open(folder / "white.tif"), float), list(csv.DictReader(file))


def draw_white(folder):
    numbers, lenses = white(folder)
    figure, panels = plt.subplots(1, 2, figsize=(14, 5.9), layout="constrained", sharey=True)
    for axes, title in zip(panels, ("white picture", "with the fitted lattice")):
        shown = axes.imshow(numbers, cmap="gray", extent=(0, numbers.shape[1], numbers.shape[0], 0), interpolation="nearest")
        axes.set_title(title, loc="left")
        axes.set_xlabel("column (pixels)")
    panels[0].set_ylabel("row (pixels)")
    figure.colorbar(shown, ax=panels, label="digital number", shrink=0.9, pad=0.01)
    at = {(int(lens["q"]), int(lens["r"])): (float(lens["model_column"]), float(lens["model_row"])) for lens in lenses}
    for (q, r), here in at.items():
        for neighbour in ((q + 1, r), (q, r + 1), (q + 1, r - 1)):
            if neighbour in at:
                panels[1].plot(*zip(here, at[neighbour]), color="#ff5050", lw=1)
    for lens in lenses:
        if int(lens["used"]):
            panels[1].add_patch(Circle((float(lens["column"]), float(lens["row"])), float(lens["radius"]), fill=False, lw=2.2,
                                       color=TYPES[int(lens["type"])]))
    handles = [plt.Line2D([], [], color=colour, lw=2.2, label=f"type {k + 1}") for k, colour in enumerate(TYPES)]
    panels[1].legend(handles=handles, loc="lower right", bbox_to_anchor=(1.01, 0.99), ncols=3, frameon=False, columnspacing=1)
    panels[1].set_xlim(0, numbers.shape[1])
    save(figure, "white-lattice.png", 125)


def bayer(folder):
    """Electrons of the raw picture, behind filters of three colours."""
    flame = turbulent_flame(ROOT / "out/overview")
    scene = (ROOT / "examples/python/turbulent.toml").read_text().replace('"turbulent.vdb"', f'"{flame}"')
    for response, colour in zip(("cie_x", "cie_y", "cie_z"), FILTERS):
        scene = scene.replace(response, "nikon_d5100_" + colour)
    sensor = 'sensor.mosaic = "rggb"\nsensor.full_well = 20000\nsensor.read_noise = 8\nsensor.bits = 12\n'
    (folder / "bayer.toml").write_text(scene.replace("up = [0, 1, 0]\n", "up = [0, 1, 0]\n" + sensor))
    run("render", "bayer.toml", "--camera", "r29", "--samples", "48", "--quiet", "--window", ",".join(map(str, WINDOW)),
                 "-o", "bayer.exr", where=folder)
    run("develop", "bayer.exr", "--sensor", "-o", "bayer-electrons.exr", where=folder)
    return plenoflame.read_light_field(folder / "bayer-electrons.exr")["sensor.raw"]


def draw_bayer(folder):
    raw = bayer(folder)
    x, y, width, height = WINDOW
    figure, panels = plt.subplots(1, 2, figsize=(14, 6.4), layout="constrained")
    place = (x, x + width, y + height, y)
    shown = panels[0].imshow(raw, cmap="gray", extent=place, interpolation="nearest", vmin=0)
    panels[0].set_title("raw picture")
    figure.colorbar(shown, ax=panels[0], label="electrons", shrink=0.9, pad=0.02)
    light = numpy.clip(raw / numpy.percentile(raw, 99.5), 0, 1) ** (1 / 2.2)
    colours = numpy.zeros(raw.shape + (3,))
    for k in range(2):
        for l in range(2):
            colour = (k + y % 2) % 2 + (l + x % 2) % 2  # red, green, blue
            colours[k::2, l::2, colour] = light[k::2, l::2]
    panels[1].imshow(colours, extent=place, interpolation="nearest")
    panels[1].set_title("its middle, each pixel in the colour of its filter")
    part = (x + 40, x + 80, y + 80, y + 40)
    panels[1].set_xlim(part[:2])
    panels[1].set_ylim(part[2:])
    panels[0].add_patch(plt.Rectangle((part[0], part[3]), 40, 40, fill=False, color="#ffb000", lw=2))
    for axes in panels:
        axes.set_xlabel("column (pixels)")
        axes.set_ylabel("row (pixels)")
    save(figure, "bayer-raw.png", 125)


def main():
    place = working_folder("calibration")
    plt.rcParams.update({"font.family": "DejaVu Sans", "font.size": 13, "axes.titlesize": 14})
    draw_white(place)
    draw_bayer(place)


if __name__ == "__main__":
    main()
