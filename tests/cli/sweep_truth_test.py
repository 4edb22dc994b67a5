"""Truth that sweeps keep: temperature, absorption and lines against formulas that share no code with the command; the example
that draws a set."""

import json
import os
import struct
import subprocess
import sys

import h5py
import numpy as np
from command import CommandTest, main

LAYERS = """[camera]
preset = "paper-plenoptic2"
[[flames]]
kind = "layered"
position = ["1 m", "2 mm", "-3 mm"]
rotation = ["20 deg", "-35 deg", "50 deg"]
scale = 1.5
brightness = 0.25
[[flames.layers]]
centre = ["1 mm", "0 mm", "2 mm"]
semi_axes = ["3 mm", "4 mm", "9 mm"]
temperature = "1400 K"
absorption = "120 1/m"
[[flames.layers]]
semi_axes = ["6 mm", "5 mm", "12 mm"]
temperature = "1900 K"
absorption = "20 1/m"
"""
CANDLE = """[camera]
preset = "paper-plenoptic2"
[[flames]]
kind = "vdb"
file = "none.vdb"
position = ["1 m", "0 m", "-16 mm"]
[[flames.lines]]
kind = "ch"
"""
FEW = ("--window", "1450,1450,32,32", "--samples", "2", "--quiet")


def turned(angles):
    """Rotation about the world's x, then y, then z."""
    (cx, sx), (cy, sy), (cz, sz) = ((np.cos(a), np.sin(a)) for a in np.radians(angles))
    about_x = np.array([[1, 0, 0], [0, cx, -sx], [0, sx, cx]])
    about_y = np.array([[cy, 0, sy], [0, 1, 0], [-sy, 0, cy]])
    about_z = np.array([[cz, -sz, 0], [sz, cz, 0], [0, 0, 1]])
    return about_z @ about_y @ about_x


def middles(low, high, count):
    return low + (np.arange(count) + 0.5) * (high - low) / count


def places(lower, upper, count):
    """Middles of the cells, [z, y, x, axis]."""
    x, y, z = (middles(*of) for of in zip(lower, upper, count))
    return np.stack(np.broadcast_arrays(x[None, None, :], y[None, :, None], z[:, None, None]), axis=-1)


def candle(place, height, fraction):
    """The candle's formulas (docs/user/flames.md), at places in its own frame: T [K], kappa [1/m], line as a share of its peak."""
    z, r = place[..., 2], np.hypot(place[..., 0], place[..., 1])
    u = np.clip(z / height, 0, 1)
    within = (z > 0) & (z < height)
    annulus = (1 - u) * (1.5e-3 + 7e-3 * u)
    p = 0.8 * 0.5 / (1 - 0.5)
    soot = (u / 0.5) ** p * ((1 - u) / 0.5) ** 0.8 * (
        np.exp(-((r - annulus) / 0.8e-3) ** 2) + u ** 2 * np.exp(-(r / 1.5e-3) ** 2))
    kappa = np.where(within & (soot > 1e-6), soot * fraction * 6 * np.pi * 0.26 / 650e-9, 0)
    outside = r - annulus - 1.2e-3
    far = np.where(outside > 0, 293.15, 1100 + u * (1650 - 1100))
    temperature = far + (1850 - far) * np.exp(-(outside / np.where(outside > 0, 2e-3, 2.2e-3)) ** 2)
    line = np.where(within, np.exp(-(outside / 0.5e-3) ** 2 - (u / 0.3) ** 2) * -np.expm1(-10 * u / 0.3), 0)
    return temperature, kappa, np.where(line > 1e-6, line, 0)


