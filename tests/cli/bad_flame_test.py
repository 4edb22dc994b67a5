"""What flame files with a mistake get: one line that names the scene's line, the file, the grid and the voxel."""

import os
import subprocess

from command import CommandTest, main

SCENE = """[camera]
preset = "paper-plenoptic2"
[[flames]]
kind = "vdb"
file = "a.vdb"
position = ["1 m", "0 m", "0 m"]
"""
WINDOW = ("--window", "1480,1490,8,8", "--samples", "2", "--quiet")
HOT = "temperature:float:K:0:1500"
SOOT = "absorption:float:1/m:0:30"


class BadFlame(CommandTest):
    def grids(self, *grids):
        subprocess.run([os.environ["PLENOFLAME_WRITE_VDB"], self.path("a.vdb"), *grids], check=True)

    def refused(self, grids, *mentions, scene=""):
        self.grids(*grids)
        self.write("a.toml", SCENE + scene)
        self.fails(1, "render", "a.toml", *WINDOW, mentions=["a.toml:5:8: a.vdb: ", *mentions])
        self.assertEqual(self.files(), ["a.toml", "a.vdb"])

    def warned(self, grids, where, *mentions, scene=""):
        self.grids(*grids)
        self.write("a.toml", SCENE + scene)
        result = self.run_command("render", "a.toml", *WINDOW)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertRegex(result.stderr, r"\Aplenoflame: warning: [^\n]+\n\Z")
        for text in ["a.toml:" + where + ": ", *mentions]:
            self.assertIn(text, result.stderr)

    def test_sound_file(self):
        self.grids(HOT, SOOT)
        self.write("a.toml", SCENE)
        self.succeeds("render", "a.toml", *WINDOW)

    def test_missing_grids_list_those_present(self):
        self.refused(["fuel:float::0:1", "velocity:vec3s::0:1", SOOT], "has no temperature grid; it holds: ",
                     '"fuel" (float), "velocity" (vec3s), "absorption" (float)', "temperature.grid")
        self.refused([HOT, "density:float::0:1"], "has no absorption grid", '"density" (float)',
                     'absorption.grid = "density"', "absorption.scale")
        self.refused([HOT, SOOT], 'has no grid "soot"; it holds: "temperature" (float), "absorption" (float)',
                     scene='absorption.grid = "soot"\n')
        self.refused(["temperature:vec3s:K:0:1500", SOOT], 'grid "temperature" has values of type vec3s')
        self.refused(["t:vec3s:K:0:1500", SOOT], 'grid "t" has values of type vec3s', "float or double",
                     scene='temperature.grid = "t"\n')

    def test_units(self):
        self.refused(["temperature:float:degF:0:1500", SOOT], 'grid "temperature" states the unit "degF"',
                     "temperature.unit", "K or degC")
        self.refused([HOT, "absorption:float:1/furlong:0:3"], 'grid "absorption" states the unit "1/furlong"',
                     "1/m, 1/cm or 1/mm")

    def test_celsius_and_normalised_grids(self):
        self.warned(["temperature:float::0:1", SOOT], "5:8", 'a.vdb: grid "temperature" is 1 K at most', "degC",
                    "temperature.scale")
        self.warned(["temperature:float::20:150", SOOT], "5:8", 'grid "temperature" is 150 K at most',
                    "temperature.unit")
        # Said what it is, it is fine.
        self.grids("temperature:float::0:1", SOOT)
        self.write("a.toml", SCENE + "temperature.scale = 1500\n")
        self.succeeds("render", "a.toml", *WINDOW)
        self.grids("temperature:float::20:1200", SOOT)
        self.write("a.toml", SCENE + 'temperature.unit = "degC"\n')
        self.succeeds("render", "a.toml", *WINDOW)

    def test_voxels(self):
        self.refused(["temperature:float:K:0:1500:nan", SOOT],
                     'grid "temperature": voxel (1, 2, -3) is nan K; it must be a finite number')
        self.refused(["temperature:double:K:0:1500:-1", SOOT],
                     'grid "temperature": voxel (1, 2, -3) is -1 K; it must be at least 0')
        self.refused([HOT, "absorption:float:1/m:0:30:nan"], 'grid "absorption": voxel (1, 2, -3) is nan 1/m')
        self.refused([HOT, "absorption:float:1/m:0:30:-0.5"], 'grid "absorption": voxel (1, 2, -3) is -0.5 1/m')
        self.refused([HOT, "absorption:float:1/m:0:30:inf"], 'grid "absorption": voxel (1, 2, -3) is inf 1/m')
        # An offset can make a value impossible that was none in the file.
        self.refused([HOT, SOOT], 'grid "absorption": the background is -2 1/m', scene="absorption.offset = -2\n")

    def test_background(self):
        self.refused([HOT, "absorption:float:1/m:2:30"], 'grid "absorption" has the background 2 1/m; it must be 0')
        self.warned([HOT, "absorption:float:1/m:0:0"], "5:8", 'grid "absorption" is 0 everywhere')

    def test_transforms(self):
        self.refused(["--frustum", HOT, SOOT], 'grid "temperature" has a transform of type', "resample it")

    def test_inside_the_camera(self):
        self.grids(HOT, SOOT)
        self.write("a.toml", SCENE.replace('"1 m"', '"1 mm"'))
        self.fails(1, "render", "a.toml", *WINDOW, mentions=['a.toml:6:12: flame "a.vdb" reaches into the camera'])
        self.write("a.toml", SCENE.replace('"1 m"', '"-1 m"'))
        self.fails(1, "render", "a.toml", *WINDOW, mentions=["a.toml:6:12: ", "lies behind the front of the camera"])
        self.write("a.toml", SCENE.replace('"1 m"', '"0.2 m"'))
        result = self.run_command("render", "a.toml", *WINDOW)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn('a.toml:6:12: flame "a.vdb" begins', result.stderr)
        self.assertIn("virtual", result.stderr)
        # As large as a room: voxels of 1 m from -5 to 4, around which the values fall to 0.
        self.write("a.toml", SCENE + "scale = 1000\n")
        self.fails(1, "render", "a.toml", *WINDOW, mentions="reaches into the camera: it extends from -5 m to 6 m")

    def test_files(self):
        self.write("a.toml", SCENE)
        self.fails(1, "render", "a.toml", *WINDOW, mentions="a.toml:5:8: a.vdb: cannot be opened (No such file")
        os.mkdir(self.path("a.vdb"))
        self.fails(1, "render", "a.toml", *WINDOW, mentions="a.toml:5:8: a.vdb: is a folder")
        os.rmdir(self.path("a.vdb"))
        for content in (b"", b"Dear reader", SCENE.encode()):
            self.write("a.vdb", content)
            self.fails(1, "render", "a.toml", *WINDOW, mentions=["a.toml:5:8: a.vdb: ", "not a .vdb file"])
        self.grids(HOT, SOOT)
        whole = self.read("a.vdb")
        for share in (0.05, 0.3, 0.6, 0.99):
            self.write("a.vdb", whole[:int(share * len(whole))])
            self.fails(1, "render", "a.toml", *WINDOW, mentions="a.toml:5:8: a.vdb: ")
            self.fails(1, "info", "a.vdb", mentions="a.vdb: ")
        self.assertEqual(self.files(), ["a.toml", "a.vdb"])


if __name__ == "__main__":
    main()
