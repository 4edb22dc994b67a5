"""Draws the rays of some pixels over the section of the lens.

    rays_over_lens.py [SCENE.toml] [FOLDER]      writes FOLDER/rays.png
"""

import pathlib
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
import numpy  # noqa: E402
from vtkmodules.util.numpy_support import vtk_to_numpy  # noqa: E402

import plenoflame  # noqa: E402

here = pathlib.Path(__file__).resolve().parent
scene = plenoflame.Scene(sys.argv[1] if len(sys.argv) > 1 else here.parent / "lenslets-30.toml")
folder = pathlib.Path(sys.argv[2] if len(sys.argv) > 2 else ".")

# Pixels up the middle column; the world's x is the optical axis, z is up (docs/rays.md).
middle = scene.columns // 2
pixels = [(middle, int(row)) for row in numpy.linspace(0.1, 0.9, 5) * scene.rows]
rays = scene.rays(pixels=pixels, rays=24)
lens = scene.camera(LevelOfDetail=3)

figure, axes = plt.subplots(2, 1, figsize=(10, 7), layout="constrained")
colours = {pixel: f"C{i}" for i, pixel in enumerate(pixels)}
for i in range(len(rays)):
    path = rays.path(i) * 1e3
    colour = colours[int(rays.pixel[i, 0]), int(rays.pixel[i, 1])]
    for axis in axes:
        axis.plot(path[:, 0], path[:, 2], color=colour if rays.status[i] == 0 else "0.7", linewidth=0.5)
for block in range(lens.GetNumberOfBlocks()):
    part = lens.GetBlock(block)
    if part.GetNumberOfPoints() == 0 or lens.GetMetaData(block).Get(lens.NAME()) not in ("lens surfaces", "sensor"):
        continue
    surfaces = part.GetCellData().GetArray("surface")
    points = vtk_to_numpy(part.GetPoints().GetData()) * 1e3
    if surfaces is None:  # the sensor
        section = points[[0, 3]]
        for axis in axes:
            axis.plot(section[:, 0], section[:, 2], color="black", linewidth=2)
        continue
    numbers = vtk_to_numpy(surfaces)
    cells = vtk_to_numpy(part.GetPolys().GetConnectivityArray())
    begins = vtk_to_numpy(part.GetPolys().GetOffsetsArray())
    for number in numpy.unique(numbers):
        used = numpy.unique(numpy.concatenate([cells[begins[k]:begins[k + 1]]
                                               for k in numpy.flatnonzero(numbers == number)]))
        own = points[used]
        section = own[numpy.abs(own[:, 1]) < 1e-6]
        section = section[numpy.argsort(section[:, 2])]
        for axis in axes:
            axis.plot(section[:, 0], section[:, 2], color="black", linewidth=1.5)
axes[0].set_title("rays of five pixels, by colour; grey: ended in the camera")
front = points[:, 0].max()
sensor = rays.points[rays.offsets[:-1], 0].min() * 1e3
axes[1].set_xlim(sensor - 0.02 * abs(sensor), 40)
axes[1].set_title("the camera")
for axis in axes:
    axis.set_xlabel("x (mm)")
    axis.set_ylabel("z (mm)")
figure.savefig(folder / "rays.png", dpi=110)
print(folder / "rays.png")
