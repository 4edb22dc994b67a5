#!/usr/bin/python3
"""Draws docs/images/turbulent-planes.png: views of a turbulent flame, and pictures that are focused through it.

    tools/draw_light_field.py [FOLDER]     the light field stays in FOLDER (out/near) and is used again

The light field is that of examples/python/turbulent-near.toml, with the flame of turbulent_flame.py beside it. Needs matplotlib, and
the built command and Python package (PLENOFLAME: build/release/app/cli/plenoflame).
"""

import os
import pathlib
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[1]
COMMAND = pathlib.Path(os.environ.get("PLENOFLAME", ROOT / "build/release/app/cli/plenoflame")).resolve()
PACKAGES = COMMAND.parents[2] / "lib/python3/dist-packages"
sys.path.insert(0, str(PACKAGES))

try:
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    import numpy
    import plenoflame
    from PIL import Image
except ImportError as missing:
    sys.exit(f"draw_light_field.py: {missing}: tools/setup.sh python dev, and cmake --build build/release")

DEPTHS = (0.975, 1.0, 1.025)  # [m]
LUMINANCE = 683e-3            # [kcd/m^2] of 1 W/(m^2 sr) through the CIE response y


def light_field(folder):
    folder.mkdir(parents=True, exist_ok=True)
    scene = ROOT / "examples/python/turbulent-near.toml"
    if not (scene.parent / "turbulent.vdb").exists():
        subprocess.run(["/usr/bin/python3", scene.parent / "turbulent_flame.py"], check=True, stdout=subprocess.DEVNULL,
                       env={**os.environ, "PYTHONPATH": str(PACKAGES)})
    if not (folder / "near.exr").exists():
        subprocess.run([str(COMMAND), "render", str(scene), "--samples", "5", "--quiet", "-o", str(folder / "near.exr")], check=True)
    return plenoflame.read_light_field(folder / "near.exr")


def main():
    field = light_field(pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ROOT / "out/near"))
    views = field.views(3)
    panels = [(views[1, column], f"view from the\n{side} of the lens", None)
              for column, side in enumerate(("left", "middle", "right"))]
    for depth in DEPTHS:
        picture = field.refocus(depth)
        step = 1e3 * picture.pixel
        extent = [side * step * size / 2 for size, sides in zip(picture.image.shape[::-1], ((-1, 1), (-1, 1))) for side in sides]
        panels.append((picture.image, f"focused\nat {depth:g} m", extent))
    plt.rcParams.update({"font.family": "DejaVu Sans", "font.size": 12, "axes.titlesize": 13})
    figure, axes = plt.subplots(1, 6, figsize=(14, 5.6), layout="constrained")
    for axis, (values, title, extent) in zip(axes, panels):
        shown = axis.imshow(LUMINANCE * numpy.asarray(values), cmap="inferno", vmin=0, vmax=110, extent=extent, interpolation="nearest")
        axis.set_title(title)
        if extent:
            axis.set_xticks((-15, 0, 15))
            axis.set_xlim(-17, 17)
            axis.set_ylim(-34, 34)
            axis.set_yticks((-30, -15, 0, 15, 30))
            axis.set_xlabel("mm")
        else:
            columns = values.shape[1]
            axis.set_xlim(0.12 * columns, 0.88 * columns)
            axis.set_xticks(())
            axis.set_yticks(())
    for axis in axes[4:]:
        axis.set_yticklabels(())
    figure.colorbar(shown, ax=axes, label="luminance (kcd/m$^2$)", pad=0.01, shrink=0.9)
    target = ROOT / "docs/images/turbulent-planes.png"
    figure.savefig(target, dpi=112)
    Image.open(target).convert("RGB").save(target, optimize=True)
    print(target)


if __name__ == "__main__":
    main()
