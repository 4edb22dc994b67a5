"""Rows of operator and reconstruct that are micro-images, or cells of them: sums of pixels that are told apart here."""

import math
import zipfile

from command import CommandTest, main
from exr import read_exr
from reconstruct_test import npy

# A thin main lens with its stop, and thin microlenses: micro-images are what similar triangles say [mm].
DIAMETER, TO_ARRAY, TO_SENSOR = 12.0, 55.0, 2.0
PITCH, OFFSET, PIXEL, COLUMNS, ROWS, CELLS = 0.5, (0.237, 0.113), 0.05, 60, 40, 3
SCENE = f"""[camera.lens]
model = "ideal"
focal_length = "50 mm"
diameter = "{DIAMETER} mm"
[camera.array]
lattice = "square"
model = "ideal"
pitch = "{PITCH} mm"
diameter = "{PITCH} mm"
offset = ["{OFFSET[0]} mm", "{OFFSET[1]} mm"]
sensor_distance = "{TO_SENSOR} mm"
[[camera.array.types]]
name = "lens"
focal_length = "2 mm"
[camera.sensor]
columns = {COLUMNS}
rows = {ROWS}
pixel_pitch = "{PIXEL} mm"
[camera.focus]
mode = "distance"
lens_distance = "{TO_ARRAY} mm"
[[flames]]
kind = "vdb"
name = "candle"
file = "candle.vdb"
position = ["0.55 m", "0 m", "-16 mm"]
[[channels]]
name = "650nm"
kind = "band"
wavelength = "650 nm"
width = "10 nm"
"""


def group_of(column, row, cells):
    """The microlens of a pixel and its cell; None between the micro-images."""
    at = (PIXEL * (COLUMNS / 2 - column - 0.5), PIXEL * (ROWS / 2 - row - 0.5))
    stretched = (TO_ARRAY + TO_SENSOR) / TO_ARRAY
    lens = tuple(round((a / stretched - o) / PITCH) for a, o in zip(at, OFFSET))
    away = [a - stretched * (o + PITCH * n) for a, o, n in zip(at, OFFSET, lens)]
    radius = DIAMETER / 2 * TO_SENSOR / TO_ARRAY
    if math.hypot(*away) > radius:
        return None
    return lens + tuple(math.floor(cells * (a + radius) / (2 * radius)) for a in away)


class RowBins(CommandTest):
    def setUp(self):
        super().setUp()
        self.write("scene.toml", SCENE)
        self.succeeds("flame", "candle", "-o", "candle.vdb")
        self.groups = {cells: {} for cells in (1, CELLS)}
        for row in range(ROWS):
            for column in range(COLUMNS):
                for cells, groups in self.groups.items():
                    group = group_of(column, row, cells)
                    if group is not None:
                        groups.setdefault(group, []).append((column, row))

    def rows_of(self, *words):
        """{(column, line): {unknown: entry}} of a matrix."""
        self.succeeds("operator", "scene.toml", "--grid", "6", "--rays", "8", "--seed", "3", "--quiet", "-o", "A.npz", "--pixels",
                      "rows.csv", *words)
        data, indices, starts = (npy(zipfile.ZipFile(self.path("A.npz")).read(name + ".npy"))
                                 for name in ("data", "indices", "indptr"))
        rows = {}
        for n, line in enumerate(self.read("rows.csv").decode().splitlines()[1:]):
            column, row = (int(word) for word in line.split(",")[1:3])
            rows[column, row] = dict(zip(indices[starts[n]:starts[n + 1]], data[starts[n]:starts[n + 1]]))
        return rows

    def test_rows_are_sums_of_pixels(self):
        pixels = self.rows_of()
        self.assertGreater(len(pixels), ROWS * COLUMNS / 4)
        views = ("--bin", "view")
        for cells, words in ((1, ("--bin", "micro-image")), (CELLS, views), (1, views + ("--cells", "1"))):
            found = self.rows_of(*words)
            expected = {}
            for members in self.groups[cells].values():
                seen = [pixel for pixel in members if pixel in pixels]
                for pixel in seen:
                    row = expected.setdefault(members[0], {})
                    for unknown, entry in pixels[pixel].items():
                        row[unknown] = row.get(unknown, 0) + entry
            self.assertEqual(sorted(found), sorted(expected), words)
            self.assertGreater(max(map(len, self.groups[cells].values())), 4)
            for pixel, row in expected.items():
                self.assertEqual(sorted(found[pixel]), sorted(row), words)
                # Entries are numbers of single precision, and so are those that are added up here.
                largest = max(row.values())
                self.assertLess(max(abs(found[pixel][u] - row[u]) for u in row), 1e-6 * largest, (words, pixel))

    def test_data_are_those_of_the_picture(self):
        """What is explained and what is not are the sum of the picture over each row's pixels."""
        self.succeeds("render", "scene.toml", "--samples", "64", "--quiet", "-o", "picture.exr")
        picture = read_exr(self.path("picture.exr"))[1]["650nm"]
        # Few voxels explain little, and one camera does not see depth: it warns.
        result = self.run_command("reconstruct", "scene.toml", "--images", "picture.exr", "--grid", "6", "--rays", "8", "--bin", "view",
                                  "--draws", "0", "--probes", "0", "--strength", "1e-3", "--residual", "left.exr", "--quiet", "-o", "x.vdb")
        self.assertEqual(result.returncode, 0, result.stderr)
        layers = read_exr(self.path("left.exr"))[1]
        left, explained = layers["650nm"], layers["explained"]
        told = 0
        for members in self.groups[CELLS].values():
            column, row = members[0]
            if explained[row][column] == 0:
                continue
            told += 1
            whole = sum(picture[y][x] for x, y in members)
            # Three numbers of single precision.
            self.assertLess(abs(explained[row][column] + left[row][column] - whole), 1e-6 * max(whole, explained[row][column]))
        self.assertGreater(told, 50)

    def test_what_is_refused(self):
        common = ("operator", "scene.toml", "--grid", "4", "--quiet", "-o", "x.npz")
        self.fails(2, *common, "--bin", "views", mentions="--bin")
        self.fails(2, *common, "--bin", "view", "--cells", "0", mentions="--cells")
        self.fails(2, *common, "--bin", "view", "--part", "1/2", mentions=["--part", "micro-images"])
        plain = SCENE.split("[camera.array]", maxsplit=1)[0] + SCENE[SCENE.index("[camera.sensor]"):]
        self.write("scene.toml", plain)
        self.fails(2, *common, "--bin", "micro-image", mentions=["microlenses", "blocks"])
        self.assertNotIn("x.npz", self.files())


if __name__ == "__main__":
    main()
