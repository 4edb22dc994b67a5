"""Compiled cameras on the command line: what they make, and what a wrong bundle or option gets."""

import json
import signal
import struct
import subprocess
import time
import zlib

import command
from command import CommandTest, main

SCENE = """[camera]
preset = "paper-plenoptic2"
[[flames]]
preset = "paper-layered"
position = ["1 m", "0 m", "-29 mm"]
"""
WINDOW = ("--window", "1400,1400,48,48")
ROUGH = ("--level", "1", "--samples", "16", "--quiet")


class Compile(CommandTest):
    def setUp(self):
        super().setUp()
        self.write("a.toml", SCENE)

    def compiled(self, *options, output="a.bundle"):
        self.succeeds("compile", "a.toml", *WINDOW, *ROUGH, *options, "-o", output)

    def refused(self, *options, mentions, status=1, scene="a.toml"):
        self.fails(status, "render", scene, *options, "-o", "x.exr", "--quiet", mentions=mentions)
        self.assertNotIn("x.exr", self.files())

    def test_another_camera_window_or_region(self):
        self.compiled()
        one = ("--compiled", "a.bundle")
        self.refused("--set", "camera.array.pitch=101 um", *one, mentions=["a.bundle", "another camera", "camera.array.pitch", "101 um"])
        self.refused("--set", "camera.focus.object_distance=1.1 m", *one, mentions=["another camera", "object_distance"])
        self.refused("--window", "1390,1400,20,20", *one, status=2, mentions=["a.bundle", "1400,1400,48,48"])
        self.refused("--set", "flames[0].position=1 m, 0 m, -20 mm", *one, mentions=["a.bundle", "9 mm beyond the region", "--margin"])
        self.refused(*one, scene="a.bundle", mentions=["a.bundle", "compiled camera", "--compiled"])
        self.refused("--compiled", "a.toml", mentions=["a.toml", "not a compiled camera", "plenoflame compile"])
        self.refused("--compiled", "none.bundle", mentions="none.bundle")
        self.refused("--samples", "4", *one, status=2, mentions=["--samples", "--compiled"])
        self.refused("--target-error", "1%", *one, status=2, mentions=["--target-error", "--compiled"])

    def test_damaged_bundles(self):
        self.compiled()
        whole = self.read("a.bundle")
        for size in (0, 40, 500, len(whole) // 2, len(whole) - 1):
            self.write("b.bundle", whole[:size])
            message = "is cut off; compile the camera again" if size else "not a compiled camera"
            self.refused("--compiled", "b.bundle", mentions=["b.bundle", message])
            self.fails(1, "info", "b.bundle", mentions="b.bundle")
        changed = bytearray(whole)
        changed[-100] ^= 1
        self.write("b.bundle", bytes(changed))
        self.refused("--compiled", "b.bundle", mentions=["b.bundle", "damaged; compile the camera again"])
        self.write("b.bundle", whole.replace(b"plenoflame bundle 1\n", b"plenoflame bundle 9\n"))
        self.refused("--compiled", "b.bundle", mentions=["b.bundle", "another version"])
        # A set is refused before anything of it is made.
        self.write("runs.csv", "flames[0].brightness\n1\n")
        self.fails(1, "sweep", "a.toml", "--table", "runs.csv", "--compiled", "b.bundle", "-o", "set", mentions="another version")
        self.assertNotIn("set", self.files())

    def test_no_room_leaves_what_was_there(self):
        self.compiled()
        whole = self.read("a.bundle")
        self.fails(1, "compile", "a.toml", *WINDOW, *ROUGH, "--seed", "2", "-o", "a.bundle", largest_file=len(whole) // 2,
                   mentions="a.bundle")
        self.assertEqual(self.read("a.bundle"), whole)
        self.assertEqual(self.files(), ["a.bundle", "a.toml"])

    def test_stopped_and_killed(self):
        self.compiled()
        whole = self.read("a.bundle")
        arguments = ("compile", "a.toml", *WINDOW, *ROUGH)
        for sent in (signal.SIGINT, signal.SIGKILL):
            # A bundle of the whole sensor takes minutes: it is stopped on the way.
            process = subprocess.Popen([command.COMMAND, "compile", "a.toml", "--error", "0.2%", "-o", "a.bundle", "--threads", "1"],
                                       cwd=self.folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
            self.addCleanup(process.communicate)
            self.addCleanup(process.kill)
            self.wait_for_signals_to_be_caught(process)
            process.send_signal(sent)
            out, errors = process.communicate(timeout=60)
            if sent == signal.SIGINT:
                self.assertEqual((process.returncode, out, errors), (1, "", "plenoflame: stopped; nothing was written\n"))
            self.assertNotEqual(process.returncode, 0)
            self.assertEqual(self.read("a.bundle"), whole)
            self.assertEqual(self.files(), ["a.bundle", "a.toml"])
        self.succeeds(*arguments, "-o", "a.bundle")
        self.assertEqual(self.read("a.bundle"), whole)

    @staticmethod
    def wait_for_signals_to_be_caught(process):
        """Until then the signal ends any process."""
        caught = 0
        while process.poll() is None and not caught >> (signal.SIGINT - 1) & 1:
            with open(f"/proc/{process.pid}/status", encoding="ascii") as file:
                caught = next(int(line.split()[1], 16) for line in file if line.startswith("SigCgt"))
            time.sleep(0.01)

    @staticmethod
    def forged(whole, change_header=lambda header: None, change_groups=lambda groups: None, change_nodes=lambda nodes: None):
        """A bundle with something changed, and all its checksums right."""
        begin, size = 64, struct.unpack_from("<Q", whole, 20)[0]
        header = json.loads(whole[begin:begin + size])
        tiles = bytearray(whole[begin + size:][:40 * header["tiles"]])
        groups = bytearray(whole[begin + size + len(tiles):][:40 * header["groups"]])
        nodes = bytearray(whole[begin + size + len(tiles) + len(groups):])
        change_groups(groups)
        change_nodes(nodes)
        for at in range(0, len(tiles), 40):
            g, gs, n, ns = struct.unpack_from("<4Q", tiles, at)
            struct.pack_into("<I", tiles, at + 32, zlib.crc32(nodes[12 * n:12 * (n + ns)], zlib.crc32(groups[40 * g:40 * (g + gs)])))
        header["tiles_checksum"] = zlib.crc32(tiles)
        change_header(header)
        text = json.dumps(header).encode()
        text += b" " * (-len(text) % 64)
        return (b"plenoflame bundle 1\n" + struct.pack("<QQ", len(text), zlib.crc32(text))).ljust(64, b"\0") + text + tiles + groups + nodes

    def test_right_checksums_do_not_make_numbers_right(self):
        self.compiled()
        whole = self.read("a.bundle")
        self.write("b.bundle", self.forged(whole))
        self.succeeds("render", "a.toml", "--compiled", "b.bundle", "-o", "x.exr", "--quiet")
        self.succeeds("info", "b.bundle")
        subprocess.run(["rm", self.path("x.exr")], check=True)
        for wrong in ("nan", "inf", "-1e-12", "3.0"):
            def change_weight(nodes, value=float(wrong)):
                struct.pack_into("<f", nodes, 12 * 7 + 8, value)
            self.write("b.bundle", self.forged(whole, change_nodes=change_weight))
            self.refused("--compiled", "b.bundle", mentions=["b.bundle", "damaged"])
            self.fails(1, "info", "b.bundle", mentions=["b.bundle", "damaged"])
        for wrong in ("nan", "inf", "1e30"):
            for offset in (4, 16 + 8):  # lower, step
                def change_place(groups, value=float(wrong), at=offset):
                    struct.pack_into("<f", groups, 40 * 3 + at, value)
                self.write("b.bundle", self.forged(whole, change_groups=change_place))
                self.refused("--compiled", "b.bundle", mentions=["b.bundle", "damaged"])
        for change in (lambda h: h.update(frame=[h["frame"][0], [2, 0, 0], *h["frame"][2:]]), lambda h: h.update(samples=0),
                       lambda h: h.update(frame=[[1e999, 0, 0], *h["frame"][1:]])):
            self.write("b.bundle", self.forged(whole, change_header=change))
            self.fails(1, "info", "b.bundle", mentions=["b.bundle", "damaged"])

    def test_a_stated_window_takes_no_memory(self):
        self.compiled()
        def change(header):
            header["window"] = [0, 0, 4194304, 65536]
            header["sensor"] = [4194304, 65536]
        self.write("b.bundle", self.forged(self.read("a.bundle"), change_header=change))
        # Three tables of 67 million tiles would not fit.
        self.fails(1, "info", "b.bundle", mentions=["b.bundle", "damaged"], address_space=1 << 30)

    def test_a_region_that_is_not_seen(self):
        for region in ("-1.1m,-1cm,-3cm:-1m,1cm,0m", "0m,-1cm,-3cm:-1cm,1cm,0m"):
            self.fails(1, "compile", "a.toml", *WINDOW, *ROUGH, "--region", region, "-o", "x.bundle", mentions=["behind", "--region"])
        self.fails(1, "compile", "a.toml", *WINDOW, *ROUGH, "--region", "1m,5m,0m:1.1m,5.1m,0.1m", "-o", "x.bundle", mentions="no pixel sees")
        self.assertEqual(self.files(), ["a.toml"])

    def test_the_ending_says_what_is_written(self):
        for name in ("a.exr", "a", "a.bundle.gz"):
            self.fails(2, "compile", "a.toml", *WINDOW, "-o", name, mentions=["-o", name, ".bundle"])

    def test_bad_options(self):
        for options, status, mentions in ((("--error", "0%"), 2, "--error"), (("--error", "soon"), 2, "--error"),
                                          (("--level", "8"), 2, "--level"), (("--region", "1m,0m,0m"), 2, "--region"),
                                          (("--margin", "-1mm"), 2, "--margin"), (("--window", "2990,0,20,20"), 2, "window"),
                                          (("--set", "flames=[]"), 2, "flames")):
            self.fails(status, "compile", "a.toml", *options, "-o", "x.bundle", "--quiet", mentions=mentions)
        self.write("dark.toml", SCENE.split("[[flames]]", maxsplit=1)[0])
        self.fails(1, "compile", "dark.toml", *WINDOW, *ROUGH, "-o", "x.bundle", mentions="--region")
        self.assertNotIn("x.bundle", self.files())


if __name__ == "__main__":
    main()
