"""plenoflame render: what it writes, where its output goes, and messages before any work."""

import json
import math
import os
import resource
import signal
import struct
import subprocess

import command
from command import CommandTest, main
from exr import read_exr

SCENE = """[camera]
preset = "paper-plenoptic2"
[[flames]]
preset = "paper-layered"
position = ["1 m", "0 m", "-29 mm"]
"""
WINDOW = ("--window", "1480,1490,24,20")


# Seconds after which a run is interrupted: machines differ in when it begins, and when it is through.
DELAYS = [0.1 * 1.35 ** k for k in range(12)]


class Render(CommandTest):
    def setUp(self):
        super().setUp()
        self.write("a.toml", SCENE)

    def test_image(self):
        out = self.succeeds("render", "a.toml", *WINDOW, "--samples", "16", "--seed", "7", "--stats", "s.json")
        self.assertIn("relative RMSE", out)
        self.assertEqual(self.files(), ["a.exr", "a.toml", "s.json"])
        attributes, images = read_exr(self.path("a.exr"))
        self.assertEqual(struct.unpack("<4i", attributes["dataWindow"][1]), (1480, 1490, 1503, 1509))
        self.assertEqual(struct.unpack("<4i", attributes["displayWindow"][1]), (0, 0, 2999, 2999))
        self.assertEqual(attributes["plenoflame.seed"], ("string", b"7"))
        # The biconvex lens (R 300 mm, t 24.26 mm, n 1.5) has P = 2 (n - 1)/R - (n - 1)^2 t/(n R^2); its stop of
        # 100 mm at the rear vertex is seen through the front surface, enlarged by 1/(1 - (n - 1) t/(n R)).
        focal_length = 1 / (1 / 300 - 0.25 * 24.26 / (1.5 * 300 ** 2))
        expected = {"effectiveFocalLength": focal_length, "focus": 1.0, "sensorPhotositePitch": 10,
                    "aperture": focal_length / 100 * (1 - 0.5 * 24.26 / (1.5 * 300))}
        for name, value in expected.items():
            kind, data = attributes[name]
            self.assertEqual(kind, "float")
            self.assertLess(abs(struct.unpack("<f", data)[0] / value - 1), 1e-6, name)
        self.assertEqual(struct.unpack("<2f", attributes["sensorOverallDimensions"][1]), (30, 30))
        self.assertEqual(set(images), {"total", "total.error"})
        flux = [value for row in images["total"] for value in row]
        self.assertTrue(all(math.isfinite(value) and value >= 0 for value in flux))
        self.assertGreater(max(flux), 0)
        figures = json.loads(self.read("s.json"))
        # The sum in single precision pixels against the sum that the renderer made.
        self.assertLess(abs(math.fsum(flux) / figures["flux"] - 1), 1e-6)
        # By the kernel's own account, in KiB, which is that of the largest process so far.
        largest = 1024 * resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss
        self.assertGreater(figures["peak_memory"], 5e6)
        self.assertLessEqual(figures["peak_memory"], largest)
        info = self.json_of("info", "a.exr")
        self.assertEqual((info["seed"], info["complete"]), (7, True))
        # The scene in the image is complete: it renders to the same image.
        self.write("b.toml", self.succeeds("info", "a.exr", "--scene"))
        self.succeeds("render", "b.toml", *WINDOW, "--samples", "16", "--seed", "7", "--quiet")
        self.assertEqual(read_exr(self.path("b.exr"))[1], images)

    def test_same_for_any_number_of_threads(self):
        for threads in ("1", "2", "7"):
            self.succeeds("render", "a.toml", "-o", threads + ".exr", *WINDOW, "--samples", "8", "--threads", threads,
                          "--quiet")
        self.assertEqual(self.read("1.exr"), self.read("2.exr"))
        self.assertEqual(self.read("1.exr"), self.read("7.exr"))

    def test_forward_estimator(self):
        def rays(*arguments):
            return self.json_of("render", "a.toml", *WINDOW, *arguments)["rays"]
        self.assertEqual(rays("--estimator", "forward", "--samples", "2e5"), 200000)
        self.assertEqual(self.json_of("info", "a.exr")["estimator"], "forward")
        self.assertGreater(max(value for row in read_exr(self.path("a.exr"))[1]["total"] for value in row), 0)
        # 64 rays a pixel, the scene's default, would be no picture of so many bundles.
        self.assertEqual(rays("--estimator", "forward"), 1e6)
        self.assertEqual(rays("--estimator", "forward", "--samples", "1"), 1)
        self.write("a.toml", SCENE + '[render]\nestimator = "forward"\nsamples = 30000\n')
        self.assertEqual(rays(), 30000)

    def test_quiet_says_nothing(self):
        self.assertEqual(self.succeeds("render", "a.toml", *WINDOW, "--samples", "2", "--quiet"), "")
        self.assertIn("rays", json.loads(self.succeeds("render", "a.toml", *WINDOW, "--samples", "2", "--json")))

    def test_messages_before_any_work(self):
        def refused(status, *arguments, mentions):
            self.fails(status, "render", "a.toml", *arguments, mentions=mentions)
        refused(2, "--target-error", "0%", mentions="--target-error")
        refused(2, "--target-error", "100%", mentions="--target-error")
        refused(2, "--time-limit", "0s", mentions="--time-limit")
        refused(2, "--time-limit", "60", mentions=["--time-limit", "min"])
        refused(2, "--samples", "0", mentions="--samples")
        refused(2, "--threads", "-1", mentions="--threads")
        refused(2, "--estimator", "sideways", mentions="--estimator")
        refused(2, "--window", "1,2,3", mentions="X,Y,W,H")
        refused(2, "--window", "2990,0,11,5", mentions="3000 x 3000")
        refused(2, "-o", "a.png", mentions="develop")
        refused(1, "-o", "none/a.exr", mentions="none' does not exist")
        refused(1, "--stats", "none/s.json", mentions="none' does not exist")
        self.fails(1, "render", "b.toml", mentions="b.toml")
        self.assertEqual(self.files(), ["a.toml"])

    def test_interrupted(self):
        process = subprocess.Popen([command.COMMAND, "render", "a.toml", "--samples", "65536", "--threads", "1"],
                                   cwd=self.folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.addCleanup(process.kill)
        try:
            process.wait(timeout=3)
            self.fail("ended by itself")
        except subprocess.TimeoutExpired:
            process.send_signal(signal.SIGINT)
        _, errors = process.communicate(timeout=60)
        self.assertEqual(process.returncode, 1, errors)
        self.assertEqual(self.files(), ["a.exr", "a.exr.state", "a.toml"])
        self.assertFalse(self.json_of("info", "a.exr")["complete"])
        self.assertNotIn("\r", errors)  # progress is for terminals

    def test_interrupted_in_the_ground_truth_keeps_the_picture(self):
        seen = False
        # On a busy machine a moment may be missed: then all are tried again.
        for count, (number, delay) in enumerate(zip([signal.SIGTERM, signal.SIGHUP] * len(DELAYS) * 3, DELAYS * 3)):
            if seen and count >= len(DELAYS):
                break
            process = subprocess.Popen([command.COMMAND, "render", "a.toml", "--samples", "1", "--truth", "--threads", "1"],
                                       cwd=self.folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
            self.addCleanup(process.kill)
            try:
                process.wait(timeout=delay)
            except subprocess.TimeoutExpired:
                process.send_signal(number)
            _, errors = process.communicate(timeout=60)
            if process.returncode == -number:  # it came before the command had begun
                self.assertEqual(self.files(), ["a.toml"])
                continue
            self.assertIn(process.returncode, (0, 1), errors)
            if "whole picture" in errors:
                seen = True
                self.assertIn("without its layers of ground truth", errors)
                figures = self.json_of("info", "a.exr")
                self.assertTrue(figures["complete"])
                self.assertNotIn("truth.distance", json.dumps(figures))
                self.assertEqual(self.files(), ["a.exr", "a.toml"])
            for name in self.files():
                if name != "a.toml":
                    os.remove(self.path(name))
        self.assertTrue(seen, "no signal came while the ground truth was worked out")

    def test_resumed_run_gives_the_same_bits(self):
        options = ["--window", "1400,1400,256,256", "--samples", "4096", "--quiet"]
        self.succeeds("render", "a.toml", *options, "-o", "whole.exr")
        for delay in DELAYS:  # until one is caught in the middle
            process = subprocess.Popen([command.COMMAND, "render", "a.toml", *options, "--threads", "1", "-o", "part.exr"],
                                       cwd=self.folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            try:
                process.wait(timeout=delay)
            except subprocess.TimeoutExpired:
                process.send_signal(signal.SIGINT)
            if process.wait(timeout=60) == 1 and "part.exr.state" in self.files():
                break
        self.assertIn("part.exr.state", self.files())
        self.fails(1, "render", "a.toml", *options, "--seed", "5", "-o", "part.exr", "--resume", "part.exr",
                   mentions="--seed was 1 and is 5")
        self.succeeds("render", "a.toml", *options, "-o", "part.exr", "--resume", "part.exr")
        self.assertEqual(self.read("part.exr"), self.read("whole.exr"))
        self.assertNotIn("part.exr.state", self.files())
        os.remove(self.path("part.exr"))
        self.fails(1, "render", "a.toml", *options, "-o", "part.exr", "--resume", "part.exr", mentions="part.exr.state")

    def test_target_error(self):
        window = ["--window", "1400,1400,128,128"]
        figures = self.json_of("render", "a.toml", *window, "--target-error", "5%")
        self.assertLessEqual(figures["relative_error_bound"], 0.05)
        self.assertLess(figures["relative_error"], figures["relative_error_bound"])
        self.assertEqual(figures["confidence"], 0.95)
        self.fails(1, "render", "a.toml", *window, "--target-error", "0.001%", "--samples", "64", "--quiet",
                   mentions="not reached")

    def test_forward_estimator_resumes_and_has_targets(self):
        options = ["--estimator", "forward", "--samples", "2e6", "--quiet", *WINDOW]
        self.succeeds("render", "a.toml", *options, "-o", "whole.exr")
        for delay in DELAYS:  # until one is caught in the middle
            process = subprocess.Popen([command.COMMAND, "render", "a.toml", *options, "--threads", "1", "-o", "part.exr"],
                                       cwd=self.folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            try:
                process.wait(timeout=delay)
            except subprocess.TimeoutExpired:
                process.send_signal(signal.SIGINT)
            if process.wait(timeout=60) == 1 and "part.exr.state" in self.files():
                break
        # The state of one estimator is none of the other's.
        self.fails(1, "render", "a.toml", "--samples", "2e6", "--quiet", *WINDOW, "-o", "part.exr", "--resume", "part.exr",
                   "--estimator", "backward", mentions="--estimator was forward and is backward")
        self.succeeds("render", "a.toml", *options, "-o", "part.exr", "--resume", "part.exr")
        self.assertEqual(self.read("part.exr"), self.read("whole.exr"))
        limited = self.json_of("render", "a.toml", "--estimator", "forward", "--time-limit", "0.2s")
        self.assertTrue(limited["complete"])
        self.assertLess(limited["rays"], 2**30)
        self.fails(1, "render", "a.toml", *options, "--target-error", "1%", mentions="not reached")

    def test_full_disk_leaves_the_old_image(self):
        self.write("a.exr", "old")
        self.fails(1, "render", "a.toml", *WINDOW, "--samples", "2", "--quiet", largest_file=2000,
                   mentions=["a.exr", "largest file size"])
        self.assertEqual(self.read("a.exr"), b"old")
        self.assertEqual([name for name in os.listdir(self.folder) if name.startswith(".")], [])


if __name__ == "__main__":
    main()
