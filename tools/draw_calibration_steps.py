#!/usr/bin/python3
"""Draws docs/images/calibration-steps.png: corners on a board, what the fit leaves of them in a micro-image, and a blackbody's counts.

    tools/draw_calibration_steps.py [FOLDER]     the pictures stay in FOLDER (out/calibration-steps) and are used again

The boards are those of docs/user/calibrations.md, the blackbody that of docs/real-cameras.md. Needs what drawing.py says.
"""

import csv
import os
import re
import subprocess

from drawing import COMMAND, ROOT, make, run, save, working_folder

import matplotlib.pyplot as plt
import numpy
from PIL import Image

LAB = ROOT / "examples/lab"
PART = (215, 155, 130, 130)      # of the first board's picture: column, row, width, height
PITCH, RATIO, PIXEL = 126e-6, 1 + 0.4 / 57.5, 5.5e-6  # of examples/lab/board-camera.toml [m]
SENSOR = (560, 440)
STOP = 0.5 * 0.4e-3 * 16 / 57.5 / PIXEL               # [pixel] radius of the stop's image
TEMPERATURES, EXPOSURE = (1300, 1400, 1500, 1600, 1700), "0.05 ms"
WAVELENGTH, RADIATION = 650e-9, 1.438777e-2           # [m], second radiation constant [m K]


def table(path):
    with open(path) as file:
        return list(csv.DictReader(file))


def boards(folder):
    """(the first board's picture, rows of its corners, rows of all residuals)."""
    if not (folder / "board-3.tif").exists():
        path = f"{COMMAND.parent}:{os.environ['PATH']}"
        subprocess.run(["sh", str(LAB / "boards.sh")], cwd=folder, check=True, env={**os.environ, "PATH": path})
    camera = LAB / "board-camera.toml"
    run("calibrate", "corners", "board-1.tif", "board-2.tif", "board-3.tif", "--camera", camera, "--board", "5x4", "--cell", "2.5 mm",
        "-o", "corners.csv", where=folder)
    run("calibrate", "geometry", "corners.csv", "--camera", camera, "--free", "camera.array.sensor_distance", "--pupil", "0", "-o",
        "calibrated.toml", "--residuals", "residuals.csv", where=folder)
    corners = table(folder / "corners.csv")
    return (numpy.asarray(Image.open(folder / "board-1.tif"), float), [c for c in corners if c["pose"] == corners[0]["pose"]],
            list(zip(corners, table(folder / "residuals.csv"))))


def draw_corners(axes, picture, corners):
    x, y, width, height = PART
    axes.imshow(picture, cmap="gray", extent=(0, picture.shape[1], picture.shape[0], 0), interpolation="nearest")
    for parity, colour in ((0, "#ffb000"), (1, "#56b4e9")):
        chosen = [c for c in corners if round((float(c["x"]) + float(c["y"])) / 2.5e-3) % 2 == parity]
        axes.plot([float(c["column"]) for c in chosen], [float(c["row"]) for c in chosen], "+", color=colour, ms=12, mew=2.2)
    axes.set_xlim(x, x + width)
    axes.set_ylim(y + height, y)
    axes.set_title("corners on a board", loc="left")
    axes.set_xlabel("column (pixels)")
    axes.set_ylabel("row (pixels)")


def draw_residuals(axes, rows):
    places, rests = [], []
    for corner, rest in rows:
        q, r = int(corner["q"]), int(corner["r"])
        lens = RATIO * PITCH / PIXEL * numpy.array([q + r / 2, r * numpy.sqrt(0.75)])
        places.append(numpy.array([float(corner["column"]), float(corner["row"])]) - numpy.array(SENSOR) / 2 + lens)
        rests.append([float(rest["residual_column"]), float(rest["residual_row"])])
    places, rests = numpy.array(places), numpy.array(rests)
    good = numpy.isfinite(rests).all(axis=1)
    cells = {}
    for place, rest in zip(places[good], rests[good]):
        cells.setdefault(tuple(numpy.floor(place / 2.5).astype(int)), []).append(rest)
    cells = {cell: numpy.mean(own, axis=0) for cell, own in cells.items() if len(own) >= 3}
    at = (numpy.array(list(cells)) + 0.5) * 2.5
    mean = numpy.array(list(cells.values()))
    arrows = axes.quiver(*at.T, *mean.T, angles="xy", scale_units="xy", scale=0.008, width=0.007, color="#b03050")
    axes.quiverkey(arrows, 0.84, 1.035, 0.02, "0.02 pixel", labelpos="W", coordinates="axes")
    axes.add_patch(plt.Circle((0, 0), STOP, fill=False, color="#2070b0", lw=2))
    axes.annotate("stop's image", (-STOP / numpy.sqrt(2), STOP / numpy.sqrt(2)), (-12.5, 12.4), color="#2070b0")
    axes.set_xlim(-13, 13)
    axes.set_ylim(13, -13)
    axes.set_aspect("equal")
    axes.set_title("residuals, mean", loc="left")
    axes.set_xlabel("from the micro-image's middle (pixels)")
    axes.set_ylabel("down (pixels)")


def blackbody(folder):
    """{temperature [K]: mean counts above dark in the middle of the picture}."""
    nominal = (LAB / "nominal.toml").read_text()
    script = (LAB / "raw-pictures.sh").read_text()
    flame = re.search(r"blackbody.toml <<'EOF'\n(.*?)EOF", script, re.DOTALL).group(1)
    counts = {}
    for kelvin in TEMPERATURES:
        name = f"blackbody-{kelvin}"
        (folder / f"{name}.toml").write_text(nominal + flame.replace("1700 K", f"{kelvin} K"))
        make(folder, {f"{name}.exr": f"render {name}.toml --samples 64 --quiet -o {name}.exr"})
        for kind, option in ((".tif", ()), ("-dark.tif", ("--dark",))):
            run("develop", f"{name}.exr", "--exposure", EXPOSURE, *option, "-o", name + kind, where=folder)
        light, dark = (numpy.asarray(Image.open(folder / (name + kind)), float) for kind in (".tif", "-dark.tif"))
        bright = light - dark.mean()
        counts[kelvin] = bright[bright > 0.7 * numpy.percentile(bright, 98)].mean()
    return counts


def draw_blackbody(axes, counts):
    kelvin = numpy.linspace(min(counts) - 30, max(counts) + 30, 200)
    planck = lambda t: 1 / numpy.expm1(RADIATION / WAVELENGTH / t)  # noqa: E731
    axes.semilogy(kelvin, counts[1700] * planck(kelvin) / planck(1700), color="#2070b0", lw=2, label="Planck's law through 1700 K")
    axes.semilogy(list(counts), list(counts.values()), "o", color="#b03050", ms=8, label="pictures")
    axes.set_title("a blackbody", loc="left")
    axes.set_xlabel("temperature (K)")
    axes.set_ylabel("counts above dark")
    axes.grid(alpha=0.3, which="both")
    axes.legend(loc="upper left", frameon=False)


def main():
    folder = working_folder("calibration-steps")
    plt.rcParams.update({"font.family": "DejaVu Sans", "font.size": 13, "axes.titlesize": 14})
    figure, panels = plt.subplots(1, 3, figsize=(16, 5.2), layout="constrained")
    picture, corners, residuals = boards(folder)
    draw_corners(panels[0], picture, corners)
    draw_residuals(panels[1], residuals)
    draw_blackbody(panels[2], blackbody(folder))
    save(figure, "calibration-steps.png", 110)


if __name__ == "__main__":
    main()
