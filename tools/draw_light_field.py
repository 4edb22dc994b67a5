#!/usr/bin/python3
"""Draws docs/images/turbulent-planes.png: views of a turbulent flame, and pictures that are focused through it.

    tools/draw_light_field.py [FOLDER]     the light field stays in FOLDER (out/near) and is used again

The light field is that of examples/python/turbulent-near.toml, with the flame of turbulent_flame.py beside it. Needs what
drawing.py says.
"""

from drawing import ROOT, make, save, turbulent_flame, working_folder

import matplotlib.pyplot as plt
import numpy
import plenoflame

DEPTHS = (0.975, 1.0, 1.025)  # [m]
LUMINANCE = 683e-3            # [kcd/m^2] of 1 W/(m^2 sr) through the CIE response y


def main():
    place = working_folder("near")
    scene = ROOT / "examples/python/turbulent-near.toml"
    turbulent_flame(scene.parent)
    make(place, {"near.exr": f"render {scene} --samples 5 --quiet -o near.exr"})
    field = plenoflame.read_light_field(place / "near.exr")
    views = field.views(3)
    panels = [(views[1, column], f"view from the\n{side} of the lens", None)
              for column, side in enumerate(("left", "middle", "right"))]
    for depth in DEPTHS:
        picture = field.refocus(depth)
        step = 1e3 * picture.pixel
        extent = [side * step * size / 2 for size, sides in zip(picture.image.shape[::-1], ((-1, 1), (-1, 1))) for side in sides]
        panels.append((picture.image, f"focused\nat {depth:g} m", extent))
    plt.rcParams.update({"font.family": "DejaVu Sans", "font.size": 12, "axes.titlesize": 13})
    figure, axes = plt.subplots(1, 6, figsize=(14, 4.9), layout="compressed")
    for axis, (values, title, extent) in zip(axes, panels):
        shown = axis.imshow(LUMINANCE * numpy.asarray(values), cmap="inferno", vmin=0, vmax=110, extent=extent, interpolation="nearest")
        axis.set_title(title)
        if extent:
            axis.set_xticks((-15, 0, 15))
            axis.set_xlim(-17, 17)
            axis.set_ylim(-34, 34)
            axis.set_yticks((-30, -15, 0, 15, 30))
            axis.set_xlabel("y (mm)")
        else:
            rows, columns = values.shape
            axis.set_xlim(columns / 2 - rows / 4, columns / 2 + rows / 4)  # the shape of the others
            axis.set_xticks(())
            axis.set_yticks(())
    axes[3].set_ylabel("z (mm)")
    for axis in axes[4:]:
        axis.set_yticklabels(())
    figure.colorbar(shown, ax=axes, label="luminance (kcd/m$^2$)", pad=0.01)
    save(figure, "turbulent-planes.png", 112)


if __name__ == "__main__":
    main()
