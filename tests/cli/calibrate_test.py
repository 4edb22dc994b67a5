"""calibrate: the array from white pictures, the scale from a blackbody; what is refused."""

import csv
import json
import math
import random
import re

from command import CommandTest, main
from exr import read_exr
from raw_pictures import tiff

WIDTH, HEIGHT = 260, 200
CAMERA = """[camera.lens]
model = "ideal"
focal_length = "50 mm"
diameter = "11 mm"
[camera.array]
lattice = "hexagonal"
model = "ideal"
pitch = "{pitch} um"
diameter = "110 um"
sensor_distance = "0.45 mm"
rotation = "{rotation} deg"
offset = ["{offset} um", "0 um"]
[[camera.array.types]]
name = "far"
focal_length = "0.62 mm"
[[camera.array.types]]
name = "middle"
focal_length = "0.52 mm"
[[camera.array.types]]
name = "near"
focal_length = "0.44 mm"
[camera.sensor]
columns = 260
rows = 200
pixel_pitch = "5.5 um"
bits = 12
full_well = 9000
read_noise = 6
quantum_efficiency = 0.5
gain = 2.3
black_level = 60
exposure_time = "{exposure}"
[camera.focus]
object_distance = "0.5 m"
[[channels]]
name = "red"
kind = "line"
wavelength = "650 nm"
width = "10 nm"
"""


def camera(pitch=127.4, rotation=0.8, offset=20, exposure="1 ms"):
    return CAMERA.format(pitch=pitch, rotation=rotation, offset=offset, exposure=exposure)


def source(temperature):
    """A hot body that fills the view, so thick that it is black."""
    return (f'[[flames]]\nposition = ["0.5 m", "0 m", "0 m"]\n[[flames.layers]]\n'
            f'semi_axes = ["80 mm", "80 mm", "80 mm"]\ntemperature = "{temperature} K"\nabsorption = "20000 1/m"\n')


