"""Temperatures of measured pictures: dark, white and blackbody pictures and those of a flame, as a laboratory with two filters
has them, go through import and pyrometry. What is recorded is made here, by Planck's law, of an invented sensor; the program
only says how much light each pixel can get (render --white).
"""

import json
import math
import random

from command import CommandTest, main
from exr import read_exr
from raw_pictures import tiff

C2 = 6.62607015e-34 * 299792458.0 / 1.380649e-23
WIDTH, HEIGHT = 100, 80
BLACKBODY, TEMPERATURE = 1500, 1820
GAIN, READ_NOISE, BLACK = 2.0, 5.0, 100
# Wavelength, counts of the brightest pixel from the blackbody in 1 ms, and exposures of blackbody and flame in ms.
CHANNELS = {"red": (650e-9, 150.0, 12, 5), "ir": (850e-9, 1600.0, 1, 0.6)}
THIN = 0.3  # the flame's share of a blackbody's light, the same in both channels: grey
CAMERA = """[camera.lens]
model = "ideal"
focal_length = "50 mm"
diameter = "11 mm"
[camera.array]
lattice = "square"
model = "ideal"
pitch = "110 um"
diameter = "105 um"
sensor_distance = "0.45 mm"
[[camera.array.types]]
name = "lens"
focal_length = "0.45 mm"
[camera.sensor]
columns = 100
rows = 80
pixel_pitch = "5.5 um"
bits = 12
gain = 2
read_noise = 5
full_well = 7600
[camera.focus]
object_distance = "0.5 m"
"""
LINE = '[[channels]]\nname = "%s"\nkind = "line"\nwavelength = "%d nm"\nwidth = "1 nm"\n'


def planck(wavelength, temperature):
    return 1 / math.expm1(C2 / (wavelength * temperature))


