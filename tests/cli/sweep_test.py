"""Sweeps: sets of many runs, whatever their order, threads and parts; what bad tables and rules get."""

import csv
import filecmp
import json
import os
import shutil
import signal
import subprocess
import time

import command
from command import CommandTest, main

SCENE = """[camera]
preset = "paper-plenoptic2"
[[flames]]
preset = "paper-layered"
position = ["1 m", "0 m", "-29 mm"]
"""
TABLE = """flames[0].position,flames[0].brightness
"1 m, 0 m, -29 mm",1
"1 m, 2 mm, -29 mm",0.5
"1 m, -2 mm, -29 mm",
"""
# The box of the lattice holds the flames of all runs.
OPTIONS = ("--window", "1400,1400,64,64", "--samples", "4", "--lattice", "4,4,6", "--region",
           "0.98m,-15mm,-32mm:1.02m,15mm,35mm", "--quiet")
# Runs the tasks of an array one after the other, and what waits for it when all went well.
SBATCH = """#!/bin/sh
set -eu
tasks() {
  for task in $(seq "$(sed -n 's/^#SBATCH --array=1-//p' "$1")"); do SLURM_ARRAY_TASK_ID=$task sh "$1" >&2; done
}
case $1 in
  --parsable) tasks "$2"; echo 42 ;;
  --dependency=afterok:42) [ "$2" = --wrap ]; sh -c "$3" ;;
  *) tasks "$1" ;;
esac
"""


