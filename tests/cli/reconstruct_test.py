"""plenoflame reconstruct: from rendered pictures of a candle back to its temperatures."""

import array
import json
import math
import os
import pathlib
import re
import shutil
import struct
import subprocess
import tempfile
import zipfile

import numpy

import command
from command import CommandTest, long, main

EXAMPLES = pathlib.Path(__file__).resolve().parents[2] / "examples"
def npy(content):
    """The numbers of a one-dimensional .npy file."""
    size = int.from_bytes(content[8:10], "little")
    kind = {"'<f4'": "f", "'<i4'": "i", "'<i8'": "q"}
    code = next(c for name, c in kind.items() if name in content[10:10 + size].decode())
    return array.array(code, content[10 + size:])


FAST = ("--draws", "4", "--probes", "4", "--quiet")


class Reconstruct(CommandTest):
    """Pictures are made once: a candle through two small cameras, with the sensor's noise."""

    @classmethod
    def setUpClass(cls):
        cls.shared = tempfile.mkdtemp(prefix="plenoflame-reconstruct-")
        maker = cls("run_command")
        maker.folder = cls.shared
        for name in ("front", "side", "two-colours"):
            shutil.copy(EXAMPLES / f"reconstruct-{name}.toml", os.path.join(cls.shared, f"{name}.toml"))
        maker.run_command("flame", "candle", "-o", "candle.vdb")
        for name in ("front", "side"):
            maker.run_command("render", f"{name}.toml", "-o", f"{name}.exr", "--samples", "512", "--quiet")
            maker.run_command("develop", f"{name}.exr", "--sensor", "-o", f"{name}-electrons.exr")

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.shared)

    def setUp(self):
        super().setUp()
        for file in os.listdir(self.shared):
            os.symlink(os.path.join(self.shared, file), self.path(file))

    def reconstruct(self, *arguments):
        fast = FAST[4:] if "--draws" in arguments else FAST
        result = self.run_command("reconstruct", *arguments, *fast, "--json")
        self.assertEqual(result.returncode, 0, result.stderr)
        return json.loads(result.stdout), result.stderr

    def test_rings_from_one_camera(self):
        found, warnings = self.reconstruct(
            "front.toml", "--images", "front-electrons.exr", "--unknowns", "rings", "--grid", "16,32",
            "--absorption", "scene", "--truth", "-o", "rings.vdb", "--report", "rings.json",
            "--residual", "left.exr", "--rays", "128")
        self.assertLess(found["truth_temperature_error"], 0.015)
        self.assertLess(found["truth_emission_error"], 0.15)
        self.assertLess(abs(found["chi_squared"] - 1), 0.25)
        self.assertNotIn("times worse", warnings)
        self.assertEqual(json.loads(self.read("rings.json"))["rows"], found["rows"])
        self.assertGreater(len(found["history"]), 5)
        grids = self.json_of("info", "rings.vdb")
        temperature = next(grid for grid in grids["grids"] if grid["name"] == "temperature")
        self.assertGreater(temperature["minimum"], 293)  # beyond the last ring fields end at 0
        self.assertGreater(temperature["background"], 293)
        self.assertGreater(temperature["maximum"], 1500)
        self.assertIn("resolved", json.dumps(grids))
        self.assertIn("temperature_deviation", json.dumps(grids))
        self.assertIn("explained", self.succeeds("info", "left.exr"))

    @long
    def test_voxels_from_two_cameras_and_from_one(self):
        both, warnings = self.reconstruct(
            "front.toml", "side.toml", "--images", "front-electrons.exr", "side-electrons.exr",
            "--grid", "24", "--bin", "2", "--rays", "32", "--absorption", "scene", "--truth", "-o", "both.vdb")
        self.assertNotIn("times worse", warnings)
        self.assertLess(both["truth_temperature_error"], 0.03)  # 0.019; it was 0.056 with light that cannot be
        self.assertIn("the grid is coarse", warnings)
        one, warnings = self.reconstruct(
            "front.toml", "--images", "front-electrons.exr", "--grid", "24", "--bin", "2", "--rays", "32", "--absorption", "scene",
            "--truth", "-o", "one.vdb")
        self.assertIn("times worse", one["warning"])
        self.assertIn("times worse", warnings)
        self.assertLess(both["truth_emission_error"], one["truth_emission_error"])

    @long
    def test_emission_without_absorption_and_the_flame_is_a_flame(self):
        found, _ = self.reconstruct("front.toml", "--images", "front.exr", "--unknowns", "rings", "--grid", "8,16",
                                    "-o", "glow.vdb")
        self.assertNotIn("mean_temperature_K", found)
        self.assertGreater(found["largest_emission"], 0)
        self.reconstruct("front.toml", "--images", "front.exr", "--unknowns", "rings", "--grid", "16,32",
                         "--absorption", "scene", "-o", "found.vdb")
        # Straight lines between values lie below a curved field: 12 % of the light on half as many rings. The flame that was found can be rendered as any other.
        scene = self.read("front.toml").decode().replace("candle.vdb", "found.vdb").replace(
            '"1 m", "0 m", "-16 mm"', '"0 m", "0 m", "0 m"')
        self.write("again.toml", scene)
        self.succeeds("render", "again.toml", "-o", "again.exr", "--samples", "64", "--quiet")
        compared = self.json_of("compare", "again.exr", "front.exr")
        self.assertLess(abs(compared["relative_bias"]), 0.03, compared)

    RINGS = ("front.toml", "--images", "front-electrons.exr", "--unknowns", "rings", "--grid", "8,16", "--bin", "2",
             "--rays", "16")
    FINE_RINGS = RINGS[:5] + ("--grid", "16,32", "--bin", "2", "--rays", "64")

    @long
    def test_every_solver_finds_about_the_same(self):
        """Two programs for the same minimum agree; the others differ by what penalties and stops make of it."""
        errors, misfits = {}, {}
        for solver in ("fista", "nnls", "cgls", "lsqr", "sirt", "sart", "mlem", "osem", "mart"):
            # Active sets are dense: their problem, and the one that they are held against, is small.
            rings = self.RINGS if solver == "nnls" else self.FINE_RINGS
            found, _ = self.reconstruct(*rings, "--absorption", "scene", "--truth", "--solver", solver,
                                        *{"mart": ("--noise", "0.0015")}.get(solver, ()), "--draws", "0", "--probes", "0",
                                        "-o", f"{solver}.vdb")
            errors[solver], misfits[solver] = found["truth_emission_error"], found["chi_squared"]
            self.assertEqual("strength" in found and found["strength"] > 0,
                             solver in ("fista", "nnls", "cgls", "lsqr"), solver)
        coarse, _ = self.reconstruct(*self.RINGS, "--absorption", "scene", "--truth", "--draws", "0", "--probes", "0",
                                     "--iterations", "5000", "-o", "coarse.vdb")
        self.assertLess(abs(errors.pop("nnls") / coarse["truth_emission_error"] - 1), 1e-3, errors)
        self.assertLess(abs(errors["lsqr"] / errors["cgls"] - 1), 1e-3, errors)
        self.assertLess(max(abs(misfits[s] - 1) for s in ("fista", "cgls", "lsqr")), 0.1, misfits)
        self.assertLess(max(errors[s] for s in ("fista", "mlem", "osem")), 0.2, errors)
        self.assertLess(max(errors.values()), 0.45, errors)  # negative values cut off; rows within the noise left out
        self.fails(2, "reconstruct", *self.RINGS, "--solver", "sirt", "--strength", "1", "-o", "x.vdb",
                   mentions="has no penalty")
        result = self.run_command("reconstruct", *self.RINGS, "--solver", "mart", "--memory", "0", "-o", "x.vdb", *FAST)
        self.assertEqual(result.returncode, 2)
        self.assertRegex(result.stderr, r"\Aplenoflame: error: [^\n]*stored matrix[^\n]*\n\Z")
        self.assertNotIn("x.vdb", self.files())

    def test_a_strength_means_the_same_on_every_grid(self):
        """Where the penalty rules, flames of fine and coarse grids are alike: the same smoothness is asked of both."""
        found = {}
        for grid in ("10,20", "20,40"):
            found[grid], _ = self.reconstruct("front.toml", "--images", "front-electrons.exr", "--unknowns", "rings", "--grid", grid,
                                              "--rays", "32", "--absorption", "scene", "--truth", "--strength", "0.01",
                                              "--iterations", "600", "--draws", "0", "--probes", "0", "-o", "x.vdb")
        coarse, fine = (found[grid]["truth_emission_error"] for grid in found)
        self.assertGreater(coarse, 0.15, found)
        self.assertLess(abs(fine / coarse - 1), 0.05, found)

    def test_what_may_help_where_noise_does_not_explain_the_pictures(self):
        """Iterations, if the misfit still falls; else a weaker penalty, if the strength was given."""
        common = (*self.RINGS, "--absorption", "scene", "--draws", "0", "--probes", "0", "-o", "x.vdb")
        _, early = self.reconstruct(*common, "--strength", "1e-4", "--iterations", "4")
        _, smooth = self.reconstruct(*common, "--strength", "1", "--iterations", "2000")
        self.assertRegex(early, r"noise does not explain [^\n]*: more --iterations may explain more")
        self.assertRegex(smooth, r"noise does not explain [^\n]*: --strength is too large")

    def test_strengths_and_reports(self):
        found, _ = self.reconstruct(*self.RINGS, "--draws", "4", "--probes", "2", "--truth",
                                    "-o", "rule.vdb", "--report", "rule.html", "--report", "rule.txt",
                                    "--absorption", "scene", "--spread", "1 m, 2 mm, 0 m")
        tried = {trial["strength"]: trial["gcv"] for trial in found["trials"]}
        self.assertGreater(len(tried), 6)  # some about the best of them
        self.assertEqual(min(tried, key=tried.get), found["strength"])
        self.assertLess(found["truth_emission_error"], 0.4)
        self.assertEqual(len(found["point_spreads"][0]["widths"]), 2)
        self.assertGreater(found["emission_deviation"], 0)
        page = self.read("rule.html").decode()
        self.assertEqual(page.count("<h1>"), 1)
        self.assertGreater(page.count("data:image/png;base64,"), 10)
        self.assertIn(f"<p>{found['verdict']}</p>", page)
        self.assertIn(">radius [mm]</text>", page)
        self.assertIn(">height [mm]</text>", page)
        # Deviation and error of a temperature share a scale that fits them: far below the temperature itself.
        ends = [float(end) for end in re.findall(r"<span>K</span><span>([^<]*)</span>", page)]
        self.assertEqual(ends[0::4], ends[2::4])
        self.assertEqual(ends[1::4], ends[3::4])
        self.assertLess(max(ends[1::4]), 0.5 * min(ends[0::4]))
        # Temperatures of dark places are not shown, so that the scale is that of the flame.
        begins = [float(begin) for begin in re.findall(r"<span>([^<]*)</span><span>K</span>", page)]
        self.assertGreater(begins[0], 1000)
        self.assertEqual(page.count("data:image/svg+xml;base64,"), 2)
        self.assertNotIn("http", page.replace("http://www.w3.org", ""))
        self.assertIn("chi^2 per row:", self.read("rule.txt").decode())

    def test_temperature_on_the_renderers_formulas(self):
        found, _ = self.reconstruct(*self.RINGS, "--absorption", "scene", "--find", "temperature", "--truth",
                                    "-o", "hot.vdb", "--strength", "1e-3")
        self.assertLess(found["truth_temperature_error"], 0.03)
        self.assertGreater(found["temperature_deviation_K"], 0)
        self.fails(2, "reconstruct", *self.RINGS, "--find", "temperature", "-o", "x.vdb", mentions="--absorption")
        self.fails(1, "reconstruct", *self.RINGS, "--find", "both", "-o", "x.vdb", *FAST, mentions="single channel")

    def test_temperature_and_absorption_of_two_channels(self):
        self.succeeds("render", "two-colours.toml", "-o", "two.exr", "--samples", "256", "--quiet")
        found, _ = self.reconstruct("two-colours.toml", "--images", "two.exr", "--find", "both", "--unknowns", "rings",
                                    "--grid", "6,8", "--truth", "-o", "both.vdb", "--report", "both.html",
                                    "--bin", "2", "--rays", "8", "--strength", "1e-4")
        self.assertLess(found["truth_temperature_error"], 0.05)
        # The rays' error is some 4 % of a row, which two wavelengths turn into some ten times as much of the absorption; rings
        # thicker than the sheet of soot take as much again. Measured: 0.78; on 8 x 12 rings with 32 rays 0.50.
        self.assertLess(found["truth_absorption_error"], 0.9)
        self.assertEqual(found["channel"], "650nm, 850nm")
        self.assertIn("absorption_deviation", json.dumps(self.json_of("info", "both.vdb")))
        self.fails(2, "reconstruct", "two-colours.toml", "--images", "two.exr", "--find", "both", "-o", "x.vdb", *FAST,
                   "--absorption-ratios", "0.7,0.5", mentions="for 2 channels")

    def test_series_start_resume_support_and_prior(self):
        done = self.run_command("reconstruct", "front.toml", "--images", "front.exr", "front-electrons.exr", "--unknowns",
                                "rings", "--grid", "8,16", "--axis", "fit", "-o", "moment.vdb", "--report", "moment.json",
                                "--bin", "2", "--rays", "16", *FAST)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("frame 2 of 2", done.stdout)
        first, second = (json.loads(self.read(f"moment-000{k}.json")) for k in (1, 2))
        self.assertGreater(len(first["trials"]), 3)
        self.assertEqual(second["trials"], [])
        self.assertEqual(second["strength"], first["strength"])
        self.assertLess(abs(first["axis"]["point"][1]), 1e-4)
        self.assertLess(abs(first["axis"]["point"][0] - 1), 1e-6)  # the depth is not told by one camera
        # The same again from the result: the same strength, and almost nothing left to do.
        again, _ = self.reconstruct(*self.RINGS, "--axis", "fit", "--resume", "moment-0002.vdb", "-o", "again.vdb")
        self.assertEqual(again["strength"], second["strength"])
        self.assertLessEqual(again["iterations"], second["iterations"])
        self.reconstruct(*self.RINGS, "--start", "again.vdb", "--prior", "again.vdb", "--support", "again.vdb",
                         "--smoothing", "2,1", "-o", "more.vdb")
        layers, _ = self.reconstruct("front.toml", "--images", "front-electrons.exr", "--unknowns", "layers", "--grid",
                                     "8", "-o", "layers.vdb", "--report", "layers.html")
        self.assertEqual(layers["unknowns"], 8)
        described = self.run_command("info", "layers.vdb")
        self.assertIn("was reconstructed without an absorption", described.stdout)
        self.assertNotIn("none", described.stdout)
        self.fails(2, "reconstruct", *self.RINGS, "--smoothing", "1,2,3", "-o", "x.vdb", mentions="2 axes of rings")
        self.fails(1, "reconstruct", *self.RINGS, "--start", "candle.vdb", "-o", "x.vdb", mentions="no grid 'emission'")
        self.fails(2, "reconstruct", *self.RINGS, "--start", "again.vdb", "--resume", "again.vdb", "-o", "x.vdb",
                   mentions="not both")
        self.fails(1, "reconstruct", *self.RINGS[:5], "--grid", "6,10", *self.RINGS[7:], "--resume", "again.vdb", "-o", "x.vdb",
                   mentions="8 x 16 x 1 unknowns, not 6 x 10 x 1")
        for other in (self.RINGS + ("--absorption", "20 1/m"), self.RINGS[:2] + ("front.exr",) + self.RINGS[3:]):
            self.fails(1, "reconstruct", *other, "--axis", "fit", "--resume", "again.vdb", "-o", "x.vdb",
                       mentions="again.vdb was found from other pictures, or with another absorption")
        refused = self.run_command("reconstruct", "front.toml", "--images", "front-electrons.exr", "side-electrons.exr", "-o", "x.vdb")
        self.assertIn("does not belong to the scene", refused.stderr)
        self.assertEqual(refused.stdout, "")

    def test_noise_explains_a_grid_that_is_finer_than_the_pixels(self):
        """The weights of rows follow a guess of the light; one that explains too little made chi^2 10 here."""
        found, _ = self.reconstruct("front.toml", "--images", "front-electrons.exr", "--unknowns", "rings", "--grid", "40,80",
                                    "--absorption", "scene", "--rays", "16", "--draws", "0", "--probes", "0", "--strength", "2e-7",
                                    "-o", "fine.vdb")
        self.assertLess(abs(found["chi_squared"] - 1), 0.3)

    def test_operator(self):
        made = self.json_of("operator", "front.toml", "--unknowns", "rings", "--grid", "40,64", "--absorption", "scene",
                            "--pixels", "rows.csv", "--places", "places.csv", "--quiet", "-o", "A.npz")
        matrix = {name: npy(zipfile.ZipFile(self.path("A.npz")).read(name + ".npy"))
                  for name in ("data", "indices", "indptr")}
        self.assertEqual(len(matrix["indptr"]), made["rows"] + 1)
        self.assertEqual(len(matrix["data"]), made["entries"])
        self.assertLess(max(matrix["indices"]), made["unknowns"])
        self.assertEqual(len(self.read("rows.csv").split()), made["rows"] + 1)
        self.assertEqual(len(self.read("places.csv").split()), made["unknowns"] + 1)
        self.assertGreater(min(matrix["data"]), 0)
        self.succeeds("operator", "front.toml", "--grid", "4", "--quiet", "-o", "A.mtx")
        self.assertTrue(self.read("A.mtx").startswith(b"%%MatrixMarket matrix coordinate real general"))
        self.fails(2, "operator", "front.toml", "--grid", "4", "-o", "A.txt", mentions=".npz")

    def test_rows_of_several_cameras_are_a_table_and_no_flame_is_needed(self):
        shutil.copy(EXAMPLES / "ring-of-six.toml", self.path("six.toml"))
        cameras, _, rest = self.read("six.toml").decode().partition("[[flames]]")
        self.write("bare.toml", cameras + rest[rest.index("[[channels]]"):])
        made = self.json_of("operator", "bare.toml", "--camera", "at0", "--camera", "at60", "--grid", "4", "--rays", "4",
                            "--center", "0 m,0 m,0 m", "--size", "20 mm,20 mm,40 mm", "--pixels", "rows.csv", "--quiet", "-o", "A.npz")
        rows = numpy.genfromtxt(self.path("rows.csv"), delimiter=",", names=True, dtype=None, encoding="utf-8")
        self.assertEqual(len(rows), made["rows"])
        self.assertEqual(set(rows["camera"]), {"at0", "at60"})

    def test_parts_of_the_operator_are_the_whole(self):
        """The same bits for any split, in any order; with blocks that lie across tiles, and lines that see nothing."""
        shutil.copy(EXAMPLES / "ring-of-six.toml", self.path("six.toml"))
        common = ("six.toml", "--camera", "at0", "--camera", "at60", "--grid", "6", "--rays", "4", "--quiet")
        for ending, count, extra in ((".npz", 5, ()), (".h5", 3, ("--bin", "3"))):
            whole = self.json_of("operator", *common, *extra, "-o", "whole.npz", "--pixels", "whole.csv")
            names = []
            pixels = []
            for k in range(1, count + 1):
                names.append(f"part{k}{ending}")
                self.succeeds("operator", *common, *extra, "--part", f"{k}/{count}", "-o", names[-1], "--pixels", "part.csv")
                pixels += [line.split(",", 1)[1] for line in self.read("part.csv").decode().splitlines()[1:]]
            self.assertEqual(self.json_of("merge", *reversed(names), "-o", "merged.npz")["rows"], whole["rows"])
            self.assertEqual(self.read("merged.npz"), self.read("whole.npz"))
            self.assertEqual(pixels, [line.split(",", 1)[1] for line in self.read("whole.csv").decode().splitlines()[1:]])
            self.fails(1, "merge", *names[1:], "-o", "x.npz", mentions=f"part 1/{count} is missing")
            self.fails(1, "merge", *names, names[0], "-o", "x.npz", mentions="are the same part")
            self.fails(1, "merge", names[0], "whole.npz", "-o", "x.npz", mentions="is no part")
        self.succeeds("operator", *common, "--part", "2/5", "--seed", "9", "-o", "other.npz")
        self.fails(1, "merge", "part1.npz", "other.npz", "-o", "x.npz", mentions="belongs to another matrix")
        self.fails(2, "operator", *common, "--part", "2/5", "-o", "x.mtx", mentions="--part")
        self.fails(2, "operator", *common, "--part", "6/5", "-o", "x.npz", mentions="6/5")
        self.fails(2, "merge", "part1.npz", "part2.npz", "-o", "x.exr", mentions=".npz")

    def test_a_job_array_of_the_operator(self):
        """The tasks of the script in any order make the whole, its bytes; one that is done ends at once."""
        shutil.copy(EXAMPLES / "reconstruct-front.toml", self.path("my front.toml"))
        options = "--unknowns rings --grid 4,6 --rays 4"
        self.succeeds("submit", "--slurm", "my front.toml", "--operator", "a b.npz", "--parts", "3", "--options", options, "-o", "jobs.sh")
        self.assertIn("#SBATCH --array=1-3\n", self.read("jobs.sh").decode())
        def run(*arguments, **task):
            return subprocess.run(["sh", "jobs.sh", *arguments], cwd=self.folder, capture_output=True, text=True, timeout=120,
                                  check=False, env={**os.environ, "PLENOFLAME": command.COMMAND, **task})
        for task in "312":
            result = run(SLURM_ARRAY_TASK_ID=task)
            self.assertEqual((result.returncode, result.stderr), (0, ""))
        self.assertEqual(run(SLURM_ARRAY_TASK_ID="2").stdout, "a b-part-2-of-3.npz is done\n")
        self.assertEqual(run(SLURM_ARRAY_TASK_ID="4").returncode, 2)
        result = run("merge")
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        self.succeeds("operator", "my front.toml", *options.split(), "-o", "whole.npz", "--quiet")
        self.assertEqual(self.read("a b.npz"), self.read("whole.npz"))
        def refused(*arguments, mentions):
            self.fails(2, "submit", "--slurm", *arguments, "-o", "x.sh", mentions=mentions)
        refused("my front.toml", "--operator", "a.mtx", "--parts", "2", mentions=".npz or .h5")
        refused("my front.toml", "my front.toml", "--operator", "a.npz", mentions="one scene")
        refused("my front.toml", "--operator", "a.npz", "--sweep", "set", mentions="--sweep")
        refused("my front.toml", "--operator", "a.npz", "--options", "--part 1/2", mentions="--part")
        refused("my front.toml", "--operator", "a.npz", "--options", "--grid x", mentions="--grid")
        refused("my front.toml", "--operator", "a.npz", "--options", "--camera b", mentions="b")
        self.write("other.toml", "[sweep]\n")
        self.fails(1, "submit", "--slurm", "my front.toml", "--operator", "a.npz", "--options", "other.toml", "-o", "x.sh",
                   mentions="a table [operator] is needed here, not [sweep]")
        self.assertNotIn("x.sh", self.files())

    def test_options_that_mean_nothing_to_each_other(self):
        """One line, before scenes and pictures are read: those here do not exist."""
        none = ("nowhere.toml", "--images", "nowhere.exr", "-o", "x.vdb")
        for mentions, *arguments in (
                ("no penalty", "--solver", "sirt", "--strength", "1"),
                ("no penalty", "--solver", "osem", "--prior", "p.vdb"),
                ("no penalty", "--solver", "sart", "--smoothing", "1,1,1"),
                ("stored matrix", "--solver", "osem", "--memory", "0"),
                ("resolution", "--solver", "sirt", "--spread", "1 m, 0 m, 0 m"),
                ("sart and osem", "--subsets", "4"),
                ("sirt, sart and mart", "--relaxation", "0.5"),
                ("at most 1", "--solver", "mart", "--relaxation", "1.5"),
                ("above 0", "--solver", "sirt", "--relaxation", "0"),
                ("for rings", "--axis", "fit"),
                ("for voxels", "--unknowns", "rings", "--basis", "constant"),
                ("needs --absorption", "--find", "temperature"),
                ("leave --absorption out", "--find", "both", "--absorption", "scene"),
                ("one at a time", "--channel", "a,b"),
                ("--find both", "--absorption-ratios", "0.7"),
                ("--find emission", "--find", "both", "--solver", "cgls"),
                ("--find emission", "--find", "both", "--spread", "1 m, 0 m, 0 m"),
                ("three lengths", "--spread", "here"),
                ("give --absorption", "--absorption-error", "0.1"),
                ("--find both finds", "--find", "both", "--absorption-error", "0.1"),
                ("need --draws", "--absorption", "scene", "--absorption-error", "0.1", "--draws", "0"),
                ("need --draws", "--absorption", "scene", "--absorption-error", "0.1", "--solver", "sirt"),
                ("3 axes", "--smoothing", "1")):
            self.fails(2, "reconstruct", *none, *arguments, mentions=mentions)
        # Filters in the pupil would do instead of a second channel: the scene is read first.
        self.fails(2, "reconstruct", "front.toml", "--images", "front.exr", "-o", "x.vdb", "--find", "both", "--channel", "red",
                   mentions="two channels")
        self.fails(2, "reconstruct", "front.toml", "--images", "front.exr", "-o", "x.vdb", "--bin", "101", mentions="100 x 180")
        self.fails(1, "reconstruct", "front.toml", "--images", "front.exr", "--unknowns", "rings", "--grid", "60,60",
                   "--solver", "nnls", "-o", "x.vdb", "--quiet", mentions="3600 unknowns")

    def test_bad_input(self):
        def fails(mentions, *arguments, status=1):
            self.fails(status, "reconstruct", *arguments, *FAST, mentions=mentions)
        out = ("-o", "x.vdb")
        fails("each camera", "front.toml", "side.toml", "--images", "front.exr", *out, status=2)
        fails("another camera", "front.toml", "--images", "side.exr", *out)
        fails("must end in .vdb", "front.toml", "--images", "front.exr", "-o", "x.exr", status=2)
        fails("no channel", "front.toml", "--images", "front.exr", "--channel", "blue", *out)
        fails("outside of all pictures", "front.toml", "--images", "front.exr", "--center",
              "1 m, 1 m, 0 m", "--size", "1 cm, 1 cm, 1 cm", *out)
        fails("--grid", "front.toml", "--images", "front.exr", "--grid", "4,5", *out, status=2)
        fails("--absorption", "front.toml", "--images", "front.exr", "--absorption", "8 mm", *out, status=2)
        small = self.read("front.toml").decode().replace("columns = 100", "columns = 90")
        self.write("small.toml", small)
        fails(["does not belong", "90 x 180"], "small.toml", "--images", "front.exr", *out)
        fails(["e+10 unknowns", "coarser grid"], "front.toml", "--images", "front.exr", "--grid", "4000,4000,4000", *out, status=2)
        self.assertNotIn("x.vdb", self.files())

    def test_pictures_with_values_that_cannot_be(self):
        """Bytes of an unpacked picture are replaced: one lit pixel is no number, infinite, or negative."""
        self.succeeds("render", "front.toml", "--samples", "16", "--compression", "none", "-o", "raw.exr", "--quiet")
        content = self.read("raw.exr")
        place = next(k for k in range(len(content) // 2, len(content) - 8)
                     if all(1e-11 < struct.unpack_from("<f", content, k + n)[0] < 1e-8 for n in (0, 4)))
        for name, value in (("nan", math.nan), ("inf", math.inf), ("negative", -1e-10)):
            with open(self.path(f"{name}.exr"), "wb") as file:
                file.write(content[:place] + struct.pack("<f", value) + content[place + 4:])
        for name in ("nan", "inf"):
            self.fails(1, "reconstruct", "front.toml", "--images", f"{name}.exr", "-o", "x.vdb", *FAST,
                       mentions=["not finite in pixel", f"{name}.exr"])
        _, warnings = self.reconstruct(*self.RINGS[:1], "--images", "negative.exr", *self.RINGS[3:], "-o", "negative.vdb")
        self.assertIn("negative.exr: 1 pixels are below 0", warnings)
        _, warnings = self.reconstruct(*self.RINGS[:1], "--images", "raw.exr", *self.RINGS[3:], "-o", "raw.vdb")
        self.assertNotIn("below 0", warnings)
        # Nothing of the flame in view; and so long an exposure that a part of the pixels is saturated.
        away = self.read("front.toml").decode().replace('position = ["1 m", "0 m", "-16 mm"]', 'position = ["1 m", "1 m", "0 m"]')
        self.write("away.toml", away)
        self.run_command("render", "away.toml", "--samples", "1", "-o", "dark.exr", "--quiet")
        self.fails(1, "reconstruct", "front.toml", "--images", "dark.exr", "-o", "x.vdb", *FAST, mentions="is dark in channel")
        self.succeeds("develop", "raw.exr", "--exposure", "20 us", "-o", "long.exr")
        found, warnings = self.reconstruct(*self.RINGS[:1], "--images", "long.exr", *self.RINGS[3:], "-o", "long.vdb")
        self.assertRegex(warnings, r"long\.exr: \d+ saturated pixels are left out")
        self.assertGreater(found["rows_left_out"], 100)

    def test_vectors_that_memory_does_not_hold(self):
        """Refused with the numbers before they are taken: the system would end the process when it runs out of memory."""
        limit = 8 << 30  # whatever the machine has; sanitizers take more than that for themselves
        if self.run_command("--version", address_space=limit).returncode != 0:
            limit = None
        for command in (("reconstruct", "front.toml", "--images", "front.exr", *FAST),
                        ("reconstruct", "front.toml", "--images", "front.exr", "--absorption", "scene", "--find", "temperature", *FAST),
                        ("reconstruct", "two-colours.toml", "--images", "two.exr", "--find", "both", *FAST),
                        ("operator", "front.toml", "--quiet")):
            if "two.exr" in command and "two.exr" not in self.files():
                self.succeeds("render", "two-colours.toml", "-o", "two.exr", "--samples", "2", "--quiet")
            output = "x.npz" if command[0] == "operator" else "x.vdb"
            self.fails(1, *command, "--grid", "1000,1000,1000", "-o", output, address_space=limit,
                       mentions=["1000000000 unknowns", "GB of memory", "are to be had", "coarser"])
            self.assertNotIn(output, self.files())

    def test_unknowns_that_are_slivers(self):
        for words in (("front.toml", "--images", "front.exr", "--grid", "100000,1,1"),
                      ("front.toml", "--images", "front.exr", "--unknowns", "rings", "--grid", "1,100000")):
            self.fails(2, "reconstruct", *words, "-o", "x.vdb", *FAST, mentions=["--grid", "times as long as wide", "at most 1000 times"])

    def test_the_files_of_a_frame_appear_together(self):
        names = ("a.vdb", "r.exr")
        words = ("reconstruct", *self.RINGS, "--draws", "0", "--probes", "0", "--quiet", "-o", "a.vdb", "--residual", "r.exr")
        self.assertEqual(self.run_command(*words).returncode, 0)
        written = {name: self.read(name) for name in names}
        limit = max(len(content) for content in written.values()) - 1
        for name in names:
            self.write(name, "old " + name)
        result = self.run_command(*words, largest_file=limit)
        self.assertEqual(result.returncode, 1)
        self.assertIn("largest file size", result.stderr.splitlines()[-1])
        for name in names:
            self.assertEqual(self.read(name), b"old " + name.encode())
        # Equal runs write equal files.
        self.assertEqual(self.run_command(*words).returncode, 0)
        self.assertEqual({name: self.read(name) for name in names}, written)

    @long
    def test_a_matrix_that_does_not_fit_is_not_stored(self):
        """Rays are followed again in each iteration, to the same result; solvers that need its rows refuse."""
        common = ("front.toml", "--images", "front-electrons.exr", "--grid", "12", "--rays", "8", "--bin", "2", "--strength", "1e-4",
                  "--iterations", "10", "--draws", "0", "--probes", "0")
        stored, _ = self.reconstruct(*common, "-o", "stored.vdb")
        again, _ = self.reconstruct(*common, "--memory", "0", "-o", "again.vdb")
        self.assertGreater(stored["matrix_bytes"], 0)
        self.assertLess(abs(again["largest_emission"] / stored["largest_emission"] - 1), 1e-5)
        self.assertLess(abs(again["chi_squared"] / stored["chi_squared"] - 1), 1e-5)
        # Drawn again they have the same bits; the matrix that is made of them, too.
        small = ("front.toml", "--images", "front-electrons.exr", "--grid", "8", "--rays", "2", "--bin", "4", "--strength", "1e-4",
                 "--iterations", "3", "--draws", "0", "--probes", "0")
        drawn, _ = self.reconstruct(*small, "--form", "drawn", "-o", "drawn.vdb", "--threads", "1")
        kept, _ = self.reconstruct(*small, "--form", "rays", "-o", "kept.vdb", "--threads", "3")
        for name in ("chi_squared", "largest_emission", "rays", "rows", "matrix_bytes"):
            self.assertEqual(drawn[name], kept[name], name)
        self.assertEqual((drawn["stored"], drawn["rays_kept"], kept["rays_kept"], stored["rays_kept"]), (False, False, True, True))
        self.fails(2, "reconstruct", *common, "--form", "none", "-o", "x.vdb", mentions=["--form", "drawn"])
        self.fails(2, "reconstruct", *common[:9], "--form", "drawn", "--solver", "sart", "-o", "x.vdb", mentions=["--form drawn", "sart"])
        self.fails(1, "reconstruct", "front.toml", "--images", "front.exr", *small[3:], "--form", "matrix", "--memory", "0", "-o", "x.vdb", mentions=["stored matrix", "MB"])
        # Bounds of the matrix and of the rays suffice for a refusal before any of them is drawn.
        many = ("reconstruct", "front.toml", "--images", "front.exr", "--grid", "24", "--strength", "1e-4", "-o", "x.vdb", "--quiet")
        self.fails(1, *many, "--rays", "64", "--bin", "2", "--form", "matrix", "--memory", "1",
                   mentions=["at least", "MB of the 1.00 MB", "'rays' or 'drawn'"])
        self.fails(1, *many, "--rays", "8192", "--form", "rays", "--threads", "1", address_space=2 << 30,
                   mentions=["rays would take some", "GB are to be had", "'drawn'"])
        for form in ("rays", "drawn"):
            self.succeeds("operator", "front.toml", "--grid", "6", "--rays", "4", "--bin", "2", "--form", form, "--quiet",
                          "-o", f"{form}.npz")
        self.assertEqual(self.read("rays.npz"), self.read("drawn.npz"))

    REFINE = ("--unknowns", "rings", "--grid", "12,24", "--rays", "16")

    @long
    def test_refine_finds_a_camera_that_stands_aside(self):
        # A round flame before one camera: what the scene has wrong is the axis in its picture, which is its place.
        refined, _ = self.reconstruct("front.toml", "--set", "camera.position=0 m, 0.5 mm, 0 m", "--images", "front-electrons.exr", *self.REFINE,
                                      "--refine", "pose", "--refined", "refined.toml", "-o", "refined.vdb")
        found, = (one for one in refined["corrected"] if one["quantity"] == "right")
        self.assertLess(abs(found["estimate"] - 0.5e-3), 0.05e-3, found)  # y points to the left
        self.assertIn("This is corrected.", refined["verdict"])
        # The scene that was written needs no more correction.
        again, _ = self.reconstruct("refined.toml", "--images", "front-electrons.exr", *self.REFINE, "-o", "again.vdb")
        self.assertFalse([one for one in again["suspects"] if one["named"] and one["quantity"] == "right"])
        self.assertLess(abs(again["chi_squared"] / refined["chi_squared"] - 1), 0.02)

    def test_refine_moves_the_axis_of_rings(self):
        run = ("front.toml", "--set", "camera.position=0 m, 0.5 mm, 0 m", "--images", "front-electrons.exr", *self.REFINE)
        found, _ = self.reconstruct(*run, "--refine", "axis", "-o", "moved.vdb")
        self.assertLess(abs(found["axis"]["point"][1] / 0.5e-3 - 1), 0.1)
        self.assertFalse([one for one in found["suspects"] if one["named"] and one["quantity"] == "right"])

    @long
    def test_cameras_are_tested_with_temperatures(self):
        found, warnings = self.reconstruct("front.toml", "--set", "camera.position=0 m, 0.5 mm, 0 m", "--images", "front-electrons.exr",
                                           *self.REFINE, "--absorption", "scene", "--find", "temperature", "-o", "hot.vdb", "--draws", "12")
        named = {one["quantity"]: one["estimate"] for one in found["suspects"] if one["named"]}
        self.assertLess(abs(named["right"] / 0.5e-3 - 1), 0.2)
        self.assertIn("The axis is", warnings)
        # The temperature is nearly linear in the light.
        self.assertLess(abs(math.log(found["chain_width"])), 0.2)
        self.assertGreater(found["chain_accepted"], 0.5)

    # The candle of the pictures shines from -5.4 mm to 5.4 mm around (1 m, 0), and from -15.8 mm to 15.8 mm.
    def test_the_block_is_found_by_the_pictures(self):
        for name in ("front", "side"):
            text = self.read(f"{name}.toml").decode()
            begin = text.index("[[flames]]")
            with open(self.path(f"{name}-alone.toml"), "w", encoding="utf-8") as file:
                file.write(text[:begin] + text[text.index("[[channels]]", begin):])
        run = ("front-alone.toml", "side-alone.toml", "--images", "front-electrons.exr", "side-electrons.exr", "--grid", "8", "--rays", "8",
               "--draws", "0", "--probes", "0", "--quiet")
        found, _ = self.reconstruct(*run, "-o", "found.vdb")
        self.assertLess(max(found["light_outside"]), 0.01)
        for axis, (middle, half) in enumerate(((1, 5.4e-3), (0, 5.4e-3), (0, 15.8e-3))):
            center, size = found["block"]["center"][axis], found["block"]["size"][axis]
            self.assertLess(center - size / 2, middle - 0.97 * half)
            self.assertGreater(center + size / 2, middle + 0.97 * half)
            self.assertLess(size, 3 * half)
        # The axis of rings is fitted with the block.
        rings, _ = self.reconstruct("front-alone.toml", "--images", "front-electrons.exr", *self.REFINE, "-o", "rings.vdb")
        self.assertLess(abs(rings["axis"]["point"][1]), 0.01 * 5.4e-3)
        # A block that was asked for is taken, and the one that holds the flame is told.
        cut, warnings = self.reconstruct(*run, "--center", "1 m, 0 m, 0 m", "--size", "8 mm, 8 mm, 16 mm", "-o", "cut.vdb")
        self.assertNotIn("block", cut)
        self.assertIn("The block cuts the flame: ", warnings)
        self.assertRegex(warnings, r"A block about (1 m|999\.\d mm|1000 mm), .* of the size 1[0-9.]* mm, ")
        # Much light ends at this block, and little passes beside it.
        end, warnings = self.reconstruct(*run, "--center", "1 m, 0 m, 0 m", "--size", "12 mm, 12 mm, 26 mm", "-o", "end.vdb")
        self.assertLess(max(end["light_outside"]), 0.01)
        self.assertIn("The block may cut the flame: ", warnings)

    def test_refine_refuses_what_it_cannot_do(self):
        run = ("reconstruct", "front.toml", "--images", "front-electrons.exr", *self.REFINE, "-o", "x.vdb", "--quiet")
        self.fails(2, *run, "--refine", "lens", mentions=["--refine", "exposure", "pose", "focus", "axis"])
        self.fails(2, *run[:4], "--grid", "4", "-o", "x.vdb", "--refine", "axis", mentions=["--refine axis", "voxels"])
        self.fails(2, *run, "--refine", "pose", "--solver", "sirt", mentions=["--refine", "sirt"])
        self.fails(2, *run, "--refined", "y.toml", mentions=["--refined", "--refine"])
        self.fails(2, *run, "--refine", "pose", "--refined", "y.toml", "z.toml", mentions=["2 files for 1 scenes"])
        self.fails(2, *run, "--refine", "pose", "--refined", "y.txt", mentions=["y.txt", ".toml"])
        self.fails(2, *run, "--refine", "pose", "--refined", "front.toml", mentions=["front.toml"])


if __name__ == "__main__":
    main()