class MeasuredPyrometry(CommandTest):
    def setUp(self):
        super().setUp()
        random.seed(20261126)
        self.write("camera.toml", CAMERA + "".join(LINE % (n, round(1e9 * c[0])) for n, c in CHANNELS.items()))
        self.succeeds("render", "camera.toml", "--white", "--samples", "64", "--quiet", "-o", "white.exr")
        white = read_exr(self.path("white.exr"))[1]["red"]
        most = max(map(max, white))
        # Dust and unequal pixels, which the white picture knows.
        self.light = [[white[y][x] / most * random.uniform(0.8, 1) for x in range(WIDTH)] for y in range(HEIGHT)]
        self.recorded("white.tif", lambda x, y: 1500 * self.light[y][x], frames=8)
        self.recorded("dark.tif", lambda x, y: 0, frames=8)
        lit = [(x, y) for y in range(HEIGHT) for x in range(35, WIDTH) if self.light[y][x] > 0.5]
        self.bad, self.full = lit[100:102] + [lit[700]], lit[400:402]
        self.write("bad.csv", "column,row\n" + "".join(f"{x},{y}\n" for x, y in self.bad))
        for name, (wavelength, brightest, long, short) in CHANNELS.items():
            self.recorded(f"bb-{name}.tif", lambda x, y, b=brightest * long: b * self.light[y][x], frames=8)
            ratio = THIN * planck(wavelength, TEMPERATURE) / planck(wavelength, BLACKBODY)

            def flame(x, y, c=brightest * short * ratio, name=name):
                # Left of column 30 there is no flame. A defect that glows in one channel would be another temperature.
                if (x, y) in self.bad:
                    return 1500 if name == "red" else 20
                if (x, y) in self.full and name == "ir":
                    return 1e6
                return c * self.light[y][x] if x >= 30 else 0
            self.recorded(f"flame-{name}.tif", flame, frames=4)

    def recorded(self, name, counts, frames):
        """Frames of so many counts above dark, with the noise of their electrons."""
        def number(mean):
            electrons = random.gauss(GAIN * mean, math.sqrt(GAIN * mean + READ_NOISE ** 2))
            return min(4095, max(0, round(min(electrons, 7600) / GAIN + BLACK)))
        self.write(name, tiff([[[number(counts(x, y)) for x in range(WIDTH)] for y in range(HEIGHT)]
                               for _ in range(frames)], rows_per_strip=HEIGHT))

    def json_of(self, *words):
        result = self.run_command(*words, "--json")
        self.assertEqual(result.returncode, 0, result.stderr)
        return json.loads(result.stdout)

    def calibrated(self):
        for name, (_, _, long, _) in CHANNELS.items():
            self.json_of("calibrate", "radiometry", f"{BLACKBODY}K@{long}ms=bb-{name}.tif", "--dark", "dark.tif",
                         "--channel", name, "--camera", "camera.toml", "--temperature-error", "1 K", "-o", f"{name}.toml")
        return [word for name in CHANNELS for word in ("--radiometry", f"{name}.toml")]

    def imported(self, *words):
        times = [word for name, c in CHANNELS.items() for word in ("--exposure-time", f"{name}={c[3]} ms")]
        return self.json_of("import", "red=flame-red.tif", "ir=flame-ir.tif", "--camera", "camera.toml", "--dark",
                            "dark.tif", "--white", "white.tif", "--defects", "bad.csv", *times, "-o", "flame.exr", *words)

    def test_temperature_of_a_flame(self):
        figures = self.imported(*self.calibrated())
        self.assertEqual((figures["unit"], figures["saturated"], figures["defective"]), ("W", 2, figures["defective"]))
        # Beside those of the list some at edges of micro-images, where the white picture is darker than a camera can be.
        self.assertTrue(3 <= figures["defective"] < 30, figures)
        for words in ((), ("--bin", "micro-image")):
            found = self.json_of("pyrometry", "flame.exr", "-o", "t.exr", "--threshold", "0.2", *words)
            self.assertEqual((found["saturated"], found["defective"]), (2, figures["defective"]))
            self.assertGreater(found["pixels"], 1000)
            # Counts know the mean to a kelvin; the furnace's kelvin makes more of each channel's scale.
            scale = found["scale_error_K"]
            by_hand = math.hypot(*(C2 / (c[0] * BLACKBODY ** 2) for c in CHANNELS.values()))
            slope = C2 * (1 / 650e-9 - 1 / 850e-9) / TEMPERATURE ** 2
            self.assertLess(abs(scale / (by_hand / slope) - 1), 0.2, found)
            self.assertLess(abs(found["mean_K"] - TEMPERATURE), 3, found)
            temperatures = read_exr(self.path("t.exr"))[1]["temperature"]
            if not words:
                self.assertTrue(all(not temperatures[y][x] > 0 for x, y in self.bad + self.full))
                self.assertLess(abs(found["deviation_K"] / found["expected_deviation_K"] - 1), 0.3, found)

    def test_counts_and_electrons_count_photons(self):
        # Without a scale the sensor is taken for equally sensitive to both channels' photons.
        def apparent(ratio):
            return C2 * (1 / 850e-9 - 1 / 650e-9) / math.log(ratio * (650e-9 / 850e-9) ** 5)
        rates = [c[1] * planck(c[0], TEMPERATURE) / planck(c[0], BLACKBODY) for c in CHANNELS.values()]
        # Power is photons by wavelength.
        expected = apparent(rates[0] / rates[1] * 850 / 650)
        for unit in ("e-", "DN"):
            figures = self.imported("--unit", unit)
            found = self.json_of("pyrometry", "flame.exr", "--threshold", "0.2")
            self.assertLess(abs(found["mean_K"] / expected - 1), 3e-3, (unit, found))
            self.assertEqual((found["saturated"], found["defective"]), (2, figures["defective"]))

    def test_what_is_refused(self):
        words = ("import", "red=flame-red.tif", "ir=flame-ir.tif", "--camera", "camera.toml", "-o", "a.exr")
        scales = self.calibrated()
        self.fails(2, *words, *scales, "--exposure-time", "red=1ms", mentions=["ir", "--exposure-time"])
        self.fails(2, *words, "--exposure-time", "1ms", "--exposure-time", "2ms", mentions=["--exposure-time", "NAME=TIME"])
        self.fails(1, *words, "--exposure-time", "1ms", "--radiometry", "red.toml", "--radiometry", "red.toml",
                   mentions=["two of the files", "red"])
        self.fails(1, *words, "--exposure-time", "1ms", "--radiometry", "red.toml", mentions=["ir", "red.toml"])
        self.succeeds(*words)
        self.fails(1, "pyrometry", "a.exr", mentions=["without an exposure time", "--exposure-time"])


if __name__ == "__main__":
    main()
