"""plenoflame views and refocus: files, figures, and what bad input gets."""

import os

from command import CommandTest, main
from exr import read_exr, read_png, write_exr, write_light_field

SCENE = """[camera]
preset = "paper-previous-60x60"
[camera.sensor]
columns = 100
rows = 80
"""


class Views(CommandTest):
    def setUp(self):
        super().setUp()
        # Brighter to the right.
        flux = [[1e-9 * (column + 1) for column in range(100)] for _ in range(80)]
        write_light_field(self.path("raw.exr"), flux, scene=SCENE)
        self.write("scene.toml", SCENE)

    def test_views(self):
        figures = self.json_of("views", "raw.exr", "-o", "out", "--grid", "3", "--exr", "--raw-flux")
        names = ["view_%02d_%02d" % (r, c) for r in range(3) for c in range(3)]
        expected = ["contact"] + names
        self.assertEqual(sorted(os.listdir(self.path("out"))), sorted(n + e for n in expected for e in (".png", ".exr")))
        width, height, bits, channels, rows, _ = read_png(self.path("out/view_01_01.png"))
        self.assertEqual([width, height], figures["size"])
        self.assertEqual((bits, channels), (16, 1))
        inner = rows[height // 2][1:-1]
        self.assertEqual(inner, sorted(inner))
        self.assertLess(inner[0], inner[-1])
        offsets = {(v["row"], v["column"]): v["offset_pixels"] for v in figures["views"]}
        self.assertEqual(offsets[1, 1], [0, 0])
        self.assertGreater(offsets[1, 2][0], 0)
        sheet = read_png(self.path("out/contact.png"))
        self.assertEqual(sheet[:2], (3 * width + 2, 3 * height + 2))
        info = self.json_of("info", "out/view_00_00.exr")
        self.assertEqual(info["window"][2:] if "window" in info else [width, height], [width, height])

    def test_sheet_only_and_force(self):
        self.succeeds("views", "raw.exr", "-o", "out", "--grid", "2", "--sheet-only")
        self.assertEqual(os.listdir(self.path("out")), ["contact.png"])
        before = self.read("out/contact.png")
        self.fails(1, "views", "raw.exr", "-o", "out", mentions=["'out'", "--force"])
        self.assertEqual(self.read("out/contact.png"), before)
        self.succeeds("views", "raw.exr", "-o", "out", "--grid", "3", "--sheet-only", "--force")
        self.assertNotEqual(self.read("out/contact.png"), before)

    def test_camera_from_a_scene_file(self):
        write_light_field(self.path("plain.exr"), [[1e-9] * 100] * 80)
        self.fails(1, "views", "plain.exr", "-o", "out", mentions=["plain.exr", "scene"])
        self.succeeds("views", "plain.exr", "-o", "out", "--scene", "scene.toml", "--sheet-only")
        write_light_field(self.path("other.exr"), [[1e-9] * 90] * 80)
        self.fails(1, "views", "other.exr", "-o", "o2", "--scene", "scene.toml", mentions=["100 x 80", "90 x 80"])

    def test_picture_from_elsewhere(self):
        rows = [[1e-9 * (column + 1) for column in range(100)] for _ in range(80)]
        write_exr(self.path("elsewhere.exr"), (100, 80), (0, 0, 100, 80), {"Y": rows}, {"plenoflame.format": 1})
        self.fails(1, "views", "elsewhere.exr", "-o", "out", mentions=["plenoflame.scene", "--scene"])
        write_exr(self.path("elsewhere.exr"), (100, 80), (0, 0, 100, 80), {"Y": rows}, {})
        self.fails(1, "views", "elsewhere.exr", "-o", "out", mentions=["plenoflame.format", "--scene"])
        figures = self.json_of("views", "elsewhere.exr", "-o", "out", "--scene", "scene.toml", "--grid", "3", "--exr")
        self.assertEqual(figures["channel"], "Y")
        self.succeeds("views", "raw.exr", "-o", "own", "--grid", "3", "--exr")
        self.assertEqual(*(read_png(self.path(name + "/view_01_01.png"))[:5] for name in ("out", "own")))

    def test_epipolar_slices(self):
        figures = self.json_of("views", "raw.exr", "-o", "out", "--grid", "3", "--epipolar-row", "4",
                               "--epipolar-column", "2")
        width, height = figures["size"]
        views = [[read_png(self.path("out/view_%02d_%02d.png" % (r, c)))[4] for c in range(3)] for r in range(3)]
        across, down = (read_png(self.path("out/epipolar_%s.png" % name)) for name in ("row", "column"))
        self.assertEqual((across[0], across[1]), (width, 3))
        self.assertEqual((down[0], down[1]), (height, 3))
        self.assertEqual(across[4], [views[1][c][4] for c in range(3)])
        self.assertEqual(down[4], [[row[2] for row in views[r][1]] for r in range(3)])
        self.fails(1, "views", "raw.exr", "-o", "o", "--epipolar-row", "99", mentions=["row 99", "%d x" % width])
        self.fails(1, "views", "raw.exr", "-o", "o", "--type", "none", mentions=["none", "type1"])
        self.assertFalse(os.path.exists(self.path("o")))

    def test_bad_use(self):
        self.fails(2, "views", "raw.exr", mentions="--output")
        self.fails(2, "views", "raw.exr", "-o", "o", "--resampling", "best", mentions="--resampling")
        self.fails(2, "views", "raw.exr", "-o", "o", "--grid", "0", mentions="--grid")
        self.fails(1, "views", "raw.exr", "-o", "o", "--resampling", "paper9", mentions="hexagonal")
        self.fails(1, "views", "none.exr", "-o", "o", mentions="none.exr")
        self.fails(1, "views", "raw.exr", "-o", "o/p", mentions="o/p")
        self.fails(1, "views", "raw.exr", "-o", "scene.toml", mentions="not a folder")
        write_light_field(self.path("bare.exr"), [[0.0] * 30] * 20,
                          scene='[camera]\n[camera.lens]\nmodel = "ideal"\nfocal_length = "50 mm"\ndiameter = "10 mm"\n'
                          '[camera.sensor]\ncolumns = 30\nrows = 20\npixel_pitch = "10 um"\n'
                          '[camera.focus]\nobject_distance = "1 m"\nconjugate = "sensor"\n')
        self.fails(1, "views", "bare.exr", "-o", "o", mentions=["bare.exr", "no microlens array"])
        self.assertFalse(os.path.exists(self.path("o")))

    def test_refocus(self):
        figures = self.json_of("refocus", "raw.exr", "-o", "one", "--depth", "1 m", "--exr")
        self.assertEqual(sorted(os.listdir(self.path("one"))), ["refocus_1.0000m.exr", "refocus_1.0000m.png"])
        self.assertEqual(figures["pictures"][0]["depth"], 1.0)
        rows = read_png(self.path("one/refocus_1.0000m.png"))[4]
        self.assertLess(rows[3][2], rows[3][-3])
        self.succeeds("refocus", "raw.exr", "-o", "stack", "--depths", "0.9m:1.1m:3", "--size", "24")
        self.assertEqual(sorted(os.listdir(self.path("stack"))),
                         ["refocus_000_0.9000m.png", "refocus_001_1.0000m.png", "refocus_002_1.1000m.png"])
        self.assertEqual(read_png(self.path("stack/refocus_001_1.0000m.png"))[0], 24)
        # The picture that is sharp everywhere, and a depth map.
        self.succeeds("refocus", "raw.exr", "-o", "sharp", "--depths", "0.9m:1.1m:3", "--all-in-focus", "--all-types")
        self.assertEqual(sorted(n for n in os.listdir(self.path("sharp")) if not n.startswith("refocus")),
                         ["all_in_focus.png", "depth.exr", "depth.png"])
        attributes, images = read_exr(self.path("sharp/depth.exr"))
        self.assertEqual(attributes["plenoflame.unit"], ("string", b"m"))
        self.assertEqual(sorted(images), ["confidence", "depth"])
        for value in (value for row in images["depth"] for value in row):
            self.assertTrue(value == 0 or 0.899 < value < 1.101)
        # A result is not a raw image.
        self.fails(1, "views", "one/refocus_1.0000m.exr", "-o", "o", "--scene", "scene.toml", mentions="not a raw image")

    def test_refocus_bad_use(self):
        def refused(status, *arguments, mentions):
            self.fails(status, "refocus", "raw.exr", "-o", "o", *arguments, mentions=mentions)
        refused(2, mentions=["--depth", "--depths"])
        refused(2, "--depth", "1 m", "--depths", "1m:2m:3", mentions="--depth")
        refused(2, "--depth", "1", mentions=["--depth", "unit"])
        refused(2, "--depths", "1m:2m", mentions="FIRST:LAST:COUNT")
        refused(2, "--depths", "1m:2m:x", mentions="FIRST:LAST:COUNT")
        refused(2, "--depth", "1 m", "--all-in-focus", mentions=["--all-in-focus", "3 depths"])
        refused(2, "--depths", "1.1m:0.9m:5", "--all-in-focus", mentions="nearest first")
        refused(1, "--depth=-1 m", mentions="behind")
        refused(1, "--depth", "10 mm", mentions="front focal plane")
        refused(1, "--depth", "1 m", "--channel", "red", mentions="red")
        self.assertFalse(os.path.exists(self.path("o")))


if __name__ == "__main__":
    main()
