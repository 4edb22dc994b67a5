#!/usr/bin/env python3
"""Runs test.sh with tools that only say what they were told, and compares what presets need with what tools/setup.sh installs."""

import json
import os
import pathlib
import re
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
CTEST = """#!/bin/bash
echo "${TEST:-1/1 Test  #1: one ..... Passed 0.01 sec}"
""" + TOOL + """echo "100% tests passed, 0 tests failed out of 7"
"""
NINJA = """#!/bin/bash
printf 'all: phony\\na.cpp.o: CXX_COMPILER__a\\nb.cpp.o: CXX_COMPILER__b\\n'
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
        for name, text in [("tools/format.sh", TOOL), ("tests/bare/run.sh", TOOL), ("bin/cmake", TOOL), ("bin/ctest", CTEST),
                           ("bin/setarch", SETARCH), ("bin/ninja", NINJA)]:
            file = self.root / name
            file.parent.mkdir(exist_ok=True, parents=True)
            file.write_text(text)
            file.chmod(0o755)

    def run_tests(self, *options, **environment):
        (self.root / "calls").unlink(missing_ok=True)
        done = subprocess.run(
            ["bash", "test.sh", "--no-setup", *options], cwd=self.root, text=True, capture_output=True,
            env=os.environ | {"PLENOFLAME_JOBS": "2", "PATH": f"{self.root / 'bin'}:{os.environ['PATH']}",
                              "CALLS": str(self.root / "calls")} | environment)
        return done, (self.root / "calls").read_text().splitlines()

    def test_everything_runs_and_is_counted(self):
        done, calls = self.run_tests()
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        tested = [c.split()[2] for c in calls if c.startswith("ctest")]
        self.assertEqual(tested, ["release", "asan", "tsan"])
        self.assertIn("run.sh ", calls)
        # Format, bare Debian and three builds are one test each; ctest reports seven, three times.
        self.assertRegex(done.stdout.splitlines()[-1], r"^100% tests passed, 0 tests failed out of 26 \(\d+ min\)$")

    def test_all_builds_file_by_file_and_leaves_nothing_out(self):
        done, calls = self.run_tests("--all")
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertEqual([c.split()[2] for c in calls if c.startswith("ctest")], ["release", "asan", "tsan"])
        plain = [c for c in calls if "PLENOFLAME_PRECOMPILE=OFF" in c]
        self.assertEqual(len(plain), 1)
        self.assertIn("cmake --build build/file-by-file -j 2 --target a.cpp.o b.cpp.o", "\n".join(calls))
        self.assertIn("run.sh --all", calls)
        self.assertIn("ctest --preset release -j", "\n".join(calls))
        # The bare Debian runs the other tests. Where none can be made, all run here.
        for ends_with, options in [("0", "-L long|meta|paraview"), ("77", "-LE unit|fuzz|short")]:
            _, calls = self.run_tests("--all", FAILS="run.sh", FAILS_WITH=ends_with)
            release = next(c for c in calls if c.startswith("ctest --preset release"))
            self.assertTrue(release.endswith(options), release)

    def test_all_goes_on_where_it_ended_on_the_same_tree(self):
        (self.root / ".gitignore").write_text("build\ncalls\n")
        for command in ["init -q", "add -A", "-c user.name=a -c user.email=a@b commit -qm one"]:
            subprocess.run(["git", *command.split()], cwd=self.root, check=True)
        self.run_tests("--all", FAILS="ctest --preset tsan")
        done, calls = self.run_tests("--all")
        self.assertIn("Not run again: 6 tests", done.stdout)  # format, file by file, bare Debian and one of each ctest
        self.assertEqual(sum(c.startswith("ctest") and c.endswith(" -E ^(one)$") for c in calls), 3)
        self.assertNotIn("run.sh --all", calls)
        self.assertNotIn("file-by-file", "\n".join(calls))
        self.assertIn("cmake --build build/asan", "\n".join(calls))
        (self.root / "other").write_text("")
        _, calls = self.run_tests("--all")
        self.assertNotIn(" -E ", "\n".join(calls))
        self.assertIn("run.sh --all", calls)

    def test_what_fails_is_named_and_its_status_is_not_zero(self):
        for fails, named in [("--build build/asan", "build: address"), ("ctest --preset release", "tests: release"),
                             ("format.sh", "format"), ("run.sh", "bare Debian")]:
            done, _ = self.run_tests(FAILS=fails)
            self.assertNotEqual(done.returncode, 0, fails)
            self.assertIn(f"Failed: {named}", done.stdout)

    def test_what_was_skipped_is_named(self):
        done, _ = self.run_tests(FAILS="run.sh", FAILS_WITH="77",
                                 TEST="3/7 Test #3: cli.mpi .....***Skipped   0.05 sec\n[  SKIPPED ] One.Two (0 ms)\n"
                                      "test_a (__main__.B) ... skipped 'no disk'\n4/7 Test #4: b ..... Passed 0.01 sec")
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        said = done.stdout.split("Not run here:\n")[1].split("\n\n")[0].split("\n")
        self.assertEqual({line.strip() for line in said}, {"bare Debian", "cli.mpi", "One.Two", "'no disk'"})
        self.assertIn(" out of 25 ", done.stdout.splitlines()[-1])


class PresetsTest(unittest.TestCase):
    GROUPS = {"VOLUMES": "volumes", "CLI": "cli", "VTK": "vtk", "PYTHON": "pybind", "DESKTOP": "qt", "MPI": "mpi"}

    def test_setup_installs_what_the_options_of_a_preset_need(self):
        """Options that are on by default, and what a preset inherits, come from CMake's own files."""
        cmake = (ROOT / "CMakeLists.txt").read_text()
        default = {name: value == "ON" for name, value in re.findall(r'^option\(PLENOFLAME_WITH_(\w+) "[^"]*" (ON|OFF)\)', cmake, re.M)}
        presets = {p["name"]: p for p in json.loads((ROOT / "CMakePresets.json").read_text())["configurePresets"]}

        def variables(name):
            preset = presets[name]
            return (variables(preset["inherits"]) if "inherits" in preset else {}) | preset.get("cacheVariables", {})

        table = dict(line.split(None, 1) for line in
                     re.search(r"^presets='\n(.*?)^'", (ROOT / "tools/setup.sh").read_text(), re.M | re.S)[1].splitlines())
        named = {name for name, preset in presets.items() if not preset.get("hidden")}
        self.assertEqual(named - {"core-only"}, set(table) - {"wheel"})
        for name in named - {"core-only"}:
            options = {k.removeprefix("PLENOFLAME_WITH_"): v == "ON" for k, v in variables(name).items() if "_WITH_" in k}
            on = {self.GROUPS[k] for k, v in (default | options).items() if v and k in self.GROUPS}
            with_tests = variables(name).get("BUILD_TESTING", "ON") == "ON"
            needed = {"core"} | on | ({"tests"} if with_tests else set())
            self.assertLessEqual(needed, set(table[name].split()), name)
            self.assertLessEqual(set(table[name].split()) - {"site", "dev", "packaging"}, needed, name)


if __name__ == "__main__":
    unittest.main()
