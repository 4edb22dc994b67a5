"""Scenes with several cameras from the command line: each picture is that of a scene with its camera alone."""

import csv
import io
import json
import os
import signal
import subprocess
import time
import zipfile

import command
from command import CommandTest, main
from exr import read_exr

LENS = """preset = "paper-previous-60x60"
"""
SIDE = """position = ["1 m", "-1 m", "0 m"]
look_direction = [0, 1, 0]
"""
REST = """[[flames]]
preset = "paper-layered"
position = ["1 m", "0 m", "-29 mm"]
[render]
samples = 4
"""
PLAIN = """[{0}.array]
present = false
[{0}.focus]
conjugate = "sensor"
"""
SEVERAL = ('[[cameras]]\nname = "front"\n' + LENS + '[[cameras]]\nname = "side"\nlike = "front"\n' + SIDE
           + '[[cameras]]\nname = "plain"\nlike = "front"\n' + PLAIN.format("cameras") + REST)
ALONE = {"front": "[camera]\n" + LENS + REST,
         "side": "[camera]\n" + LENS + SIDE + REST,
         "plain": "[camera]\n" + LENS + PLAIN.format("camera") + REST}
WINDOW = ("--window", "280,250,40,100")


class Cameras(CommandTest):
    def setUp(self):
        super().setUp()
        self.write("lab.toml", SEVERAL)

    def refused(self, status, *arguments, mentions):
        before = self.files()
        self.fails(status, *arguments, mentions=mentions)
        self.assertEqual(self.files(), before)

    def test_every_picture_is_that_of_its_camera_alone(self):
        out = self.succeeds("render", "lab.toml", "-o", "out.exr", *WINDOW, "--truth", "--stats", "s.json")
        self.assertEqual(self.files(), ["lab.toml", "out-front.exr", "out-plain.exr", "out-side.exr", "s-front.json",
                                        "s-plain.json", "s-side.json"])
        for name, text in ALONE.items():
            self.assertIn(f"out-{name}.exr\n", out)
            self.write(f"{name}.toml", text)
            self.succeeds("render", f"{name}.toml", *WINDOW, "--truth", "--quiet")
            (attributes, images), (_, alone) = read_exr(self.path(f"out-{name}.exr")), read_exr(self.path(f"{name}.exr"))
            self.assertEqual(images, alone, name)
            self.assertGreater(max(map(max, images["total"])), 0)
            self.assertEqual(attributes["plenoflame.text.camera"][1], name.encode())
            scene = self.succeeds("info", f"out-{name}.exr", "--scene")
            self.assertIn(f'[camera]\nname = "{name}"\n', scene)
            self.assertNotIn("cameras", scene)
        # Commands that take a picture know its camera.
        truth = self.succeeds("truth", "out-side.exr", "-o", "side.csv")
        self.assertIn("micro-images", truth)
        self.succeeds("views", "out-side.exr", "-o", "views")
        self.succeeds("views", "side.exr", "-o", "alone")
        self.assertEqual(sorted(os.listdir(self.path("views"))), sorted(os.listdir(self.path("alone"))))

    def test_names_of_pictures(self):
        small = ("--window", "300,300,2,2", "--quiet")
        self.succeeds("render", "lab.toml", *small, "--camera", "side")
        self.assertEqual(self.files(), ["lab-side.exr", "lab.toml"])
        self.succeeds("render", "lab.toml", *small, "--camera", "side", "-o", "mine.exr")
        self.succeeds("render", "lab.toml", *small, "--camera", "side", "--camera", "plain", "-o", "two.exr")
        self.succeeds("render", "lab.toml", *small, "--camera", "plain", "-o", "w.exr", "--white", "--f-numbers", "8,11")
        self.assertEqual(self.files(), ["lab-side.exr", "lab.toml", "mine.exr", "two-plain.exr", "two-side.exr",
                                        "w-f11.exr", "w-f8.exr"])
        self.assertEqual(self.read("lab-side.exr"), self.read("mine.exr"))
        self.assertEqual(self.read("two-side.exr"), self.read("mine.exr"))

    def test_wrong_names(self):
        self.refused(2, "render", "lab.toml", "--camera", "sid", mentions=("--camera", '"sid"', 'did you mean "side"?'))
        self.refused(2, "render", "lab.toml", "--camera", "side", "--camera", "side", mentions=("--camera", "twice"))
        for name, arguments in [("rays", ("--chief", "-o", "r.csv")), ("design", ()), ("bench", ()),
                                ("optimize", ("-o", "o.toml", "--merit", "light"))]:
            self.refused(2, name, "lab.toml", *arguments, mentions=("--camera", "front, side, plain"))
        self.write("one.toml", ALONE["front"])
        self.refused(2, "render", "one.toml", "--camera", "front", mentions="without a name")
        self.refused(2, "render", "lab.toml", "--resume", "x.exr", mentions=("--resume", "--camera"))
        # A folder that is missing is found before the first picture is made.
        self.refused(2, "render", "lab.toml", "--window", "590,590,20,20", mentions="--window")

    def test_bad_scenes(self):
        for text, mentions in [
                (SEVERAL.replace('"side"', '"front"'), ("lab.toml:5:8", "both called")),
                (SEVERAL + "[camera]\n" + LENS, ("both [camera] and [[cameras]]",)),
                (SEVERAL.replace('["1 m", "-1 m"', '["1 m", "0 m"'), ("lab.toml:18:12", 'into camera "side"')),
                (SEVERAL.replace("like", "liek"), ("lab.toml:6:1", "liek", 'did you mean "like"?'))]:
            self.write("lab.toml", text)
            self.refused(1, "render", "lab.toml", mentions=mentions)

    def test_other_commands_take_a_camera(self):
        self.write("side.toml", ALONE["side"])
        warning = ('plenoflame: warning: f-numbers do not match for type "type1": micro-images are 4.53 pixels narrower '
                   'than the pitch\n')
        design = json.loads(self.succeeds("design", "lab.toml", "--camera", "side", "--json", stderr=warning))
        self.assertEqual(design.pop("camera"), "side")
        self.assertEqual(design, json.loads(self.succeeds("design", "side.toml", "--json", stderr=warning)))
        self.succeeds("rays", "lab.toml", "--camera", "side", "--chief", "-o", "a.csv")
        self.succeeds("rays", "side.toml", "--chief", "-o", "b.csv")
        self.assertEqual(self.read("a.csv"), self.read("b.csv"))
        info = self.json_of("info", "lab.toml")
        self.assertEqual([(c["name"], c["position_m"]) for c in info["cameras"]],
                         [("front", [0, 0, 0]), ("side", [1, -1, 0]), ("plain", [0, 0, 0])])
        self.succeeds("optimize", "lab.toml", "--camera", "side", "--merit", "light", "--vary", "spacing", "--bound",
                      "1.001", "--paraxial", "-o", "best.toml")
        after = self.json_of("info", "best.toml")
        self.assertEqual([c["name"] for c in after["cameras"]], ["front", "side", "plain"])
        self.assertEqual(after["cameras"][0], info["cameras"][0])

    def test_operator_has_the_rows_of_all_cameras(self):
        how = ("--grid", "4", "--bin", "40", "--rays", "4", "--quiet", "-o")
        self.succeeds("operator", "lab.toml", *how, "all.npz", "--pixels", "all.csv")
        rows = list(csv.DictReader(io.StringIO(self.read("all.csv").decode())))
        for name, text in ALONE.items():
            self.write("one.toml", text)
            self.succeeds("operator", "one.toml", *how, "one.npz", "--pixels", "one.csv")
            alone = list(csv.DictReader(io.StringIO(self.read("one.csv").decode())))
            self.assertEqual([(r["column"], r["line"]) for r in rows if r["camera"] == name],
                             [(r["column"], r["line"]) for r in alone])
            with zipfile.ZipFile(self.path("all.npz")) as whole, zipfile.ZipFile(self.path("one.npz")) as part:
                self.assertIn(part.read("data.npy")[128:], whole.read("data.npy")[128:])

    def test_a_stopped_run_goes_on_with_its_camera(self):
        # On a busy machine runs differ in speed: a stop may meet one before its first samples or just after its last.
        for delay in [0.1 * 1.2 ** k for k in range(24)] * 3:
            run = subprocess.Popen([command.COMMAND, "render", "lab.toml", "-o", "out.exr", "--samples", "12288", "--quiet",
                                    "--window", "290,200,20,200"], cwd=self.folder, stderr=subprocess.PIPE, text=True)
            time.sleep(delay)
            run.send_signal(signal.SIGINT)
            message = run.communicate()[1]
            if "--resume" in message:
                break
        self.assertIn("--resume out-", message)
        stopped = message[message.index("out-"):].split(".exr")[0]
        name = stopped[4:]
        self.assertIn(f"--camera {name}", message)
        self.assertNotIn("out-plain.exr", self.files() if name != "plain" else [])
        self.succeeds("render", "lab.toml", "--resume", f"out-{name}.exr", "--camera", name, "--samples", "12288",
                      "--quiet", "--window", "290,200,20,200")
        self.write("one.toml", ALONE[name])
        self.succeeds("render", "one.toml", "--samples", "12288", "--quiet", "--window", "290,200,20,200")
        self.assertEqual(read_exr(self.path(f"out-{name}.exr"))[1], read_exr(self.path("one.exr"))[1])


if __name__ == "__main__":
    main()
