"""plenoflame export --format plenopticam: the list of centres as that tool goes through it, for arrays of any kind.

The tool looks a centre up for every row from 0 to the largest and every column from 0 to the largest, and stops with
an error where there is none; it tells the direction of a hexagonal array's half step from the first two rows.
"""

import json
import math

from command import CommandTest, main
from exr import write_light_field
from export_scenes import GLOWING_POINT, LENS

SCENE = LENS + """[camera.array]
lattice = "%s"
model = "ideal"
pitch = "100 um"
diameter = "100 um"
rotation = "%g deg"
offset = ["13 um", "-21 um"]
sensor_distance = "0.5 mm"
[[camera.array.types]]
name = "a"
focal_length = "0.5 mm"
[camera.sensor]
columns = 480
rows = 360
pixel_pitch = "5 um"
""" + GLOWING_POINT
PITCH = 20 * (1 + 0.5e-3 / (1 / (1 / 50e-3 - 1)))  # of the micro-images, pixels


class Plenopticam(CommandTest):
    def check(self, lattice, degrees, window=(0, 0, 480, 360)):
        x, y, width, height = window
        write_light_field(self.path("raw.exr"), [[1e-12] * width] * height, sensor=(480, 360), origin=(x, y),
                          scene=SCENE % (lattice, degrees))
        self.succeeds("export", "raw.exr", "--format", "plenopticam", "-o", "out", "--force")
        with open(self.path("out/raw_white.json"), encoding="utf-8") as file:
            calibration = json.load(file)
        self.assertEqual(calibration["pat_type"], "rec" if lattice == "square" else "hex")
        centres = {(row, column): (y, x) for y, x, row, column in calibration["mic_list"]}
        self.assertEqual(len(centres), len(calibration["mic_list"]))
        rows, columns = (1 + max(place[k] for place in centres) for k in (0, 1))
        self.assertEqual(sorted(centres), [(row, column) for row in range(rows) for column in range(columns)])
        # The turned rows leave the picture at one side: what is missing there is a triangle, not most of it.
        step = PITCH * (math.sqrt(0.75) if lattice == "hexagonal" else 1)
        slant = math.tan(math.radians(abs(degrees)))
        least = (width - height * slant - 3 * PITCH) * (height - width * slant - 3 * step) / (PITCH * step)
        self.assertGreater(rows * columns, 0.8 * least)
        # Neighbours in a row and from row to row; odd rows all lie to the same side.
        c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))

        def between(first, second):
            down, right = (b - a for a, b in zip(centres[first], centres[second]))
            return (c * right + s * down) / PITCH, (c * down - s * right) / PITCH
        side = 0
        if lattice == "hexagonal":
            side = 0.5 if between((0, 0), (1, 0))[0] > 0 else -0.5
        for row, column in centres:
            expected = [((row, column + 1), (1, 0))]
            expected.append(((row + 1, column), (side if row % 2 == 0 else -side, step / PITCH)))
            for other, (right, down) in expected:
                if other in centres:
                    self.assertLess(math.dist(between((row, column), other), (right, down)), 1e-3)

    def test_hexagonal(self):
        self.check("hexagonal", 0)

    def test_hexagonal_turned(self):
        self.check("hexagonal", 2)
        self.check("hexagonal", -1)

    def test_hexagonal_window(self):
        """Begins with an odd row or an even one."""
        self.check("hexagonal", 0, (31, 15, 300, 260))
        self.check("hexagonal", 0, (31, 33, 300, 260))

    def test_square_turned(self):
        self.check("square", 1.5)


if __name__ == "__main__":
    main()
