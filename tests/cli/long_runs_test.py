"""Runs that are killed, stopped or go on; files that appear all together or not at all."""

import json
import os
import resource
import signal
import struct
import subprocess
import time

import command
from command import CommandTest, main
from exr import read_exr, write_light_field

SCENE = """[camera]
preset = "paper-plenoptic2"
[[flames]]
preset = "paper-layered"
position = ["1 m", "0 m", "-29 mm"]
"""
SMALL = """[camera]
preset = "paper-previous-60x60"
[camera.sensor]
columns = 100
rows = 80
"""
WINDOW = ("--window", "1400,1400,200,200")
# Seconds after which a signal is sent: machines differ in when a command begins, and when it is through.
DELAYS = [0.01 * 1.5 ** k for k in range(14)]


class LongRuns(CommandTest):
    def setUp(self):
        super().setUp()
        self.write("a.toml", SCENE)

    def start(self, *arguments, **options):
        process = subprocess.Popen([command.COMMAND, *arguments], cwd=self.folder, stdout=subprocess.PIPE,
                                   stderr=subprocess.PIPE, text=True, **options)
        self.addCleanup(process.communicate)
        self.addCleanup(process.kill)
        return process

    def kill_when_kept(self, name, *arguments):
        """Kills a run outright as soon as its state was kept, and says whether that was in its middle."""
        process = self.start(*arguments, "-o", name, "--checkpoint", "0.05s", "--threads", "1")
        while process.poll() is None and name + ".state" not in self.files():
            time.sleep(0.02)
        process.kill()
        process.wait()
        return name + ".state" in self.files()

    def test_a_killed_run_goes_on_by_its_state_alone(self):
        options = (*WINDOW, "--samples", "2048", "--seed", "9", "--quiet")
        self.succeeds("render", "a.toml", *options, "-o", "whole.exr", "--stats", "whole.json")
        self.assertTrue(self.kill_when_kept("part.exr", "render", "a.toml", *options, "--stats", "part.json"))
        self.assertNotIn("part.exr", self.files())
        self.succeeds("render", "--resume", "part.exr", "--quiet")
        self.assertEqual(self.read("part.exr"), self.read("whole.exr"))
        self.assertNotIn("part.exr.state", self.files())
        self.assertLess(json.loads(self.read("part.json"))["rays"], json.loads(self.read("whole.json"))["rays"])

    @staticmethod
    def forged(state, change_key=lambda key: None, change_samples=lambda samples: samples):
        """A state with something changed, whose checksum (FNV-1a of 64 bits, RFC 9923) is right."""
        at = state.index(b"\n") + 1
        size = struct.unpack_from("<Q", state, at)[0]
        key = json.loads(state[at + 8:at + 8 + size])
        change_key(key)
        text = json.dumps(key).encode()
        rest = state[at + 8 + size:]
        x, y, width, height = struct.unpack_from("<4i", rest, 8)
        tiles = -(-width // 64) * -(-height // 64)
        begin = 8 + 24 + 8
        samples = change_samples(struct.unpack_from("<%dd" % tiles, rest, begin))
        rest = rest[:begin] + struct.pack("<%dd" % tiles, *samples) + rest[begin + 8 * tiles:]
        goals = struct.unpack_from("<Q", rest, begin + 8 * tiles)[0]
        summed = rest[8:32] + rest[begin:begin + 8 * tiles] + rest[begin + 8 * tiles + 8:]
        value = 0xcbf29ce484222325
        for byte in summed:
            value = (value ^ byte) * 0x100000001b3 & 0xffffffffffffffff
        return state[:at] + struct.pack("<Q", len(text)) + text + rest[:32] + struct.pack("<Q", value) + rest[40:]

    def test_a_count_of_samples_that_no_run_has(self):
        options = ("--window", "1400,1400,70,70", "--samples", "65536", "--quiet")
        self.assertTrue(self.kill_when_kept("part.exr", "render", "a.toml", *options))
        state = self.read("part.exr.state")
        refused = lambda **changes: (self.write("part.exr.state", self.forged(state, **changes)),
                                     self.fails(1, "render", "--resume", "part.exr", "--time-limit", "1s", "--quiet",
                                                mentions=["part.exr.state", "damaged"]))
        for count in (1e15, 1e300, float("nan"), float("inf"), -1.0, 40000.0):  # per replicate: the run has 2 times 32768
            refused(change_samples=lambda samples, count=count: (count, *samples[1:]))
        for samples in (-1, 0, 2 ** 30 + 1, 2 ** 31 - 1):
            refused(change_key=lambda key, samples=samples: key.update(samples=samples))
        for name, value in (("replicates", 0), ("replicates", 1000), ("target_error", 2), ("time_limit", -1), ("seconds", -5)):
            refused(change_key=lambda key, name=name, value=value: key.update({name: value}))
        # The longest run that can be asked for ends at its limit, and at a signal.
        self.write("part.exr.state", self.forged(state, change_key=lambda key: key.update(samples=2 ** 30)))
        self.succeeds("render", "--resume", "part.exr", "--time-limit", "1s", "--quiet")

    def test_what_differs_is_named(self):
        options = (*WINDOW, "--samples", "2048", "--quiet")
        self.assertTrue(self.kill_when_kept("part.exr", "render", "a.toml", *options))
        self.write("b.toml", SCENE.replace('"1 m"', '"1.1 m"'))
        refused = lambda *arguments, mentions: self.fails(1, "render", *arguments, "--resume", "part.exr",
                                                          mentions=["part.exr.state", *mentions])
        refused("--seed", "5", mentions=["--seed was 1 and is 5"])
        refused("--window", "0,0,5,5", mentions=["--window was 1400,1400,200,200 and is 0,0,5,5"])
        refused("--estimator", "forward", mentions=["--estimator was backward and is forward"])
        refused("b.toml", mentions=['flames[0].position was ["1 m", "0 m", "-29 mm"] and is ["1.1 m", "0 m", "-29 mm"]'])
        self.fails(2, "render", "--resume", "part.exr", "--samples", "1024", mentions="2048 already")
        self.fails(2, "render", mentions="SCENE is required")
        self.fails(1, "render", "--resume", "other.exr", mentions=["other.exr.state", "no run to continue"])
        self.assertIn("part.exr.state", self.files())
        # A limit of time is no property of the picture.
        figures = self.json_of("render", "--resume", "part.exr", "--time-limit", "1000s", "--quiet")
        self.assertTrue(figures["complete"])
        self.assertNotIn("part.exr.state", self.files())

    def test_a_complete_picture_gets_more(self):
        first = self.json_of("render", "a.toml", *WINDOW, "--samples", "16", "-o", "a.exr", "--quiet")
        whole = self.json_of("render", "a.toml", *WINDOW, "--samples", "256", "-o", "b.exr", "--quiet")
        self.fails(2, "render", "--resume", "a.exr", mentions=["complete", "--samples above 16"])
        more = self.json_of("render", "--resume", "a.exr", "--samples", "256", "--quiet")
        self.assertEqual(self.json_of("info", "a.exr")["samples"], 256)
        self.assertLess(more["rays"], whole["rays"])
        self.assertLess(more["relative_error"], 0.5 * first["relative_error"])
        self.assertLess(more["relative_error"], 1.3 * whole["relative_error"])
        self.assertGreater(more["relative_error"], 0.7 * whole["relative_error"])
        errors = 3 * (more["relative_error"] + whole["relative_error"])
        self.assertLess(abs(more["flux"] / whole["flux"] - 1), errors)
        # Layers of ground truth are added to what is there, and the picture stays as it is.
        before = read_exr(self.path("a.exr"))[1]
        self.succeeds("render", "--resume", "a.exr", "--truth", "--quiet")
        after = read_exr(self.path("a.exr"))[1]
        self.assertIn("truth.distance", after)
        for name, image in before.items():
            self.assertEqual(image, after[name], name)
        target = self.json_of("render", "--resume", "a.exr", "--target-error", "0.1%", "--samples", "4096", "--quiet")
        self.assertLessEqual(target["relative_error_bound"], 0.001)
        self.assertIn("truth.distance", read_exr(self.path("a.exr"))[1])

    def test_forward_goes_on_too(self):
        options = ("--estimator", "forward", "--quiet", *WINDOW)
        self.succeeds("render", "a.toml", *options, "--samples", "400000", "-o", "a.exr")
        self.succeeds("render", "a.toml", *options, "--samples", "800000", "-o", "b.exr")
        self.succeeds("render", "--resume", "a.exr", "--samples", "800000", "--quiet")
        a, b = self.json_of("info", "a.exr"), self.json_of("info", "b.exr")
        self.assertEqual(a["samples"], b["samples"])
        difference = self.json_of("compare", "a.exr", "b.exr")
        self.assertLess(difference["relative_rmse"], 1e-5)  # the same bundles; sums went through single precision

    def test_signals_at_any_moment(self):
        write_light_field(self.path("raw.exr"), [[1e-9 * (c + 1) for c in range(100)] for _ in range(80)], scene=SMALL)
        before = self.files()
        saw_stop = False
        for k, delay in enumerate(DELAYS):
            for arguments in (("views", "raw.exr", "-o", "out", "--grid", "9", "--exr"),
                              ("export", "raw.exr", "--format", "hci", "-o", "out"),
                              ("truth", "raw.exr", "-o", "t.csv", "--attach", "t.exr")):
                process = self.start(*arguments)
                try:
                    process.wait(timeout=delay)
                except subprocess.TimeoutExpired:
                    process.send_signal([signal.SIGINT, signal.SIGTERM, signal.SIGHUP][k % 3])
                _, errors = process.communicate(timeout=60)
                left = [name for name in self.files() if name not in before]
                if process.returncode == 0:
                    self.assertEqual(left, ["out"] if "out" in arguments else ["t.csv", "t.exr"], errors)
                else:
                    saw_stop = saw_stop or "stopped; nothing was written" in errors
                    self.assertIn(process.returncode, (1, -signal.SIGINT, -signal.SIGTERM, -signal.SIGHUP), errors)
                    self.assertEqual(left, [], errors)
                for name in left:
                    path = self.path(name)
                    if os.path.isdir(path):
                        for file in os.listdir(path):
                            os.remove(os.path.join(path, file))
                        os.rmdir(path)
                    else:
                        os.remove(path)
        self.assertTrue(saw_stop, "no signal came in time")


class Sets(CommandTest):
    """All or none, on a disk that fills up."""

    def setUp(self):
        super().setUp()
        write_light_field(self.path("raw.exr"), [[1e-9 * (c * r % 97 + 1) for c in range(100)] for r in range(80)],
                          scene=SMALL)

    def contents(self, folder):
        result = {}
        for name in sorted(os.listdir(self.path(folder))):
            with open(self.path(folder + "/" + name), "rb") as file:
                result[name] = file.read()
        return result

    def limits(self, command_line, folder):
        """Sizes of files that let none of a command's files pass, about half of them, and all but the largest."""
        self.succeeds(*command_line)
        sizes = sorted(len(content) for content in self.contents(folder).values())
        return sorted({sizes[k] - 1 for k in (0, len(sizes) // 2, -1)})

    def check(self, *arguments):
        """A new folder is not there in the end, an older set as it was."""
        for limit in self.limits((*arguments, "-o", "good"), "good"):
            self.fails(1, *arguments, "-o", "new", largest_file=limit, mentions="'new/")
            self.assertNotIn("new", self.files())
            old = {name: b"old " + name.encode() for name in self.contents("good")}
            os.mkdir(self.path("set"))
            for name, content in old.items():
                self.write("set/" + name, content)
            self.fails(1, *arguments, "-o", "set", "--force", largest_file=limit, mentions="'set/")
            self.assertEqual(self.contents("set"), old)
            self.succeeds(*arguments, "-o", "set", "--force")
            self.assertEqual(self.contents("set"), self.contents("good"))
            for name in old:
                os.remove(self.path("set/" + name))
            os.rmdir(self.path("set"))

    def test_views(self):
        self.check("views", "raw.exr", "--grid", "2", "--exr")

    def test_export(self):
        self.check("export", "raw.exr", "--format", "hci", "--grid", "3")

    def test_refocus(self):
        self.check("refocus", "raw.exr", "--depth", "1 m", "--exr")

    def test_truth(self):
        self.succeeds("truth", "raw.exr", "-o", "t.csv", "--attach", "t.exr")
        sizes = sorted(len(self.read(name)) for name in ("t.csv", "t.exr"))
        for name in ("t.csv", "t.exr"):
            self.write(name, "old")
        self.fails(1, "truth", "raw.exr", "-o", "t.csv", "--attach", "t.exr", largest_file=sizes[1] - 1,
                   mentions="largest file size")
        for name in ("t.csv", "t.exr"):
            self.assertEqual(self.read(name), b"old")
        self.assertEqual(self.files(), ["raw.exr", "t.csv", "t.exr"])

    def all_or_none(self, arguments, names, limit):
        """Old files stay where one of the new ones has no room."""
        for name in names:
            self.write(name, "old " + name)
        self.fails(1, *arguments, largest_file=limit, mentions="largest file size")
        for name in names:
            self.assertEqual(self.read(name), b"old " + name.encode())
        self.assertEqual(self.files(), sorted(["raw.exr", *names]))

    def test_frames_of_develop(self):
        self.write("b.toml", SCENE + '[[channels]]\nname = "red"\nkind = "band"\nwavelength = "650 nm"\nwidth = "20 nm"\n')
        self.succeeds("render", "b.toml", "-o", "raw.exr", "--samples", "2", "--window", "1480,1490,40,40", "--quiet")
        os.remove(self.path("b.toml"))
        arguments = ("develop", "raw.exr", "--sensor", "--frames", "6", "-o", "f.png")
        self.succeeds(*arguments)
        names = [f"f-{k}.png" for k in range(1, 7)]
        sizes = [len(self.read(name)) for name in names]
        self.assertGreater(max(sizes), sizes[0], "the first has room, a later one has not")
        self.all_or_none(arguments, names, max(sizes) - 1)

    def test_bench(self):
        self.write("a.toml", SCENE)
        bench = ("bench", "a.toml", "--window", "1480,1490,8,8", "--samples", "2,4", "--estimators", "backward",
                 "--repeat", "1", "--reference-samples", "16", "--cache", "cache", "-o", "out", "--quiet")
        self.succeeds(*bench)
        names = ["out.csv", "out.json", "out.png", "out.svg"]
        largest = max(len(self.read(name)) for name in names)
        for name in names:
            self.write(name, "old")
        self.fails(1, *bench, largest_file=largest * 3 // 4, mentions="largest file size")
        for name in names:
            self.assertEqual(self.read(name), b"old")
        self.assertEqual(self.files(), ["a.toml", "cache", *names, "raw.exr"])


class HardTimes(CommandTest):
    def test_what_is_open_or_round_is_not_replaced(self):
        write_light_field(self.path("raw.exr"), [[1e-9] * 100] * 80, scene=SMALL)
        self.write("log", "kept\n")
        with open(self.path("log"), "ab") as log:
            result = self.run_command("truth", "raw.exr", "-o", "/dev/stdout", stdout=log)
        self.assertEqual(result.returncode, 1)
        self.assertIn("open already", result.stderr)
        self.assertEqual(self.read("log"), b"kept\n")
        os.symlink("round.csv", self.path("round.csv"))
        self.fails(1, "truth", "raw.exr", "-o", "round.csv", mentions="circle")
        self.assertTrue(os.path.islink(self.path("round.csv")))

    def test_a_pipe_is_not_waited_for(self):
        os.mkfifo(self.path("pipe"))
        self.fails(1, "info", "pipe", mentions="it is a pipe")
        self.fails(1, "develop", "pipe", "-o", "a.png", mentions="pipe")
        os.mkfifo(self.path("pipe.toml"))
        self.fails(1, "render", "pipe.toml", mentions="nobody writes")

    def test_few_threads_and_little_memory(self):
        """Whatever the system refuses, the end is a picture or a line; never an abort."""
        self.write("a.toml", SCENE)
        tried = 0
        for megabytes in (120, 150, 180, 220, 260, 300, 400, 600, 900):
            def limit(bytes_=megabytes << 20):
                resource.setrlimit(resource.RLIMIT_AS, (bytes_, bytes_))
            def run(*arguments):
                return subprocess.run([command.COMMAND, *arguments], cwd=self.folder, stdin=subprocess.DEVNULL,
                                      stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, timeout=120,
                                      preexec_fn=limit, check=False)
            start = run("--version")
            if start.returncode == 127:  # the libraries find no room
                continue
            if start.returncode != 0:  # one of OpenVDB's wants a thread before main() begins
                self.assertEqual(start.returncode, 1, (megabytes, start.stderr))
                self.assertRegex(start.stderr, r"\Aplenoflame: error: [^\n]+too low to start\n\Z")
                continue
            tried += 1
            result = run("render", "a.toml", "--samples", "2", "--window", "1480,1490,24,20", "--threads", "16", "--quiet")
            self.assertIn(result.returncode, (0, 1), (megabytes, result.stderr))
            self.assertNotIn("Resource temporarily unavailable", result.stderr)
            if result.returncode == 1:
                self.assertRegex(result.stderr, r"\Aplenoflame: error: [^\n]+\n\Z")
            else:
                self.assertEqual(result.stderr, "")
        self.assertGreater(tried, 3)


if __name__ == "__main__":
    main()
