"""plenoflame render --white and plenoflame truth."""

import csv
import io
import math

from command import CommandTest, main
from exr import read_exr

SCENE = """[camera]
preset = "raytrix-r29"
[camera.sensor]
columns = 96
rows = 64
pixel_pitch = "5.5 um"
"""


def etendue_of_the_middle_lens(f_number):
    """m^2 sr from the stop of that camera (a thin lens of 100 mm) through both faces of the microlens on the axis.

    Traced here: from a point of the stop to the flat front, refracted, and on to the spherical back; how far out
    on the front a ray may meet it so that it leaves within the back's clear diameter is found by halving.
    """
    clear, thickness, radius, index = 82.5e-6, 0.2e-3, 1.125e-3, 1.5
    image = 1 / (1 / 0.1 - 1 / 1.0)
    # Sharp for the type f = 2 mm with the sensor 1.2 mm behind its rear principal plane, which is the rear vertex: the
    # main lens' image lies 3 mm behind the front one, which is in the glass, thickness / index behind the front.
    sharp = 1 / (1 / 1.2e-3 - 1 / 2e-3)
    distance = image - sharp - thickness / index

    def leaves(pupil, r, cosine, sine):
        x, y = r * cosine, r * sine
        length = math.sqrt((x - pupil) ** 2 + y * y + distance * distance)
        dx, dy = (x - pupil) / length / index, y / length / index
        dz = math.sqrt(1 - dx * dx - dy * dy)
        # The sphere around z = thickness - radius.
        z = radius - thickness
        b, c = x * dx + y * dy + z * dz, x * x + y * y + z * z - radius * radius
        t = -b + math.sqrt(b * b - c)
        return (x + t * dx) ** 2 + (y + t * dy) ** 2 <= clear * clear

    rings, spokes, total = 40, 64, 0.0
    widest = 0.05 / f_number
    for ring in range(rings):  # of equal area
        pupil = widest * math.sqrt((ring + 0.5) / rings)
        for spoke in range(spokes):  # one half; the other is its mirror image
            angle = math.pi * (spoke + 0.5) / spokes
            cosine, sine = math.cos(angle), math.sin(angle)
            low, high = 0.0, clear
            if leaves(pupil, high, cosine, sine):
                low = high
            else:
                for _ in range(40):
                    middle = 0.5 * (low + high)
                    low, high = (middle, high) if leaves(pupil, middle, cosine, sine) else (low, middle)
            total += 0.5 * low * low * distance * distance / (distance * distance + pupil * pupil) ** 2
    return total * (2 * math.pi / spokes) * (math.pi * widest * widest / rings)


