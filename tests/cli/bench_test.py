"""plenoflame bench: what it prints and writes, its cache, its comparison, messages."""

import json
import math
import os
import re

from command import CommandTest, main

SCENE = """[camera]
preset = "paper-plenoptic2"
[[flames]]
preset = "paper-layered"
position = ["1 m", "0 m", "-29 mm"]
"""
QUICK = ("--window", "1480,1490,30,30", "--samples", "4,16,64", "--estimators", "backward", "--repeat", "2",
         "--reference-samples", "512", "--cache", "cache")


class Bench(CommandTest):
    def setUp(self):
        super().setUp()
        self.write("a.toml", SCENE)

    def test_figures_agree_with_each_other(self):
        table = self.succeeds("bench", "a.toml", *QUICK, "-o", "out.json")
        self.assertEqual(self.files(), ["a.toml", "cache", "out.csv", "out.json", "out.png", "out.svg"])
        bench = json.loads(self.read("out.json"))
        points = bench["points"]
        self.assertEqual([p["samples"] for p in points], [4, 16, 64])
        for p in points:
            self.assertLessEqual(p["seconds_least"], p["seconds"])
            self.assertLessEqual(p["seconds"], p["seconds_most"])
            self.assertLess(abs(p["efficiency"] * p["relative_rmse"] ** 2 * p["seconds"] - 1), 1e-12)
            self.assertLess(abs(p["relative_bias"]), 5 * p["relative_bias_error"])
            self.assertGreater(p["peak_memory"], 1e6)
        # The error falls, and the slopes are those of the errors.
        errors = [math.log(p["relative_rmse"]) for p in points]
        self.assertLess(errors[2], errors[0])
        self.assertLess(abs(points[1]["local_slope"] - (errors[1] - errors[0]) / math.log(4)), 1e-12)
        # Three points at equal distances: the fitted slope is that between the outer two.
        self.assertLess(abs(bench["fitted_slope"]["backward"] - (errors[2] - errors[0]) / math.log(16)), 1e-12)
        self.assertEqual(bench["reference"]["samples"], 512)
        self.assertLess(bench["reference"]["relative_error"], points[2]["relative_rmse"])
        self.assertFalse(bench["reference"]["cached"])
        self.assertIn("fitted slope, backward: %.2f" % bench["fitted_slope"]["backward"], table)
        csv = self.read("out.csv").decode().splitlines()
        self.assertEqual(len(csv), 4)
        row = dict(zip(csv[0].split(","), csv[2].split(",")))
        self.assertEqual(float(row["relative_rmse"]), points[1]["relative_rmse"])
        self.assertTrue(self.read("out.png").startswith(b"\x89PNG\r\n\x1a\n"))
        self.assertIn(b"</svg>", self.read("out.svg"))

    def test_reference_of_changed_surfaces_is_computed_again(self):
        """The scene's text is the same, its files are not."""
        mesh = "v 0.9 -1 -1\nv 0.9 1 -1\nv 0.9 0 1\nf 1 2 3\n"
        self.write("thing.obj", mesh)
        self.write("s.toml", SCENE + '[[surfaces]]\nshape = "mesh"\nfile = "thing.obj"\nposition = ["0.3 m", "0 m", '
                   '"0 m"]\n[[lights]]\npower = "1 W"\nposition = ["0 m", "1 m", "0 m"]\n')
        quick = ("--window", "1480,1490,16,16", "--samples", "4", "--repeat", "1", "--reference-samples", "64",
                 "--cache", "cache")
        cached = lambda: self.json_of("bench", "s.toml", *quick)["reference"]["cached"]
        self.assertFalse(cached())
        self.assertTrue(cached())
        self.write("thing.obj", mesh.replace("0.9", "0.95"))
        self.assertFalse(cached())

    def test_forward_estimator_falls_as_monte_carlo_does(self):
        sensor = '[camera.sensor]\ncolumns = 40\nrows = 40\npixel_pitch = "90 um"\n'
        self.write("f.toml", SCENE.replace("[[flames]]", sensor + "[[flames]]", 1))
        bench = self.json_of("bench", "f.toml", "--cache", "cache", "--samples", "64", "--bundles", "2e5,8e5",
                             "--repeat", "2")
        points = bench["points"]
        self.assertEqual([p["estimator"] for p in points], ["backward", "forward", "forward"])
        for p in points:
            self.assertLess(abs(p["relative_bias"]), 5 * p["relative_bias_error"])
        # Errors over 1000 pixels scatter by a few per cent.
        self.assertGreater(points[2]["local_slope"], -0.6)
        self.assertLess(points[2]["local_slope"], -0.4)
        self.assertGreater(points[0]["gain_over_forward"], 1)

    def test_cache(self):
        def reference(stderr=""):
            out = self.succeeds("bench", "a.toml", *QUICK, "--json", stderr=stderr)
            return json.loads(out)["reference"]
        self.assertFalse(reference()["cached"])
        first = reference()
        self.assertTrue(first["cached"])
        name = os.listdir(self.path("cache"))
        self.assertEqual(len(name), 1)
        file = os.path.join("cache", name[0])
        good = self.read(file)

        def recomputed(content, why):
            self.write(file, content)
            second = reference(f"plenoflame: note: the reference in {file} {why}; it is computed again\n")
            self.assertFalse(second["cached"])
            self.assertEqual(second["relative_error"], first["relative_error"])
            self.assertEqual(self.read(file), good)
        recomputed(good[:-200], "is damaged")
        recomputed(b"no image", "is damaged")
        name = b"benchmark.checksum\0string\0"
        at = good.index(name) + len(name) + 4 + 3  # within the value, behind its length
        recomputed(good[:at] + bytes([good[at] ^ 1]) + good[at + 1:], "is damaged")
        # One bit of what stands around the pixels: the last digit of the number of samples, a word, a number.
        for name, within in ((b"plenoflame.samples\0string\0", 0), (b"plenoflame.estimator\0string\0", 0),
                             (b"plenoflame.complete\0int\0", 0)):
            at = good.index(name) + len(name) + 4 + within
            recomputed(good[:at] + bytes([good[at] ^ 1]) + good[at + 1:], "is damaged")
        version = re.search(rb"plenoflame.version\0string\0....([0-9.]+)", good, re.S)
        other = bytearray(good)
        other[version.start(1)] = ord("9")
        shown = other[version.start(1):version.end(1)].decode()
        recomputed(bytes(other), f"is of version {shown}, this is {version.group(1).decode()}")
        # Another scene has another reference; more samples replace it.
        self.write("a.toml", SCENE.replace("-29 mm", "-28 mm"))
        self.assertFalse(reference()["cached"])
        self.assertEqual(len(os.listdir(self.path("cache"))), 2)

    def test_comparison(self):
        self.succeeds("bench", "a.toml", *QUICK, "-o", "old")
        old = json.loads(self.read("old.json"))
        for p in old["points"]:
            for key in ("seconds", "seconds_least", "seconds_most"):
                p[key] *= 100
            p["relative_rmse"] *= 2
            p["efficiency"] /= 400
        self.write("slow.json", json.dumps(old))
        out = self.succeeds("bench", "a.toml", *QUICK, "--compare", "slow.json")
        for samples in (4, 16, 64):
            self.assertRegex(out, rf"backward {samples}: faster, more accurate; new/old: time 0\.0\d\d, RMSE 0\.500")
        other = list(QUICK)
        other[1] = "1480,1490,20,30"
        self.assertIn("window differ", self.succeeds("bench", "a.toml", *other, "--compare", "slow.json"))
        self.write("other.json", "{}")
        self.fails(1, "bench", "a.toml", *QUICK, "--compare", "other.json", mentions="bench -o")
        self.fails(1, "bench", "a.toml", *QUICK, "--compare", "none.json", mentions="none.json")

    def test_messages(self):
        def refused(status, *arguments, mentions):
            self.fails(status, "bench", "a.toml", *arguments, mentions=mentions)
        refused(2, "--samples", "16,4", mentions=["--samples", "larger"])
        refused(2, "--samples", "4,,5", mentions="--samples")
        refused(2, "--samples", "", mentions="--samples")
        refused(2, "--bundles", "1.5", mentions="--bundles")
        refused(2, "--estimators", "sideways", mentions="--estimators")
        refused(2, "--repeat", "0", mentions="--repeat")
        refused(2, "--window", "2990,0,20,20", mentions="3000 x 3000")
        refused(1, "-o", "none/out", mentions="none' does not exist")
        refused(1, "--cache", "a.toml/x", mentions="--cache")
        refused(1, "--cache", "cache", "--window", "0,0,8,8", "--samples", "4", "--estimators", "backward",
                mentions="no pixel is lit")
        self.assertEqual(self.files(), ["a.toml", "cache"])


if __name__ == "__main__":
    main()
