#!/usr/bin/python3
"""Makes docs/images/overview.png, the README's figure: what the program is for, from what the tutorial makes.

    tools/measure_tutorial.py --keep out/tutorial && tools/make_overview.py out/tutorial

Needs matplotlib, Xvfb, and the built command and Python package (PLENOFLAME: build/release/app/cli/plenoflame).
"""

import os
import pathlib
import shutil
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[1]
COMMAND = pathlib.Path(os.environ.get("PLENOFLAME", ROOT / "build/release/app/cli/plenoflame")).resolve()
sys.path.insert(0, str(COMMAND.parents[2] / "python"))

try:
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    import numpy
    import plenoflame
except ImportError as missing:
    sys.exit(f"make_overview.py: {missing}: tools/setup.sh python, and cmake --build build/release")



FOOT = (1, 0, -0.016)  # of the flame in the scene [m]


def middle(path, foot=(0, 0, 0)):
    """The temperature of a flame in the plane through its axis: ([K], extent in mm from its foot)."""
    arrays, spacing, origin, _ = plenoflame.flame_arrays(plenoflame.read_flame(path, grid="temperature"))
    (values,) = arrays.values()
    x, z = (1e3 * (origin[k] - foot[k] + numpy.array([-0.5, values.shape[k] - 0.5]) * spacing[k]) for k in (0, 2))
    return values[:, values.shape[1] // 2, :].T, (*x, *z)


def scene_picture(folder, view, size):
    """The candle or the camera, with the rays of two pixels."""
    path = folder / f"scene-{view}.png"
    subprocess.run([shutil.which("xvfb-run") or sys.exit("make_overview.py: xvfb-run is missing: tools/setup.sh vtk"), "-a",
                    str(COMMAND), "picture", "examples/reconstruct-front.toml", "--pixel", "50,60", "--pixel", "50,120",
                    "--view", view, "--no-axes", "--size", size, "-o", path.name], cwd=folder, check=True)
    return plt.imread(path)


def show(axes, image, title, **options):
    drawn = axes.imshow(image, **options)
    axes.set_title(title, fontsize=9, loc="left")
    axes.set_xticks([])
    axes.set_yticks([])
    return drawn


def main():
    if len(sys.argv) != 2:
        sys.exit("make_overview.py: give the folder of tools/measure_tutorial.py --keep")
    folder = pathlib.Path(sys.argv[1])
    field = plenoflame.read_light_field(folder / "front.exr")
    views = field.views(3)
    truth, extent = middle(folder / "examples/candle.vdb")
    found, found_extent = middle(folder / "candle-back.vdb", FOOT)

    figure = plt.figure(figsize=(10, 6.2), dpi=110)
    grid = figure.add_gridspec(2, 5, height_ratios=(1.15, 1), hspace=0.12, wspace=0.12,
                               left=0.012, right=0.93, top=0.95, bottom=0.02)
    show(figure.add_subplot(grid[0, :3]), scene_picture(folder, "camera", "1300x800"), "1  camera, with the rays of two pixels ...")
    show(figure.add_subplot(grid[0, 3:]), scene_picture(folder, "flame", "900x800"), "    ... that end in the flame")
    raw = field.develop() / 2 ** 14
    show(figure.add_subplot(grid[1, 0]), raw, "2  raw image", cmap="gray")
    part = raw[70:110, 38:62]
    show(figure.add_subplot(grid[1, 1]), part, "    enlarged: micro-images", cmap="gray", interpolation="nearest")
    show(figure.add_subplot(grid[1, 2]), views.sheet, "3  views from 3 x 3 places", cmap="gray")
    kelvin = {"cmap": "inferno", "vmin": 300, "vmax": 1950, "origin": "lower"}
    frame = (-14, 14, min(extent[2], found_extent[2]), max(extent[3], found_extent[3]))
    for place, values, reach, title in ((3, found, found_extent, "4  reconstructed [K]"), (4, truth, extent, "    the flame it was [K]")):
        axes = figure.add_subplot(grid[1, place])
        axes.set_facecolor("black")
        drawn = show(axes, values, title, extent=reach, **kelvin)
        axes.set_xlim(frame[:2])
        axes.set_ylim(frame[2:])
    bar = figure.add_axes([0.94, 0.04, 0.012, 0.38])
    figure.colorbar(drawn, cax=bar).ax.tick_params(labelsize=7)
    target = ROOT / "docs/images/overview.png"
    figure.savefig(target)
    print(target)


if __name__ == "__main__":
    main()
