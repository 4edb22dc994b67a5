"""From raw pictures of a board to a camera: corners, geometry, a rig of two; a measured picture against a simulated one."""

import csv
import math
import random

from command import CommandTest, main
from raw_pictures import tiff

CAMERA = """[camera.lens]
model = "ideal"
focal_length = "{focal} mm"
diameter = "16 mm"
[camera.array]
lattice = "hexagonal"
model = "ideal"
pitch = "126 um"
diameter = "124 um"
rotation = "4 mrad"
offset = ["20 um", "-30 um"]
sensor_distance = "{sensor} mm"
[[camera.array.types]]
name = "all"
focal_length = "0.5 mm"
[camera.focus]
mode = "distance"
lens_distance = "{lens} mm"
[camera.sensor]
columns = 560
rows = 440
pixel_pitch = "5.5 um"
bits = 12
full_well = 9000
read_noise = 6
gain = 2.3
black_level = 60
exposure_time = "1 ms"
[[channels]]
name = "red"
kind = "line"
wavelength = "650 nm"
width = "10 nm"
"""
BOARD = """[[lights]]
kind = "environment"
radiance = "10 W/(m^2 sr)"
[[surfaces]]
name = "board"
shape = "plane"
position = ["{x} mm", "{y} mm", "{z} mm"]
rotation = ["{a} deg", "{b} deg", "{c} deg"]
extent = ["60 mm", "60 mm"]
material.reflectivity = 0.9
[surfaces.material.texture]
kind = "checkerboard"
dark = 0.05
cell = "2.5 mm"
columns = 6
rows = 5
"""
POSES = ((305, -0.5, 0.4, -20, -75, -25), (318, 0.6, 0.1, 25, -70, 5), (309, -0.2, -0.6, -15, -118, 40))


def camera(focal=50, lens=57.5, sensor=0.4):
    return CAMERA.format(focal=focal, lens=lens, sensor=sensor)


