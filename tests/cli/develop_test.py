"""plenoflame develop: pictures against the definition, computed here; messages; no half-written files."""

import os
import struct

from command import CommandTest, main
from exr import read_png, write_exr, write_light_field


def single(value):
    """Rounded to single precision, as an EXR stores it."""
    return struct.unpack("<f", struct.pack("<f", value))[0]


def srgb(linear):
    return 12.92 * linear if linear <= 0.0031308 else 1.055 * linear ** (1 / 2.4) - 0.055


class Develop(CommandTest):
    def setUp(self):
        super().setUp()
        self.flux = [[1e-9 * (3 * x + 7 * y * y) for x in range(11)] for y in range(6)]
        write_light_field(self.path("raw.exr"), self.flux, sensor=(40, 30), origin=(5, 4))

    def expected(self, saturation, bits, curve):
        largest = 2 ** bits - 1
        rows = []
        for row in self.flux:
            numbers = [min(largest, int(single(f) / saturation * largest + 0.5)) for f in row]
            rows.append([int(65535 * curve(n / largest) + 0.5) for n in numbers])
        return rows

    def test_linear(self):
        for bits in (1, 8, 12, 14, 16):
            self.succeeds("develop", "raw.exr", "-o", "a.png", "--saturation", "150 nW", "--bits", str(bits), "--curve",
                          "linear")
            width, height, depth, channels, rows, chunks = read_png(self.path("a.png"))
            self.assertEqual((width, height, depth, channels), (11, 6, 16, 1))
            self.assertEqual(rows, self.expected(150e-9, bits, lambda v: v))
            self.assertEqual(chunks["gAMA"], struct.pack(">I", 100000))
            self.assertEqual(chunks["sBIT"], bytes([bits]))

    def test_display_is_the_default(self):
        self.succeeds("develop", "raw.exr", "--saturation", "0.2uW")
        *_, rows, chunks = read_png(self.path("raw.png"))
        self.assertIn("sRGB", chunks)
        for row, expected in zip(rows, self.expected(200e-9, 14, srgb)):
            for sample, value in zip(row, expected):
                self.assertLessEqual(abs(sample - value), 1)

    def test_automatic_exposure_and_figures(self):
        figures = self.json_of("develop", "raw.exr", "-o", "a.png")
        brightest = single(self.flux[5][10])
        self.assertEqual(figures["saturation_W"], brightest)
        self.assertTrue(figures["automatic_exposure"])
        self.assertEqual(figures["pixels_with_light"], 65)
        self.assertEqual(figures["saturated_share"], 1 / 66)
        self.assertEqual(figures["size"], [11, 6])
        self.assertEqual(figures, self.json_of("develop", "raw.exr", "-o", "a.png", "--saturation", "auto"))
        text = self.succeeds("develop", "raw.exr", "-o", "a.png", "--saturation", "100 nW")
        self.assertRegex(text, r"saturation: +100 nW per pixel\n")
        self.assertRegex(text, r"saturated: +\S+ % of all pixels\n")

    def test_scene_gives_the_defaults(self):
        scene = "[develop]\nsaturation = \"150 nW\"\nbits = 10\ncurve = \"linear\"\n"
        write_light_field(self.path("raw.exr"), self.flux, scene=scene)
        self.succeeds("develop", "raw.exr", "-o", "a.png")
        self.assertEqual(read_png(self.path("a.png"))[4], self.expected(150e-9, 10, lambda v: v))
        self.succeeds("develop", "raw.exr", "-o", "a.png", "--bits", "6", "--saturation", "100 nW")
        self.assertEqual(read_png(self.path("a.png"))[4], self.expected(100e-9, 6, lambda v: v))
        figures = self.json_of("develop", "raw.exr", "-o", "a.png", "--saturation", "auto", "--curve", "display")
        self.assertEqual((figures["automatic_exposure"], figures["bits"], figures["curve"]), (True, 10, "display"))
        write_light_field(self.path("raw.exr"), self.flux, scene="[develop\n")
        result = self.run_command("develop", "raw.exr", "-o", "a.png")
        self.assertEqual(result.returncode, 0)
        self.assertRegex(result.stderr, r"\Aplenoflame: warning: [^\n]+\n\Z")

    def test_dark_image_warns(self):
        write_light_field(self.path("dark.exr"), [[0.0] * 4] * 3)
        result = self.run_command("develop", "dark.exr")
        self.assertEqual(result.returncode, 0)
        self.assertIn("plenoflame: warning: ", result.stderr)
        self.assertEqual(read_png(self.path("dark.png"))[4], [[0] * 4] * 3)

    def test_bad_use(self):
        def refused(*arguments, mentions):
            self.fails(2, "develop", "raw.exr", *arguments, mentions=mentions)
        refused("--bits", "0", mentions="--bits")
        refused("--bits", "17", mentions="--bits")
        refused("--bits", "many", mentions="--bits")
        refused("--curve", "log", mentions=["--curve", "linear"])
        refused("--saturation", "5000", mentions=["--saturation", "nW"])
        refused("--saturation", "5 m", mentions=["--saturation", "W"])
        refused("--saturation", "0 W", mentions=["--saturation", "auto"])
        refused("--saturation", "-1 nW", mentions="--saturation")
        refused("--saturation", "nan W", mentions="--saturation")
        refused("-o", "raw.exr", mentions="reads")
        os.symlink("raw.exr", self.path("link.exr"))
        refused("-o", "link.exr", mentions="reads")
        self.fails(2, "develop", mentions="RAW")
        self.fails(2, "develop", "raw.exr", "other.exr", mentions="other.exr")
        self.assertEqual(self.files(), ["link.exr", "raw.exr"])

    def test_bad_input(self):
        self.fails(1, "develop", "none.exr", mentions=["none.exr", "No such file"])
        self.fails(1, "develop", "raw.exr", "--channel", "650nm", mentions=["650nm", "it has: total"])
        self.write("text.exr", "not a picture")
        self.fails(1, "develop", "text.exr", mentions=["text.exr", "not an EXR"])
        write_exr(self.path("foreign.exr"), (3, 2), (0, 0, 3, 2), {"Y": [[1.0] * 3] * 2}, {})
        self.fails(1, "develop", "foreign.exr", mentions="'plenoflame.format' is missing")
        write_light_field(self.path("newer.exr"), [[1.0]], format=3)
        self.fails(1, "develop", "newer.exr", mentions="format 3")
        write_light_field(self.path("nan.exr"), [[1.0, 1.0], [1.0, float("nan")]], sensor=(9, 9), origin=(3, 5))
        self.fails(1, "develop", "nan.exr", mentions="column 4, row 6")
        data = self.read("raw.exr")
        self.write("cut.exr", data[:-100])
        self.fails(1, "develop", "cut.exr", mentions="cut.exr")
        self.assertFalse([name for name in self.files() if not name.endswith(".exr")])

    def test_nothing_is_half_written(self):
        self.succeeds("develop", "raw.exr", "-o", "a.png")
        before = self.read("a.png")
        self.fails(1, "develop", "raw.exr", "-o", "a.png", "--saturation", "1 nW", largest_file=60,
                   mentions=["a.png", "largest file size"])
        self.fails(1, "develop", "raw.exr", "-o", "none/a.png", mentions="none' does not exist")
        os.mkdir(self.path("folder"))
        self.fails(1, "develop", "raw.exr", "-o", "folder", mentions="it is a folder")
        os.symlink("/dev/null", self.path("null.png"))
        self.fails(1, "develop", "raw.exr", "-o", "null.png", mentions="regular")
        self.assertEqual(self.read("a.png"), before)
        self.assertEqual(self.files(), ["a.png", "folder", "null.png", "raw.exr"])


if __name__ == "__main__":
    main()
