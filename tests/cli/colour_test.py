"""Colour from the flame to numbers: channels, soot, the sensor's frames, colour pictures, two-colour temperatures."""

import math
import struct

from command import CommandTest, main
from exr import read_exr, read_png

H, C, K = 6.62607015e-34, 299792458.0, 1.380649e-23
TEMPERATURE = 1700


def planck(wavelength, temperature):
    return 2 * H * C * C / wavelength ** 5 / math.expm1(H * C / (wavelength * K * temperature))


def mean_planck(wavelength, width, temperature):
    """Over a band, by Simpson's rule."""
    n = 40
    f = [planck(wavelength + width * (i / n - 0.5), temperature) for i in range(n + 1)]
    return (f[0] + f[n] + 4 * sum(f[1:n:2]) + 2 * sum(f[2:n:2])) / (3 * n)


CAMERA = """[camera.lens]
model = "ideal"
focal_length = "100 mm"
diameter = "20 mm"
[camera.sensor]
columns = 40
rows = 30
pixel_pitch = "20 um"
%s
[camera.focus]
object_distance = "1 m"
conjugate = "sensor"
"""
# Two ellipsoids, 8 mm wide: every pixel sees the flame; of one temperature.
FLAME = """[[flames]]
position = ["1 m", "0 m", "0 m"]
[flames.spectrum]
%s
[[flames.layers]]
centre = ["0 m", "0 m", "0 m"]
semi_axes = ["20 mm", "20 mm", "20 mm"]
temperature = "1700 K"
%s
"""
SOOT = 'kind = "soot"\nreference = "650 nm"'
THIN = 'absorption = "0.1 1/m"'
RED = '[[channels]]\nname = "red"\nkind = "band"\nwavelength = "650 nm"\nwidth = "10 nm"\n'
INFRARED = '[[channels]]\nname = "ir"\nkind = "band"\nwavelength = "850 nm"\nwidth = "10 nm"\n'
XYZ = "".join('[[channels]]\nname = "%s"\nkind = "named"\nresponse = "cie_%s"\n' % (n, n.lower()) for n in "XYZ")


