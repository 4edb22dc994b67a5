"""Pictures that several processes share under mpirun: the bits of one process, and what is said when something goes wrong."""

import json
import os
import shutil
import signal
import subprocess
import sys
import time

import command
from command import CommandTest, main

SCENE = """[camera]
preset = "paper-plenoptic2"
[[flames]]
preset = "paper-layered"
position = ["1 m", "0 m", "-29 mm"]
"""
WINDOW = ("--window", "1400,1400,300,200")
PLUGIN = os.path.join(os.path.dirname(command.COMMAND), "plugins", "libplenoflame_mpi.so")
MPIRUN = ["mpirun", "--oversubscribe", "--bind-to", "none"]
ENVIRONMENT = {**os.environ, "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
               "OMPI_MCA_btl_vader_single_copy_mechanism": "none", "OMPI_MCA_rmaps_base_oversubscribe": "1"}


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
        for ranks in (1, 2, 3, 4):
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
