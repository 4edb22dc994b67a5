"""plenoflame export of scenes with colour channels: pictures in colour, against the fluxes and the definition of sRGB."""

import os

from command import CommandTest, main
from exr import read_exr, read_png

SCENE = """[camera]
preset = "raytrix-r29"
[camera.sensor]
columns = 160
rows = 120
[[flames]]
position = ["1 m", "0 m", "0 m"]
[flames.spectrum]
kind = "grey"
[[flames.layers]]
centre = ["0 m", "0 m", "0 m"]
semi_axes = ["3 mm", "3 mm", "3 mm"]
temperature = "1800 K"
absorption = "10 1/m"
"""
BANDS = "".join('[[channels]]\nname = "%s"\nkind = "band"\nwavelength = "%d nm"\nwidth = "10 nm"\n' % (n, w)
                for n, w in (("ir", 850), ("red", 650), ("green", 620), ("blue", 590)))
XYZ = "".join('[[channels]]\nname = "c%s"\nkind = "named"\nresponse = "cie_%s"\n' % (n, n) for n in "xyz")


def srgb(linear):
    v = min(max(linear, 0), 1)
    return 12.92 * v if v <= 0.0031308 else 1.055 * v ** (1 / 2.4) - 0.055


class ExportColour(CommandTest):
    def render(self, channels):
        self.write("a.toml", SCENE + channels)
        self.succeeds("render", "a.toml", "--samples", "8", "--quiet", "-o", "raw.exr")
        return read_exr(self.path("raw.exr"))[1]

    def export(self, name, *options):
        return self.json_of("export", "raw.exr", "--format", name, "-o", name, "--force", *options)

    def picture(self, name):
        folder = self.path(name)
        (png,) = [f for f in os.listdir(folder) if f.endswith(".png") and "white" not in f]
        return read_png(os.path.join(folder, png))

    def agrees(self, picture, images, saturation, largest=255):
        width, _, bits, channels, rows, _ = picture
        self.assertEqual((bits, channels), (8, 3))
        lit = 0
        for y, row in enumerate(rows):
            for x in range(width):
                for c in range(3):
                    self.assertLessEqual(abs(row[3 * x + c] - largest * srgb(images[c][y][x] / saturation)), 0.51)
                lit += row[3 * x] > row[3 * x + 2] + 30
        self.assertGreater(lit, 500)

    def test_pictures_of_red_green_blue(self):
        images = self.render(BANDS)
        rgb = [images[n] for n in ("red", "green", "blue")]
        saturation = 0.5 * max(map(max, images["red"]))
        for name in ("libpleno", "plenoptic-toolbox"):
            figures = self.export(name, "--saturation", "%.17g W" % saturation)
            self.assertEqual(figures["colours"], ["red", "green", "blue"])
            self.agrees(self.picture(name), rgb, saturation)
        # In another order, or one channel in grey.
        self.assertEqual(self.export("libpleno", "--channels", "blue,green,red")["colours"], ["blue", "green", "red"])
        _, _, _, _, rows, _ = self.picture("libpleno")
        brightest = max(((x, y) for y in range(120) for x in range(160)), key=lambda p: images["red"][p[1]][p[0]])
        blue, _, red = rows[brightest[1]][3 * brightest[0]:3 * brightest[0] + 3]
        self.assertLess(blue, red)
        self.assertNotIn("colours", self.export("libpleno", "--channel", "ir"))
        _, _, _, channels, rows, _ = self.picture("libpleno")
        self.assertTrue(all(row[3 * x] == row[3 * x + 1] == row[3 * x + 2] for row in rows for x in range(160)))
        # Formats that hold one channel stay as they were.
        self.assertNotIn("colours", self.export("npz"))
        self.fails(2, "export", "raw.exr", "--format", "npz", "-o", "n", "--channels", "red,green,blue", mentions="one channel")
        self.fails(2, "export", "raw.exr", "--format", "hci", "-o", "n", "--channels", "red,green", mentions="three names")
        self.fails(1, "export", "raw.exr", "--format", "hci", "-o", "n", "--channels", "red,green,pink",
                   mentions=["pink", "it has: ir, red"])
        self.fails(2, "export", "raw.exr", "--format", "hci", "-o", "n", "--channels", "red,green,blue", "--channel", "ir",
                   mentions="--channel")

    def test_views_are_in_colour(self):
        self.render(BANDS)
        for name, pattern, bits in (("hci", "input_Cam012.png", 8), ("view-grid", "view_02_02.png", 16)):
            self.export(name, "--grid", "5")
            width, height, depth, channels, rows, _ = read_png(os.path.join(self.path(name), pattern))
            self.assertEqual((depth, channels), (bits, 3))
            colours = [max(max(row[c::3]) for row in rows) for c in range(3)]
            self.assertTrue(colours[0] > 1.05 * colours[1] > 1.05 ** 2 * colours[2], colours)
        self.export("eslf", "--grid", "5")
        (png,) = [f for f in os.listdir(self.path("eslf")) if f.endswith(".png")]
        _, _, _, channels, rows, _ = read_png(os.path.join(self.path("eslf"), png))
        self.assertGreater(max(max(row[0::3]) for row in rows), 1.05 * max(max(row[2::3]) for row in rows))

    def test_the_standard_observer_becomes_srgb(self):
        images = self.render(XYZ)
        self.assertEqual(self.export("libpleno", "--saturation", "1e-12 W")["colours"], ["cx", "cy", "cz"])
        saturation = 0.5 * max(map(max, images["cy"]))
        self.export("libpleno", "--saturation", "%.17g W" % saturation)
        matrix = ((3.2406, -1.5372, -0.4986), (-0.9689, 1.8758, 0.0415), (0.0557, -0.2040, 1.0570))
        rgb = [[[sum(m * images[n][y][x] for m, n in zip(row, ("cx", "cy", "cz"))) for x in range(160)]
                for y in range(120)] for row in matrix]
        self.agrees(self.picture("libpleno"), rgb, saturation)

    def test_bands_of_other_names_are_no_colours(self):
        self.render(BANDS.replace("red", "650nm").replace("green", "620nm"))
        self.assertNotIn("colours", self.export("libpleno"))


if __name__ == "__main__":
    main()
