"""import: files of every kind, counts to electrons and watts with their errors, what is refused."""

import json
import math
import random
import struct
import zlib

from command import CommandTest, main
from exr import read_exr
from raw_pictures import headerless, jpeg, pgm, png, tiff

WIDTH, HEIGHT = 37, 23

SENSOR = """[camera.lens]
model = "ideal"
focal_length = "100 mm"
diameter = "25 mm"
[camera.focus]
object_distance = "0.75 m"
conjugate = "sensor"
[camera.sensor]
columns = {columns}
rows = {rows}
pixel_pitch = "10 um"
"""
LINE = '[[channels]]\nname = "{0}nm"\nkind = "line"\nwavelength = "{0} nm"\nwidth = "10 nm"\n'


def camera(sensor="", columns=WIDTH, rows=HEIGHT, channels=(650,)):
    return SENSOR.format(columns=columns, rows=rows) + sensor + "".join(LINE.format(c) for c in channels)


def numbers(bits, seed=1):
    random.seed(seed)
    return [[random.randrange(1 << bits) for _ in range(WIDTH)] for _ in range(HEIGHT)]


def poisson(mean):
    """A number of Poisson's law: by multiplication where that is short, else nearly normal."""
    if mean > 200:
        return max(0, round(random.gauss(mean, math.sqrt(mean))))
    limit, count, product = math.exp(-mean), 0, random.random()
    while product > limit:
        product *= random.random()
        count += 1
    return count