class Boards(CommandTest):
    def boards(self, count):
        self.write("real.toml", camera())
        names = []
        for k, pose in enumerate(POSES[:count]):
            self.write("scene.toml", camera() + BOARD.format(**dict(zip("xyzabc", pose))))
            self.succeeds("render", "scene.toml", "-o", "board.exr", "--samples", "8", "--quiet")
            names.append(f"board-{k}.tif")
            self.run_command("develop", "board.exr", "-o", names[-1], "--exposure", "auto")
        return names

    def corners(self, names, *more):
        return self.json_of("calibrate", "corners", *names, "--camera", "real.toml", "--board", "5x4",
                            "--cell", "2.5 mm", "-o", "corners.csv", *more)

    def of_blur(self, found):
        """Blur tells the focal length of the microlenses, 0.5 mm; tables without it tell what they did."""
        self.assertEqual(found["blur_corners"], found["corners"])
        value = found["values"]["camera.array.types[0].focal_length"]
        self.assertLess(abs(value["value"] / 0.5e-3 - 1), 0.02)
        self.assertEqual(len(found["boards"]), len(POSES))
        for board, pose in zip(found["boards"], POSES):
            self.assertLess(abs(1e3 * board["distance_m"] - pose[0]), 4e3 * board["error_m"])
        rows = [line.split(",") for line in self.read("corners.csv").decode().splitlines()]
        self.assertEqual(rows[0][-3:], ["error", "blur", "blur_error"])
        run = ("--camera", "real.toml", "-o", "blur.toml", "--free", "camera.array.sensor_distance")
        self.write("places.csv", "\n".join(",".join(row[:7]) for row in rows) + "\n")
        self.assertNotIn("blur_corners", self.json_of("calibrate", "geometry", "places.csv", *run))
        for column in (7, 9):  # errors of the place and of the blur
            bad = [list(row) for row in rows]
            bad[2][column] = "-0.1"
            self.write("bad.csv", "\n".join(map(",".join, bad)) + "\n")
            self.fails(1, "calibrate", "geometry", "bad.csv", *run, mentions=["bad.csv:3", "not below 0"])
        # Neighbouring micro-images lie to the right and to the left of where they belong.
        moved = [[*r[:3], repr(float(r[3]) + 0.65 * (-1) ** int(r[5])), *r[4:]] for r in rows[1:]]
        self.write("moved.csv", "\n".join(map(",".join, moved)) + "\n")
        result = self.run_command("calibrate", "geometry", "moved.csv", "--camera", "nominal.toml", *run[2:])
        self.assertRegex(result.stderr, r"the fit leaves 0\.6\d+ pixels .* of the corners, whose own errors are 0\.0")
        self.write("other.toml", camera().replace('focal_length = "0.5 mm"', 'focal_length = "0.56 mm"'))
        result = self.run_command("calibrate", "geometry", "corners.csv", "--camera", "other.toml", *run[2:])
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn("focal lengths of microlenses differ by -1", result.stderr)

    def test_raw_pictures_to_a_camera(self):
        names = self.boards(len(POSES))
        figures = self.corners(names, "--picture", "seen.png")
        self.assertEqual(figures["boards"], len(POSES))
        for picture, pose in zip(figures["pictures"], POSES):
            self.assertTrue(picture["whole"])
            self.assertLess(abs(1e3 * picture["distance_m"] / pose[0] - 1), 0.02)
        self.assertTrue(self.read("seen.png").startswith(b"\x89PNG"))
        self.write("nominal.toml", camera(50, 57.6, 0.41))
        found = self.json_of("calibrate", "geometry", "corners.csv", "--camera", "nominal.toml", "-o", "found.toml",
                             "--free", "camera.focus.lens_distance,camera.array.sensor_distance", "--plot", "left.svg",
                             "--poses", "poses.csv", "--residuals", "left.csv")
        self.assertLess(found["corner_rms_pixel"], 0.1)
        self.assertEqual(found["poses"], len(POSES))
        self.assertLess(found["left_out"], 0.02 * found["corners"])
        for key, truth in (("camera.focus.lens_distance", 57.5e-3), ("camera.array.sensor_distance", 0.4e-3)):
            value = found["values"][key]
            self.assertLess(abs(value["value"] / truth - 1), 0.01, key)
            self.assertGreater(value["error"], 0)
        self.of_blur(found)
        # Radii of white micro-images agree with the sensor's distance: 25 mm / N of the stop, seen from the sensor.
        rows = [f"0,{n},{math.hypot(25 * 0.4 / 57.5 / 5.5e-3 / n, 2)},0.01\n" for n in (4, 8)]
        self.write("radii.csv", "type,f_number,radius,error\n" + "".join(rows))
        run = ("corners.csv", "--camera", "real.toml", "-o", "both.toml", "--free", "camera.array.sensor_distance")
        both = self.json_of("calibrate", "geometry", *run, "--radii", "radii.csv")
        self.assertLess(abs(both["radii_pixel"][0] / (25 * 0.4 / 57.5 / 5.5e-3) - 1), 1e-6)
        self.assertLess(abs(both["radii_conflict"]), 1)
        self.assertLess(abs(both["radii_error"] / 0.03 - 1), 0.01)
        for text, mentions in (("3,4,9,0.01\n", "type 3"), ("0,4,9,0.01\n", "two apertures"), ("", "no line of the file")):
            self.write("bad.csv", text)
            self.fails(1, "calibrate", "geometry", *run, "--radii", "bad.csv", mentions=mentions)
        variance = found["covariance"][0][0]
        error = found["values"]["camera.focus.lens_distance"]["error"]
        self.assertLess(abs(variance / error ** 2 - 1), 1e-6)
        self.assertIn(b'height="1240pt"', self.read("left.svg")[:400])  # both parts
        # The boards' distances are those of the scenes.
        with open(self.path("poses.csv"), encoding="ascii") as file:
            rows = list(csv.DictReader(file))
        for row, pose in zip(rows, POSES):
            self.assertLess(abs(1e3 * float(row["z"]) / pose[0] - 1), 0.02)
        # Two such cameras side by side, by the same boards: what one sees moved by 30 mm.
        with open(self.path("right.csv"), "w", encoding="ascii") as file:
            file.write("pose,rms_pixel,x,y,z," + ",".join(f"r{i}{k}" for i in range(3) for k in range(3)) + "\n")
            for row in rows:
                row["x"] = repr(float(row["x"]) - 0.03)
                file.write(",".join(row.values()) + "\n")
        rig = self.json_of("calibrate", "rig", "found.toml=poses.csv", "found.toml=right.csv", "-o", "rig.toml")
        place = rig["cameras"][0]["place_m"]
        self.assertLess(math.dist(place, (0.03, 0, 0)), 1e-9)
        text = self.read("rig.toml").decode()
        self.assertEqual(text.count("[[cameras]]"), 2)
        # A scene that opens: its cameras are called as their files are. That it has no flame yet is no fault.
        opened = self.run_command("info", "rig.toml")
        self.assertEqual((opened.returncode, opened.stderr), (0, ""))
        for name in ("found", "found-2"):
            self.assertIn(f'name = "{name}"\n', text)

    def test_what_is_refused(self):
        names = self.boards(1)
        random.seed(1)
        grey = [[400 + round(random.gauss(0, 8)) for _ in range(560)] for _ in range(440)]
        self.write("grey.tif", tiff([grey]))
        before = self.files()
        run = ("calibrate", "corners", names[0], "--camera", "real.toml", "-o", "a.csv", "--cell", "2.5 mm")
        self.fails(2, *run, "--board", "5", mentions="--board")
        self.fails(2, *run, "--board", "1x4", mentions="2x2")
        self.fails(2, "calibrate", "rig", "real.toml", "real.toml", "-o", "b.toml", mentions="POSES.csv")
        self.fails(1, "calibrate", "corners", "grey.tif", "grey.tif", "--camera", "real.toml", "-o", "a.csv",
                   "--cell", "2.5 mm", "--board", "5x4",
                   mentions="no picture shows the board; the first: 'grey.tif': no board is seen")
        self.assertEqual(self.files(), before)
        # Pictures and corners of another sensor.
        self.write("other.toml", camera().replace("columns = 560", "columns = 300"))
        for pair in (("corners", names[0], "--board", "5x4", "--cell", "2.5 mm", "--camera", "other.toml"),):
            self.fails(1, "calibrate", *pair, "-o", "a.csv", mentions=["560 x 440", "300 x 440"])
        self.assertEqual(self.files(), sorted([*before, "other.toml"]))
        # A picture that shows none is named and left out.
        result = self.run_command("calibrate", "corners", names[0], "grey.tif", "--camera", "real.toml", "-o", "a.csv",
                                  "--cell", "2.5 mm", "--board", "5x4")
        self.assertEqual(result.returncode, 0)
        self.assertIn("warning: 'grey.tif': no board is seen", result.stderr)
        self.assertIn("1 of 2 pictures", result.stdout)
        self.fails(1, "calibrate", "geometry", "a.csv", "--camera", "other.toml", "-o", "b.toml",
                   mentions=["a corner of pose 0", "sensor of 300 x 440"])
        # One pose does not tell lengths from each other; what is found with more values than that is named.
        self.fails(1, "calibrate", "geometry", "a.csv", "--camera", "real.toml", "-o", "b.toml",
                   mentions="do not determine")
        self.assertNotIn("b.toml", self.files())
        result = self.run_command("calibrate", "geometry", "a.csv", "--camera", "real.toml", "-o", "b.toml",
                                  "--free", "camera.array.sensor_distance,camera.lens.distortion.k3")
        self.assertIn("these poses hardly tell camera.lens.distortion.k3", result.stderr)


