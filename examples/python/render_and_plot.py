"""Renders a light field, and plots the raw image, a view and a refocused picture.

    render_and_plot.py [SCENE.toml] [FOLDER]      writes FOLDER/render.png
"""

import pathlib
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

import plenoflame  # noqa: E402

here = pathlib.Path(__file__).resolve().parent
scene = plenoflame.Scene(sys.argv[1] if len(sys.argv) > 1 else here.parent / "lenslets-30.toml")
folder = pathlib.Path(sys.argv[2] if len(sys.argv) > 2 else ".")

light_field = scene.render(samples=16)
view = light_field.views(5)[2, 2]
picture = light_field.refocus(1.0)

figure, axes = plt.subplots(1, 3, figsize=(12, 3.4), layout="compressed")
panels = [(light_field.flux * 1e9, "raw image", "flux per pixel (nW)"),
          (view, "view from the middle of the lens", "radiance (W/(m$^2$ sr))"),
          (picture.image, "refocused at 1 m", "radiance (W/(m$^2$ sr))")]
for axis, (image, title, label) in zip(axes, panels):
    shown = axis.imshow(image, cmap="inferno")
    axis.set_title(title)
    axis.set_xlabel("column")
    axis.set_ylabel("row")
    figure.colorbar(shown, ax=axis, label=label)
figure.savefig(folder / "render.png", dpi=110)
print(folder / "render.png")
