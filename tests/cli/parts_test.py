"""Pictures in parts, windows and seeds; merge; scripts for a batch system."""

import math
import os
import subprocess

import command
import h5py
from command import CommandTest, main
from exr import read_exr

SCENE = """[camera]
preset = "paper-plenoptic2"
[[flames]]
preset = "paper-layered"
position = ["1 m", "0 m", "-29 mm"]
"""
WINDOW = ("--window", "1400,1400,300,200")


class Parts(CommandTest):
    def setUp(self):
        super().setUp()
        self.write("a.toml", SCENE)

    def render(self, name, *options, window=WINDOW, samples=4):
        self.succeeds("render", "a.toml", *window, "--samples", str(samples), "--quiet", "-o", name, *options)

    def parts(self, name, count, *options):
        for k in range(1, count + 1):
            self.render(name, "--part", f"{k}/{count}", *options)
        stem = name[:-4]
        return [f"{stem}-part-{k}-of-{count}.exr" for k in range(1, count + 1)]

    def test_any_division_makes_the_whole_bit_by_bit(self):
        self.render("whole.exr", "--truth")
        for count in (1, 2, 3, 7):
            names = self.parts("p.exr", count, "--truth", "--threads", str(1 + count % 2))
            self.succeeds("merge", *reversed(names), "-o", "all.exr")
            self.assertEqual(self.read("all.exr"), self.read("whole.exr"), count)

    def test_parts_share_the_work(self):
        tiles = [self.json_of("render", "a.toml", *WINDOW, "--samples", "2", "-o", "p.exr", "--part", f"{k}/4")["tiles"]
                 for k in range(1, 5)]
        self.assertEqual(sum(tiles), 20)  # of 64 x 64 pixels: 5 x 4
        self.assertEqual(set(tiles), {5})

    def test_an_exposure_of_several_moments_in_parts(self):
        self.write("a.toml", SCENE + 'time_table = "light.csv"\n')
        self.write("light.csv", "time [ms], brightness\n0, 1\n1, 0.5\n2, 0.25\n")
        timed = ("--set", "camera.sensor.exposure_time=2 ms")
        self.render("whole.exr", *timed)
        self.assertIn("exposure.moments", self.succeeds("info", "whole.exr"))
        self.succeeds("merge", *self.parts("p.exr", 2, *timed), "-o", "all.exr")
        self.assertEqual(self.read("all.exr"), self.read("whole.exr"))

    def test_parts_are_gone_on_with_and_get_more_samples(self):
        self.render("whole.exr")
        self.succeeds("render", "--resume", "whole.exr", "--samples", "8", "--quiet")
        names = self.parts("p.exr", 2)
        self.fails(1, "render", "a.toml", "--resume", names[0], "--part", "2/2", "--samples", "8",
                   mentions=["--part was 1/2 and is 2/2"])
        for name in names:
            self.succeeds("render", "--resume", name, "--samples", "8", "--quiet")
        self.succeeds("merge", *names, "-o", "all.exr")
        self.assertEqual(self.read("all.exr"), self.read("whole.exr"))
        self.fails(2, "render", "--resume", names[0], "--target-error", "1%", mentions="part of a picture")

    def test_windows_side_by_side(self):
        self.render("whole.exr")
        windows = ("1400,1400,101,200", "1501,1400,199,77", "1501,1477,199,123")
        for i, window in enumerate(windows):
            self.render(f"w{i}.exr", window=("--window", window))
        self.succeeds("merge", "w1.exr", "w0.exr", "w2.exr", "-o", "all.exr")
        self.assertEqual(self.read("all.exr"), self.read("whole.exr"))
        self.fails(1, "merge", "w0.exr", "w1.exr", "-o", "x.exr", mentions="the pixel in column 1501, row 1477")
        self.fails(1, "merge", "w0.exr", "whole.exr", "-o", "x.exr", mentions=["w0.exr and whole.exr overlap", "same seed"])
        self.assertNotIn("x.exr", self.files())

    def test_seeds_are_averaged_with_their_errors(self):
        self.render("s1.exr")
        self.render("s3.exr", "--seed", "3", samples=12)
        names = self.parts("s2.exr", 2, "--seed", "2")
        self.succeeds("merge", "s3.exr", *names, "s1.exr", "-o", "mean.exr")
        self.succeeds("merge", *names, "-o", "s2.exr")
        of_seeds = [(4, read_exr(self.path("s1.exr"))[1]), (4, read_exr(self.path("s2.exr"))[1]),
                    (12, read_exr(self.path("s3.exr"))[1])]
        attributes, mean = read_exr(self.path("mean.exr"))
        lit = 0
        for y, row in enumerate(mean["total"]):
            for x, value in enumerate(row):
                flux = sum(n * images["total"][y][x] for n, images in of_seeds) / 20
                error = math.sqrt(sum((n * images["total.error"][y][x]) ** 2 for n, images in of_seeds)) / 20
                self.assertLessEqual(abs(value - flux), 1e-7 * flux)
                self.assertLessEqual(abs(mean["total.error"][y][x] - error), 1e-6 * error)
                lit += flux > 0
        self.assertGreater(lit, 1000)
        self.assertIn("20", str(attributes["plenoflame.samples"]))
        self.fails(1, "render", "--resume", "mean.exr", "--samples", "40", mentions="with another --seed")
        self.fails(1, "merge", "mean.exr", "s1.exr", "-o", "x.exr", mentions="is merged already")

    def test_what_is_missing_doubled_or_of_another_picture(self):
        names = self.parts("p.exr", 3)
        self.fails(1, "merge", names[0], names[2], "-o", "x.exr", mentions="1 of the 3 parts is missing: 2 (seed 1")
        self.fails(1, "merge", names[0], "-o", "x.exr", mentions="2 of the 3 parts are missing: 2, 3")
        self.fails(1, "merge", *names, names[1], "-o", "x.exr", mentions=["are both part 2/3", names[1]])
        self.render("other.exr", "--part", "2/3", "--set", "camera.focus.object_distance=2 m")
        self.fails(1, "merge", names[0], "other-part-2-of-3.exr", names[2], "-o", "x.exr",
                   mentions=["other-part-2-of-3.exr does not belong to p-part-1-of-3.exr", "camera.focus.object_distance"])
        self.render("more.exr", "--part", "2/3", samples=8)
        self.fails(1, "merge", names[0], "more-part-2-of-3.exr", names[2], "-o", "x.exr", mentions="have the same")
        self.render("whole.exr")
        self.fails(1, "merge", names[0], "whole.exr", "-o", "x.exr", mentions="parts of one division")
        self.fails(2, "merge", *names, "-o", names[1], mentions="-o")
        self.fails(2, "merge", *names, "-o", "x.png", mentions=".exr")
        self.write("text.exr", "no picture")
        self.fails(1, "merge", names[0], "text.exr", "-o", "x.exr", mentions="text.exr")
        self.assertNotIn("x.exr", self.files())

    def test_bad_parts(self):
        def refused(part, mentions, *options, status=2):
            self.fails(status, "render", "a.toml", *WINDOW, "-o", "p.exr", "--part", part, *options, mentions=mentions)
        for part in ("0/4", "5/4", "2", "2/", "/4", "-1/4", "2/4/8", "a/b", "1/9999999999", "1.5/4"):
            refused(part, ["--part", part])
        refused("1/4", "--samples", "--target-error", "1%")
        refused("1/4", "--seed", "--estimator", "forward")
        refused("1/999", "20 tiles")
        refused("auto", "SLURM_ARRAY_TASK_ID")
        self.assertEqual(self.files(), ["a.toml"])

    def test_a_part_of_an_operator_claims_more_than_it_holds(self):
        """Refused in one line before memory is asked for: 8 GB here, of a file of some kilobytes."""
        common = ("a.toml", "--center", "1 m, 0 m, 0 m", "--size", "1 cm, 1 cm, 1 cm", "--grid", "2", "--rays", "2", "--quiet",
                  "--set", "camera.sensor.columns=128", "--set", "camera.sensor.rows=64")
        for k in (1, 2):
            self.succeeds("operator", *common, "--part", f"{k}/2", "-o", f"{k}.h5")
        self.succeeds("merge", "1.h5", "2.h5", "-o", "whole.h5")
        with h5py.File(self.path("2.h5"), "r+") as file:
            del file["data"]
            file.create_dataset("data", shape=(1 << 30,), dtype="f8", chunks=(1 << 20,), compression="gzip")
        self.fails(1, "merge", "1.h5", "2.h5", "-o", "x.h5", address_space=2 << 30, mentions=["2.h5", "data"])

    def test_the_task_of_a_job_array(self):
        def part(text, **variables):
            result = self.run_command("render", "a.toml", *WINDOW, "--samples", "2", "--quiet", "-o", "p.exr", "--part", text,
                                      environment={**os.environ, **variables})
            names = [name for name in self.files() if name.startswith("p-")]
            for name in names:
                os.remove(self.path(name))
            return names[0] if names else result.stderr
        array = {"SLURM_ARRAY_TASK_COUNT": "4", "SLURM_ARRAY_TASK_MIN": "0", "SLURM_ARRAY_TASK_MAX": "3"}
        self.assertEqual(part("auto", SLURM_ARRAY_TASK_ID="0", **array), "p-part-1-of-4.exr")
        self.assertEqual(part("auto", SLURM_ARRAY_TASK_ID="3", **array), "p-part-4-of-4.exr")
        self.assertEqual(part("auto/7", SLURM_ARRAY_TASK_ID="5", SLURM_ARRAY_TASK_COUNT="1"), "p-part-5-of-7.exr")
        array["SLURM_ARRAY_TASK_MAX"] = "6"
        self.assertIn("give auto/N", part("auto", SLURM_ARRAY_TASK_ID="0", **array))

    def run_script(self, script, *arguments, task=None):
        environment = {**os.environ, "PLENOFLAME": command.COMMAND}
        if task is not None:
            environment["SLURM_ARRAY_TASK_ID"] = str(task)
        return subprocess.run(["sh", script, *arguments], cwd=self.folder, env=environment, capture_output=True, text=True,
                              timeout=120, check=False)

    def test_a_job_array(self):
        options = " ".join([*WINDOW, "--samples 4"])
        self.write("b c.toml", SCENE)
        printed = self.succeeds("submit", "--slurm", "a.toml", "b c.toml", "--parts", "2", "--threads", "2", "--time", "90min",
                                "--memory", "4G", "--options", options + " --set 'render.reflections=2'", "-o", "jobs.sbatch")
        self.assertIn("sbatch --parsable jobs.sbatch", printed)
        script = self.read("jobs.sbatch").decode()
        for line in ("--array=1-4", "--cpus-per-task=2", "--time=0-01:30:00", "--mem=4G"):
            self.assertIn(f"#SBATCH {line}\n", script)
        for task in (1, 2, 3, 4):
            result = self.run_script("jobs.sbatch", task=task)
            self.assertEqual((result.returncode, result.stderr), (0, ""))
        self.assertIn("is done", self.run_script("jobs.sbatch", task=2).stdout)
        self.assertEqual(self.run_script("jobs.sbatch", task=5).returncode, 2)
        self.assertIn("sbatch", self.run_script("jobs.sbatch").stderr)
        result = self.run_script("jobs.sbatch", "merge")
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        self.render("whole.exr", "--set", "render.reflections=2")
        self.assertEqual(self.read("a.exr"), self.read("whole.exr"))
        self.assertIn("b c.exr", self.files())

    def test_bad_submissions(self):
        def refused(*arguments, mentions, status=2):
            self.fails(status, "submit", *arguments, "-o", "jobs.sbatch", mentions=mentions)
        refused("a.toml", mentions="--slurm")
        refused("--slurm", "missing.toml", mentions="missing.toml", status=1)
        refused("--slurm", "a.toml", "--options", "--sample 4", mentions="--options")
        refused("--slurm", "a.toml", "--options", "--samples 'four", mentions="quote")
        refused("--slurm", "a.toml", "--options", "--samples four", mentions="--samples")
        refused("--slurm", "a.toml", "--options", "--part 1/4", mentions="--part")
        refused("--slurm", "a.toml", "--parts", "4", "--options", "--target-error 1%", mentions="--samples")
        refused("--slurm", "a.toml", "a.toml", mentions="a.exr")
        refused("--slurm", "a.toml", "--time", "soon", mentions="--time")
        refused("--slurm", "a.toml", "--parts", "0", mentions="--parts")
        self.assertNotIn("jobs.sbatch", self.files())


if __name__ == "__main__":
    main()
