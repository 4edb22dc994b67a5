"""plenoflame export --format libpleno, read by that tool's own conventions: points are projected through the exported
camera as libpleno does it, and must arrive where exact rays through our camera do.

libpleno's conventions, as its sources have them: nested lists are the columns of a matrix; mesh nodes of rows with
even numbers are half a pitch to the right; a point of a mesh or of the sensor is turned, then moved by its pose; the
thin main lens is at its own pose; light goes straight through a microlens' centre; pixels are counted from the
sensor's last one, with centres at whole numbers; lens (k, l) has the micro-image (width - 1 - k, height - 1 - l).
"""

import csv
import json
import math

from command import CommandTest, main
from exr import read_png, write_light_field
from export_scenes import GLOWING_POINT, TILTED_ARRAY, TYPE

SCENE = """[camera.lens]
model = "ideal"
surfaces = []
focal_length = "50 mm"
diameter = "16 mm"
decentre = ["%g mm", "%g mm"]
tilt = ["%g deg", "%g deg"]
[camera.focus]
mode = "paraxial"
object_distance = "1 m"
conjugate = "array"
""" + TILTED_ARRAY + GLOWING_POINT
FOCAL = {"a": 0.45, "b": 0.5057, "c": 0.58}
POINTS = [(0.6, 0.0015, -0.001), (0.63, -0.002, 0.0012), (0.55, 0.0002, 0.0018)]  # world: forward, left, up


def add(a, b):
    return [x + y for x, y in zip(a, b)]


def scaled(factor, a):
    return [factor * x for x in a]


class Pose:
    def __init__(self, pose):
        self.columns = pose["rotation"]
        (self.translation,) = pose["translation"]

    def from_local(self, p):
        n = len(self.columns)
        return [sum(self.columns[j][i] * p[j] for j in range(n)) + self.translation[i] for i in range(n)]

    def to_local(self, p):
        d = [a - b for a, b in zip(p, self.translation)]
        return [sum(column[i] * d[i] for i in range(len(d))) for column in self.columns]


class Mesh:
    def __init__(self, mesh):
        self.width, self.height, self.rows = mesh["width"], mesh["height"], mesh["geometry"] == 1
        ((self.pitch, _),) = mesh["pitch"]
        self.pose = Pose(mesh["pose"])
        self.zeros = [0.0] * (len(self.pose.columns) - 2)

    def node(self, k, l):
        x = self.pitch * (k + (0.5 if self.rows and l % 2 == 0 else 0))
        y = self.pitch * l * (math.sin(math.pi / 3) if self.rows else 1)
        return self.pose.from_local([x, y, *self.zeros])


class Tool:
    def __init__(self, camera):
        self.mla, self.mia = Mesh(camera["mla"]["mesh"]), Mesh(camera["mia"]["mesh"])
        self.f, self.lens = camera["main_lens"]["f"], Pose(camera["main_lens"]["pose"])
        self.focals = camera["mla"]["focal_lengths"]
        sensor = camera["sensor"]
        self.sensor, self.scale, self.size = Pose(sensor["pose"]), sensor["scale"], (sensor["width"], sensor["height"])

    def focal(self, k, l):
        k, l = self.mla.width - 1 - k, self.mla.height - 1 - l
        count = len(self.focals)
        return self.focals[0 if count == 1 else (l % (count - 1) + k) % count]

    def project(self, p):
        """{(k, l): pixel} of a point in mm; only those within their micro-images' circles."""
        local = self.lens.to_local(p)
        image = self.lens.from_local(scaled(-self.f / (abs(local[2]) - self.f), local))
        found = {}
        for k in range(self.mla.width):
            for l in range(self.mla.height):
                centre = self.mla.node(k, l)
                ray = add(centre, scaled(-1, image))
                # The sensor is not turned: its plane is z = constant.
                t = (self.sensor.translation[2] - centre[2]) / ray[2]
                x, y, _ = self.sensor.to_local(add(centre, scaled(t, ray)))
                uv = [self.size[0] - 1 - x / self.scale, self.size[1] - 1 - y / self.scale]
                middle = self.mia.node(self.mla.width - 1 - k, self.mla.height - 1 - l)
                if math.dist(uv, middle) <= self.mia.pitch / 2 - 1.5:
                    found[k, l] = uv
        return found


class Libpleno(CommandTest):
    def compare(self, lattice="hexagonal", types="abc", decentre=(0, 0), tilt=(0, 0), array_tilt=(0, 0),
                window=(0, 0, 400, 300)):
        text = SCENE % (*decentre, *tilt, lattice, 3, *array_tilt, "".join(TYPE % (n, FOCAL[n]) for n in types))
        x, y, width, height = window
        write_light_field(self.path("raw.exr"), [[1e-12] * width] * height, sensor=(400, 300), origin=(x, y),
                          scene=text)
        self.write("points.csv", "".join("%r,%r,%r\n" % p for p in POINTS))
        self.succeeds("truth", "raw.exr", "--points", "points.csv", "--projections", "images.csv")
        self.succeeds("export", "raw.exr", "--format", "libpleno", "-o", "out")
        with open(self.path("out/camera.js"), encoding="utf-8") as file:
            tool = Tool(json.load(file))
        with open(self.path("images.csv"), encoding="utf-8") as file:
            truth = list(csv.DictReader(file))
        compared = 0
        for i, (forward, left, up) in enumerate(POINTS):
            # From the middle of the thin main lens: right, down, forward.
            images = tool.project([-1e3 * left - decentre[0], -1e3 * up - decentre[1], 1e3 * forward])
            # libpleno's images are those through the lenses' middles; lenses seen in part have none.
            rows = [row for row in truth if int(row["point"]) == i and row["column"] != "nan"]
            for (k, l), uv in images.items():
                if not (1 < uv[0] < width - 2 and 1 < uv[1] < height - 2):
                    continue
                # Exact rays count pixels from their corners, in the whole picture.
                near = min(rows, key=lambda row: math.dist(uv, self.pixel(row, window)))
                error = math.dist(uv, self.pixel(near, window))
                self.assertLess(error / tool.mia.pitch, 1e-6, (i, k, l, uv, near))
                self.assertLess(abs(tool.focal(k, l) / FOCAL[near["type"]] - 1), 1e-9)
                compared += 1
        self.assertGreater(compared, 20)

    @staticmethod
    def pixel(row, window):
        return [float(row["column"]) - 0.5 - window[0], float(row["row"]) - 0.5 - window[1]]

    def test_turned_array(self):
        self.compare()

    def test_square_array(self):
        self.compare("square", "b")

    def test_window(self):
        self.compare(window=(21, 12, 360, 250))

    def test_decentred_main_lens(self):
        self.compare(decentre=(0.3, -0.2))

    def test_tilted_array(self):
        self.compare(array_tilt=(0.4, -0.3))

    def test_all_at_once(self):
        self.compare(decentre=(-0.2, 0.1), tilt=(0.5, -0.8), array_tilt=(-0.3, 0.2), window=(21, 12, 360, 250))

    def test_pictures(self):
        """OpenCV turns colour of 8 bits to grey in that tool, and aborts at other pictures."""
        self.compare()
        with open(self.path("out/images.js"), encoding="utf-8") as file:
            images = json.load(file)
        self.assertEqual((images["meta"]["rgb"], images["meta"]["format"]), (True, 8))
        for entry in [*images["whites"], *images["images"], images["mask"]]:
            width, height, bits, channels, _, _ = read_png(self.path("out/" + entry["path"]))
            self.assertEqual((width, height, bits, channels), (400, 300, 8, 3))


if __name__ == "__main__":
    main()
