"""plenoflame flame: what it writes and prints, wrong options; info of what it wrote."""

import math
import os
import signal
import subprocess

import command
from command import CommandTest, main

LAYERS = """
[[layers]]
name = "ball"
centre = ["0 mm", "0 mm", "10 mm"]
semi_axes = ["8 mm", "6 mm", "5 mm"]
temperature = "1500 K"
absorption = "20 1/m"
"""

SCENE = """
[camera.lens]
model = "ideal"
focal_length = "50 mm"
diameter = "20 mm"
[camera.sensor]
columns = 24
rows = 32
pixel_pitch = "0.1 mm"
[camera.focus]
object_distance = "1 m"
conjugate = "sensor"
[[flames]]
kind = "vdb"
file = "a.vdb"
position = ["1 m", "0 mm", "-16 mm"]
[[flames.lines]]
kind = "ch"
width = "1 nm"
[[flames.lines]]
kind = "na_d"
[[channels]]
name = "blue"
kind = "band"
wavelength = "431 nm"
width = "20 nm"
[[channels]]
name = "yellow"
kind = "band"
wavelength = "589 nm"
width = "10 nm"
"""


class Flame(CommandTest):
    def grids(self, *arguments):
        figures = self.json_of("flame", *arguments, "-o", "a.vdb")
        self.assertEqual(figures["size_bytes"], os.path.getsize(self.path("a.vdb")))
        self.assertEqual(self.files(), ["a.vdb"] + [f for f in self.files() if f.endswith(".toml")])
        return {grid["name"]: grid for grid in figures["grids"]}

    def test_every_flame(self):
        for name, size in (("layered", "1mm"), ("candle", "1 mm"), ("diffusion", "1 mm"), ("cylinder", "8 mm"),
                           ("turbulent", "5 mm")):
            grids = self.grids(name, "--voxel-size", size)
            self.assertEqual(sorted(grids), ["absorption", "temperature"])
            self.assertEqual(grids["temperature"]["unit"], "K")
            self.assertEqual(grids["absorption"]["unit"], "1/m")
            self.assertEqual(grids["absorption"]["background"], 0)
            self.assertGreater(grids["temperature"]["maximum"], 1400)
            self.assertLess(grids["temperature"]["maximum"], 2100)
            self.assertGreater(grids["temperature"]["voxels"], grids["absorption"]["voxels"])
            self.assertEqual(grids["absorption"]["voxel_size_m"] * 1000, float(size[0]))

    def test_layers_from_a_file(self):
        with open(self.path("layers.toml"), "w", encoding="utf-8") as file:
            file.write(LAYERS)
        grids = self.grids("layered", "--layers", "layers.toml", "--voxel-size", "0.5 mm")
        self.assertEqual(grids["absorption"]["maximum"], 20)
        # Samples that a layer touches: those within a voxel of the ellipsoid.
        voxels = 4 / 3 * math.pi * 8 * 6 * 5 / 0.5 ** 3
        self.assertGreater(grids["absorption"]["voxels"], voxels)
        self.assertLess(grids["absorption"]["voxels"], 4 / 3 * math.pi * 8.9 * 6.9 * 5.9 / 0.5 ** 3)
        self.assertEqual(grids["absorption"]["lower_m"][0] * 1000, -8)

    def test_half_and_compression(self):
        sizes = {}
        for options in ((), ("--half",), ("--compression", "none"), ("--compression", "zip", "--half")):
            self.grids("candle", "--voxel-size", "1 mm", *options)
            sizes[options] = os.path.getsize(self.path("a.vdb"))
        self.assertLess(sizes[("--half",)], sizes[()])
        self.assertLess(sizes[()], sizes[("--compression", "none")])
        self.assertLess(sizes[("--compression", "zip", "--half")], sizes[("--compression", "none")])

    def test_options_of_the_soot(self):
        low = self.grids("candle", "--voxel-size", "1 mm")["absorption"]["maximum"]
        high = self.grids("candle", "--voxel-size", "1 mm", "--soot-function", "0.39", "--wavelength",
                          "325 nm")["absorption"]["maximum"]
        self.assertLess(abs(high / low - 3), 1e-5)  # E(m)/lambda: 1.5 times 2

    def test_lines(self):
        grids = self.grids("candle", "--voxel-size", "0.5 mm", "--line", "ch", "--line", "na_d=2 kW/m^3")
        self.assertEqual(sorted(grids), ["CH*", "Na_D", "absorption", "temperature"])
        self.assertEqual({grids[name]["unit"] for name in ("CH*", "Na_D")}, {"W/m^3"})
        # Near the base, at a rim that no sample meets exactly.
        self.assertTrue(60 < grids["CH*"]["maximum"] <= 100)
        self.assertLess(abs(grids["Na_D"]["maximum"] / grids["CH*"]["maximum"] / 20 - 1), 1e-5)
        info = self.json_of("info", "a.vdb")
        self.assertEqual(info["lines"], [{"grid": "CH*", "kind": "ch"}, {"grid": "Na_D", "kind": "na_d"}])
        self.write("a.toml", SCENE)
        flame = self.json_of("info", "a.toml")["flames"][0]
        self.assertEqual([line["kind"] for line in flame["lines"]], ["ch", "na_d"])
        self.assertLess(abs(flame["lines"][0]["seen"]["blue"] - 1), 1e-9)
        self.assertEqual(flame["lines"][0]["seen"]["yellow"], 0)
        self.assertEqual(flame["lines"][1]["seen"], {"blue": 0, "yellow": 1})
        self.succeeds("render", "a.toml", "-o", "a.exr", "--samples", "4", "--quiet")
        for options, mentions in ((["--line", "ch=2 m"], "needs a peak above 0 with its unit"),
                                  (["--line", "x"], "known are ch"),
                                  (["--line", "ch", "--line", "ch"], "given twice")):
            self.fails(2, "flame", "candle", *options, "-o", "b.vdb", mentions=["--line", mentions])
        self.fails(2, "flame", "turbulent", "--line", "ch", "-o", "b.vdb", mentions="does not apply to the flame")

    def test_seeds_differ_and_repeat(self):
        contents = []
        for seed in ("1", "2", "1"):
            self.grids("turbulent", "--voxel-size", "5 mm", "--seed", seed)
            figures = self.json_of("info", "a.vdb")
            contents.append([(g["minimum"], g["maximum"], g["voxels"]) for g in figures["grids"]])
        self.assertEqual(contents[0], contents[2])
        self.assertNotEqual(contents[0], contents[1])

    def test_text(self):
        text = self.succeeds("flame", "candle", "--voxel-size", "1 mm", "-o", "a.vdb")
        self.assertIn("a.vdb: flame candle", text)
        self.assertIn("voxels of 1 mm", text)

    def test_info(self):
        self.grids("candle", "--voxel-size", "1 mm")
        figures = self.json_of("info", "a.vdb")
        self.assertEqual((figures["type"], figures["temperature_grid"], figures["absorption_grid"], figures["remarks"]),
                         ("flame", "temperature", "absorption", []))
        self.assertEqual(figures["grids"][0]["index_to_world"]["linear"], [[0.001, 0, 0], [0, 0.001, 0], [0, 0, 0.001]])
        text = self.succeeds("info", "a.vdb")
        self.assertIn("grid temperature", text)
        self.assertIn("absorption from", text)

    def test_damaged_file(self):
        self.grids("candle", "--voxel-size", "2 mm")
        with open(self.path("a.vdb"), "rb") as file:
            content = file.read()
        with open(self.path("b.vdb"), "wb") as file:
            file.write(content[: len(content) // 2])
        self.fails(1, "info", "b.vdb", mentions=["b.vdb", "ends too early"])

    def test_wrong_options(self):
        out = ("-o", "a.vdb")
        self.fails(2, "flame", "bonfire", *out, mentions="bonfire")
        self.fails(2, "flame", "candle", mentions="--output")
        self.fails(2, "flame", "candle", *out, "--voxel-size", "1", mentions=["--voxel-size", "mm"])
        self.fails(2, "flame", "candle", *out, "--voxel-size", "0 mm", mentions="--voxel-size")
        self.fails(2, "flame", "candle", *out, "--seed", "3", mentions=["--seed", "candle"])
        for seed in ("-1", "1.5", "99999999999999999999"):
            self.fails(2, "flame", "turbulent", *out, "--seed", seed, mentions=["--seed", seed])
        for share in ("9", "0", "-0.3", "nan"):
            self.fails(2, "flame", "candle", *out, "--soot-function", share, mentions=["--soot-function", "0.2 to 0.4"])
        # A flame that falls between the samples would be empty.
        for name in ("layered", "candle", "diffusion", "cylinder", "turbulent"):
            self.fails(1, "flame", name, *out, "--voxel-size", "1 m", mentions=["too coarse", "choose at most"])
        self.fails(2, "flame", "cylinder", *out, "--layers", "x.toml", mentions="--layers")
        self.fails(2, "flame", "turbulent", *out, "--soot-function", "0.3", mentions="--soot-function")
        self.fails(2, "flame", "layered", *out, "--wavelength", "650 nm", mentions="--wavelength")
        self.fails(2, "flame", "candle", *out, "--compression", "rar", mentions="rar")
        self.fails(2, "flame", "candle", "-o", "a.exr", mentions="must end in .vdb")
        self.fails(1, "flame", "layered", *out, "--layers", "none.toml", mentions=["none.toml", "No such file"])
        self.fails(1, "flame", "candle", *out, "--voxel-size", "1 nm", mentions="choose a larger one")
        self.fails(1, "flame", "candle", "--voxel-size", "2 mm", "-o", "no/a.vdb", mentions="no folder no")
        self.assertEqual(self.files(), [])

    def test_wrong_layers(self):
        for mistake, where, message in (
                ('temprature = "1 K"\n', "9:1", 'unknown key "temprature" in layers[1]; did you mean "temperature"?'),
                ('temperature = "1500"\n', "9:15", "its unit is missing (one of K, degC)"),
                ('temperature = nan\n', "9:15", "nan is not a number"),
                ('absorption = "-20 1/m"\n', "9:14", "-20 1/m is not possible here; 0 1/m to"),
                ('semi_axes = ["1 mm", "0 mm", "1 mm"]\n', "9:13", "above 0 m"),
                ('name = "b"\n', "8:1", "layers[1].semi_axes is missing")):
            self.write("l.toml", LAYERS.lstrip("\n") + "\n[[layers]]\n" + mistake)
            self.fails(1, "flame", "layered", "--layers", "l.toml", "-o", "a.vdb", mentions=["l.toml:" + where, message])
        self.assertEqual(self.files(), ["l.toml"])

    def test_equal_flames_are_equal_files(self):
        """What OpenVDB writes has a random UUID, by which files could not be told to be the same."""
        options = ("--voxel-size", "2 mm")
        for compression in ("none", "zip", "blosc"):
            for name in ("a.vdb", "b.vdb"):
                self.succeeds("flame", "candle", *options, "--compression", compression, "-o", name)
            self.assertEqual(self.read("a.vdb"), self.read("b.vdb"))
        uuid = self.read("a.vdb")[21:57].decode()
        self.assertRegex(uuid, r"\A[0-9a-f]{8}-[0-9a-f]{4}-8[0-9a-f]{3}-a[0-9a-f]{3}-[0-9a-f]{12}\Z")
        self.succeeds("flame", "candle", *options, "--set", "height=41 mm", "-o", "b.vdb")
        self.assertNotEqual(self.read("b.vdb")[21:57].decode(), uuid)

    def test_full_disk(self):
        self.fails(1, "flame", "candle", "--voxel-size", "1 mm", "-o", "a.vdb", largest_file=5000,
                   mentions=["a.vdb", "largest file size"])
        self.assertEqual(self.files(), [])

    def test_a_killed_write_leaves_the_old_file(self):
        """It is held while its file is open in the folder, at several sizes of what is written by then, and killed."""
        for least in (1, 20_000, 200_000):
            for _ in range(20):  # what is written before it is seen tells nothing
                self.write("a.vdb", "old")
                if self.killed_while_writing(least):
                    break
            else:
                self.fail(f"no write was seen at {least} bytes")
            self.assertEqual(self.files(), ["a.vdb"])
            self.assertEqual(self.read("a.vdb"), b"old")

    def killed_while_writing(self, least):
        process = subprocess.Popen([command.COMMAND, "flame", "candle", "--voxel-size", "0.2 mm", "-o", "a.vdb"],
                                   cwd=self.folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        while process.poll() is None and self.being_written(process.pid) < least:
            pass
        process.send_signal(signal.SIGSTOP)
        writing = process.poll() is None and self.being_written(process.pid) >= least
        process.kill()
        process.wait()
        return writing

    def being_written(self, pid):
        """Bytes of the file in the test's folder that a process has open."""
        size = 0
        try:
            with os.scandir(f"/proc/{pid}/fd") as links:
                for link in links:
                    if os.readlink(link.path).startswith(os.path.realpath(self.folder) + "/"):
                        size = max(size, os.stat(link.path).st_size)
        except OSError:  # closed in the meantime
            pass
        return size


if __name__ == "__main__":
    main()
