#!/usr/bin/python3
"""Draws pictures of how-to pages in docs/images: film.png, three-filters.png, quartz-tube.png, microlens-shapes.png, objects-depth.png.

    tools/draw_examples.py [NAME ...]     film, filters, tube, shapes, depth; without any, all

The scenes are those of the pages. Light fields stay in out/examples and are used again. Needs what drawing.py says.
"""

import re
import sys

from drawing import ROOT, make, save

import matplotlib.pyplot as plt
import numpy
import plenoflame

PLACE = ROOT / "out/examples"
RADIANCE = "radiance (W/(m$^2$ sr))"


def axes_of(count, width, height):
    plt.rcParams.update({"font.family": "DejaVu Sans", "font.size": 12, "axes.titlesize": 13})
    figure, axes = plt.subplots(1, count, figsize=(width, height), layout="compressed")
    return figure, axes


def extent_of(picture):
    """Edges of a refocused picture [mm]."""
    rows, columns = picture.image.shape
    step = 1e3 * picture.pixel / 2
    return -step * columns, step * columns, -step * rows, step * rows


def planes(name, fields, depth, reach):
    """Refocused pictures side by side, with one scale: fields are (title, light field), reach the half width and height [mm]."""
    figure, axes = axes_of(len(fields), 5.2 * len(fields) * reach[0] / reach[1] + 2.2, 5.2)
    pictures = [field.refocus(depth) for _, field in fields]
    most = max(picture.image.max() for picture in pictures)
    for axis, (title, _), picture in zip(axes, fields, pictures):
        shown = axis.imshow(picture.image, cmap="inferno", vmin=0, vmax=most, extent=extent_of(picture), interpolation="nearest")
        axis.set_title(title)
        axis.set_xlabel("y (mm)")
        axis.set_xlim(-reach[0], reach[0])
        axis.set_ylim(-reach[1], reach[1])
    axes[0].set_ylabel("z (mm)")
    figure.colorbar(shown, ax=axes, label=RADIANCE, pad=0.02)
    return figure, name


def film():
    page = (ROOT / "docs/user/time.md").read_text()
    (PLACE / "film.toml").write_text(re.search(r"<<'END'\n(.*?)END\n", page, re.S)[1])
    heights = {1: 28, 2: 32, 3: 38}
    make(PLACE, {f"run_{n:04}.vdb": f"flame candle --set height={mm}mm -o run_{n:04}.vdb" for n, mm in heights.items()} |
         {"film.0003.exr": "render film.toml --frames 1:3 --quiet -o film.exr"})
    fields = [(f"{10 * n - 10} ms", plenoflame.read_light_field(PLACE / f"film.{n:04}.exr")) for n in heights]
    return planes("film.png", fields, 1.0, (8, 20))


def tube():
    text = (ROOT / "examples/quartz-tube.toml").read_text()
    (PLACE / "tube.toml").write_text(text)
    (PLACE / "bare.toml").write_text(re.sub(r"\[\[windows\]\].*?(?=\n\[)", "", text, flags=re.S))
    make(PLACE, {"candle.vdb": "flame candle -o candle.vdb"} |
         {f"{name}.exr": f"render {name}.toml --quiet -o {name}.exr" for name in ("tube", "bare")})
    fields = [(title, plenoflame.read_light_field(PLACE / f"{name}.exr"))
              for title, name in (("through tube and port", "tube"), ("without glass", "bare"))]
    return planes("quartz-tube.png", fields, 0.75, (12, 20))