class Truth(CommandTest):
    def truth(self, path, group=""):
        with h5py.File(self.path(path)) as file:
            return {name: file[group + name][:] for name in ("temperature", "absorption", "lines/CH*") if group + name in file}

    def test_layers(self):
        self.write("a.toml", LAYERS)
        self.write("runs.csv", "flames[0].brightness,flames[0].position [m]\n1,\n,\"0.99, 0, 0.004\"\n")
        lower, upper, count = (0.96, -0.03, -0.035), (1.03, 0.04, 0.03), (23, 19, 29)
        self.succeeds("sweep", "a.toml", "--table", "runs.csv", "-o", "set", "--lattice", "23,19,29", "--region",
                      "0.96m,-30mm,-35mm:1.03m,40mm,30mm", *FEW)
        for run, position in enumerate(((1, 0.002, -0.003), (0.99, 0, 0.004))):
            # As rows: the transpose turns back.
            place = (places(lower, upper, count) - position) @ turned((20, -35, 50)) / 1.5
            first = (((place - (1e-3, 0, 2e-3)) / (3e-3, 4e-3, 9e-3)) ** 2).sum(axis=-1) < 1
            second = ((place / (6e-3, 5e-3, 12e-3)) ** 2).sum(axis=-1) < 1
            kept = self.truth(f"set/runs/00000{run}.truth.h5")
            self.assertGreater(first.sum(), 20)
            self.assertGreater((second & ~first).sum(), 100)
            np.testing.assert_array_equal(kept["absorption"][0], np.where(first, 120, np.where(second, 20, 0)))
            np.testing.assert_array_equal(kept["temperature"][0], np.where(first, 1400, np.where(second, 1900, 0)))

    def test_generated_flames_and_their_lines(self):
        """The middles of the cells are those of the voxels, so that nothing is interpolated, and none lies at the end of the flame."""
        self.write("a.toml", CANDLE)
        heights, fractions, bright = ("30.5 mm", "25.5 mm"), (3e-6, 1e-6), (1, 0.5)
        self.write("runs.csv", "flames[0].generator,flames[0].generator.voxel_size,flames[0].generator.lines,flames[0].generator.height,"
                   "flames[0].generator.peak_volume_fraction,flames[0].brightness\n"
                   + "".join(f"candle,1 mm,ch=3 kW/m^3,{h},{f},{b}\n" for h, f, b in zip(heights, fractions, bright)))
        options = ("--table", "runs.csv", "--lattice", "31,31,46", "--region", "0.9845m,-15.5mm,-20.5mm:1.0155m,15.5mm,25.5mm", *FEW)
        self.succeeds("sweep", "a.toml", *options, "-o", "set")
        self.succeeds("sweep", "a.toml", *options, "--format", "hdf5", "-o", "packed")
        packed = self.truth("packed/set.h5", "truth/")
        place = places((-15.5e-3, -15.5e-3, -4.5e-3), (15.5e-3, 15.5e-3, 41.5e-3), (31, 31, 46))
        for run in range(2):
            kept = self.truth(f"set/runs/00000{run}.truth.h5")
            temperature, kappa, line = candle(place, (30.5e-3, 25.5e-3)[run], fractions[run])
            self.assertGreater(np.count_nonzero(line), 100)
            inside = kappa > 0
            for name, expected in (("absorption", kappa), ("lines/CH*", bright[run] * 3000 * line)):
                np.testing.assert_allclose(kept[name][0], expected, rtol=1e-4, atol=1e-5 * expected.max(), err_msg=name)
            np.testing.assert_allclose(kept["temperature"][0][inside], temperature[inside], rtol=1e-5)
            for name, values in kept.items():
                np.testing.assert_array_equal(packed[name][run], values[0], err_msg=name)

    def test_a_flame_beyond_the_lattice_is_said(self):
        self.write("a.toml", LAYERS)
        self.write("runs.csv", "flames[0].position [m]\n\"1, 0.002, -0.003\"\n\"1, 0, 0.02\"\n\"1, 0.02, 0\"\n")
        options = ("sweep", "a.toml", "--table", "runs.csv", "--lattice", "4", *FEW, "--json")
        for parts, runs in ((("1/1",), [1, 2]), (("1/2", "2/2"), [1, 2])):
            said = []
            for part in parts:
                result = self.run_command(*options, "--part", part, "-o", f"set{len(parts)}")
                self.assertEqual(result.returncode, 0, result.stderr)
                self.assertRegex(result.stderr, r"\Aplenoflame: warning: [^\n]* beyond the lattice[^\n]* --region[^\n]*\n\Z")
                said += json.loads(result.stdout)["beyond_lattice"]
            self.assertEqual(sorted(said), runs)
        result = self.run_command("merge", "set2-part-1-of-2", "set2-part-2-of-2", "-o", "all", "--json")
        self.assertEqual(json.loads(result.stdout)["beyond_lattice"], [1, 2])
        self.assertIn("2 runs, the first of them run 1", result.stderr)

    def test_the_example_draws_a_set(self):
        self.write("a.toml", LAYERS)
        self.write("runs.csv", "flames[0].brightness\n1\n2\n")
        self.succeeds("sweep", "a.toml", "--table", "runs.csv", "--format", "hdf5", "-o", "set", "--lattice", "8", *FEW)
        root = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
        result = subprocess.run([sys.executable, "-B", os.path.join(root, "examples/python/sweep_sheet.py"), "set/set.h5", "sheet.png"],
                                cwd=self.folder, capture_output=True, text=True, timeout=120, check=False)
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        data = self.read("sheet.png")
        self.assertEqual(data[:8], b"\x89PNG\r\n\x1a\n")
        self.assertGreater(min(struct.unpack(">II", data[16:24])), 300)


if __name__ == "__main__":
    main()
