"""Flames that change with time, from the command line: frames, exposures, what is done before, wrong input."""

import json
import math
import os
import signal
import subprocess
import time

import command
from command import CommandTest, main
from exr import read_exr

CAMERA = """[camera]
preset = "paper-previous-60x60"
[camera.sensor]
{sensor}
"""
FLAME = """[[flames]]
kind = "vdb"
name = "plume"
position = ["1 m", "0 m", "-29 mm"]
{flame}
[render]
samples = 4
"""
SERIES = 'file = "run_####.vdb"\nframe_rate = "1 kHz"\n'
WINDOW = ("--window", "250,250,100,100")


class Time(CommandTest):
    @classmethod
    def setUpClass(cls):
        # Three candles of different heights, made once.
        cls.flames = {}
        test = CommandTest()
        test.setUp()
        for number, height in ((1, 25), (2, 32), (3, 40)):
            test.succeeds("flame", "candle", "--voxel-size", "1 mm", "--set", f"height={height} mm", "-o", "f.vdb")
            cls.flames[number] = test.read("f.vdb")
        test.doCleanups()

    def setUp(self):
        super().setUp()
        for number, flame in self.flames.items():
            self.write(f"run_{number:04d}.vdb", flame)
        self.scene("film.toml")
        made = os.stat(self.path("run_0002.vdb"))
        self.made = (made.st_atime_ns, made.st_mtime_ns)

    def scene(self, name, flame=SERIES, sensor=""):
        self.write(name, CAMERA.format(sensor=sensor) + FLAME.format(flame=flame))

    def alone(self, number, *options):
        """Image of a scene with one of the files alone."""
        self.scene("alone.toml", f'file = "run_{number:04d}.vdb"\n')
        self.succeeds("render", "alone.toml", *WINDOW, "--quiet", *options)
        return read_exr(self.path("alone.exr"))

    def test_every_frame_is_that_of_its_file_alone(self):
        out = self.succeeds("render", "film.toml", "--frames", "1:3:2", "-o", "film.exr", *WINDOW, "--truth",
                            "--stats", "s.json")
        self.assertRegex(out, r"\Afilm\.0001\.exr: [^\n]* W, error [^\n]*\nfilm\.0003\.exr: [^\n]*\n\Z")
        self.assertIn("film.0003.exr", self.files())
        self.assertNotIn("film.0002.exr", self.files())
        for number in (1, 3):
            attributes, images = read_exr(self.path(f"film.000{number}.exr"))
            _, alone = self.alone(number, "--truth")
            self.assertEqual(images, alone)
            self.assertGreater(max(map(max, images["total"])), 0)
            self.assertEqual(float(attributes["plenoflame.number.frame.number"][1]), number)
            scene = self.succeeds("info", f"film.000{number}.exr", "--scene")
            self.assertIn(f'file = "run_000{number}.vdb"', scene)
        self.assertEqual(json.loads(self.read("s.0003.json"))["exposure_begin"], 2e-3)
        self.succeeds("views", "film.0003.exr", "-o", "views")  # whatever follows needs nothing of time

    def test_moments_of_other_commands(self):
        self.alone(2)
        for number, arguments in ((2, ("--frame", "2")), (2, ("--time", "1.5ms")), (1, ())):
            self.scene("alone.toml", f'file = "run_000{number}.vdb"\n')
            note = "" if arguments else ("plenoflame: the scene changes with time, and this is its first frame; choose "
                                         "another with --frame or --time\n")
            self.succeeds("rays", "film.toml", "--pixel", "300,300", "--rays", "4", "-o", "film.csv", *arguments,
                          stderr=note)
            self.succeeds("rays", "alone.toml", "--pixel", "300,300", "--rays", "4", "-o", "alone.csv")
            self.assertEqual(self.read("film.csv"), self.read("alone.csv"))
        self.succeeds("render", "film.toml", "--time", "2ms", "-o", "t.exr", *WINDOW, "--quiet")
        self.assertEqual(read_exr(self.path("t.exr"))[1], self.alone(3)[1])
        self.succeeds("render", "film.toml", "-o", "first.exr", *WINDOW, stderr="plenoflame: the scene changes with "
                      "time, and this is its first frame; choose others with --frames or --time\n")
        self.assertEqual(read_exr(self.path("first.exr"))[1], self.alone(1)[1])

    def test_info(self):
        out = self.succeeds("info", "film.toml")
        self.assertRegex(out, r"series plume: +files 1 to 3 at 1 kHz\n")
        self.assertRegex(out, r"frames: +1 to 3 at 1 kHz\n")
        os.remove(self.path("run_0002.vdb"))
        self.assertIn("files 1 to 3 at 1 kHz, MISSING: 2\n", self.succeeds("info", "film.toml"))
        self.assertEqual(self.json_of("info", "film.toml")["time"][0]["missing"], [2])

    def test_an_exposure_is_the_mean(self):
        # From 0.75 ms on for 1.25 ms: 0.25 of file 1 to 1 of file 2.
        self.scene("film.toml", sensor='exposure_begin = "0.75 ms"\nexposure_time = "1.25 ms"\n')
        figures = self.json_of("render", "film.toml", "--frames", "1", "-o", "m.exr", *WINDOW, "--samples", "400")
        attributes, images = read_exr(self.path("m.0001.exr"))
        one = self.alone(1, "--samples", "1000")[1]["total"]
        two = self.alone(2, "--samples", "1000")[1]["total"]
        mean = [[0.2 * a + 0.8 * b for a, b in zip(*rows)] for rows in zip(one, two)]
        total, expected = sum(map(sum, images["total"])), sum(map(sum, mean))
        self.assertLess(abs(total / expected - 1), 3e-3)
        self.assertGreater(abs(total / sum(map(sum, one)) - 1), 0.05)
        # Energy in J of an exposure is its flux times its time.
        self.assertEqual(figures["moments"], 2)
        self.assertLess(abs(figures["energy"] / (1.25e-3 * figures["flux"]) - 1), 1e-9)
        self.assertLess(abs(float(attributes["plenoflame.number.exposure.energy"][1]) / figures["energy"] - 1), 1e-6)
        self.assertRegex(self.succeeds("info", "m.0001.exr"), r"exposure\.energy: +[0-9.e-]+ J\n")
        self.fails(1, "render", "--resume", "m.0001.exr", "--samples", "800", mentions="mean of several moments")
        self.assertEqual(figures["flames_loaded"], 2)
        self.fails(2, "render", "film.toml", "--frames", "1", "-o", "x.exr", "--truth", mentions="exposure_time=0s")
        self.fails(1, "render", "film.toml", "--frames", "1:3", "-o", "x.exr",
                   mentions=["there is no frame 3", "for frames 1 to 2"])

    def test_frames_that_are_done_stay(self):
        arguments = ("render", "film.toml", "--frames", "1:3", *WINDOW)
        os.rename(self.path("run_0003.vdb"), self.path("aside"))
        self.write("run_0003.vdb", b"no flame")
        result = self.run_command(*arguments, "-o", "f.exr")
        self.assertEqual(result.returncode, 1)
        self.assertIn("run_0003.vdb", result.stderr)
        self.assertTrue({"f.0001.exr", "f.0002.exr"} <= set(self.files()))
        self.assertNotIn("f.0003.exr", self.files())
        os.rename(self.path("aside"), self.path("run_0003.vdb"))
        before = os.stat(self.path("f.0001.exr")).st_mtime_ns
        out = self.succeeds(*arguments, "--resume", "f.exr")
        self.assertRegex(out, r"\Af\.0001\.exr: done before\nf\.0002\.exr: done before\nf\.0003\.exr: [^\n]* W")
        self.assertEqual(os.stat(self.path("f.0001.exr")).st_mtime_ns, before)
        self.assertEqual(read_exr(self.path("f.0003.exr"))[1], self.alone(3)[1])
        # A flame that is newer than its picture; other settings; a picture from elsewhere.
        os.utime(self.path("run_0001.vdb"), (time.time() + 10, time.time() + 10))
        self.assertRegex(self.succeeds(*arguments, "--resume", "f.exr"), r"\Af\.0001\.exr: [^\n]* W")
        result = self.run_command(*arguments, "--resume", "f.exr", "--samples", "8")
        self.assertIn("samples 4 then, samples 8 now", result.stderr)
        self.succeeds("render", "alone.toml", *WINDOW, "-o", "f.0002.exr", "--quiet")
        self.assertIn("not a frame of this run", self.run_command(*arguments, "--resume", "f.exr").stderr)

    def test_a_stopped_run_goes_on(self):
        self.scene("film.toml", SERIES)
        arguments = ("render", "film.toml", "--frames", "1:3", "--samples", "64", "-o", "s.exr")
        process = subprocess.Popen([command.COMMAND, *arguments], cwd=self.folder, stdout=subprocess.PIPE,
                                   stderr=subprocess.PIPE, text=True)
        limit = time.monotonic() + 100
        while not os.path.exists(self.path("s.0001.exr")) and time.monotonic() < limit:
            time.sleep(0.01)
        process.send_signal(signal.SIGINT)
        _, stderr = process.communicate(timeout=100)
        if process.returncode == 0:
            self.skipTest("all frames were done before the signal came")
        self.assertIn("continue with the same frames and --resume s.exr", stderr)
        self.succeeds(*arguments[:-2], "--resume", "s.exr", "--quiet")
        self.succeeds(*arguments[:-2], "-o", "w.exr", "--quiet")
        for number in (1, 2, 3):
            self.assertEqual(read_exr(self.path(f"s.000{number}.exr"))[1], read_exr(self.path(f"w.000{number}.exr"))[1])
        self.assertFalse([name for name in self.files() if name.endswith(".state")])

    def exposure(self, name="film.toml"):
        """A scene whose frame 1 is half of file 1 and half of file 2."""
        self.scene(name, sensor='exposure_begin = "0.5 ms"\nexposure_time = "1 ms"\n')

    def stopped(self, arguments, signal_number, state):
        """Starts a run, sends a signal as soon as its state is there, and returns what it said."""
        process = subprocess.Popen([command.COMMAND, *arguments, "--checkpoint", "0.05s"], cwd=self.folder,
                                   stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        limit = time.monotonic() + 100
        while process.poll() is None and not os.path.exists(self.path(state)) and time.monotonic() < limit:
            time.sleep(0.005)
        if process.poll() is None:
            process.send_signal(signal_number)
        _, stderr = process.communicate(timeout=100)
        self.assertNotEqual(process.returncode, 0, "the run ended before its state was kept")
        return stderr

    def test_a_stopped_exposure_goes_on(self):
        self.exposure()
        for options in (("--samples", "1024"), ("--target-error", "0.7%")):
            whole = ("render", "film.toml", "--frames", "1", *options, *WINDOW)
            self.succeeds(*whole, "-o", "w.exr", "--quiet")
            for number in (signal.SIGKILL, signal.SIGINT):
                said = self.stopped((*whole, "-o", "s.exr", "--threads", "1"), number, "s.0001.exr.state")
                self.assertNotIn("s.0001.exr", self.files())
                if number == signal.SIGINT:
                    self.assertIn("its state is saved; continue with the same frames and --resume s.exr", said)
                self.succeeds(*whole, "--resume", "s.exr", "--quiet")
                self.assertEqual(self.read("s.0001.exr"), self.read("w.0001.exr"))
                self.assertNotIn("s.0001.exr.state", self.files())
                os.remove(self.path("s.0001.exr"))

    def test_a_stopped_exposure_goes_on_by_its_state_alone(self):
        self.exposure()
        arguments = ("render", "film.toml", "--time", "0.5ms", "--samples", "1024", *WINDOW, "--threads", "1")
        self.succeeds(*arguments, "-o", "w.exr", "--quiet")
        self.stopped((*arguments, "-o", "s.exr"), signal.SIGKILL, "s.exr.state")
        for options, mentions in ((("--samples", "2048"), ["--samples", "some are done", "1024"]),
                                  (("--target-error", "1%"), ["--target-error", "none"]),
                                  (("--truth",), ["--truth", "exposure_time=0s"])):
            self.fails(2, "render", "--resume", "s.exr", *options, mentions=mentions)
        self.fails(1, "render", "film.toml", "--time", "0.25ms", "--resume", "s.exr",
                   mentions=["beginning of the exposure was 500 us and is 250 us"])
        self.fails(1, "render", "film.toml", "--time", "0.5ms", "--resume", "s.exr", "--set",
                   "camera.sensor.exposure_time=1.5ms", mentions='exposure_time was "1 ms" and is "1.5 ms"')
        os.utime(self.path("run_0002.vdb"), (time.time() + 10, time.time() + 10))
        self.fails(1, "render", "--resume", "s.exr", mentions="file 'run_0002.vdb' was of")
        self.assertIn("s.exr.state", self.files())
        self.write("run_0002.vdb", self.flames[2])
        os.utime(self.path("run_0002.vdb"), ns=self.made)
        self.succeeds("render", "--resume", "s.exr", "--quiet")
        self.assertEqual(self.read("s.exr"), self.read("w.exr"))

    def test_moments_are_read_once(self):
        cameras = ('[[cameras]]\nname = "left"\npreset = "paper-previous-60x60"\n[cameras.sensor]\n'
                   'exposure_begin = "0.5 ms"\nexposure_time = "1 ms"\n')
        cameras += '[[cameras]]\nname = "right"\nlike = "left"\nposition = ["1 m", "-1 m", "0 m"]\nlook_direction = [0, 1, 0]\n'
        self.write("two.toml", cameras + FLAME.format(flame=SERIES))
        self.succeeds("render", "two.toml", "--frames", "1", "-o", "t.exr", *WINDOW, "--quiet", "--target-error", "3%",
                      "--stats", "s.json")
        loaded = {name: json.loads(self.read(f"s-{name}.0001.json"))["flames_loaded"] for name in ("left", "right")}
        self.assertEqual(loaded, {"left": 2, "right": 0})
        for name in ("left", "right"):
            self.succeeds("render", "two.toml", "--camera", name, "--frames", "1", "-o", f"{name}.exr", *WINDOW, "--quiet",
                          "--target-error", "3%")
            self.assertEqual(self.read(f"t-{name}.0001.exr"), self.read(f"{name}.0001.exr"))

    def test_a_table(self):
        self.write("slide.csv", "time [ms],y [mm],scale,brightness\n0,0,1,1\n4,8,1.5,3\n")
        self.scene("slide.toml", 'file = "run_0001.vdb"\ntime_table = "slide.csv"\n', 'frame_rate = "500 Hz"')
        self.succeeds("render", "slide.toml", "--frames", "0:2", "-o", "f.exr", *WINDOW, "--quiet")
        self.write("moved.toml", (CAMERA.format(sensor="") + FLAME.format(
            flame='file = "run_0001.vdb"\nbrightness = 2\nscale = 1.25\n')).replace('"0 m", "-29', '"4 mm", "-29'))
        self.succeeds("render", "moved.toml", *WINDOW, "--quiet")
        self.assertEqual(read_exr(self.path("f.0001.exr"))[1], read_exr(self.path("moved.exr"))[1])
        flux = [sum(map(sum, read_exr(self.path(f"f.000{i}.exr"))[1]["total"])) for i in range(3)]
        self.assertTrue(all(math.isfinite(f) and f > 0 for f in flux))
        self.write("slide.csv", "time [ms],y [mm]\n0,0\n4,nan\n")
        self.fails(1, "render", "slide.toml", "--frames", "0:2", "-o", "x.exr", mentions="slide.csv:3:3: y is \"nan\"")

    def test_cameras_take_turns(self):
        # Frame by frame, each picture as that of the camera alone.
        cameras = """[[cameras]]
name = "left"
preset = "paper-previous-60x60"
[[cameras]]
name = "right"
like = "left"
position = ["1 m", "-1 m", "0 m"]
look_direction = [0, 1, 0]
"""
        self.write("two.toml", cameras + FLAME.format(flame=SERIES))
        out = self.succeeds("render", "two.toml", "--frames", "1:2", "-o", "t.exr", *WINDOW)
        self.assertEqual([line.split(":")[0] for line in out.splitlines()],
                         ["t-left.0001.exr", "t-right.0001.exr", "t-left.0002.exr", "t-right.0002.exr"])
        for name in ("left", "right"):
            self.succeeds("render", "two.toml", "--camera", name, "--frames", "1:2", "-o", f"{name}.exr", *WINDOW,
                          "--quiet")
            for number in (1, 2):
                image = read_exr(self.path(f"t-{name}.000{number}.exr"))[1]
                self.assertEqual(image, read_exr(self.path(f"{name}.000{number}.exr"))[1])
                self.assertGreater(max(map(max, image["total"])), 0)

    def test_wrong_input(self):
        render = ("render", "film.toml", "-o", "x.exr")
        os.rename(self.path("run_0002.vdb"), self.path("aside"))
        self.fails(1, *render, "--frames", "1:3", mentions=["film.toml:", "missing: run_0002.vdb"])
        self.fails(1, "rays", "film.toml", "--frame", "2", "--pixel", "1,1", "-o", "x.csv", mentions="run_0002.vdb")
        os.rename(self.path("aside"), self.path("run_0002.vdb"))
        self.fails(1, *render, "--frames", "2:4", mentions=["there is no frame 4", "frames 1 to 3"])
        self.fails(1, *render, "--time", "3ms", mentions=["beyond the end of the series", "last until 3 ms"])
        self.fails(1, *render, "--time", "-1ms", mentions="before the begin")
        for frames in ("2:1", "a", "1:2:0", "1:2:3:4", "1.5", "-1", ":"):
            self.fails(2, *render, f"--frames={frames}", mentions="--frames")
        self.fails(2, *render, "--white", "--frames", "1:2", mentions="--white")
        self.scene("still.toml", 'file = "run_0001.vdb"\n')
        self.fails(2, "render", "still.toml", "--frames", "1", "-o", "x.exr", mentions="no flame of the scene changes")
        self.fails(2, "rays", "still.toml", "--frame", "1", "--pixel", "1,1", "-o", "x.csv", mentions="no flame")
        self.assertFalse([name for name in self.files() if name.startswith("x")])
        # Another lattice from the second file on: what was done before stays.
        self.succeeds("flame", "candle", "--voxel-size", "2 mm", "-o", "run_0002.vdb")
        result = self.run_command(*render, "--frames", "1:3", *WINDOW)
        self.assertEqual(result.returncode, 1)
        self.assertRegex(result.stderr, r"\Aplenoflame: error: film\.toml:\d+:\d+: [^\n]*run_0002\.vdb' has voxels of "
                         r"2 mm[^\n]*instead of 1 mm[^\n]*run_0001\.vdb[^\n]*\n\Z")
        self.assertEqual([name for name in self.files() if name.startswith("x")], ["x.0001.exr"])
        self.fails(1, *render, "--frames", "2", *WINDOW, mentions=["run_0002.vdb' has voxels", "run_0001.vdb"])


if __name__ == "__main__":
    main()