class Truth(CommandTest):
    def setUp(self):
        super().setUp()
        self.write("a.toml", SCENE)

    def test_points_far_beside_the_axis_have_no_image(self):
        # The exit pupil of this lens lies on the sensor's side: nothing but the sensor bounds what is looked at.
        self.write("far.toml", '[camera]\npreset = "r12"\n')
        self.succeeds("render", "far.toml", "--white", "--window", "0,0,2,2", "--samples", "1", "--quiet", "-o", "far.exr")
        self.write("far.csv", "0.9,-0.01,65536\n0.001,100,0\n1,0,1e9\n1,0,0\n")
        self.succeeds("truth", "far.exr", "--points", "far.csv", "--projections", "images.csv")
        points = {line.split(",")[0] for line in self.read("images.csv").decode().splitlines()[1:]}
        self.assertEqual(points, {"3"})

    def test_white_images_at_several_apertures(self):
        self.succeeds("render", "a.toml", "--white", "--f-numbers", "14,28", "--samples", "4096", "-o", "w.exr", "--quiet")
        self.assertEqual([f for f in self.files() if f.endswith(".exr")], ["w-f14.exr", "w-f28.exr"])
        for number in ("14", "28"):
            images = read_exr(self.path(f"w-f{number}.exr"))[1]
            # The middle micro-image, which at these apertures touches no other.
            own = [(x, y) for y in range(64) for x in range(96) if (x - 47.5) ** 2 + (y - 31.5) ** 2 < 15.5 ** 2]
            flux = sum(images["total"][y][x] for x, y in own)
            error = math.sqrt(sum(images["total.error"][y][x] ** 2 for x, y in own))
            # A field of radiance 1. The quadrature is good to 1e-5, and the pupil's bounds may lose 1e-4.
            expected = etendue_of_the_middle_lens(float(number))
            self.assertLess(error, 1e-3 * flux)
            self.assertLess(abs(flux - expected), 4 * error + 1.1e-4 * flux, (number, flux, expected, error))
        self.fails(2, "render", "a.toml", "--white", "--f-numbers", "4", "-o", "w.exr", mentions="wider than the lens")
        # All of them are tried before the first is rendered.
        self.fails(2, "render", "a.toml", "--white", "--f-numbers", "22,4", "-o", "n.exr", mentions="wider than the lens")
        self.fails(2, "render", "a.toml", "--white", "--f-numbers", "22,22.0", "-o", "n.exr", mentions="twice")
        self.assertFalse([name for name in self.files() if name.startswith("n")])
        self.fails(2, "render", "a.toml", "--f-numbers", "8", "-o", "w.exr", mentions="white")

    def test_truth(self):
        self.succeeds("render", "a.toml", "--white", "--samples", "2", "-o", "w.exr", "--quiet")
        self.write("p.csv", "x,y,z\n1.0,0,0\n1.0,0.001,0\n")
        figures = self.json_of("truth", "w.exr", "-o", "t.csv", "--attach", "w2.exr", "--points", "p.csv",
                               "--projections", "i.csv", "--chief-rays", "c.exr")
        lines = self.read("t.csv").decode().splitlines()
        self.assertEqual(lines[0], "q,r,type,column,row,radius")
        self.assertEqual(len(lines) - 1, figures["micro_images"])
        middle = [line.split(",") for line in lines if line.startswith("0,0,")]
        self.assertEqual(middle[0][2], "far")
        self.assertLess(abs(float(middle[0][3]) - 48), 1e-6)
        self.assertLess(abs(float(middle[0][4]) - 32), 1e-6)
        attributes = read_exr(self.path("w2.exr"))[0]
        self.assertIn("0,0,far,48", str(attributes["plenoflame.text.truth.micro_images"]))
        images = self.read("i.csv").decode().splitlines()
        self.assertEqual(images[0], "point,x,y,z,q,r,type,column,row,centroid_column,centroid_row,spread,share")
        self.assertGreater(len(images), 4)
        rays = read_exr(self.path("c.exr"))[1]
        # The middle pixels look along +x of the world.
        self.assertGreater(rays["chief.dx"][32][48], 0.999)
        self.fails(2, "truth", "w.exr", mentions="--output")
        self.fails(2, "truth", "w.exr", "--points", "p.csv", mentions="--projections")
        self.write("p.csv", "x,y,z\n1,2,3\n4,5\n")
        self.fails(1, "truth", "w.exr", "--points", "p.csv", "--projections", "i.csv", mentions="p.csv:3")
        # A first line with any number in it is no header.
        for line in ["1.0,abc,2", "1,0", "nan,0,0", ",,"]:
            self.write("p.csv", line + "\n1,0,0\n")
            self.fails(1, "truth", "w.exr", "--points", "p.csv", "--projections", "none.csv", mentions="p.csv:1:")
        self.write("p.csv", "x,y,z\n1,0,0\n-1,0,0\n")
        self.fails(1, "truth", "w.exr", "--points", "p.csv", "--projections", "none.csv",
                   mentions=["point 1", "-1, 0, 0 m", "in front of the camera"])
        self.fails(2, "truth", "w.exr", "-o", "i.csv", "--points", "p.csv", "--projections", "i.csv", mentions="same file")
        self.assertNotIn("none.csv", self.files())
        self.fails(1, "truth", "t.csv", "-o", "x.csv", mentions="t.csv")

    def test_projections_are_where_the_light_is(self):
        """A speck of flame behind plano-convex microlenses: the centroid of its light in every micro-image, and its share."""
        scene = """[camera]
preset = "r12"
[camera.sensor]
columns = 420
rows = 320
[[flames]]
position = ["0.42 m", "1.1 mm", "0.7 mm"]
[flames.spectrum]
kind = "grey"
[[flames.layers]]
centre = ["0 m", "0 m", "0 m"]
semi_axes = ["0.1 mm", "0.1 mm", "0.1 mm"]
temperature = "1700 K"
absorption = "20 1/m"
"""
        self.write("a.toml", scene)
        self.succeeds("render", "a.toml", "--samples", "2048", "--window", "140,100,90,85", "-o", "w.exr", "--quiet")
        self.write("p.csv", "0.42,0.0011,0.0007\n")
        figures = self.json_of("truth", "w.exr", "--points", "p.csv", "--projections", "i.csv", "--rays", "100000")
        rows = list(csv.DictReader(io.StringIO(self.read("i.csv").decode())))
        self.assertEqual(len(rows), figures["point_images"])
        flux = read_exr(self.path("w.exr"))[1]["total"]
        seen = {}
        places = [(float(row["centroid_column"]), float(row["centroid_row"])) for row in rows]
        for y, line in enumerate(flux):
            for x, value in enumerate(line):
                if value > 0:
                    k = min(range(len(rows)), key=lambda k: math.hypot(x + 140.5 - places[k][0], y + 100.5 - places[k][1]))
                    sums = seen.setdefault(k, [0.0, 0.0, 0.0])
                    for i, part in enumerate((value, value * (x + 140.5), value * (y + 100.5))):
                        sums[i] += part
        total = sum(map(sum, flux))
        apart, part = 0, 0
        for k, row in enumerate(rows):
            share = float(row["share"])
            if share < 0.01:  # too few rays of the picture
                continue
            weight, x, y = seen[k]
            self.assertLess(abs(weight / total / share - 1), 0.05, row)
            # The speck, which is no point, lights another part of lenses at the rim of the beam.
            whole = share > 0.0765
            self.assertLess(math.hypot(x / weight - places[k][0], y / weight - places[k][1]), 0.03 if whole else 0.15, row)
            chief = float(row["column"]), float(row["row"])
            if math.isnan(chief[0]):
                part += 1
            elif whole:
                apart = max(apart, math.hypot(chief[0] - places[k][0], chief[1] - places[k][1]))
        # The ray through the middle is not the middle of the light, and some lenses see it in part.
        self.assertGreater(apart, 0.15)
        self.assertGreater(part, 0)
        self.assertGreaterEqual(figures["point_images_in_part"], part)
        self.fails(2, "truth", "w.exr", "-o", "t.csv", "--rays", "9", mentions="--projections")

    def test_tolerances_move_the_micro_images(self):
        tolerances = '[camera.array]\ndiameter = "140 um"\nrotation = "1 deg"\noffset = ["11 um", "0 m"]\ncentre_jitter = "10 um"\n'
        self.write("b.toml", SCENE + tolerances)
        self.succeeds("render", "b.toml", "--white", "--samples", "2", "-o", "w.exr", "--quiet")
        self.succeeds("truth", "w.exr", "-o", "t.csv")
        rows = [line.split(",") for line in self.read("t.csv").decode().splitlines()[1:]]
        places = {(int(row[0]), int(row[1])): float(row[3]) for row in rows}
        # 11 um are 2 pixels to the other side, a little more seen from the pupil.
        self.assertLess(abs(places[0, 0] - 46), 0.05)
        # A pitch of 174 um, 31.6 pixels; displaced by up to 10 um, 1.82 pixels.
        step = places[0, 0] - places[1, 0]
        self.assertLess(abs(step - 31.9), 2.2)
        self.assertNotAlmostEqual(step, 31.9, places=1)
        self.write("c.toml", SCENE + '[camera.array]\ncentre_jitter = "10 um"\n')
        self.fails(1, "render", "c.toml", "--white", "-o", "w.exr", mentions=["c.toml:8", "overlap"])


if __name__ == "__main__":
    main()