class Sweeps(CommandTest):
    def setUp(self):
        super().setUp()
        self.write("a.toml", SCENE)
        self.write("runs.csv", TABLE)

    def sweep(self, folder, *options, table="runs.csv"):
        self.succeeds("sweep", "a.toml", "--table", table, "-o", folder, *OPTIONS, *options)

    def assert_same(self, one, other):
        def files(folder):
            return sorted(os.path.relpath(os.path.join(path, name), self.path(folder))
                          for path, _, names in os.walk(self.path(folder)) for name in names)
        self.assertEqual(files(one), files(other))
        self.assertEqual(filecmp.cmpfiles(self.path(one), self.path(other), files(one), shallow=False)[1:], ([], []))

    def index(self, folder):
        with open(self.path(folder + "/index.csv"), newline="", encoding="utf-8") as file:
            return list(csv.DictReader(file))

    def test_parts_threads_and_a_break_make_the_same_set(self):
        for format_name in ("exr", "hdf5"):
            options = ("--format", format_name, "--test-share", "34%")
            self.sweep(format_name, *options, "--threads", "1")
            for k in (2, 1):
                self.sweep("p" + format_name, *options, "--part", f"{k}/2", "--threads", "2")
            parts = [f"p{format_name}-part-{k}-of-2" for k in (1, 2)]
            self.succeeds("merge", *parts, "-o", "all" + format_name)
            self.assert_same(format_name, "all" + format_name)
        for end in ("json", "exr"):
            os.remove(self.path(f"exr/runs/000001.{end}"))
        self.sweep("exr", "--format", "exr", "--test-share", "34%")
        self.assert_same("exr", "allexr")
        self.assertEqual([row["split"] for row in self.index("exr")].count("test"), 1)

    def test_a_run_is_the_picture_that_render_makes(self):
        self.sweep("set")
        row = self.index("set")[1]
        self.succeeds("render", "a.toml", "--set", "flames[0].position=1 m, 2 mm, -29 mm", "--set", "flames[0].brightness=0.5",
                      *OPTIONS[:4], "--quiet", "--seed", row["seed"], "-o", "one.exr")
        self.assertEqual(self.read("one.exr"), self.read("set/" + row["picture"]))

    def test_cameras_and_exposures(self):
        """Each camera has the picture that render makes, with what the run says of it."""
        self.write("two.toml", """[[cameras]]
name = "front"
preset = "paper-previous-60x60"
[[cameras]]
name = "side"
like = "front"
position = ["1 m", "-1 m", "0 m"]
look_direction = [0, 1, 0]
""" + SCENE[SCENE.index("[[flames]]"):])
        self.write("two.csv", "cameras[side].focus.object_distance,cameras.front.sensor.exposure_time\n1 m,1 ms\n0.9 m,3 ms\n")
        common = ("two.toml", "--samples", "2", "--quiet")
        self.succeeds("sweep", *common, "--table", "two.csv", "-o", "set")
        rows = self.index("set")
        self.assertEqual([(row["run"], row["camera"]) for row in rows], [("0", "front"), ("0", "side"), ("1", "front"), ("1", "side")])
        self.succeeds("render", *common, "--set", "cameras[side].focus.object_distance=0.9 m", "--set",
                      "cameras.front.sensor.exposure_time=3 ms", "--seed", rows[2]["seed"], "-o", "one.exr")
        for row in rows[2:]:
            self.assertEqual(self.read("set/" + row["picture"]), self.read(f"one-{row['camera']}.exr"), row["camera"])
        self.assertRegex(self.succeeds("info", "set/" + rows[2]["picture"]), r"exposure.time: +3 ms")

    def test_bad_tables(self):
        def refused(text, *mentions):
            self.write("bad.csv", text)
            self.fails(1, "sweep", "a.toml", "--table", "bad.csv", "-o", "x", *OPTIONS, mentions=["bad.csv:", *mentions])
        refused("flames[0].brightnes\n1\n", "bad.csv:2:1", "flames[0].brightness")
        refused("flames[0].name,flames[0].brightness\na,1\nb,red\n", "bad.csv:3:3", "red")
        refused("flames[0].brightness\n1,2\n", "bad.csv:2", "2 cells")
        refused("flames[0].brightness\n", "no row")
        refused("flames[0].position\n\"1 m\n", "bad.csv:2:1", "quote")
        self.assertNotIn("x", self.files())

    def test_bad_rules(self):
        def refused(text, *mentions):
            self.write("bad.toml", "runs = 3\n[[random]]\nkey = \"flames[0].brightness\"\n" + text)
            self.fails(1, "sweep", "a.toml", "--random", "bad.toml", "-o", "x", *OPTIONS, mentions=["bad.toml:", *mentions])
        refused("uniform = [2, 1]\n", "bad.toml:4:11", "least")
        refused("unifrom = [1, 2]\n", "bad.toml:4:11", "unifrom")
        refused("log_uniform = [0, 2]\n", "bad.toml:4:15", "above 0")
        refused("uniform = [\"1 m\", \"2 mm\"]\n", "same unit")
        refused("uniform = [\"1 m\", \"2 m\"]\n", "bad.toml:3:7", "run 0", "brightness")
        refused("", "no rule")

    def test_random_values_lie_where_the_rules_say(self):
        self.write("rules.toml", "[[random]]\nkey = \"flames[0].brightness\"\nlog_uniform = [0.5, 2]\n")
        self.succeeds("sweep", "a.toml", "--random", "rules.toml", "--runs", "4", "-o", "set", *OPTIONS)
        values = [float(row["flames[0].brightness"]) for row in self.index("set")]
        self.assertEqual(len(set(values)), 4)
        self.assertTrue(all(0.5 <= value <= 2 for value in values), values)

    def test_parts_that_do_not_fit_and_other_sweeps(self):
        self.sweep("p", "--part", "1/2")
        self.fails(1, "merge", "p-part-1-of-2", "-o", "all", mentions="part 2 of 2 is missing")
        self.fails(1, "merge", "p-part-1-of-2", "p-part-1-of-2", "-o", "all", mentions="are both part 1/2")
        self.write("other.csv", TABLE.replace("0.5", "0.6"))
        self.sweep("q", "--part", "2/2", table="other.csv")
        self.fails(1, "merge", "p-part-1-of-2", "q-part-2-of-2", "-o", "all", mentions=["different sweeps", "table"])
        self.fails(1, "sweep", "a.toml", "--table", "other.csv", "-o", "p", "--part", "1/2", *OPTIONS, mentions="differs in table")
        self.assertNotIn("all", self.files())

    def test_damaged_sets_are_named(self):
        self.sweep("p", "--part", "1/2")
        self.sweep("p", "--part", "2/2")
        parts = ("p-part-1-of-2", "p-part-2-of-2")
        wrong = {"sweep.json": (("part", 3), ("part", "x"), ("runs", "many"), ("format", 1), ("lattice", []), (None, None)),
                 "runs/000001.json": (("run", []), ("seed", "s"), ("values", {"a": 1}), ("pictures", 3), ("lines", None), (None, None))}
        for name, changes in wrong.items():
            path = "p-part-2-of-2/" + name
            whole = self.read(path)
            for key, value in changes:
                self.write(path, json.dumps({**json.loads(whole), key: value} if key else []))
                self.fails(1, "merge", *parts, "-o", "all", mentions=["'" + path + "'", "damaged"])
            self.write(path, whole)
        self.succeeds("merge", *parts, "-o", "all")
        result = self.run_command("merge", *parts, "-o", "all")
        self.assertEqual((result.returncode, "has files in it" in result.stderr, "--force" in result.stderr), (1, True, False))
        largest = max(os.path.getsize(os.path.join(at, name)) for at, _, names in os.walk(self.path("all")) for name in names)
        self.fails(1, "merge", *parts, "-o", "new", largest_file=largest - 1, mentions=["'new/", "largest file size"])
        self.assertNotIn("new", self.files())

    def test_tables_in_other_encodings(self):
        for encoding in ("utf-16", "utf-16-le", "utf-16-be"):
            self.write("wide.csv", TABLE.encode(encoding))
            self.fails(1, "sweep", "a.toml", "--table", "wide.csv", "-o", "set", *OPTIONS, mentions=["wide.csv", "UTF-16", "save it as UTF-8"])
            self.write("wide.toml", SCENE.encode(encoding))
            self.fails(1, "info", "wide.toml", mentions=["wide.toml", "UTF-16", "UTF-8"])
        self.write("marked.csv", TABLE.encode("utf-8-sig"))
        self.sweep("marked", table="marked.csv")
        self.sweep("plain")
        self.assertEqual(self.read("marked/index.csv"), self.read("plain/index.csv"))

    def test_a_lattice_that_memory_does_not_hold(self):
        options = [o for o in OPTIONS if o not in ("--lattice", "4,4,6")]
        self.fails(1, "sweep", "a.toml", "--table", "runs.csv", "-o", "set", *options, "--lattice", "1000,1000,1000", address_space=4 << 30,
                   mentions=["--lattice", "1e+09 cells", "8 GB of memory", "are to be had", "fewer cells"])
        self.assertNotIn("set", self.files())

    def test_no_room_for_a_run_leaves_those_that_are_done(self):
        self.sweep("set")
        os.remove(self.path("set/runs/000002.json"))
        self.fails(1, "sweep", "a.toml", "--table", "runs.csv", "-o", "set", *OPTIONS, largest_file=20000,
                   mentions=["000002", "2 of 3 runs are in set; the same command continues"])
        self.assertIn("000001.json", os.listdir(self.path("set/runs")))
        self.sweep("set")

    def test_no_room_for_the_packed_set_leaves_the_runs(self):
        self.sweep("set", "--format", "hdf5")
        whole = self.read("set/set.h5")
        shutil.rmtree(self.path("set"))
        # Each run's picture has room, all three together have not.
        self.fails(1, "sweep", "a.toml", "--table", "runs.csv", "-o", "set", *OPTIONS, "--format", "hdf5",
                   largest_file=len(whole) * 2 // 3, mentions=["set.h5", "3 of 3 runs are in set; the same command continues"])
        self.assertEqual(sorted(n for n in os.listdir(self.path("set/runs")) if n.endswith(".json")),
                         [f"00000{k}.json" for k in range(3)])
        self.assertNotIn("set.h5", os.listdir(self.path("set")))
        self.sweep("set", "--format", "hdf5")
        self.assertEqual(self.read("set/set.h5"), whole)

    def submitted(self, printed):
        """What a shell makes of the printed lines where sbatch is the one above."""
        self.write("sbatch", SBATCH)
        os.chmod(self.path("sbatch"), 0o755)
        return subprocess.run(["sh", "-e", "-c", printed], cwd=self.folder, capture_output=True, text=True, timeout=120, check=False,
                              env={**os.environ, "PATH": self.folder + ":" + os.environ["PATH"], "PLENOFLAME": command.COMMAND})

    def test_a_job_array(self):
        for parts, name in ((2, "my set"), (1, "one")):
            options = f"--table runs.csv --format hdf5 --test-share 34% {' '.join(OPTIONS)}"
            printed = self.succeeds("submit", "--slurm", "a.toml", "--sweep", name + "/", "--parts", str(parts), "--threads", "2",
                                    "--options", options, "-o", "jobs.sbatch")
            result = self.submitted(printed)
            self.assertEqual((result.returncode, result.stderr), (0, ""))
            self.assertEqual("merged" in result.stdout, parts > 1)
        self.sweep("whole", "--format", "hdf5", "--test-share", "34%")
        self.assert_same("whole", "my set")
        self.assert_same("whole", "one")

    def test_a_task_that_is_begun_anew_makes_what_is_left(self):
        printed = self.succeeds("submit", "--slurm", "a.toml", "--sweep", "set", "--parts", "2", "-o", "jobs.sbatch",
                                "--options", "--table runs.csv " + " ".join(OPTIONS))
        self.assertEqual(self.submitted(printed).returncode, 0)
        def record(run):
            return self.path(f"set-part-1-of-2/runs/00000{run}.json")
        before = os.stat(record(0))
        os.remove(record(2))
        environment = {**os.environ, "SLURM_ARRAY_TASK_ID": "1", "PLENOFLAME": command.COMMAND}
        subprocess.run(["sh", "jobs.sbatch"], cwd=self.folder, env=environment, check=True, timeout=60)
        self.assertTrue(os.path.exists(record(2)))
        self.assertEqual(os.stat(record(0)).st_mtime_ns, before.st_mtime_ns)
        environment["SLURM_ARRAY_TASK_ID"] = "3"
        result = subprocess.run(["sh", "jobs.sbatch"], cwd=self.folder, env=environment, check=False, timeout=60,
                                capture_output=True, text=True)
        self.assertEqual((result.returncode, result.stderr), (2, "there is no task 3\n"))

    def test_bad_submissions(self):
        def refused(options, mentions, *more, status=2, scenes=("a.toml",)):
            self.fails(status, "submit", "--slurm", *scenes, "--sweep", "set", *more, "--options", options, "-o", "jobs.sbatch",
                       mentions=mentions)
        self.write("bad.csv", "flames[0].brightness\n1\nred\n")
        refused("--table bad.csv", "bad.csv:3:1", status=1)
        refused("--table runs.csv --sample 4", "--options")
        self.write("other.toml", "[operator]\n")
        refused("other.toml", "a table [sweep] is needed here, not [operator]", status=1)
        refused("--table runs.csv --part 1/2", "--part")
        refused("--table runs.csv -o other", "--output")
        refused("", "--table")
        refused("runs.csv", "give scenes before --options")
        refused("--table runs.csv", "3 runs", "--parts", "4")
        refused("--table runs.csv", "one scene", scenes=("a.toml", "b.toml"))
        for memory in ("4", "4e9", "1.5"):  # sbatch takes megabytes
            refused("--table runs.csv", ["--memory", "4G", memory], "--memory", memory, status=2)
        self.assertNotIn("jobs.sbatch", self.files())

    def begun(self, *options):
        """A sweep that runs in the background, of runs of about a second, until one of them is done."""
        self.write("long.csv", "flames[0].brightness\n1\n0.9\n0.8\n0.7\n0.6\n0.5\n")
        arguments = ("sweep", "a.toml", "--table", "long.csv", "-o", "set", "--window", "1400,1400,128,128", "--samples", "512",
                     "--threads", "1", "--quiet", *options)
        process = subprocess.Popen([command.COMMAND, *arguments], cwd=self.folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                   text=True)
        self.addCleanup(process.communicate)
        self.addCleanup(process.kill)
        while process.poll() is None and not os.path.exists(self.path("set/runs/000000.json")):
            time.sleep(0.02)
        self.assertIsNone(process.poll(), "it ended too early")
        return process, arguments

    def goes_on(self, arguments):
        """The same command makes the rest; the set is that of a run that nobody stopped."""
        kept = {name: os.stat(self.path("set/runs/" + name)).st_mtime_ns for name in os.listdir(self.path("set/runs"))
                if name.endswith(".json")}
        self.assertLess(len(kept), 6)
        self.succeeds(*arguments)
        for name, when in kept.items():
            self.assertEqual(os.stat(self.path("set/runs/" + name)).st_mtime_ns, when, name)
        self.succeeds(*("whole" if argument == "set" else argument for argument in arguments))
        self.assert_same("set", "whole")

    def test_interrupted(self):
        process, arguments = self.begun()
        process.send_signal(signal.SIGINT)
        out, errors = process.communicate(timeout=60)
        self.assertEqual((process.returncode, out), (1, ""))
        self.assertRegex(errors, r"\Aplenoflame: stopped; [1-5] of 6 runs are in set; the same command continues\n\Z")
        self.goes_on(arguments)

    def test_killed(self):
        process, arguments = self.begun()
        process.kill()
        process.communicate(timeout=60)
        self.goes_on(arguments)


if __name__ == "__main__":
    main()