class ByLens(CommandTest):
    def test_shift_and_gain_of_a_picture(self):
        """The same scene by a camera whose micro-images stand elsewhere by a fifth of a pixel."""
        source = ('[[flames]]\nposition = ["0.31 m", "0 m", "0 m"]\n[[flames.layers]]\n'
                  'semi_axes = ["6 mm", "6 mm", "6 mm"]\ntemperature = "1800 K"\nabsorption = "60 1/m"\n')
        text = camera().replace("columns = 560", "columns = 200").replace("rows = 440", "rows = 160")
        self.write("a.toml", text + source)
        self.write("b.toml", text.replace('"20 um"', '"21.1 um"') + source)
        for name in "ab":
            self.succeeds("render", name + ".toml", "-o", name + ".exr", "--samples", "64", "--quiet")
        figures = self.json_of("compare", "a.exr", "b.exr", "--by-lens", "--lenses", "lenses.csv", "--map", "left.png")
        # Camera x runs against columns: micro-images of a lie farther right, by the lens' 1.1 um and a little.
        expected = 1.1 / 5.5 * (57.5 + 0.4) / 57.5
        self.assertLess(abs(abs(figures["shift_pixel"][0]) - expected), 0.1 * expected)
        self.assertLess(abs(figures["shift_pixel"][1]), 0.1 * expected)
        self.assertLess(abs(figures["gain"] - 1), 0.02)
        with open(self.path("lenses.csv"), encoding="ascii") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual(len(rows), figures["lenses"])
        self.assertTrue(self.read("left.png").startswith(b"\x89PNG"))
        same = self.json_of("compare", "a.exr", "a.exr", "--by-lens")
        self.assertLess(abs(same["shift_pixel"][0]), 1e-6)


if __name__ == "__main__":
    main()