def filters():
    make(PLACE, {"three.exr": f"render {ROOT}/examples/three-filters.toml --quiet -o three.exr",
                 "temperature.exr": "pyrometry three.exr --filters 650nm,850nm -o temperature.exr"})
    raw = plenoflame.read_light_field(PLACE / "three.exr").flux
    found = plenoflame.read_light_field(PLACE / "temperature.exr")["temperature"]
    found = numpy.where(found > 0, found, numpy.nan)
    figure, axes = axes_of(3, 9.7, 6.2)
    rows, columns = raw.shape
    box = (columns // 2 - 60, columns // 2 + 60, rows // 2 + 108, rows // 2 - 108)
    for axis, extent, title in ((axes[0], (0, columns, rows, 0), "raw picture"), (axes[1], box, "its middle")):
        part = raw[extent[3]:extent[2], extent[0]:extent[1]]
        shown = axis.imshow(1e9 * part, cmap="gray", vmin=0, vmax=1e9 * raw.max(), extent=extent, interpolation="nearest")
        axis.set_title(title)
        axis.set_xlabel("column (pixels)")
    axes[0].set_ylabel("row (pixels)")
    figure.colorbar(shown, ax=axes[:2], label="flux per pixel (nW)", location="bottom", pad=0.02, aspect=40)
    shown = axes[2].imshow(found, cmap="inferno", vmin=1650, vmax=1850, interpolation="nearest")
    axes[2].set_facecolor("#808080")
    axes[2].set_title("temperature")
    axes[2].set_xlabel("column (microlenses)")
    figure.colorbar(shown, ax=axes[2], label="two-colour temperature (K)", location="bottom", pad=0.02, extend="both")
    return figure, "three-filters.png"


def shapes():
    text = (ROOT / "examples/square-lenses.toml").read_text()
    (PLACE / "squares.toml").write_text(text)
    (PLACE / "circles.toml").write_text(re.sub(r"^(columns = 30|rows = 30|aperture = ).*$", "", text, flags=re.M))
    make(PLACE, {f"{name}.exr": f"render {name}.toml --white --quiet -o {name}.exr" for name in ("squares", "circles")})
    figure, axes = axes_of(2, 11, 5)
    for axis, name, title in zip(axes, ("squares", "circles"), ("square lenses, corner of the array", "round lenses, no edge")):
        flux = plenoflame.read_light_field(PLACE / f"{name}.exr").flux
        shown = axis.imshow(flux / flux.max(), cmap="gray", vmin=0, vmax=1, interpolation="nearest")
        rows, columns = flux.shape
        axis.set_xlim(columns - 140, columns)
        axis.set_ylim(rows, rows - 140)
        axis.set_title(title)
        axis.set_xlabel("column (pixels)")
    axes[0].set_ylabel("row (pixels)")
    figure.colorbar(shown, ax=axes, label="flux, of the largest", pad=0.02)
    return figure, "microlens-shapes.png"


def depth():
    make(PLACE, {"objects.exr": f"render {ROOT}/examples/paper-objects-r29.toml --samples 16 --quiet -o objects.exr"})
    field = plenoflame.read_light_field(PLACE / "objects.exr")
    stack = field.focus_stack([1.2 + 0.05 * k for k in range(17)], width=250)
    figure, axes = axes_of(2, 13, 4.2)
    shown = axes[0].imshow(stack.all_in_focus, cmap="gray", interpolation="nearest")
    axes[0].set_title("all in focus")
    figure.colorbar(shown, ax=axes[0], label=RADIANCE, pad=0.02)
    known = numpy.where(numpy.asarray(stack.depth) > 0, stack.depth, numpy.nan)
    shown = axes[1].imshow(known, cmap="viridis_r", interpolation="nearest")
    axes[1].set_facecolor("#808080")
    axes[1].set_title("depth")
    figure.colorbar(shown, ax=axes[1], label="distance (m)", pad=0.02)
    for axis in axes:
        axis.set_xticks(())
        axis.set_yticks(())
    return figure, "objects-depth.png"


if __name__ == "__main__":
    PLACE.mkdir(parents=True, exist_ok=True)
    drawings = {"film": film, "filters": filters, "tube": tube, "shapes": shapes, "depth": depth}
    for wanted in sys.argv[1:] or drawings:
        save(*drawings[wanted](), 130)
