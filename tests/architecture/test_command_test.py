#!/usr/bin/env python3
"""Runs test.sh with tools that only say what they were told: its limit in time holds for all that it does."""

import os
import pathlib
import shutil
import subprocess
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]

# Every tool writes down what it was called with; a name that the test chose fails.
TOOL = """#!/bin/bash
echo "$(basename "$0") $*" >>"$CALLS"
[[ -z "${FAILS:-}" || "$(basename "$0") $*" != *"$FAILS"* ]] || exit "${FAILS_WITH:-1}"
"""
CMAKE = TOOL + """case "$*" in *"--build --preset asan"*) sleep "${BUILD_TAKES:-0}" ;; esac
"""
CTEST = """#!/bin/bash
echo "${TEST:-1/1 Test  #1: one ..... Passed 0.01 sec}"
""" + TOOL + """echo "100% tests passed, 0 tests failed out of 7"
"""
TIMEOUT = """#!/bin/bash
echo "timeout $*" >>"$CALLS"
while [[ "$1" == --* ]]; do shift; done
shift
exec "$@"
"""
SETARCH = """#!/bin/bash
shift 2
exec "$@"
"""


class TestCommand(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = pathlib.Path(folder.name)
        shutil.copy(ROOT / "test.sh", self.root)
        for name, text in [("tools/format.sh", TOOL), ("bin/cmake", CMAKE), ("bin/ctest", CTEST),
                           ("bin/timeout", TIMEOUT), ("bin/setarch", SETARCH)]:
            file = self.root / name
            file.parent.mkdir(exist_ok=True)
            file.write_text(text)
            file.chmod(0o755)

    def run_tests(self, *options, **environment):
        done = subprocess.run(
            ["bash", "test.sh", "--no-setup", *options], cwd=self.root, text=True, capture_output=True,
            env=os.environ | {"PATH": f"{self.root / 'bin'}:{os.environ['PATH']}",
                              "CALLS": str(self.root / "calls")} | environment)
        return done, (self.root / "calls").read_text().splitlines()

    def test_everything_runs_and_is_counted(self):
        done, calls = self.run_tests()
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        tested = [c.split()[2] for c in calls if c.startswith("ctest")]
        self.assertEqual(tested, ["release", "asan", "tsan"])
        # The format and four builds are one test each that is counted when it fails; ctest reports seven.
        self.assertRegex(done.stdout.splitlines()[-1], r"^100% tests passed, 0 tests failed out of \d+$")

    def test_no_command_is_given_more_than_what_is_left(self):
        minutes = 10
        done, calls = self.run_tests("--minutes", str(minutes), BUILD_TAKES="3")
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        given = [next(int(word) for word in call.split() if word.isdigit())
                 for call in calls if call.startswith("timeout")]
        self.assertEqual(len(given), 4, calls)  # builds and tests of both sanitizers
        self.assertLessEqual(given[0], 60 * minutes)
        # The first one's build took three seconds; both ends of them are counted in whole seconds.
        self.assertLessEqual(given[1], given[0] - 2)
        self.assertEqual(given, sorted(given, reverse=True))

    def test_what_fails_is_named_and_its_status_is_not_zero(self):
        for fails, named in [("--build --preset core-only", "build: core alone"), ("ctest --preset release", "tests: release"),
                             ("format.sh", "format")]:
            (self.root / "calls").unlink(missing_ok=True)
            done, _ = self.run_tests(FAILS=fails)
            self.assertNotEqual(done.returncode, 0, fails)
            self.assertIn(f"Failed: {named}", done.stdout)

    def test_sanitizer_that_ran_out_of_time_is_left_out_and_said(self):
        done, _ = self.run_tests("--minutes", "10", FAILS="ctest --preset asan", FAILS_WITH="124")
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertIn("Left out for want of time: the rest of tests: asan", done.stdout)

    def test_skipped_tests_of_a_run_that_ended_early_are_no_failures(self):
        for ended, passes in [("***Skipped", True), ("***Failed", False), ("***Exception: SegFault", False),
                              ("***Timeout", False), ("***Not Run", False)]:
            done, _ = self.run_tests("--minutes", "10", FAILS="ctest --preset asan", FAILS_WITH="124",
                                     TEST=f"3/7 Test #3: one .....{ended}   0.05 sec\n********* Start testing of One")
            self.assertEqual(done.returncode == 0, passes, done.stdout + done.stderr)
            self.assertIn(f" {0 if passes else 1} tests failed", done.stdout.splitlines()[-1])
            self.assertEqual("Failed: tests: asan" in done.stdout, not passes, ended)


if __name__ == "__main__":
    unittest.main()