class Import(CommandTest):
    def imported(self, *words, output="field.exr"):
        """Figures, and images of the light field."""
        result = self.run_command("import", *words, "-o", output, "--json")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.warnings = result.stderr
        return json.loads(result.stdout), read_exr(self.path(output))[1]

    def same(self, value, expected, share):
        self.assertLess(abs(value / expected - 1), share)

    def counts_of(self, name, content, *words):
        self.write(name, content)
        return self.imported(name, "--camera", "a.toml", "--unit", "DN", *words)[1]["650nm"]

    def test_every_kind_of_file_holds_the_same_counts(self):
        self.write("a.toml", camera('bits = 16\nfull_well = 1e9\n'))
        for bits in (16, 12, 8):
            rows = numbers(bits)
            files = {
                "strips.tif": (tiff([rows], bits),), "big.tif": (tiff([rows], bits, order=">"),),
                "tiles.tif": (tiff([rows], bits, tile=(16, 16)),),
                "deflate.tif": (tiff([rows], bits, deflate=True, rows_per_strip=HEIGHT),),
                "one.tif": (tiff([rows], bits, rows_per_strip=HEIGHT),),
                "white0.tif": (tiff([[[(1 << bits) - 1 - v for v in row] for row in rows]], bits, photometric=0),),
                "a.pgm": (pgm(rows, (1 << bits) - 1),),
                "a.raw": (headerless([rows], "<", bits), "--size", f"{WIDTH}x{HEIGHT}", "--bits", str(bits)),
                "b.raw": (b"head" + headerless([rows], ">", bits), "--size", f"{WIDTH}x{HEIGHT}", "--bits",
                          str(bits), "--endian", "big", "--skip", "4"),
            }
            if bits != 12:
                files["a.png"] = (png(rows, bits),)
            else:
                files["s.png"] = (png([[v << 4 | v >> 8 for v in row] for row in rows], 16, significant=12),)
                files["moved.tif"] = (tiff([[[v << 4 for v in row] for row in rows]], 16), "--shift", "4")
            for name, (content, *words) in files.items():
                self.assertEqual(self.counts_of(name, content, *words), rows, (name, bits))

    def test_colours_planes_and_pages(self):
        self.write("a.toml", camera('bits = 16\nfull_well = 1e9\n', channels=(650, 550, 450)))
        planes = [numbers(16, seed) for seed in (1, 2, 3)]
        rows = [[v for pixel in zip(*lines) for v in pixel] for lines in zip(*planes)]
        for words in ({}, {"planar": True}, {"planar": True, "tile": (16, 32)}, {"tile": (32, 16)}):
            self.write("a.tif", tiff([rows], channels=3, **words))
            images = self.imported("a.tif", "--camera", "a.toml", "--unit", "DN")[1]
            self.assertEqual([images[f"{c}nm"] for c in (650, 550, 450)], planes, words)
        # Pages are frames, as files are.
        self.write("pages.tif", tiff(planes))
        figures, images = self.imported("pages.tif", "--camera", "a.toml", "--unit", "DN", "--channel", "550nm")
        self.assertEqual(figures["frames"], 3)
        for y in range(HEIGHT):
            for x in range(WIDTH):
                self.same(images["550nm"][y][x], sum(plane[y][x] for plane in planes) / 3, 1e-6)
        for c, plane in zip((650, 550), planes):
            self.write(f"{c}.tif", tiff([plane]))
        images = self.imported("650nm=650.tif", "550nm=550.tif", "--camera", "a.toml", "--unit", "DN")[1]
        self.assertEqual((images["650nm"], images["550nm"]), (planes[0], planes[1]))
        self.fails(2, "import", "other=650.tif", "--camera", "a.toml", "-o", "b.exr",
                   mentions="other=650.tif: the camera's file has no channel 'other'; it has 650nm, 550nm, 450nm")

    def test_jpeg_is_read_with_a_warning(self):
        def picture(blocks, c=None):
            return [[blocks[y // 8][x // 8] if c is None else blocks[y // 8][x // 8][c] for x in range(WIDTH)]
                    for y in range(HEIGHT)]
        self.write("a.toml", camera("bits = 8\n"))
        blocks = [[(37 * x + 91 * y) % 256 for x in range(5)] for y in range(3)]
        blocks[0][1], blocks[2][4] = 0, 255
        self.assertEqual(self.counts_of("a.jpg", jpeg(blocks, WIDTH, HEIGHT)), picture(blocks))
        self.assertIn("'a.jpg' was packed with losses", self.warnings)
        self.assertEqual(self.warnings.count("warning:"), 1)
        self.write("c.toml", camera("bits = 8\n", channels=(650, 550, 450)))
        blocks = [[(9 * x, 255 - 11 * y, 100 + x * y) for x in range(5)] for y in range(3)]
        self.write("c.jpg", jpeg(blocks, WIDTH, HEIGHT))
        images = self.imported("c.jpg", "--camera", "c.toml", "--unit", "DN")[1]
        self.assertEqual([images[f"{name}nm"] for name in (650, 550, 450)], [picture(blocks, c) for c in range(3)])

    def test_turned(self):
        rows = numbers(8)
        self.write("a.toml", camera("bits = 8\n"))
        self.write("b.toml", camera("bits = 8\n", HEIGHT, WIDTH))
        self.write("a.tif", tiff([rows], 8))

        def turned(scene, *words):
            return self.imported("a.tif", "--camera", scene, "--unit", "DN", *words)[1]["650nm"]
        self.assertEqual(turned("a.toml", "--turn", "180"), [row[::-1] for row in rows[::-1]])
        self.assertEqual(turned("a.toml", "--mirror"), [row[::-1] for row in rows])
        self.assertEqual(turned("b.toml", "--turn", "90"), [list(row) for row in zip(*rows[::-1])])
        self.assertEqual(turned("b.toml", "--turn", "270"), [list(row) for row in zip(*rows)][::-1])

    def test_electrons_watts_and_errors(self):
        # A sensor written anew: light from 20 to 4000 electrons, dark level 100, read noise 6, gain 2.5,
        # pixels of unequal sensitivity.
        gain, read, black, frames, dark_frames = 2.5, 6.0, 100, 5, 20
        self.write("a.toml", camera(f'bits = 12\ngain = {gain}\nread_noise = {read}\nfull_well = 9900\n'
                                    'quantum_efficiency = 0.6\nfill_factor = 0.9\nexposure_time = "4 ms"\n'))
        random.seed(7)
        light = [[20 + 4000 * (x / WIDTH) ** 2 for x in range(WIDTH)] for _ in range(HEIGHT)]
        own = [[random.gauss(1, 0.1) for _ in range(WIDTH)] for _ in range(HEIGHT)]

        def frame(factor):
            return [[round((poisson(max(0, light[y][x] * own[y][x] * factor)) + random.gauss(0, read)) / gain + black)
                     for x in range(WIDTH)] for y in range(HEIGHT)]
        self.write("a.tif", tiff([frame(1) for _ in range(frames)]))
        self.write("d.tif", tiff([frame(0) for _ in range(dark_frames)]))
        flat = [[round(poisson(7500 * own[y][x]) / gain + black) for x in range(WIDTH)] for y in range(HEIGHT)]
        self.write("flat.tif", tiff([flat]))
        words = ("a.tif", "--camera", "a.toml", "--dark", "d.tif", "--flat", "flat.tif")
        figures, images = self.imported(*words)
        middle = sorted(v for row in own for v in row)[WIDTH * HEIGHT // 2]
        squares = [((images["650nm"][y][x] - middle * light[y][x]) / images["650nm.error"][y][x]) ** 2
                   for y in range(HEIGHT) for x in range(WIDTH)]
        # The mean of so many squares scatters by sqrt(2 / n) = 0.05.
        self.same(sum(squares) / len(squares), 1, 0.2)
        self.assertEqual(figures["unit"], "e-")
        # The scatter of the series knows the gain by itself.
        self.assertLess(abs(figures["series_slope"] - 1 / gain), 4 * figures["series_slope_error"])
        for source in ("series",):
            other = self.imported(*words, "--noise", source)[1]
            ratios = [a / b for p, q in zip(other["650nm.error"], images["650nm.error"]) for a, b in zip(p, q)]
            self.same(sum(ratios) / len(ratios), 1, 0.1)
        # Energy of a photon, from its textbook formula.
        watt = 6.62607015e-34 * 299792458 / 650e-9 / (0.6 * 0.9) / 4e-3
        watts = self.imported(*words, "--unit", "W")[1]
        for y in range(HEIGHT):
            for x in range(WIDTH):
                self.same(watts["650nm"][y][x], images["650nm"][y][x] * watt, 1e-4)

    def test_each_channel_has_its_own_curvature(self):
        """Counts c of a channel of J joules a count and curvature k, exposed for t, are J c (1 + k c) / t."""
        names, k, j, time = ("650nm", "550nm", "450nm"), (6e-5, -2e-5, 1e-5), (2e-16, 3e-16, 5e-16), 2e-3
        sensor = 'bits = 16\ngain = 1\nfull_well = 1e9\nexposure_time = "2 ms"\n'
        self.write("a.toml", camera(sensor, channels=(650, 550, 450)))
        self.write("m.toml", camera(sensor + 'mosaic = "rggb"\n', channels=(650, 550, 450)))
        self.write("scale.toml", f"columns = {WIDTH}\nrows = {HEIGHT}\n" + "".join(
            f'[[channels]]\nname = "{name}"\njoules_per_count = {of}\nrelative_error = 0.01\ncurvature = {bend}\n'
            for name, of, bend in zip(names, j, k)))

        def light(c, counts):
            return j[c] * counts * (1 + k[c] * counts) / time
        counts = (3000, 5000, 7000)
        words = ("--radiometry", "scale.toml", "--black-level", "0")
        self.write("a.tif", tiff([[[c for _ in range(WIDTH) for c in counts]] * HEIGHT], channels=3))
        images = self.imported("a.tif", "--camera", "a.toml", *words)[1]
        for c, name in enumerate(names):
            self.same(images[name][4][5], light(c, counts[c]), 1e-6)
        colour = [[((0, 1), (1, 2))[y % 2][x % 2] for x in range(WIDTH)] for y in range(HEIGHT)]
        self.write("m.tif", tiff([[[counts[c] for c in row] for row in colour]]))
        images = self.imported("m.tif", "--camera", "m.toml", *words)[1]
        for c, name in enumerate(names):
            self.same(images[name][4][5], light(c, counts[c]), 1e-6)
        # The counts of a flat field are bent as those of the picture are: of the same light, the picture is even.
        def bent(c, linear):
            return (math.sqrt(1 + 4 * k[c] * linear) - 1) / (2 * k[c])
        self.write("a.tif", tiff([[[round(bent(c, 4000 * (1 + x / WIDTH))) for x in range(WIDTH) for c in range(3)]]
                                  * HEIGHT], channels=3))
        images = self.imported("a.tif", "--camera", "a.toml", *words, "--flat", "a.tif")[1]
        for c, name in enumerate(names):
            # A count of 4000 is rounded by half of one.
            for x in (0, WIDTH // 2, WIDTH - 1):
                self.same(images[name][4][x], images[name][4][WIDTH // 3], 2e-4)

    def test_numbers_that_no_sensor_has(self):
        self.write("a.toml", camera('bits = 12\ngain = 2\nblack_level = 64\nfull_well = 9000\nexposure_time = "1 ms"\n'))
        self.write("a.tif", tiff([[[100 + 10 * x for x in range(WIDTH)] for _ in range(HEIGHT)]]))
        words = ("import", "a.tif", "--camera", "a.toml", "-o", "x.exr")
        for options, status, mentions in ((("--gain", "1e300"), 2, ["--gain", "1e+09", "1e300"]),
                                          (("--exposure-time", "1e9 s"), 2, ["--exposure-time", "1e+06 s"]),
                                          (("--read-noise", "1e8"), 2, "--read-noise"),
                                          (("--saturation", "1"), 1, ["100 % of the pixels of 'a.tif' are full (1 counts"]),
                                          (("--saturation", "50", "--dark", "a.tif"), 1, "full"),
                                          (("-o", "x.png"), 2, "--output")):
            self.fails(status, *words, *options, mentions=mentions)
        scale = f'columns = {WIDTH}\nrows = {HEIGHT}\n[[channels]]\nname = "650nm"\njoules_per_count = {{}}\ncurvature = {{}}\n'
        for joules, curvature, mentions in (("1e300", "0", "joules_per_count must be a number from 1e-30 to 1"), ("-1", "0", "joules_per_count"),
                                            ("1e-18", "1e300", "curvature must be a number from -0.1 to 0.1"), ("1e-18", "nan", "curvature")):
            self.write("scale.toml", scale.format(joules, curvature))
            self.fails(1, *words, "--radiometry", "scale.toml", mentions=["scale.toml:", mentions])
        self.write("scale.toml", scale.format("1e-18", "0").replace(f"columns = {WIDTH}", "columns = 1e300"))
        self.fails(1, *words, "--radiometry", "scale.toml", mentions=["scale.toml:1", "columns"])
        self.assertNotIn("x.exr", self.files())

    def test_the_ending_says_what_is_written(self):
        self.write("a.toml", camera())
        self.write("a.tif", tiff([[[100] * WIDTH for _ in range(HEIGHT)]]))
        for name in ("x.png", "x", "x.toml"):
            self.fails(2, "import", "a.tif", "--camera", "a.toml", "-o", name, mentions=["-o", name, ".exr"])
        for words in (("camera", "import", "a.toml"), ("calibrate", "geometry", "c.csv", "--camera", "a.toml"),
                      ("calibrate", "white", "a.tif", "--camera", "a.toml"), ("calibrate", "rig", "a.toml=p.csv"),
                      ("calibrate", "radiometry", "1500 K=a.tif", "--camera", "a.toml")):
            self.fails(2, *words, "-o", "x.png", mentions=["-o", "x.png", ".toml"])

    def test_no_furnace_is_so_hot_and_no_pixel_so_wide(self):
        self.write("a.toml", camera())
        self.write("a.tif", tiff([[[100] * WIDTH for _ in range(HEIGHT)]]))
        self.fails(2, "calibrate", "radiometry", "1e9 K=a.tif", "--camera", "a.toml", "-o", "x.toml", mentions=["100000 K", "1e9 K"])
        self.fails(2, "calibrate", "white", "a.tif", "--pixel-pitch", "5.5 m", "-o", "x.toml", mentions=["--pixel-pitch", "1 cm", "5.5 m"])

    def test_a_dark_frame_is_no_flat_field(self):
        self.write("a.toml", camera("bits = 12\ngain = 2\nblack_level = 100\nfull_well = 8000\n"))
        self.write("a.tif", tiff([[[100 + 10 * x for x in range(WIDTH)] for _ in range(HEIGHT)]]))
        self.write("d.tif", tiff([[[100] * WIDTH for _ in range(HEIGHT)]]))
        self.fails(1, "import", "a.tif", "--camera", "a.toml", "--dark", "d.tif", "--flat", "d.tif", "-o", "x.exr",
                   mentions=["100 % of the pixels", "flat field", "dark frame"])

    def test_values_are_shown_in_the_pictures_unit(self):
        self.write("a.toml", camera("bits = 12\ngain = 2\nblack_level = 100\nfull_well = 8000\n"))
        self.write("a.tif", tiff([[[100 + 10 * x for x in range(WIDTH)] for _ in range(HEIGHT)]]))
        self.imported("a.tif", "--camera", "a.toml")  # twice as many electrons as counts above black
        text = self.succeeds("compare", "field.exr", "field.exr")
        self.assertRegex(text, rf"mean flux: +{2 * 10 * sum(range(WIDTH)) / (WIDTH - 1):.4g} e-, reference")
        self.assertRegex(text, "largest difference: +0 e-")
        text = self.succeeds("develop", "field.exr", "-o", "field.png")
        self.assertRegex(text, r"saturation: +[\d.]+ e- per pixel")

    def test_pixels_that_say_nothing(self):
        self.write("a.toml", camera('bits = 12\ngain = 1\nfull_well = 4000\n'))
        rows = [[100 + x for x in range(WIDTH)] for _ in range(HEIGHT)]
        rows[5][6], rows[7][8] = 4095, 0
        dark = [[0] * WIDTH for _ in range(HEIGHT)]
        dark[9][10] = 50
        self.write("a.tif", tiff([rows]))
        self.write("d.tif", tiff([dark]))
        self.write("bad.csv", "column,row\n8,7\n")
        figures, images = self.imported("a.tif", "--camera", "a.toml", "--defects", "bad.csv")
        state = images["sensor.state"]
        self.assertEqual((state[5][6], state[7][8], sum(map(sum, state))), (2, 1, 3))
        self.assertEqual((figures["saturated"], figures["defective"]), (1, 1))
        self.same(images["650nm"][7][8], 108, 1e-5)
        self.write("map.pgm", pgm([[255 * ((x, y) == (8, 7)) for x in range(WIDTH)] for y in range(HEIGHT)], 255))
        self.assertEqual(self.imported("a.tif", "--camera", "a.toml", "--defects", "map.pgm")[1], images)
        state = self.imported("a.tif", "--camera", "a.toml", "--dark", "d.tif", "--defects", "auto")[1]["sensor.state"]
        self.assertEqual((state[9][10], sum(map(sum, state))), (1, 3))

    def test_mosaic(self):
        self.write("a.toml", camera('bits = 12\ngain = 2\nfull_well = 9000\nmosaic = "grbg"\n',
                                    channels=(620, 540, 460)))
        colour = [[(1, 0), (2, 1)][y % 2][x % 2] for y in range(HEIGHT) for x in range(WIDTH)]
        rows = [[(301, 201, 101)[colour[y * WIDTH + x]] for x in range(WIDTH)] for y in range(HEIGHT)]
        self.write("a.tif", tiff([rows]))
        images = self.imported("a.tif", "--camera", "a.toml")[1]
        for name, value in (("620nm", 602), ("540nm", 402), ("460nm", 202)):
            self.assertTrue(all(abs(v - value) < 1e-3 * value for row in images[name] for v in row), name)
        self.assertEqual(images["sensor.raw"], [[2 * v for v in row] for row in rows])
        self.fails(1, "import", "a.tif", "--camera", "a.toml", "-o", "b.exr", "--channel", "620nm",
                   mentions="mosaic")

    def test_what_is_refused_leaves_nothing(self):
        self.write("a.toml", camera("bits = 12\ngain = 1\n"))
        rows = numbers(12)
        whole = tiff([rows])
        good = ("--camera", "a.toml", "-o", "field.exr")

        def refused(name, content, mentions, *words, status=1):
            with self.subTest(name=name, mentions=mentions):
                self.write(name, content)
                before = self.files()
                self.fails(status, "import", name, *good, *words, mentions=mentions)
                self.assertEqual(self.files(), before)
        refused("a.tif", whole[:len(whole) // 2], ["a.tif", "cut off"])
        refused("a.tif", tiff([rows], extra=[(339, 3, [3])]), "floating-point")
        refused("a.tif", tiff([rows], photometric=5), "palettes")
        refused("a.tif", tiff([rows], extra=[(274, 3, [3])]), "Orientation")
        refused("a.png", png(rows)[:300], "damaged PNG")
        refused("a.pgm", pgm(rows, 4095)[:300], "cut off")
        refused("a.pgm", b"P5\n100000 100000\n255\n", "cut off")
        # A header of a gigapixel in a file of a hundred bytes.
        huge = tiff([[[0]]]).replace(struct.pack("<HHII", 256, 4, 1, 1), struct.pack("<HHII", 256, 4, 1, 30000))
        refused("a.tif", huge.replace(struct.pack("<HHII", 257, 4, 1, 1), struct.pack("<HHII", 257, 4, 1, 30000)),
                "cut off")
        refused("a.jpg", b"\xff\xd8\xff\xe0" + b"x" * 100, ["a.jpg", "damaged JPEG"])
        packed = jpeg([[50 + 20 * x + y for x in range(5)] for y in range(3)], WIDTH, HEIGHT)
        refused("a.jpg", packed[:-8], ["a.jpg", "damaged JPEG, or cut off"])
        refused("a.jpg", packed[:len(packed) // 2], ["a.jpg", "damaged JPEG, or cut off"])
        size = struct.pack(">HH", HEIGHT, WIDTH)
        refused("a.jpg", packed.replace(size, struct.pack(">HH", 30000, 30000)), "cut off")
        refused("a.dat", b"x" * 100, "--size")
        refused("a.exr", b"\x76\x2f\x31\x01" + b"x" * 100, "needs no import")
        refused("a.dat", b"", "empty")
        refused("a.dat", b"x" * 100, "100 bytes", "--size", "10x8", "--bits", "12")
        refused("a.dat", b"\xff" * 16, "largest of 12", "--size", "4x2", "--bits", "12")
        refused("a.tif", tiff([rows[:5]]), ["37 x 5", "37 x 23", "--window"])
        refused("a.tif", tiff([rows, rows[:5]]), "page 2")
        refused("a.tif", whole, "--exposure-time", "--unit", "W", status=2)
        refused("a.tif", whole, "several frames", "--noise", "series", status=2)
        refused("a.tif", whole, "dark frames", "--defects", "auto", status=2)
        refused("a.tif", whole, "WxH", "--size", "3", status=2)

    def test_a_png_of_few_bits_packs_tightly(self):
        """Stripes of one bit shrink to a thousandth of what they are read as: no sign of damage."""
        columns, rows = 1600, 800
        line = b"\0" + b"\xff\0" * (columns // 16)
        def chunk(kind, content):
            return struct.pack(">I", len(content)) + kind + content + struct.pack(">I", zlib.crc32(kind + content))
        content = (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", columns, rows, 1, 0, 0, 0, 0)) +
                   chunk(b"IDAT", zlib.compress(line * rows, 9)) + chunk(b"IEND", b""))
        self.assertLess(len(content), columns * rows / 1032)
        self.write("a.toml", camera("bits = 8\n", columns=columns, rows=rows))
        counts = self.counts_of("a.png", content)
        self.assertEqual([row[:24] for row in counts[:2]], [[255] * 8 + [0] * 8 + [255] * 8] * 2)

    def test_the_black_level_has_its_unit(self):
        self.write("a.toml", camera("bits = 12\ngain = 1\nblack_level = 70\n"))
        self.write("a.tif", tiff([numbers(12)]))
        self.imported("a.tif", "--camera", "a.toml")
        self.assertRegex(self.run_command("info", "field.exr").stdout, r"sensor\.black_level: +70 counts\n")

    def test_what_is_probably_not_meant_is_said(self):
        self.write("a.toml", camera("bits = 16\ngain = 1\nfull_well = 1e9\n"))
        self.write("a.tif", tiff([[[v << 4 for v in row] for row in numbers(12)]]))
        self.imported("a.tif", "--camera", "a.toml")
        self.assertIn("--shift 4", self.warnings)
        self.write("b.tif", tiff([[[100] * WIDTH] * HEIGHT]))
        self.write("d.tif", tiff([[[500] * WIDTH] * HEIGHT]))
        self.imported("b.tif", "--camera", "a.toml", "--dark", "d.tif")
        self.assertIn("below 0", self.warnings)


if __name__ == "__main__":
    main()