class Colour(CommandTest):
    def all_or_none(self, *arguments):
        """Where the larger of the last run's files has no room the other one is not written either."""
        names = ("t.exr", "t.png")
        written = {name: self.read(name) for name in names}
        limit = max(len(content) for content in written.values()) - 1
        for name in names:
            self.write(name, "old " + name)
        self.fails(1, *arguments, largest_file=limit, mentions="largest file size")
        for name in names:
            self.assertEqual(self.read(name), b"old " + name.encode())
            self.write(name, written[name])

    def render(self, scene, *options):
        self.write("a.toml", scene)
        self.succeeds("render", "a.toml", "--samples", "16", "--quiet", "-o", "raw.exr", *options)
        return read_exr(self.path("raw.exr"))[1]

    def scene(self, channels, sensor="", spectrum=SOOT, layer=THIN):
        return CAMERA % sensor + FLAME % (spectrum, layer) + channels

    # ---- channels ----

    def test_flux_is_that_of_soot(self):
        images = self.render(self.scene(RED + INFRARED))
        # On the axis, through the middle of the lens.
        ratio = images["red"][15][20] / images["ir"][15][20]
        tau = 0.1 * 40e-3
        expected = mean_planck(650e-9, 10e-9, TEMPERATURE) / mean_planck(850e-9, 10e-9, TEMPERATURE) \
            * math.expm1(-tau) / math.expm1(-tau * 650 / 850)
        # Within the stated error of standing for a band by one wavelength, and far from the thin limit.
        self.assertLess(abs(ratio / expected - 1), 2e-4)

    def test_a_volume_fraction_is_an_absorption(self):
        ppm = self.render(self.scene(RED, layer="volume_fraction = 4e-6"))["red"]
        kappa = 6 * math.pi * 0.26 * 4e-6 / 650e-9
        given = self.render(self.scene(RED, layer='absorption = "%r 1/m"' % kappa))["red"]
        self.assertLess(abs(ppm[15][20] / given[15][20] - 1), 1e-6)

    def test_a_curve_comes_with_the_image(self):
        self.write("curve.csv", "wavelength_nm,response\n640,0\n645,1\n655,1\n660,0\n")
        curve = '[[channels]]\nname = "curve"\nkind = "curve"\nfile = "curve.csv"\n'
        images = self.render(self.scene(RED + curve))
        # A trapezium of 15 nm.
        self.assertLess(abs(images["curve"][15][20] / images["red"][15][20] / 1.5 - 1), 2e-3)
        self.assertIn("645 nm 1", self.succeeds("info", "raw.exr", "--scene"))

    def test_truth_of_a_wide_channel_is_its_own(self):
        wide = '[[channels]]\nname = "wide"\nkind = "band"\nwavelength = "600 nm"\nwidth = "400 nm"\n'
        self.write("a.toml", self.scene(wide, layer='absorption = "5 1/m"'))
        self.succeeds("render", "a.toml", "--samples", "4", "--quiet", "--truth", "-o", "raw.exr")
        attributes, images = read_exr(self.path("raw.exr"))
        self.assertLess(abs(float(attributes["plenoflame.number.truth.wavelength"][1]) / 600e-9 - 1), 1e-12)
        # The absorption, 650 nm / wavelength, weighted with Planck's law; the chief ray at (20, 15) is a
        # fraction of a pixel away from the axis.
        n = 400
        at = [400e-9 + 400e-9 * (i + 0.5) / n for i in range(n)]
        light = [planck(w, 1700) for w in at]
        mean = sum(b * 650e-9 / w for b, w in zip(light, at)) / sum(light)
        self.assertLess(abs(images["truth.optical_depth"][15][20] / (5 * 40e-3 * mean) - 1), 1e-3)
        self.assertLess(abs(images["truth.temperature"][15][20] / TEMPERATURE - 1), 1e-6)

    # ---- the sensor ----

    SENSOR = 'exposure_time = "0.5 ms"\nquantum_efficiency = 0.5\nfull_well = 30000\nread_noise = 5\n' \
             'dark_current = 1000\nbits = 12\nblack_level = 50\ngain = 10'

    def electrons(self, image, column, row, seconds):
        return image[row][column] * seconds * 0.5 * 650e-9 / (H * C)

    def test_errors_of_a_frame_hold_those_of_its_rendering(self):
        images = self.render(self.scene(RED, self.SENSOR.replace("full_well = 30000", "full_well = 300000000")
                                        .replace("0.5 ms", "5 s")))
        self.succeeds("develop", "raw.exr", "--sensor", "-o", "e.exr")
        frame = read_exr(self.path("e.exr"))[1]
        squares = lambda image: sum(value * value for row in image for value in row)
        counted = sum(max(value, 0) + 25 for row in frame["red"] for value in row)
        # Electrons, of noise and of the rendering: as a whole they are those that it states.
        of_rays = squares([[self.electrons(images["red.error"], x, y, 5) for x in range(len(row))]
                           for y, row in enumerate(images["red.error"])])
        self.assertGreater(of_rays, 0.1 * counted)
        self.assertLess(abs(squares(frame["red.error"]) / (counted + of_rays) - 1), 1e-2)

    def test_digital_numbers_and_electrons(self):
        images = self.render(self.scene(RED + INFRARED, self.SENSOR))
        self.succeeds("develop", "raw.exr", "--noise", "dark", "-o", "a.png")
        rows = read_png(self.path("a.png"))[4]
        for column, row in ((20, 15), (3, 7)):
            mean = self.electrons(images["red"], column, row, 0.5e-3) + 0.5
            self.assertLessEqual(abs(rows[row][column] - (mean / 10 + 50)), 0.5001)
        self.succeeds("develop", "raw.exr", "--noise", "none", "-o", "e.exr")
        counted = read_exr(self.path("e.exr"))[1]
        self.assertLess(abs(counted["red"][15][20] / self.electrons(images["red"], 20, 15, 0.5e-3) - 1), 1e-5)
        self.assertLess(abs(counted["red.error"][15][20] - 0.0), 1e-30)
        infrared = images["ir"][15][20] * 0.5e-3 * 0.5 * 850e-9 / (H * C)
        self.assertLess(abs(counted["ir"][15][20] / min(infrared, 30000) - 1), 1e-5)

    def test_tiff_holds_the_same_numbers(self):
        self.render(self.scene(RED, self.SENSOR))
        self.succeeds("develop", "raw.exr", "--sensor", "-o", "a.png")
        self.succeeds("develop", "raw.exr", "--sensor", "-o", "a.tif", "--threads", "3")
        rows = read_png(self.path("a.png"))[4]
        data = self.read("a.tif")
        self.assertEqual(data[:4], b"II*\0")
        numbers = struct.pack("<1200H", *[n for row in rows for n in row])
        self.assertIn(numbers, data)
        self.assertIn(b"exposure 500 us", data)

    def test_read_noise_is_not_cut_off(self):
        """Frames of few electrons: half of the noise lies below 0."""
        sensor = 'full_well = 20000\nread_noise = 12\nbits = 12\nexposure_time = "1 ms"'
        self.render(self.scene(RED, sensor))
        figures = self.json_of("develop", "raw.exr", "--dark", "-o", "d.png")["frames"][0]
        values = [v for row in read_png(self.path("d.png"))[4] for v in row]
        mean = figures["gain"] * (sum(values) / len(values) - figures["black_level"])
        self.assertLess(abs(mean), 4 * 12.2 / math.sqrt(len(values)))
        self.assertLess(values.count(min(values)), 20)  # they do not pile up at the lower end
        self.assertEqual(self.json_of("develop", "raw.exr", "--noise", "none", "-o", "n.png")["frames"][0]["black_level"],
                         figures["black_level"])
        self.write("a.toml", self.scene(RED, sensor + "\nblack_level = 1"))
        result = self.run_command("info", "a.toml")
        self.assertEqual(result.returncode, 0)
        self.assertIn("camera.sensor.black_level leaves 4.89 electrons below it", result.stderr)
        self.assertIn("2.7 electrons too many", result.stderr)
        self.write("a.toml", self.scene(RED, sensor))
        self.assertNotIn("black_level", self.run_command("info", "a.toml").stderr)

    def test_series_and_dark_frames(self):
        self.render(self.scene(RED, self.SENSOR))
        figures = self.json_of("develop", "raw.exr", "--exposure", "0.2 ms,0.4 ms", "--frames", "2", "-o", "f.png")
        self.assertEqual([f["file"] for f in figures["frames"]],
                         ["f-200us-1.png", "f-200us-2.png", "f-400us-1.png", "f-400us-2.png"])
        means = [f["mean_electrons"] for f in figures["frames"]]
        self.assertLess(abs(means[2] / means[0] - 2), 0.02)
        self.assertNotEqual(self.read("f-200us-1.png"), self.read("f-200us-2.png"))
        dark = self.json_of("develop", "raw.exr", "--dark", "--exposure", "100 ms", "-o", "d.png")["frames"][0]
        self.assertLess(abs(dark["mean_electrons"] - 100), 4 * math.sqrt(125 / 1200))
        auto = self.json_of("develop", "raw.exr", "--exposure", "auto", "--noise", "none", "-o", "g.png")["frames"][0]
        self.assertEqual(auto["saturated_share"], 0)
        self.assertGreater(auto["mean_electrons"], 20000)

    def test_mosaic(self):
        names = "".join('[[channels]]\nname = "%s"\nkind = "named"\nresponse = "nikon_d5100_%s"\nphotons = true\n'
                        % (n, n) for n in ("red", "green", "blue"))
        images = self.render(self.scene(names, 'mosaic = "grbg"\nfull_well = 1e9\nexposure_time = "1 ms"'))
        self.succeeds("develop", "raw.exr", "--noise", "none", "-o", "e.exr")
        seen = read_exr(self.path("e.exr"))[1]
        raw = seen["sensor.raw"]
        # Green and red in the first row, blue and green in the second.
        for name, column, row in (("green", 10, 10), ("red", 11, 10), ("blue", 10, 11), ("green", 11, 11)):
            self.assertEqual(raw[row][column], seen[name][row][column])
            share = raw[row][column] / images[name][row][column]
            self.assertLess(abs(share / (raw[row + 2][column] / images[name][row + 2][column]) - 1), 1e-6)
        between = (raw[10][11] + raw[10][13]) / 2
        self.assertLess(abs(seen["red"][10][12] / between - 1), 1e-6)

    def test_means_of_full_pixels_have_no_temperature(self):
        names = "".join('[[channels]]\nname = "%s"\nkind = "named"\nresponse = "nikon_d5100_%s"\n' % (n, n)
                        for n in ("red", "green", "blue"))
        small = FLAME.replace('"20 mm", "20 mm", "20 mm"', '"2 mm", "20 mm", "1.5 mm"')
        self.render(CAMERA % 'mosaic = "rggb"\nfull_well = 2000\nread_noise = 3' + small % (SOOT, THIN) + names)
        for exposure in ("0.2 ms", "1 ms", "5 ms", "20 ms"):
            self.succeeds("develop", "raw.exr", "--sensor", "--exposure", exposure, "-o", "e.exr")
            attributes, images = read_exr(self.path("e.exr"))
            raw, limit = images["sensor.raw"], 2000 - 5 * 3
            # Red at even columns and rows, blue at odd ones; each pixel needs those next to it.
            count = means = 0
            for y in range(30):
                for x in range(40):
                    used = []
                    for odd in (0, 1):
                        ys = [y] if y % 2 == odd else [v for v in (y - 1, y + 1) if 0 <= v < 30]
                        xs = [x] if x % 2 == odd else [v for v in (x - 1, x + 1) if 0 <= v < 40]
                        used += [raw[v][u] for v in ys for u in xs]
                    count += max(used) >= limit
                    means += max(images["red"][y][x], images["blue"][y][x]) >= limit
            if 0 < means < count:
                break
        self.assertGreater(means, 0)
        self.assertGreater(count, means)
        self.assertEqual(self.json_of("pyrometry", "e.exr", "--channels", "red,blue")["saturated"], count)

    # ---- pictures ----

    def test_colour_picture(self):
        images = self.render(self.scene(XYZ))
        self.assertEqual(self.json_of("develop", "raw.exr", "--colour", "-o", "c.png")["colour"], "xyz")
        width, height, bits, channels, rows, _ = read_png(self.path("c.png"))
        self.assertEqual((width, height, bits, channels), (40, 30, 8, 3))
        white = sorted(v for row in images["Y"] for v in row)[-2]
        x, y, z = (images[n][15][20] / white for n in "XYZ")
        linear = (3.2406 * x - 1.5372 * y - 0.4986 * z, -0.9689 * x + 1.8758 * y + 0.0415 * z,
                  0.0557 * x - 0.2040 * y + 1.0570 * z)
        for c, value in enumerate(linear):
            v = min(max(value, 0), 1)
            v = 12.92 * v if v <= 0.0031308 else 1.055 * v ** (1 / 2.4) - 0.055
            self.assertLessEqual(abs(rows[15][3 * 20 + c] - 255 * v), 1.01)
        red, green, blue = rows[15][60:63]
        self.assertTrue(red > green > blue)

    # ---- temperatures ----

    def test_a_uniform_flame_has_its_temperature(self):
        for spectrum, law in ((SOOT, "as the scene's flames"), ('kind = "grey"', "grey, as the scene's flames")):
            self.render(self.scene(RED + INFRARED, spectrum=spectrum))
            figures = self.json_of("pyrometry", "raw.exr", "-o", "t.exr", "--picture", "t.png")
            self.all_or_none("pyrometry", "raw.exr", "--picture", "t.png", "-o", "t.exr")
            self.assertEqual(figures["law"], law)
            self.assertEqual(figures["pixels"], 1200)
            for key in ("mean_K", "lowest_K", "highest_K"):
                self.assertLess(abs(figures[key] / TEMPERATURE - 1), 1e-3)
            self.assertLess(abs(read_exr(self.path("t.exr"))[1]["temperature"][3][5] / TEMPERATURE - 1), 1e-3)
            self.assertEqual(read_png(self.path("t.png"))[:4], (40 + 4 + 12 + 52, 96, 8, 3))
        # The wrong law gives the wrong temperature: kappa too large by 850/650 in the red.
        wrong = self.json_of("pyrometry", "raw.exr", "--law", "soot")["mean_K"]
        c2 = H * C / K
        expected = 1 / (1 / TEMPERATURE + math.log(850 / 650) / (c2 * (1 / 650e-9 - 1 / 850e-9)))
        self.assertLess(abs(wrong / expected - 1), 1e-3)

    def test_noise_is_propagated(self):
        sensor = 'full_well = 1e9\nexposure_time = "1 ms"\nread_noise = 10\nquantum_efficiency = 0.02'
        self.render(self.scene(RED + INFRARED, sensor))
        self.succeeds("develop", "raw.exr", "--sensor", "-o", "e.exr")
        figures = self.json_of("pyrometry", "e.exr")
        # The standard deviation of 1200 pixels is known to 2 %.
        self.assertLess(abs(figures["deviation_K"] / figures["expected_deviation_K"] - 1), 0.08)
        self.assertGreater(figures["deviation_K"], 0.5)
        self.assertLess(abs(figures["mean_K"] - TEMPERATURE), 4 * figures["deviation_K"] / math.sqrt(1200) + 0.2)

    def test_the_colour_bar_has_numbers(self):
        self.render(self.scene(RED + INFRARED))
        self.succeeds("pyrometry", "raw.exr", "--picture", "t.png", "--range", "1650 K,1850 K")
        rows = read_png(self.path("t.png"))[4]
        bar, text = 3 * 44, 3 * 56
        self.assertEqual(rows[50][bar - 12:bar], [0] * 12)  # the gap
        self.assertGreater(min(rows[0][bar:bar + 3]), 200)  # white on top
        self.assertTrue(0 < rows[95][bar] < 100 and rows[95][bar + 1:bar + 3] == [0, 0])  # dark red below
        # Every 50 K a tick, and a number beside it: the tick is the only thing in the first three columns.
        ticks = [y for y, row in enumerate(rows) if min(row[text:text + 9]) == 255]
        self.assertEqual(ticks, [0, 24, 48, 72, 95])
        self.assertTrue(all(max(row[text:text + 9]) == 0 for y, row in enumerate(rows) if y not in ticks))
        for y in (24, 48, 72):
            self.assertGreater(sum(v > 128 for row in rows[y - 5:y + 5] for v in row[text + 18:text + 3 * 52:3]), 60)
        self.assertFalse(any(max(rows[y][text + 18:]) for y in (36, 60, 84)))

    def test_bins_have_less_noise(self):
        # Bright enough that the errors of single pixels are small, as the propagation takes them to be.
        sensor = 'full_well = 1e9\nexposure_time = "1 ms"\nread_noise = 10\nquantum_efficiency = 0.4'
        self.render(self.scene(RED + INFRARED, sensor))
        self.succeeds("develop", "raw.exr", "--sensor", "-o", "e.exr")
        single = self.json_of("pyrometry", "e.exr")
        figures = self.json_of("pyrometry", "e.exr", "--bin", "2", "-o", "t.exr")
        self.assertEqual((figures["pixels"], figures["bins"]), (1200, 300))
        self.assertLess(abs(figures["expected_deviation_K"] / single["expected_deviation_K"] * 2 - 1), 0.01)
        # The standard deviation of 300 is known to 4 %.
        self.assertLess(abs(figures["deviation_K"] / figures["expected_deviation_K"] - 1), 0.16)
        images = read_exr(self.path("t.exr"))[1]
        for name in ("temperature", "temperature.error"):
            block = {images[name][y][x] for y in (4, 5) for x in (6, 7)}
            self.assertEqual(len(block), 1)
        self.assertNotEqual(images["temperature"][4][6], images["temperature"][4][8])
        # Noise alone, bin by bin: against the flux from which the electrons were made.
        for words in ((), ("--bin", "2")):
            against = self.json_of("pyrometry", "e.exr", "--reference", "raw.exr", *words)
            self.assertLess(abs(against["reference_rms_over_expected"] - 1), 0.16)
            self.assertLess(abs(against["reference_mean_difference_K"]), against["expected_deviation_K"] / 4)
        exact = self.json_of("pyrometry", "raw.exr", "--reference", "raw.exr")
        self.assertEqual(exact["reference_rms_difference_K"], 0)
        self.succeeds("render", "a.toml", "-o", "part.exr", "--window", "0,0,8,8", "--samples", "4", "--quiet")
        self.fails(1, "pyrometry", "e.exr", "--reference", "part.exr", mentions="does not hold the same pixels")
        self.fails(2, "pyrometry", "e.exr", "--bin", "0", mentions="--bin")
        self.fails(2, "pyrometry", "e.exr", "--bin", "lens", mentions="--bin")
        self.fails(2, "pyrometry", "e.exr", "--bin", "micro-image", mentions="no microlens array")

    def test_micro_images_and_views_are_bins(self):
        camera = '[camera]\npreset = "raytrix-r29"\n[camera.sensor]\ncolumns = 96\nrows = 64\n' \
                 'quantum_efficiency = 0.5\nread_noise = 5\n'
        scene = camera + FLAME % (SOOT, 'absorption = "0.1 1/m"') + RED + INFRARED
        self.render(scene.replace('"20 mm", "20 mm", "20 mm"', '"90 mm", "90 mm", "90 mm"'), "--truth")
        self.succeeds("develop", "raw.exr", "--channel-exposure", "auto", "-o", "e.exr")
        figures = self.json_of("pyrometry", "e.exr", "--bin", "micro-image", "-o", "t.exr")
        self.assertLess(abs(figures["mean_K"] / TEMPERATURE - 1), 0.03)
        self.assertLess(abs(figures["mean_difference_K"]), 30)
        seen = read_exr(self.path("t.exr"))[1]["temperature"]
        self.succeeds("truth", "raw.exr", "-o", "micro.csv")
        lenses = [line.split(",") for line in self.read("micro.csv").decode().splitlines()[1:]]
        different = set()
        for _, _, _, column, row, radius in lenses:
            x, y, r = float(column), float(row), float(radius)
            if not (r < x < 96 - r and r < y < 64 - r):
                continue
            inside = {seen[v][u] for v in range(64) for u in range(96)
                      if math.hypot(u + 0.5 - x, v + 0.5 - y) < 0.9 * r} - {0.0}
            self.assertEqual(len(inside), 1)
            different |= inside
        self.assertGreaterEqual(len(different), 3)
        parts = self.json_of("pyrometry", "e.exr", "--bin", "view", "--cells", "2", "-o", "v.exr")
        self.assertTrue(2 * figures["bins"] < parts["bins"] <= 4 * figures["bins"])
        self.assertGreater(parts["expected_deviation_K"], 1.5 * figures["expected_deviation_K"])

    def test_channels_with_exposures_of_their_own(self):
        sensor = 'full_well = 20000\nquantum_efficiency = 0.4\nread_noise = 5\ndark_current = 1000'
        images = self.render(self.scene(RED + INFRARED, sensor), "--truth")
        frame = self.json_of("develop", "raw.exr", "--channel-exposure", "auto", "-o", "e.exr")["frames"][0]
        counted = read_exr(self.path("e.exr"))
        times = frame["exposure_times_s"]
        self.assertGreater(times["red"], 3 * times["ir"])
        for name in ("red", "ir"):
            mean = sum(map(sum, counted[1][name])) / 1200
            self.assertTrue(10000 < mean < 20000, (name, mean))
            expected = images[name][15][20] * times[name] * 0.4 * {"red": 650e-9, "ir": 850e-9}[name] / (H * C)
            self.assertLess(abs(counted[1][name][15][20] - expected - 1000 * times[name]), 5 * math.sqrt(expected + 25))
            said = counted[0]["plenoflame.number.sensor.exposure_time." + name][1]
            self.assertLess(abs(float(said) / times[name] - 1), 1e-12)
        # The ratio is that of the light, and the truth has come along.
        figures = self.json_of("pyrometry", "e.exr", "-o", "t.exr")
        self.assertLess(abs(figures["mean_K"] - TEMPERATURE), 4 * figures["deviation_K"] / math.sqrt(1200) + 1)
        self.assertLess(figures["rms_difference_K"], 1.5 * figures["expected_deviation_K"])
        self.assertEqual(counted[1]["truth.temperature"], images["truth.temperature"])
        self.assertEqual(read_exr(self.path("t.exr"))[1]["truth.temperature"], images["truth.temperature"])
        # Times by name; what is not named has the scene's.
        frame = self.json_of("develop", "raw.exr", "--channel-exposure", "red=2 ms,ir=0.25 ms", "-o", "e.exr")["frames"][0]
        self.assertEqual(frame["exposure_times_s"], {"red": 2e-3, "ir": 2.5e-4})
        self.assertEqual(self.json_of("develop", "raw.exr", "--channel-exposure", "ir=0.25 ms", "--channel", "ir", "-o",
                                      "f.png")["frames"][0]["exposure_time_s"], 2.5e-4)

        def refused(status, *arguments, mentions):
            self.fails(status, "develop", "raw.exr", "-o", "n.exr", *arguments, mentions=mentions)
        refused(2, "--channel-exposure", "2 ms", mentions=["--channel-exposure", "CHANNEL=TIME"])
        refused(2, "--channel-exposure", "red=0 s", mentions="above 0 s")
        refused(1, "--channel-exposure", "blue=1 ms", mentions=["blue", "red"])
        refused(2, "--channel-exposure", "auto", "--exposure", "1 ms", mentions="exclude")

    def test_saturated_pixels_have_no_temperature(self):
        # The infrared channel overflows in every pixel: without a word its ratio would be another temperature.
        sensor = 'full_well = 20000\nexposure_time = "1 ms"\nquantum_efficiency = 0.4'
        self.render(self.scene(RED + INFRARED, sensor))
        self.succeeds("develop", "raw.exr", "--sensor", "--exposure", "1 s", "-o", "e.exr")
        self.fails(1, "pyrometry", "e.exr", mentions="no temperature")
        self.succeeds("develop", "raw.exr", "--sensor", "--exposure", "auto", "-o", "e.exr")
        figures = self.json_of("pyrometry", "e.exr")
        self.assertEqual(figures["saturated"], 0)
        self.assertGreater(figures["pixels"], 100)

    # ---- what is refused ----

    def test_bad_curves(self):
        curve = '[[channels]]\nname = "c"\nkind = "curve"\nfile = "c.csv"\n'
        for text, mentions in (("650,1\n640,1\n", ["c.csv:2", "ascend"]), ("640,1\n650,-1\n", ["c.csv:2", "negative"]),
                               ("0.64,1\n0.65,1\n", ["c.csv:1", "is in um, it seems"]),
                               ("wavelength_um,r\n640,1\n650,1\n", ["c.csv:2", "is in nm, it seems"])):
            self.write("c.csv", text)
            self.write("a.toml", self.scene(curve))
            self.fails(1, "render", "a.toml", "-o", "a.exr", mentions=mentions)
        self.assertEqual(self.files(), ["a.toml", "c.csv"])

    def refused(self, scene, *mentions):
        self.write("a.toml", scene)
        self.fails(1, "info", "a.toml", mentions=["a.toml:", *mentions])

    def test_bad_values(self):
        self.refused(self.scene(RED, "full_well = 0"), "full_well", "above 0")
        self.refused(self.scene(RED, "black_level = 16383"), "black_level", "16383")
        self.refused(self.scene(RED, 'mosaic = "rggb"'), "three channels")
        self.refused(self.scene(RED, spectrum='kind = "soot"\nindex = "dalzell"\nreference = "900 nm"'),
                     "Dalzell", "435.8 nm")
        self.refused(self.scene(RED, spectrum='kind = "table"\ntable = "500 nm 1, 450 nm 2"'), "ascend")
        percent = '[[channels]]\nname = "q"\nkind = "curve"\nphotons = true\ncurve = "400 nm 20, 500 nm 52, 700 nm 30"\n'
        self.refused(self.scene(percent), "52", "percent", "divide its values by 100")
        self.refused(self.scene(RED, spectrum='kind = "grey"', layer="volume_fraction = 1e-6"), "soot")
        self.refused(self.scene('[[channels]]\nname = "a"\nkind = "named"\nresponse = "kodak"\n'), "nikon_d5100_red")
        self.refused(self.scene(RED.replace("band", "line").replace("10 nm", "700 nm")), "line filter")
        scattering = "[flames.scattering]\nalbedo = %s\n"
        for albedo, mentions in (("1.2", "albedo"), ("-0.1", "albedo"), ("1", "below 1")):
            self.refused(self.scene(scattering % albedo + RED), mentions)
        self.refused(self.scene("[camera.transmission]\nfilter = \"400 nm 1.2, 700 nm 1\"\n" + RED), "at most everything")
        glass = CAMERA.replace('focal_length = "100 mm"\ndiameter = "20 mm"',
                               'preset = "achromat-100mm"') % ""
        infrared = RED.replace("650 nm", "4 um")
        self.refused(glass + FLAME % (SOOT, THIN) + infrared, "N-BK7", "300 nm to 2.5 um")

    # ---- what the camera does to light of each wavelength ----

    def test_a_filter_dims_its_colours(self):
        open_images = self.render(self.scene(RED + INFRARED))
        filtered = "[camera.transmission]\nfilter = \"500 nm 0, 700 nm 1, 900 nm 0.2\"\n"
        images = self.render(self.scene(filtered + RED + INFRARED))
        self.assertLess(abs(images["red"][15][20] / open_images["red"][15][20] / 0.75 - 1), 2e-3)
        self.assertLess(abs(images["ir"][15][20] / open_images["ir"][15][20] / 0.4 - 1), 2e-3)
        # The ratio is that of filtered light.
        self.assertLess(abs(self.json_of("pyrometry", "raw.exr")["mean_K"] / TEMPERATURE - 1), 1e-3)
        self.write("a.toml", self.scene("[camera.transmission]\nfilter = \"400 nm 1, 500 nm 1\"\n" + RED))
        self.fails(1, "render", "a.toml", "-o", "a.exr", mentions=["a.toml:", "red", "lets nothing through"])

    def test_what_surfaces_reflect(self):
        open_images = self.render(self.scene(RED))
        cover = self.render(self.scene("[camera.transmission]\ncover_index = 1.5\n" + RED))
        # An ideal lens reflects nothing, the cover glass 0.04 at each face.
        self.assertLess(abs(cover["red"][15][20] / open_images["red"][15][20] / 0.96 ** 2 - 1), 1e-4)

    def test_bad_use(self):
        self.render(self.scene(RED))
        self.fails(1, "pyrometry", "raw.exr", mentions="two channels")
        self.fails(2, "develop", "raw.exr", "--colour", "--sensor", mentions="--colour")
        self.fails(2, "develop", "raw.exr", "--exposure", "5", mentions=["--exposure", "ms"])
        self.fails(1, "develop", "raw.exr", "--colour", mentions="three channels")
        self.render(self.scene('[[channels]]\nname = "total"\n', spectrum='kind = "grey"'))
        self.fails(1, "develop", "raw.exr", "--sensor", "-o", "a.tif", mentions="photon energy")


if __name__ == "__main__":
    main()
