"""plenoflame info: what it says about each kind of file."""

import json
import os
import struct

from command import CommandTest, main
from exr import write_light_field

VTP = """<?xml version="1.0"?>
<!-- rays -->
<VTKFile type="PolyData" version="0.1" byte_order="LittleEndian">
 <PolyData>
  <FieldData><DataArray type="String" Name="scene" NumberOfTuples="1">65</DataArray></FieldData>
  <Piece NumberOfPoints="5" NumberOfVerts="0" NumberOfLines="2" NumberOfStrips="0" NumberOfPolys="0">
   <PointData><DataArray type="Float64" Name="distance" format="ascii">0 1 2 0 1</DataArray></PointData>
   <CellData Scalars="radiance">
    <DataArray type="Float64" Name='radiance' format="ascii">1 2</DataArray>
    <DataArray type="Int32" Name="pixel" NumberOfComponents="2" format="ascii">1 2 3 4</DataArray>
   </CellData>
   <Points><DataArray type="Float64" NumberOfComponents="3" format="ascii">0 0 0</DataArray></Points>
  </Piece>
 </PolyData>
</VTKFile>
"""


class Info(CommandTest):
    def test_light_field(self):
        scene = "# caf\u00e9\n[camera]\n"
        write_light_field(self.path("a.exr"), [[1e-9, 0.0, 3e-9]], [[1e-11, 0.0, 1e-11]], sensor=(40, 30), origin=(5, 4),
                          scene=scene, seed="18446744073709551615", complete=0, **{"number.array.pitch": 1e-4})
        figures = self.json_of("info", "a.exr")
        self.assertEqual(figures["type"], "light field")
        self.assertEqual(figures["sensor"], [40, 30])
        self.assertEqual(figures["window"], [5, 4, 3, 1])
        self.assertEqual(figures["seed"], 18446744073709551615)
        self.assertEqual(figures["complete"], False)
        self.assertEqual(figures["numbers"], {"array.pitch": 1e-4})
        self.assertEqual(figures["scene"], scene)
        channel, = figures["channels"]
        self.assertEqual((channel["name"], channel["lit_pixels"]), ("total", 2))
        total = sum(struct.unpack("<2f", struct.pack("<2f", 1e-9, 3e-9)))
        self.assertEqual(channel["total_W"], total)
        # sqrt(mean(s^2)) / mean(flux) = 1e-11 / 2e-9
        self.assertLess(abs(channel["relative_error"] / 0.005 - 1), 1e-6)
        text = self.succeeds("info", "a.exr")
        self.assertRegex(text, r"array.pitch: +100 um\n")
        self.assertIn("channel total: 4 nW in 2 lit pixels, largest 3 nW, error 0.5 %\n", text)
        self.assertRegex(text, r"complete: +no: ")
        self.assertEqual(self.succeeds("info", "a.exr", "--scene"), scene)

    def test_samples_of_tiles_are_summed_up(self):
        self.write("a.toml", '[camera]\npreset = "paper-plenoptic2"\n[[flames]]\npreset = "paper-layered"\n'
                   'position = ["1 m", "0 m", "-29 mm"]\n')
        self.succeeds("render", "a.toml", "-o", "a.exr", "--target-error", "3%", "--window", "1000,1200,500,300", "--quiet")
        tiles = self.json_of("info", "a.exr")["texts"]["render.tile_samples"]
        runs = [word.split("x") for word in tiles.split()]
        self.assertEqual(sum(int(count) for count, _ in runs), 8 * 5)  # of 64 x 64 pixels
        least, most = (f(float(samples) for _, samples in runs) for f in (min, max))
        self.assertRegex(self.succeeds("info", "a.exr"), rf"render.tile_samples: +{least:g} to {most:g} per replicate\n")

    def test_windows(self):
        self.write("a.toml", """[camera]
preset = "paper-previous-60x60"
[[windows]]
name = "tube"
shape = "tube"
position = ["1 m", "0 m", "-40 mm"]
radius = "15 mm"
thickness = "2 mm"
height = "80 mm"
glass = "FUSED-SILICA"
[[windows]]
position = ["0.4 m", "0 m", "0 m"]
rotation = ["0 deg", "90 deg", "0 deg"]
extent = ["80 mm", "60 mm"]
thickness = "6 mm"
index = 1.46
""")
        text = self.run_command("info", "a.toml").stdout
        self.assertRegex(text, r"window tube: +tube, radius 15 mm, wall 2 mm, height 80 mm, of FUSED-SILICA, at 1 m, 0 m, -0\.04 m\n")
        self.assertRegex(text, r"window 2: +plate, 80 mm by 60 mm, 6 mm thick, of index 1\.46, at 400 mm, 0 mm, 0 mm\n")
        self.assertEqual([w["shape"] for w in json.loads(self.run_command("info", "a.toml", "--json").stdout)["windows"]], ["tube", "plate"])

    def test_scene(self):
        scene = "[camera]\npreset = \"paper-plenoptic2\"\n[[flames]]\npreset = \"paper-layered\"\n" \
            "position = [\"1 m\", \"0 m\", \"-29 mm\"]\n"
        self.write("a.toml", scene)
        figures = self.json_of("info", "a.toml")
        self.assertEqual((figures["type"], figures["sensor"], len(figures["flames"])), ("scene", [3000, 3000], 1))
        self.assertEqual(figures["render"]["estimator"], "backward")
        text = self.succeeds("info", "a.toml")
        self.assertRegex(text, r"microlens array: +hexagonal, pitch 100 um, 3 types")
        # Complete: the presets' values stand in it, and reading it gives the same again.
        complete = self.succeeds("info", "a.toml", "--scene")
        self.assertNotIn("preset", complete)
        self.write("b.toml", complete)
        self.assertEqual(self.succeeds("info", "b.toml", "--scene"), complete)
        self.assertEqual(self.succeeds("info", "b.toml").replace("b.toml", "a.toml"), text)

    def test_scene_with_errors(self):
        self.write("a.toml", "[camera]\npresett = \"paper-plenoptic2\"\n")
        self.fails(1, "info", "a.toml", mentions=["a.toml:2:1", "preset"])
        self.write("a.toml", "[camera\n")
        self.fails(1, "info", "a.toml", mentions="a.toml:1")
        self.write("empty.toml", "")
        self.fails(1, "info", "empty.toml", mentions="empty.toml")

    def test_scene_with_warning(self):
        self.write(
            "a.toml",
            "[camera]\npreset = \"paper-plenoptic2\"\n"
            "[[flames]]\npreset = \"paper-layered\"\nposition = [\"0.3 m\", \"0 m\", \"-29 mm\"]\n")
        result = self.run_command("info", "a.toml", "--json")
        self.assertEqual(result.returncode, 0)
        self.assertRegex(result.stderr, r"\Aplenoflame: warning: a\.toml:5:\d+: [^\n]+virtual[^\n]*\n\Z")
        self.assertEqual(len(json.loads(result.stdout)["warnings"]), 1)

    def test_ray_paths(self):
        self.write("rays.vtp", VTP)
        figures = self.json_of("info", "rays.vtp")
        self.assertEqual((figures["points"], figures["lines"]), (5, 2))
        self.assertEqual([(a["of"], a["name"], a["type"], a["components"]) for a in figures["arrays"]],
                         [("file", "scene", "String", "1"), ("point", "distance", "Float64", "1"),
                          ("cell", "radiance", "Float64", "1"), ("cell", "pixel", "Int32", "2")])
        self.write("grid.vti", VTP.replace("PolyData", "ImageData"))
        self.fails(1, "info", "grid.vti", mentions="'ImageData'")

    def test_picture(self):
        write_light_field(self.path("a.exr"), [[1e-9, 0.0, 3e-9]])
        self.succeeds("develop", "a.exr", "--curve", "linear", "--bits", "12", "--saturation", "3nW")
        figures = self.json_of("info", "a.png")
        self.assertEqual((figures["size"], figures["bits"], figures["significant_bits"], figures["curve"]),
                         ([3, 1], 16, 12, "linear"))
        self.assertIn("saturation 3 nW per pixel", figures["texts"]["Comment"])

    def test_bad_files(self):
        self.fails(1, "info", "none", mentions="No such file")
        os.mkdir(self.path("folder"))
        self.fails(1, "info", "folder", mentions="it is a folder")
        for name, content in (("empty.exr", b""), ("letter.txt", b"Dear reader"), ("noise.bin", bytes(range(256)))):
            self.write(name, content)
            self.fails(1, "info", name, mentions="not a file that Plenoflame reads")
        self.fails(1, "info", "empty.exr", mentions="'empty.exr' is empty")
        self.write("cut.exr", b"\x76\x2f\x31\x01\x02\x00\x00\x00")
        self.fails(1, "info", "cut.exr", mentions="cut.exr")
        self.fails(2, "info", "letter.txt", "--scene", mentions="--scene")

    def test_names_that_are_not_unicode(self):
        name = os.fsencode(self.folder) + b"/\xff\xfe.exr"
        write_light_field(name, [[1e-9]])
        result = self.run_command("info", os.fsdecode(name), "--json")
        self.assertEqual(result.returncode, 0)
        json.loads(result.stdout)


if __name__ == "__main__":
    main()
