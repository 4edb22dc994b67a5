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

    def test_sweep(self):
        os.mkdir(self.path("a"))
        self.write("a/runs.csv", "camera.focus.object_distance\n0.9 m\n1 m\n")
        self.succeeds("sweep", "a.toml", "--table", "a/runs.csv", "-o", "set", "--samples", "2", "--seed", "3", "--quiet")
        for output in ("set=1", "auto"):  # these are names of folders, too
            self.write("a/run.toml", f'[sweep]\nscene = "../a.toml"\ntable = "runs.csv"\noutput = "{output}"\nsamples = 2\nseed = 3\n')
            self.succeeds("sweep", "a/run.toml", "--quiet")
            self.assertEqual(self.read(f"a/{output}/index.csv"), self.read("set/index.csv"))
            self.assertEqual(self.read(f"a/{output}/runs/000001.exr"), self.read("set/runs/000001.exr"))
        self.write("a/run.toml", '[sweep]\nscene = "../a.toml"\ntable = "runs.csv"\noutput = "other"\ntest_share = 2\n')
        self.fails(1, "sweep", "a/run.toml", mentions="a/run.toml:5:1: test_share must be a share")

    def test_import(self):
        os.mkdir(self.path("a"))
        self.succeeds("develop", "a.exr", "-o", "a.png")
        self.write("a/run.toml", '[import]\nraw = "total=../a.png"\ncamera = "../a.toml"\noutput = "b.exr"\nunit = "DN"\ngain = 2\n'
                   'read_noise = 3\nexposure_time = "1 ms"\n')
        self.run_command("import", "a/run.toml")
        self.run_command("import", "total=a.png", "--camera", "a.toml", "-o", "c.exr", "--unit", "DN", "--gain", "2", "--read-noise", "3",
                         "--exposure-time", "1 ms")
        self.succeeds("compare", "a/b.exr", "c.exr")
        self.write("a/run.toml", '[import]\nraw = "../a.png"\ncamera = "../a.toml"\noutput = "b.exr"\nskip = 1e15\n')
        self.fails(1, "import", "a/run.toml", mentions="a/run.toml:5:1: skip: at most 2^40 bytes")

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
                ("f.vdb", "a.exr", 1, ["run.toml:5:1: output: 'a.exr' is a file that this command reads"]),
                ("f.vdb", "f.png", 1, ["run.toml:5:1: output: 'f.png' must end in .vdb"]),
                # The command finds these errors later.
                ("noise = 0.01", 'basis = "constant"', 1, ["run.toml:11:1: basis is for voxels"]),
                ("noise = 0.01", 'solver = "sirt"\nstrength = 1', 1, ["run.toml:11:1: solver='sirt'", "neither strength nor"]),
                ("[4, 6]", "[4, 6, 8]", 1, ["run.toml:7:1: grid must be the rings and heights"]),
                ('images = ["a.exr"]', 'images = ["a.exr"]\nresidual = ["a.exr"]', 1, ["run.toml:5:1: residual: 'a.exr' is a file that this command reads"]),
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
