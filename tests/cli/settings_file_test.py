"""A file of settings in place of a long command line: the same bytes, what wins, and what is refused."""

import os

from command import CommandTest, main
from settings_test import SCENE

FILE = """# A flame of rings.
[reconstruction]
scenes = "a.toml"
images = ["a.exr"]
output = "{output}"
unknowns = "rings"
grid = [4, 6]
center = ["1 m", "0 m", "0 m"]
size = ["20 mm", "20 mm", "60 mm"]
spread = ["1 m, 0 m, 0 m", ["1 m", "1 mm", "0 m"]]
noise = 0.01
rays = 8
draws = 2
probes = 2
all_voxels = true
truth = false
report = "{output}.json"
"""
LINE = ("a.toml", "--images", "a.exr", "-o", "b.vdb", "--unknowns", "rings", "--grid", "4,6", "--center", "1 m, 0 m, 0 m",
        "--size", "20 mm, 20 mm, 60 mm", "--spread", "1 m, 0 m, 0 m", "--spread", "1 m, 1 mm, 0 m", "--noise", "0.01",
        "--rays", "8", "--draws", "2", "--probes", "2", "--all-voxels", "--report", "b.vdb.json", "--quiet")


class SettingsFile(CommandTest):
    def setUp(self):
        super().setUp()
        self.write("a.toml", SCENE)
        self.succeeds("render", "a.toml", "--samples", "4", "--quiet", "-o", "a.exr")

    def test_it_is_as_the_command_line(self):
        self.write("run.toml", FILE.format(output="f.vdb"))
        self.run_command("reconstruct", *LINE)
        self.run_command("reconstruct", "run.toml", "--quiet")
        self.assertEqual(self.read("f.vdb"), self.read("b.vdb"))
        # All but the name of the result.
        self.assertEqual(self.read("f.vdb.json").replace(b"f.vdb", b"b.vdb"), self.read("b.vdb.json"))
        # Options win; paths are relative to the file, those of options to here.
        os.mkdir(self.path("runs"))
        self.write("runs/run.toml", FILE.format(output="f.vdb").replace('"a.', '"../a.'))
        self.run_command("reconstruct", "runs/run.toml", "--quiet")
        self.assertEqual(self.read("runs/f.vdb"), self.read("b.vdb"))
        self.run_command("reconstruct", "runs/run.toml", "--grid", "3,5", "-o", "c.vdb", "--report", "c.json", "--quiet")
        other = {"4,6": "3,5", "b.vdb": "d.vdb", "b.vdb.json": "d.json"}
        self.run_command("reconstruct", *(other.get(word, word) for word in LINE))
        self.assertEqual(self.read("c.vdb"), self.read("d.vdb"))
        self.assertNotEqual(self.read("c.vdb"), self.read("b.vdb"))

    def test_operator(self):
        self.write("run.toml", '[operator]\nscene = "a.toml"\noutput = "A.npz"\ngrid = 4\nrays = 2\npixels = "p.csv"\n')
        self.succeeds("operator", "run.toml", "--quiet")
        self.succeeds("operator", "a.toml", "-o", "B.npz", "--grid", "4", "--rays", "2", "--pixels", "q.csv", "--quiet")
        self.assertEqual(self.read("A.npz"), self.read("B.npz"))
        self.assertEqual(self.read("p.csv"), self.read("q.csv"))

    def test_what_is_refused(self):
        text = FILE.format(output="f.vdb")
        before = sorted([*self.files(), "run.toml"])
        for old, new, status, mentions in (
                ("noise = 0.01", "nose = 0.01", 1, ['run.toml:11:1: unknown key "nose" of [reconstruction]; did you mean noise?']),
                ("all_voxels", "all-voxels", 1, ["run.toml:15:1: ", "did you mean all_voxels?"]),
                ("rays = 8", 'rays = "many"', 1, ["run.toml:12:1: rays takes a whole number from", "not 'many'"]),
                ("noise = 0.01", "noise = -1", 1, ["run.toml:11:1: noise: -1 is not a number from 0 to 1"]),
                ("noise = 0.01", "noise = {x = 1}", 1, ["run.toml:11:9: a setting is a text, a number"]),
                ('"rings"', '"ringe"', 1, ["run.toml:6:1: unknowns: 'ringe' is not one of voxels, rings, layers"]),
                ('scenes = "a.toml"\n', "", 1, ['run.toml: [reconstruction] has no key "scenes"']),
                ('images = ["a.exr"]\n', "", 2, ["--images is required"]),
                ("noise = 0.01", "noise =", 1, ["run.toml:11:"]),
                ("[reconstruction]", "[[reconstruction]]", 1, ['"reconstruction" is not a table; begin it with [reconstruction]']),
                ("# A flame of rings.", "[sweep]", 1, ['run.toml:1:2: "sweep" stands beside [reconstruction]']),
                ("noise = 0.01", "absorption = 8", 1, ["run.toml:11:1: absorption: ", "its unit is missing"]),
                ("truth = false", 'truth = "yes"', 1, ["run.toml:16:1: truth: true or false, not 'yes'"]),
                ("f.vdb", "a.exr", 2, ["a.exr"]),
                ("f.vdb.json", "f.pdf", 1, ["run.toml:17:1: report: 'f.pdf' must end in .json, .txt or .html"])):
            self.assertIn(old, text)
            self.write("run.toml", text.replace(old, new))
            self.fails(status, "reconstruct", "run.toml", mentions=mentions)
            self.assertEqual(self.files(), before)
        self.write("run.toml", text)
        self.fails(2, "reconstruct", "run.toml", "a.toml", mentions="of [reconstruction] one file is given")
        self.fails(1, "operator", "run.toml", "-o", "A.npz", mentions="run.toml: a table [operator] is needed here, not [reconstruction]")
        self.write("run.toml", '[operator]\nscene = ["a.toml", "a.toml"]\noutput = "A.npz"\n')
        self.fails(1, "operator", "run.toml", mentions="run.toml:2:1: scene: one, not several")
        self.fails(1, "reconstruct", "run.toml", mentions="run.toml: a table [reconstruction] is needed here, not [operator]")
        self.assertEqual(self.files(), before)


if __name__ == "__main__":
    main()