class White(CommandTest):
    def setUp(self):
        super().setUp()
        self.write("true.toml", camera() + source(1800))
        self.succeeds("render", "true.toml", "-o", "white.exr", "--white", "--samples", "64", "--quiet")
        self.run_command("develop", "white.exr", "-o", "white.tif", "--exposure", "auto")

    def test_the_array_comes_back(self):
        self.write("nominal.toml", camera(126.9, 0, 0))
        figures = self.json_of("calibrate", "white", "white.tif", "--camera", "nominal.toml", "-o", "found.toml",
                               "--centres", "centres.csv", "--picture", "seen.png")
        self.assertEqual((figures["lattice"], figures["types"]), ("hexagonal", 3))
        self.assertLess(abs(figures["pitch_m"] - 127.4e-6), 4 * figures["pitch_error_m"])
        self.assertLess(abs(figures["array_rotation_rad"] - math.radians(0.8)), 4 * figures["rotation_error_rad"])
        self.assertLess(figures["camera_rms_pixels"], 0.03)
        # The file that was written is a camera whose own white picture has these centres.
        again = self.json_of("calibrate", "white", "white.tif", "--camera", "found.toml", "--centres", "again.csv")
        self.assertLess(abs(again["pitch_m"] / figures["pitch_m"] - 1), 1e-6)
        with open(self.path("centres.csv"), encoding="ascii") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual(len(rows), figures["micro_images"])
        # Types are (q - r) mod 3 in the scene's order, and each pair of neighbours differs.
        self.assertTrue(all(int(row["type"]) == (int(row["q"]) - int(row["r"])) % 3 for row in rows))
        self.assertTrue(self.read("seen.png").startswith(b"\x89PNG"))

    def test_microlenses_have_the_numbers_that_the_camera_gives_them(self):
        """The array's offset is that of the lens 0, 0: some pitches off the middle, and known to a tenth of one."""
        for offset in (0.4e-3, -0.5e-3):
            self.write("true.toml", camera(offset=1e6 * offset) + source(1800))
            self.succeeds("render", "true.toml", "-o", "white.exr", "--white", "--samples", "64", "--quiet")
            self.run_command("develop", "white.exr", "-o", "white.tif", "--exposure", "auto")
            self.write("nominal.toml", camera(126.9, 0.7, 1e6 * offset + 12))
            figures = self.json_of("calibrate", "white", "white.tif", "--camera", "nominal.toml", "--centres", "centres.csv")
            self.assertLess(abs(figures["offset_m"][0] - offset), 0.1 * 127.4e-6, figures)
            self.assertTrue(figures["same_origin"])
            with open(self.path("centres.csv"), encoding="ascii") as file:
                first = next(row for row in csv.DictReader(file) if (row["q"], row["r"]) == ("0", "0"))
            self.assertEqual(first["type"], "0")
            for name, place in zip(("model_column", "model_row"), figures["origin_pixels"]):
                self.assertLess(abs(float(first[name]) - place), 1e-3)

    def test_a_tilt_that_is_none_is_warned_of(self):
        # Mounts of arrays are better than 20 mrad; here the array is tilted by as much indeed.
        self.write("true.toml", camera().replace("[camera.array]", '[camera.array]\ntilt = ["20 mrad", "0 mrad"]') + source(1800))
        self.succeeds("render", "true.toml", "-o", "white.exr", "--white", "--samples", "64", "--quiet")
        self.run_command("develop", "white.exr", "-o", "tilted.tif", "--exposure", "auto")
        self.write("nominal.toml", camera())
        result = self.run_command("calibrate", "white", "tilted.tif", "--camera", "nominal.toml", "--json")
        self.assertEqual(result.returncode, 0, result.stderr)
        figures = json.loads(result.stdout)
        tilted = [abs(t) > 5e-3 and abs(t) > 5 * e for t, e in zip(figures["tilt_rad"], figures["tilt_error_rad"])]
        self.assertTrue(any(tilted), figures)
        self.assertEqual(result.stderr.count("more than arrays are mounted with"), sum(tilted))

    def test_keys_without_a_camera(self):
        self.succeeds("calibrate", "white", "white.tif", "--pixel-pitch", "5.5 um", "-o", "array.toml",
                      stderr="")
        text = self.read("array.toml").decode()
        self.assertIn('lattice = "hexagonal"', text)
        self.fails(2, "calibrate", "white", "white.tif", "-o", "a.toml", mentions="--pixel-pitch")
        self.fails(2, "calibrate", mentions="subcommand")

    def test_radii_against_apertures(self):
        words = []
        for number in (5, 7, 10):
            self.write("stop.toml", camera(rotation=0, offset=0).replace('"11 mm"', f'"{50 / number} mm"'))
            self.run_command("render", "stop.toml", "-o", "w.exr", "--white", "--samples", "64", "--quiet")
            self.run_command("develop", "w.exr", "-o", f"w{number}.tif", "--exposure", "auto")
            words.append(f"{number}=w{number}.tif")
        figures = self.json_of("calibrate", "white", *words, "--centres", "a.csv", "--pixel-pitch", "5.5 um",
                               "--radii", "radii.csv")
        # The stop's radius f / 2N, seen through a microlens from the sensor, in pixels.
        slope = 25e-3 * 0.45e-3 / (1 / (1 / 50e-3 - 1 / 0.5)) / 5.5e-6
        self.assertEqual(len(figures["radius_lines"]), 3)
        for line in figures["radius_lines"]:
            # Edges of small discs that are blurred lie within by the square of the blur over the radius, 2 % at f/10.
            self.assertLess(abs(line["slope_pixels"] / slope - 1), 0.03, line)
            self.assertGreater(line["rest_pixels"], 0)
        # Squares of radii are sums: the stop's image over N, and the microlens' own blur.
        with open(self.path("radii.csv"), encoding="ascii") as file:
            rows = [{key: float(value) for key, value in row.items()} for row in csv.DictReader(file)]
        self.assertEqual(len(rows), 9)
        for kind in range(3):
            five, ten = ([row["radius"] for row in rows if row["type"] == kind and row["f_number"] == number][0]
                         for number in (5, 10))
            found = math.sqrt((five ** 2 - ten ** 2) / (1 / 25 - 1 / 100))
            self.assertLess(abs(found / slope - 1), 0.03)
        self.fails(2, "calibrate", "white", words[0], "--pixel-pitch", "5.5 um", "--radii", "r.csv",
                   mentions="two f-numbers")

        # Files that change places, that are one and the same, and an f-number that is another's.
        before = self.files()
        for words in (("10=w5.tif", "5=w10.tif"), ("5=w5.tif", "10=w5.tif"), ("5=w5.tif", "7=w10.tif", "10=w7.tif"),
                      ("5=w5.tif", "6=w10.tif")):
            with self.subTest(words=words):
                self.fails(1, "calibrate", "white", *words, "--centres", "b.csv", "--pixel-pitch", "5.5 um",
                           mentions="are the f-numbers those of the files")
                self.assertEqual(self.files(), before)

    def test_what_is_no_good_white_picture_is_said(self):
        def told(*words):
            result = self.run_command("calibrate", "white", *words, "--camera", "true.toml", "--centres", "a.csv")
            self.assertEqual(result.returncode, 0, result.stderr)
            return result.stderr
        self.assertEqual(told("white.tif"), "")
        # The camera's stop is one stop narrower or wider than that of the picture. The stop's image has a radius of
        # B / b / 2 = 0.45 / 55.6 / 2 of its diameter, and that of 11 mm is 8.1 pixels.
        for diameter in (7.8, 15.6):
            self.write("stop.toml", camera().replace('"11 mm"', f'"{diameter} mm"'))
            result = self.run_command("calibrate", "white", "white.tif", "--camera", "stop.toml", "--centres", "a.csv")
            told_of = re.search(r"of 'white.tif' have a radius of ([\d.]+) pixels, by the camera's f/[\d.]+ it is ([\d.]+)",
                                result.stderr)
            for number, stop in zip(told_of.groups(), (11, diameter)):
                self.assertLess(abs(float(number) / (0.5 * stop * 0.45 / (500 / 9) / 5.5e-3) - 1), 0.1)
        # The full well counts, far below the largest number: 9000 e- are 3970 counts, and the converter goes on to 4095.
        self.run_command("develop", "white.exr", "-o", "bright.tif", "--exposure", "10 s")
        self.assertRegex(told("bright.tif"), r"\d+ % of the pixels of 'bright.tif' are full")
        # 12 bits at the top of 16.
        self.write("top.tif", tiff([[[v << 4 for v in row] for row in self.counts("white.tif")]]))
        self.assertIn("numbers up to", told("top.tif"))
        # A stop so wide that each micro-image reaches beyond the middle between two.
        self.write("wide.toml", camera().replace('"11 mm"', '"18 mm"'))
        self.run_command("render", "wide.toml", "-o", "wide.exr", "--white", "--samples", "64", "--quiet")
        self.run_command("develop", "wide.exr", "-o", "wide.tif", "--exposure", "auto")
        self.assertRegex(told("wide.tif"), r"'wide.tif' overlap: they reach 1\d.\d pixels .* 23.\d pixels apart; .* stop the lens down")
        # A lamp that shines on the left half alone.
        corner = [[v if x < 125 else 60 for x, v in enumerate(row)] for row in self.counts("white.tif")]
        self.write("corner.tif", tiff([corner]))
        self.assertIn("micro-images take part in the model: is 'corner.tif' a white picture", told("corner.tif"))
        # The part in the middle of a larger sensor.
        self.write("large.toml", camera().replace("columns = 260", "columns = 300"))
        self.fails(1, "calibrate", "white", "white.tif", "--camera", "large.toml", "-o", "b.toml",
                   mentions=["300 x 200", "260 x 200", "set camera.sensor.columns=260"])
        self.assertNotIn("b.toml", self.files())

    def test_a_flame_can_be_added_to_the_camera(self):
        self.write("nominal.toml", camera())
        self.succeeds("calibrate", "white", "white.tif", "--camera", "nominal.toml", "-o", "found.toml")
        self.write("scene.toml", self.read("found.toml").decode() + source(1500))
        self.succeeds("info", "scene.toml")

    def counts(self, name):
        """Rows of numbers of a TIFF that develop wrote: imported as counts, black level added."""
        self.succeeds("import", name, "--camera", "true.toml", "--unit", "DN", "-o", "counts.exr")
        return [[round(v) + 60 for v in row] for row in read_exr(self.path("counts.exr"))[1]["red"]]

    def test_centres_of_another_program(self):
        random.seed(2)
        pitch, places = 20.3, []
        for k in range(12):
            for l in range(10):
                x, y = 20 + pitch * (k + 0.5 * (l % 2)), 15 + pitch * math.sqrt(0.75) * l
                # A lattice seen aslant: w is 1 at the picture's top left, where the pitch is that of above.
                w = 1 + 2e-5 * x - 1e-5 * y
                places.append((k, l, x / w + random.gauss(0, 0.02), y / w + random.gauss(0, 0.02)))
        self.write("plain.csv", "".join(f"{x},{y}\n" for _, _, x, y in places))
        self.write("tool.csv", "k,l,u,v\n" + "".join(f"{k},{l},{x - 0.5},{y - 0.5}\n" for k, l, x, y in places))
        words = ("--size", "270x200", "--pixel-pitch", "5.5 um", "-o", "keys.toml", "--centres", "all.csv")
        texts = []
        for name in ("plain.csv", "tool.csv"):
            figures = self.json_of("calibrate", "white", name, *words)
            self.assertEqual((figures["lattice"], figures["used"], figures["looks"]), ("hexagonal", 120, []))
            # Noise of both coordinates, less what 14 values of the model take of 240 numbers.
            self.assertLess(abs(figures["rms_pixels"] / (0.02 * math.sqrt(2 * (1 - 14 / 240))) - 1), 0.2)
            texts.append(self.read("all.csv"))
        self.assertEqual(*texts)

    def test_no_lattice(self):
        random.seed(1)
        noise = [[1000 + round(random.gauss(0, 30)) for _ in range(WIDTH)] for _ in range(HEIGHT)]
        self.write("noise.tif", tiff([noise]))
        before = self.files()
        self.fails(1, "calibrate", "white", "noise.tif", "--centres", "a.csv", mentions=["noise.tif", "no lattice is seen"])
        self.assertEqual(self.files(), before)
        self.fails(1, "calibrate", "white", "noise.tif", "--picture", "seen.png", mentions="seen.png")
        self.assertTrue(self.read("seen.png").startswith(b"\x89PNG"))
        square = camera().replace("hexagonal", "square")
        self.write("square.toml", square)
        self.fails(1, "calibrate", "white", "white.tif", "--camera", "square.toml", "-o", "b.toml",
                   mentions=["square", "hexagonal"])


