"""Loads a set that `plenoflame sweep --format hdf5` made and draws its first runs, picture and flame, as a sheet.

    python3 examples/python/sweep_sheet.py set/set.h5 sheet.png
"""

import sys

import h5py
import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402 (the backend is chosen first)
import numpy as np  # noqa: E402

with h5py.File(sys.argv[1]) as file:
    channel = next(iter(file["picture"]))
    pictures = file["picture"][channel][:6]  # [run, row, column], W
    runs, test = file["run"][:6], file["test"][:6]
    absorption = file["truth/absorption"][:6]  # [run, z, y, x], 1/m
    lower, upper = file["truth"].attrs["lower_m"], file["truth"].attrs["upper_m"]

# The sum over y times the cell is the optical depth along the camera's sideways axis.
depth = absorption.sum(axis=2) * (upper[1] - lower[1]) / absorption.shape[2]
figure, axes = plt.subplots(2, len(pictures), figsize=(2.2 * len(pictures), 5), squeeze=False, layout="constrained")
extent = 1e3 * np.array([lower[0], upper[0], lower[2], upper[2]])
for i, run in enumerate(runs):
    axes[0, i].imshow(pictures[i] * 1e12, cmap="inferno", vmin=0, vmax=1e12 * np.percentile(pictures, 99.9))
    axes[0, i].set_title(f"run {run}, {'test' if test[i] else 'train'}", fontsize=9)
    axes[0, i].set_axis_off()
    shown = axes[1, i].imshow(depth[i], origin="lower", extent=extent, cmap="viridis", vmin=0, vmax=depth.max())
    axes[1, i].set_xlabel("x [mm]")
axes[1, 0].set_ylabel("z [mm]")
figure.colorbar(shown, ax=axes[1, :], label="optical depth along y")
figure.savefig(sys.argv[2], dpi=110)
