"""Pictures that several processes share under mpirun: the bits of one process, and what is said when something goes wrong."""

import filecmp
import json
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import time

import command
from command import CommandTest, long, main

SCENE = """[camera]
preset = "paper-plenoptic2"
[[flames]]
preset = "paper-layered"
position = ["1 m", "0 m", "-29 mm"]
"""
EXAMPLES = pathlib.Path(__file__).resolve().parents[2] / "examples"
WINDOW = ("--window", "1400,1400,300,200")
SWEEP = ("--window", "1400,1400,64,64", "--samples", "4", "--lattice", "4", "--threads", "1", "--quiet")
PLUGIN = os.path.join(os.path.dirname(command.COMMAND), "plugins", "libplenoflame_mpi.so")
MPIRUN = ["mpirun", "--oversubscribe", "--bind-to", "none"]
ENVIRONMENT = {**os.environ, "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
               "OMPI_MCA_btl_vader_single_copy_mechanism": "none", "OMPI_MCA_rmaps_base_oversubscribe": "1"}

# One rank, which leads and works; several, of which one leads, that share unevenly.
RANKS = (1, 2, 3, 4) if "PLENOFLAME_LONG_TESTS" in os.environ else (1, 3)


class Ranks(CommandTest):
    def setUp(self):
        super().setUp()
        self.write("a.toml", SCENE)

    def shared(self, ranks, *arguments):
        return subprocess.run([*MPIRUN, "-n", str(ranks), command.COMMAND, *arguments], cwd=self.folder, env=ENVIRONMENT,
                              capture_output=True, text=True, timeout=240, check=False, stdin=subprocess.DEVNULL)

    def renders(self, ranks, *arguments):
        result = self.shared(ranks, "render", "a.toml", *WINDOW, "--threads", "1", *arguments)
        self.assertEqual((result.returncode, result.stderr), (0, ""), arguments)
        return result.stdout

    def test_the_bits_of_one_process(self):
        options = ("--samples", "8", "--quiet")
        self.succeeds("render", "a.toml", *WINDOW, *options, "-o", "one.exr", "--truth")
        for ranks in RANKS:
            self.renders(ranks, *options, "-o", "all.exr", "--truth", "--stats", "all.json")
            self.assertEqual(self.read("all.exr"), self.read("one.exr"), ranks)
            self.assertEqual(json.loads(self.read("all.json"))["ranks"], ranks)

    def test_rounds_and_going_on(self):
        options = ("--target-error", "2%", "--quiet")
        self.succeeds("render", "a.toml", *WINDOW, *options, "-o", "one.exr", "--stats", "one.json")
        self.renders(3, *options, "-o", "all.exr", "--stats", "all.json")
        self.assertEqual(self.read("all.exr"), self.read("one.exr"))
        one, all_ranks = json.loads(self.read("one.json")), json.loads(self.read("all.json"))
        self.assertGreater(one["tiles"], 20)  # some of the 5 x 4 came in more than one round, with the sums that they had
        for key in ("rays", "rays_reached", "pairs", "tiles"):
            self.assertEqual(all_ranks[key], one[key], key)
        self.succeeds("render", "--resume", "one.exr", "--samples", "4096", "--target-error", "1.2%", "--quiet")
        result = self.shared(2, "render", "--resume", "all.exr", "--samples", "4096", "--target-error", "1.2%", "--quiet", "--threads", "1")
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        self.assertEqual(self.read("all.exr"), self.read("one.exr"))

    @long
    def test_moments_of_cameras(self):
        # Scenes come back: with the other camera, and in the passes of a target error.
        self.write("move.csv", "time [ms],y [mm]\n0,-4\n2,4\n")
        self.write("a.toml", """[[cameras]]
name = "front"
preset = "paper-previous-60x60"
[cameras.sensor]
frame_rate = "1 kHz"
exposure_time = "1 ms"
exposure_steps = 3
[[cameras]]
name = "side"
like = "front"
position = ["1 m", "-1 m", "0 m"]
look_direction = [0, 1, 0]
""" + SCENE[SCENE.index("[[flames]]"):] + 'time_table = "move.csv"\n')
        options = ("--frames", "0:1", "--target-error", "5%", "--quiet")
        self.succeeds("render", "a.toml", *options, "-o", "one.exr")
        result = self.shared(3, "render", "a.toml", *options, "--threads", "1", "-o", "all.exr")
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        for name in ("front.0000", "side.0000", "front.0001", "side.0001"):
            self.assertEqual(self.read(f"all-{name}.exr"), self.read(f"one-{name}.exr"), name)

    def test_a_rank_that_dies_costs_no_more_than_the_state(self):
        options = (*WINDOW, "--samples", "4096", "--quiet")
        process = subprocess.Popen([*MPIRUN, "-n", "3", command.COMMAND, "render", "a.toml", *options, "--threads", "1", "-o", "part.exr",
                                    "--checkpoint", "0.05s"], cwd=self.folder, env=ENVIRONMENT, stdout=subprocess.PIPE,
                                   stderr=subprocess.PIPE, text=True)
        self.addCleanup(process.communicate)
        self.addCleanup(process.kill)
        while process.poll() is None and "part.exr.state" not in self.files():
            time.sleep(0.02)
        if process.poll() is None:
            children = subprocess.run(["pgrep", "-P", str(process.pid)], capture_output=True, text=True, check=False).stdout.split()
            last = children[-1]
            os.kill(int(last), signal.SIGKILL)
        _, errors = process.communicate(timeout=60)
        self.assertNotEqual(process.returncode, 0)
        self.assertIn("signal 9", errors)
        self.assertIn("part.exr.state", self.files())
        result = self.shared(2, "render", "--resume", "part.exr", "--quiet", "--threads", "1")
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        self.succeeds("render", "a.toml", *options, "-o", "whole.exr")
        self.assertEqual(self.read("part.exr"), self.read("whole.exr"))

    def sweep(self, ranks, folder, *options):
        return self.shared(ranks, "sweep", "a.toml", "--table", "runs.csv", "-o", folder, *SWEEP, *options)

    def assert_same(self, one, other):
        names = sorted(os.path.relpath(os.path.join(path, name), self.path(one)) for path, _, files in os.walk(self.path(one))
                       for name in files)
        self.assertEqual(names, sorted(os.path.relpath(os.path.join(path, name), self.path(other))
                                       for path, _, files in os.walk(self.path(other)) for name in files))
        self.assertEqual(filecmp.cmpfiles(self.path(one), self.path(other), names, shallow=False)[1:], ([], []))

    def runs(self, rows, header="flames[0].brightness"):
        self.write("runs.csv", header + "\n" + "".join(f"{row}\n" for row in rows))

    def test_a_sweep_has_the_same_bits(self):
        self.runs([1, 0.9, 0.8, 0.7, 0.6])
        for form in ("exr", "hdf5"):
            self.succeeds("sweep", "a.toml", "--table", "runs.csv", "-o", "one" + form, *SWEEP, "--format", form)
            for ranks in RANKS:
                result = self.sweep(ranks, f"all{form}{ranks}", "--format", form)
                self.assertEqual((result.returncode, result.stderr), (0, ""), ranks)
                self.assert_same("one" + form, f"all{form}{ranks}")

    @long
    def test_what_is_wrong_with_a_run_of_a_sweep_is_said_once(self):
        self.runs([1, 0.5, "none.vdb", 0.5], "flames[0].brightness")
        result = self.sweep(3, "set")
        self.assertEqual(result.returncode, 1)
        self.assertRegex(result.stderr, r"\Aplenoflame: error: [^\n]*runs.csv:4:1: [^\n]*\n")
        # This one is found only while the run is made.
        self.write("b.toml", SCENE.replace('preset = "paper-layered"', 'kind = "vdb"\nfile = "a.vdb"'))
        self.runs(["missing.vdb"] * 3, "flames[0].file")
        result = self.shared(3, "sweep", "b.toml", "--table", "runs.csv", "-o", "other", "--samples", "2", "--quiet")
        self.assertEqual(result.returncode, 1)
        lines = [line for line in result.stderr.splitlines() if line.startswith("plenoflame: ")]
        self.assertEqual(len(lines), 1, result.stderr)
        self.assertIn("missing.vdb", lines[0])

    @long
    def test_a_rank_of_a_sweep_that_dies_costs_no_more_than_its_runs(self):
        self.runs([1 - 0.01 * run for run in range(12)])
        options = ("sweep", "a.toml", "--table", "runs.csv", "--window", "1400,1400,128,128", "--samples", "512", "--quiet",
                   "--threads", "1")
        process = subprocess.Popen([*MPIRUN, "-n", "3", command.COMMAND, *options, "-o", "set"], cwd=self.folder, env=ENVIRONMENT,
                                   stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.addCleanup(process.communicate)
        self.addCleanup(process.kill)
        def done():
            return [n for n in os.listdir(self.path("set/runs")) if n.endswith(".json")] if os.path.isdir(self.path("set/runs")) else []
        while process.poll() is None and not done():
            time.sleep(0.02)
        self.assertIsNone(process.poll(), "it ended too early")
        children = subprocess.run(["pgrep", "-P", str(process.pid)], capture_output=True, text=True, check=False).stdout.split()
        os.kill(int(children[-1]), signal.SIGKILL)
        _, errors = process.communicate(timeout=60)
        self.assertNotEqual(process.returncode, 0)
        self.assertIn("signal 9", errors)
        self.assertTrue(0 < len(done()) < 12, done())
        result = self.shared(2, *options, "-o", "set")
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        self.succeeds(*options, "-o", "one")
        self.assert_same("set", "one")

    def test_a_reconstruction_has_the_same_bits(self):
        """With an axis that is fitted first, and of two quantities. The matrix is too small for several ranks, and stays on the first one."""
        self.succeeds("flame", "candle", "--voxel-size", "1 mm", "-o", "candle.vdb")
        common = ("--unknowns", "rings", "--grid", "4,6", "--draws", "0", "--probes", "0", "--quiet")
        for scene, all_ranks, more in (
                ("front", (1, 2, 3, 4), ("--axis", "fit", "--rays", "128", "--iterations", "10", "--residual", "r.exr")),
                ("two-colours", (1, 3), ("--find", "both", "--rays", "8", "--bin", "5", "--iterations", "1"))):
            shutil.copy(EXAMPLES / f"reconstruct-{scene}.toml", self.path(f"{scene}.toml"))
            self.succeeds("render", f"{scene}.toml", "--samples", "8", "--quiet", "-o", "p.exr")
            shutil.copy(self.path("p.exr"), self.path(f"{scene}.exr"))
            options = ("reconstruct", f"{scene}.toml", "--images", "p.exr", *common, *more, "-o", "r.vdb", "--report", "r.json")
            found = []
            for ranks in all_ranks:
                result = self.shared(ranks, *options, "--threads", "1")
                self.assertEqual(result.returncode, 0, result.stderr)
                found.append([self.read("r.json"), self.read("r.exr")])
                self.assertEqual(found[-1], found[0], (scene, ranks))
        # Rays of forms without a matrix are the first rank's own.
        found = []
        for form in ("rays", "drawn"):
            result = self.shared(2, "reconstruct", "front.toml", "--images", "front.exr", *common, "--rays", "4", "--bin", "8", "--iterations", "2",
                                 "--strength", "1e-4", "--form", form, "--threads", "1", "--json", "-o", "x.vdb")
            self.assertEqual(result.returncode, 0, result.stderr)
            found.append(json.loads(result.stdout))
            self.assertEqual(found[-1].pop("rays_kept"), form == "rays")
        self.assertEqual(found[0], found[1])
        result = self.shared(3, *options[:3], "none.exr", "-o", "x.vdb")
        lines = [line for line in result.stderr.splitlines() if line.startswith("plenoflame: ")]
        self.assertEqual((result.returncode, len(lines)), (1, 1), result.stderr)
        self.assertIn("none.exr", lines[0])

    def test_each_rank_keeps_its_share_of_the_matrix(self):
        """Two cameras and voxels, whose matrix is shared: the bits of one process, and the memory of each rank."""
        self.succeeds("flame", "candle", "--voxel-size", "1 mm", "-o", "candle.vdb")
        for name in ("front", "side"):
            shutil.copy(EXAMPLES / f"reconstruct-{name}.toml", self.path(f"{name}.toml"))
            self.succeeds("render", f"{name}.toml", "--samples", "8", "--quiet", "-o", f"{name}.exr")
        self.write("measured.sh", f"""#!{sys.executable}
import os, resource, subprocess, sys
status = subprocess.call(sys.argv[1:])
with open("memory." + os.environ["OMPI_COMM_WORLD_RANK"], "w") as file:
    file.write(str(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss))
sys.exit(status)
""")
        os.chmod(self.path("measured.sh"), 0o755)

        def memory(ranks, *arguments):
            """[kB] of each rank."""
            result = subprocess.run([*MPIRUN, "-n", str(ranks), "./measured.sh", command.COMMAND, *arguments], cwd=self.folder,
                                    env=ENVIRONMENT, capture_output=True, text=True, timeout=240, check=False, stdin=subprocess.DEVNULL)
            self.assertEqual(result.returncode, 0, result.stderr)
            return [int(self.read(f"memory.{rank}")) for rank in range(ranks)]

        idle = memory(1, "info", "front.toml")[0]
        common = ("reconstruct", "front.toml", "side.toml", "--images", "front.exr", "side.exr", "--grid", "48", "--rays", "32",
                  "--strength", "1e-4", "--iterations", "4", "--probes", "0", "--draws", "0", "--threads", "1", "--quiet",
                  "-o", "x.vdb", "--residual", "a.exr", "b.exr", "--report", "x.json")
        one = memory(1, *common)[0] - idle
        files = [self.read(name) for name in ("x.vdb", "a.exr", "b.exr")]
        figures = json.loads(self.read("x.json"))
        self.assertGreater(figures["matrix_bytes"], 5e7)
        for ranks in (2, 3):
            each = memory(ranks, *common)
            self.assertEqual([self.read(name) for name in ("x.vdb", "a.exr", "b.exr")], files, ranks)
            self.assertEqual(json.loads(self.read("x.json")), figures, ranks)
            self.assertLess((max(each) - idle) / one, 0.2 + 1.2 / ranks, (each, idle, one))

    def test_wrong_input_is_said_once(self):
        for arguments, status, text in ((("render", "missing.toml", "-o", "x.exr"), 1, "missing.toml"),
                                        (("render", "a.toml", "--sample", "4"), 2, "--sample")):
            result = self.shared(3, *arguments)
            lines = [line for line in result.stderr.splitlines() if line.startswith("plenoflame: ")]
            self.assertEqual(len(lines), 1, result.stderr)
            self.assertIn(text, lines[0])
            self.assertEqual(result.returncode, status)

    def test_other_commands_run_once(self):
        result = self.shared(2, "info", "a.toml")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(result.stdout, self.succeeds("info", "a.toml"))


class WithoutMpi(CommandTest):
    def test_a_build_without_mpi_says_so_once(self):
        copy = self.path("plenoflame")
        shutil.copy(command.COMMAND, copy)
        for rank, text in ((0, "mpirun started several processes, and this build has no MPI"), (1, "")):
            result = subprocess.run([copy, "info", "a.toml"], cwd=self.folder, capture_output=True, text=True, check=False,
                                    env={**os.environ, "OMPI_COMM_WORLD_SIZE": "2", "OMPI_COMM_WORLD_RANK": str(rank)})
            self.assertEqual(result.returncode, 2)
            self.assertEqual(len(result.stderr.splitlines()), 1 if text else 0)
            self.assertIn(text, result.stderr)


if __name__ == "__main__":
    if not os.path.exists(PLUGIN) or not shutil.which("mpirun"):
        print("skipped: built without MPI, or there is no mpirun (tools/setup.sh mpi)")
        sys.exit(77)
    main()