class Radiometry(CommandTest):
    def test_scale_within_its_error(self):
        """Temperatures are stated with an error: the scale's truth is of the sensor's numbers alone."""
        random.seed(3)
        stated, error = [], 4.0
        for number, (temperature, exposure) in enumerate(((1500, "0.6 ms"), (1650, "0.15 ms"), (1800, "0.05 ms"))):
            real = temperature + random.gauss(0, error)
            self.write("bb.toml", camera(exposure=exposure) + source(real))
            self.succeeds("render", "bb.toml", "-o", "bb.exr", "--samples", "32", "--quiet")
            self.run_command("develop", "bb.exr", "-o", f"bb{number}.tif", "--sensor", "--frames", "1")
            self.run_command("develop", "bb.exr", "-o", f"dark{number}.tif", "--sensor", "--dark")
            stated.append((f"{temperature} K@{exposure}=bb{number}.tif", f"{exposure}=dark{number}.tif"))
        self.write("camera.toml", camera())
        figures = self.json_of("calibrate", "radiometry", *(s for s, _ in stated), "--dark", *(d for _, d in stated),
                               "--camera", "camera.toml", "--temperature-error", f"{error} K", "-o", "scale.toml")
        (channel,) = figures["channels"]
        # Energy of a photon by the gain over the quantum efficiency.
        truth = 6.62607015e-34 * 299792458 / 650e-9 * 2.3 / 0.5
        off = channel["joules_per_count"] / truth - 1
        self.assertLess(abs(off), 3 * channel["relative_error"])
        # Wien: an error of 4 K is 3 to 4 % of the light; three pictures know it better than one.
        self.assertGreater(channel["relative_error"], 0.01)
        self.assertLess(channel["relative_error"], 0.04)
        # A picture that is imported with it has these watts.
        words = ("bb1.tif", "--camera", "camera.toml", "--dark", "dark1.tif", "--exposure-time", "0.15 ms", "--json")
        watts = json.loads(self.run_command("import", *words, "--radiometry", "scale.toml", "-o", "a.exr").stdout)
        plain = json.loads(self.run_command("import", *words, "--unit", "W", "-o", "b.exr").stdout)
        self.assertEqual(watts["unit"], "W")
        self.assertLess(abs(watts["scale_error_red"] / channel["relative_error"] - 1), 1e-3)
        self.assertLess(abs(watts["largest"] / plain["largest"] / (1 + off) - 1), 1e-4)

    def test_a_vignetted_camera(self):
        """The camera loses light from the left to the right, by a wedge and by the pixels' own gains, which its file
        does not know: white picture and flat field tell it, and the scale is that of the light."""
        random.seed(5)
        temperature, k = 1700, 3e-5
        self.write("camera.toml", camera(exposure="0.1 ms").replace("black_level = 60", "black_level = 0"))
        self.write("bb.toml", camera(exposure="0.1 ms") + source(temperature))
        for name, words in (("bb", ()), ("white", ("--white",))):
            self.succeeds("render", "bb.toml", "-o", f"{name}.exr", *words, "--samples", "32", "--quiet")
        light, white = (read_exr(self.path(f"{name}.exr"))[1]["red"] for name in ("bb", "white"))
        most = {"bb": max(map(max, light)), "white": max(map(max, white))}
        loss = [[(1 - 0.4 * x / WIDTH) * random.uniform(0.95, 1.05) for x in range(WIDTH)] for _ in range(HEIGHT)]
        own = [[random.uniform(0.9, 1.1) for _ in range(WIDTH)] for _ in range(HEIGHT)]
        joules = most["bb"] * 1e-4 / 3000  # 3000 counts at a pixel that loses nothing

        def bent(linear):
            return (math.sqrt(1 + 4 * k * linear) - 1) / (2 * k)

        def counts(values, top, gains=own):
            return [[round(bent(values[y][x] * loss[y][x] * gains[y][x] / top * 3000)) for x in range(WIDTH)]
                    for y in range(HEIGHT)]
        self.write("bb.tif", tiff([counts(light, most["bb"])]))
        self.write("white.tif", tiff([counts(white, most["white"])]))
        self.write("flat.tif", tiff([[[round(bent(2500 * own[y][x])) for x in range(WIDTH)] for y in range(HEIGHT)]]))
        self.write("zero.tif", tiff([[[0] * WIDTH] * HEIGHT]))
        for time in (1, 2, 4, 6):
            self.write(f"w{time}.tif", tiff([[[round(bent(500.0 * time))] * WIDTH] * HEIGHT]))
        series = [f"{time} ms=w{time}.tif" for time in (1, 2, 4, 6)]
        words = (f"{temperature} K=bb.tif", "--camera", "camera.toml", "--dark", "zero.tif", "-o", "scale.toml", "--json")
        corrections = ("--white", "white.tif", "--flat", "flat.tif")

        def scale(*more):
            result = self.run_command("calibrate", "radiometry", *words, *more)
            self.assertEqual(result.returncode, 0, result.stderr)
            return json.loads(result.stdout)["channels"][0]
        # Without them the scale is off by the mean loss, in silence.
        plain = scale("--white", *series)
        self.assertGreater(plain["joules_per_count"] / joules, 1.2)
        # The blackbody fills the left part, which loses less than the others.
        found = scale("--white", "white.tif", *series, "--flat", "flat.tif", "--part", f"0,0,80,{HEIGHT}")
        self.assertLess(abs(found["curvature"] / k - 1), 0.02)
        # A picture that is imported with both is the light that went in; the white picture alone knows it up to
        # a factor, which is that of the pixel in the middle.
        imported = self.run_command("import", "bb.tif", "--camera", "camera.toml", "--dark", "zero.tif", *corrections,
                                    "--radiometry", "scale.toml", "-o", "a.exr", "--json")
        self.assertEqual((imported.returncode, imported.stderr), (0, ""))
        images = read_exr(self.path("a.exr"))[1]
        bright = [(y, x) for y in range(HEIGHT) for x in range(WIDTH) if light[y][x] > 0.8 * most["bb"]]
        ratios = [images["red"][y][x] / light[y][x] for y, x in bright]
        self.assertGreater(len(ratios), 1000)
        # Single pixels have the noise of two renderings.
        noise = math.sqrt(sum((r - 1) ** 2 for r in ratios) / len(ratios))
        self.assertLess(noise, 0.1)
        for half in (0, 1):
            of_half = [r for r, (_, x) in zip(ratios, bright) if (2 * x >= WIDTH) == half]
            self.assertLess(abs(sum(of_half) / len(of_half) - 1), 4 * noise / math.sqrt(len(of_half)))
        # A scale for pictures that are evened out is not for others, and the other way round.
        for more in ((), ("--white", "white.tif"), ("--flat", "flat.tif")):
            result = self.run_command("import", "bb.tif", "--camera", "camera.toml", "--dark", "zero.tif", *more,
                                      "--radiometry", "scale.toml", "-o", "b.exr")
            self.assertEqual((result.returncode, result.stderr.count("to both commands")), (0, 2 - len(more) // 2))
        self.write("short.tif", tiff([[[9] * WIDTH] * 3]))
        self.fails(1, "calibrate", "radiometry", *words, "--white", "short.tif", mentions=["short.tif", "260 x 3"])
        self.fails(2, "calibrate", "radiometry", *words[:3], "--dark", "0.1ms=zero.tif", "1ms=zero.tif", "-o", "b.toml",
                   "--white", "white.tif", mentions="--white-dark")

    def test_curvature_of_a_sensor(self):
        """Counts of whites at five exposures, bent by hand."""
        self.write("camera.toml", camera())
        self.write("bb.toml", camera(exposure="0.1 ms") + source(1700))
        self.succeeds("render", "bb.toml", "-o", "bb.exr", "--samples", "32", "--quiet")
        self.run_command("develop", "bb.exr", "-o", "bb.tif", "--sensor")
        self.write("zero.tif", tiff([[[0] * WIDTH] * HEIGHT]))
        k, words = 4e-5, []
        for exposure in (1, 2, 4, 6, 8):
            # c (1 + k c) = x
            x = 400.0 * exposure
            c = (math.sqrt(1 + 4 * k * x) - 1) / (2 * k)
            self.write(f"w{exposure}.tif", tiff([[[round(c)] * WIDTH] * HEIGHT]))
            words.append(f"{exposure} ms=w{exposure}.tif")
        result = self.run_command("calibrate", "radiometry", "1700 K@0.1 ms=bb.tif", "--camera", "camera.toml", "--dark",
                                  "zero.tif", "--white", *words, "-o", "a.toml", "--json")
        self.assertEqual(result.returncode, 0, result.stderr)
        (channel,) = json.loads(result.stdout)["channels"]
        self.assertLess(abs(channel["curvature"] / k - 1), 0.02)

    def test_what_is_refused(self):
        self.write("camera.toml", camera())
        self.write("a.tif", tiff([[[500] * WIDTH] * HEIGHT]))
        words = ("--camera", "camera.toml", "-o", "r.toml")
        self.fails(2, "calibrate", "radiometry", "a.tif", *words, mentions="1500K=a.tif")
        self.fails(2, "calibrate", "radiometry", "-5K=a.tif", *words, mentions="K")
        self.write("d.tif", tiff([[[600] * WIDTH] * HEIGHT]))
        self.fails(1, "calibrate", "radiometry", "1500K=a.tif", "--dark", "d.tif", *words, mentions="no brighter")
        self.fails(1, "calibrate", "radiometry", "1500K@2ms=a.tif", "--dark", "1ms=d.tif", *words,
                   mentions="as long as")
        self.write("r.toml", "columns = 3\nrows = 2\n[[channels]]\nname = \"red\"\njoules_per_count = -1\n")
        self.fails(1, "import", "a.tif", "--camera", "camera.toml", "--radiometry", "r.toml", "-o", "a.exr",
                   mentions=["r.toml:5", "joules_per_count"])


if __name__ == "__main__":
    main()
