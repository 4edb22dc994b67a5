#!/usr/bin/env python3
"""What a user sees of a run's progress on a terminal: the share done, and the time left.

The reference of the share is the processor time that the run takes in all, which other work on the machine does not
change as it does the wall clock's: after a share s of it the bar shall show about s. The time left is in proportion."""

import fcntl
import os
import pty
import re
import struct
import subprocess
import termios
import time

from command import COMMAND, CommandTest, main

SCENE = """[camera]
preset = "paper-plenoptic2"
[[flames]]
preset = "paper-layered"
position = ["1 m", "0 m", "-29 mm"]
"""
SHOWN = re.compile(rb"(?:\r([^\r:]+): +)?(\d+) % \[[#.]{24}\]([^\r]*)")
ERROR = re.compile(rb"error ([0-9.e+-]+) %")
LEFT = re.compile(rb"(?:(\d+):)?(\d+):(\d\d) left")
TICK = os.sysconf("SC_CLK_TCK")


class Shown:
    """One drawing of the bar: share [%], time left [s] or None, and when [s of processor, s of wall clock]."""

    def __init__(self, match, processor, wall):
        self.label = match[1].decode() if match[1] else ""
        self.percent = int(match[2])
        error = ERROR.search(match[3])
        self.error = float(error[1]) if error else None
        left = LEFT.search(match[3])
        self.left = None if left is None else int(left[1] or 0) * 3600 + int(left[2]) * 60 + int(left[3])
        self.processor, self.wall = processor, wall

    def __repr__(self):
        return f"{self.percent} % after {self.processor:.2f} ({self.wall:.2f}) s, {self.left} s left"


def processor_seconds(process):
    with open(f"/proc/{process}/stat", encoding="ascii") as file:
        fields = file.read().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / TICK


class ProgressOnATerminal(CommandTest):
    def setUp(self):
        super().setUp()
        self.write("a.toml", SCENE)

    def watch(self, *arguments):
        """Runs the command on a terminal of its own; what its bar showed, in order."""
        ours, theirs = pty.openpty()
        fcntl.ioctl(theirs, termios.TIOCSWINSZ, struct.pack("HHHH", 24, 120, 0, 0))
        start = time.monotonic()
        with subprocess.Popen([COMMAND, *arguments], cwd=self.folder, stdin=subprocess.DEVNULL,
                              stdout=subprocess.DEVNULL, stderr=theirs,
                              env={**os.environ, "TERM": "xterm"}) as process:
            os.close(theirs)
            shown, rest = [], b""
            while True:
                try:
                    new = os.read(ours, 65536)
                except OSError:  # the other end is closed
                    break
                if not new:
                    break
                now = processor_seconds(process.pid), time.monotonic() - start
                *lines, rest = (rest + new).split(b"\x1b[K")
                shown += [Shown(match, *now) for match in map(SHOWN.search, lines) if match]
            os.close(ours)
            self.assertEqual(process.wait(), 0)
        return shown

    def assert_honest(self, shown):
        self.assertGreater(len(shown), 12, shown)
        self.assertEqual(shown[-1].percent, 100)
        for before, after in zip(shown, shown[1:]):
            self.assertGreaterEqual(after.percent, before.percent, "the share fell")
        first, whole = shown[0].processor, shown[-1].processor - shown[0].processor
        seen = 0
        for state in shown:
            done = state.processor - first
            if not (0.25 * whole < done < 0.9 * whole):
                continue
            seen += 1
            rest = whole - done
            # Shares are rounded down to whole per cents.
            low, high = (done * (100 - p) / max(p, 1e-3) for p in (state.percent + 1, state.percent))
            self.assertLess(low, 2 * rest, (state, shown))
            self.assertGreater(high, rest / 2, (state, shown))
            if state.left is not None:
                # As long as the rest takes at the speed so far, whose measure is the wall clock, as the shares rose on
                # it: a machine that was busy for a while has slowed down both. Seconds are rounded up.
                low, high = ((state.wall - shown[0].wall) * (100 - p) / (p - shown[0].percent) for p in
                             (state.percent + 1, state.percent))
                self.assertLess(state.left - 1, 1.5 * high + 0.5, (state, shown))
                self.assertGreater(state.left + 0.5, low / 1.5, (state, shown))
        self.assertGreater(seen, 5, shown)
        self.assertIsNotNone(shown[len(shown) // 2].left)

    def test_of_a_number_of_samples(self):
        # Its first rows of tiles see nothing of the flame.
        self.assert_honest(self.watch("render", "a.toml", "-o", "a.exr", "--samples", "256",
                                      "--window", "1000,800,640,1000", "--threads", "1"))

    def test_of_a_target_error(self):
        shown = self.watch("render", "a.toml", "-o", "a.exr", "--target-error", "0.4%", "--window", "1000,800,640,1000",
                           "--threads", "1")
        self.assert_honest(shown)
        # The error falls while samples are taken, not in one step at the end.
        errors = [s.error for s in shown if s.error is not None]
        self.assertGreater(len({e for e in errors if 0.4 < e < 3}), 4, errors)
        self.assertLessEqual(errors[-1], 0.4)

    def test_of_parts_that_have_names(self):
        shown = self.watch("bench", "a.toml", "--window", "1400,1400,200,100", "--samples", "4,16", "--estimators", "backward",
                           "--repeat", "2", "--reference-samples", "64", "--cache", "cache", "--threads", "1")
        labels = [s.label for s in shown]
        self.assertEqual(list(dict.fromkeys(labels)), ["reference", "1 of 2, backward 4", "2 of 2, backward 16"])
        for label in set(labels):  # both repetitions are one part
            percents = [s.percent for s in shown if s.label == label]
            self.assertEqual(percents, sorted(percents), label)

    def test_of_the_forward_estimator(self):
        self.assert_honest(self.watch("render", "a.toml", "-o", "a.exr", "--estimator", "forward", "--samples",
                                      "15000000", "--threads", "1"))

    def test_of_a_picture_with_ground_truth(self):
        shown = self.watch("render", "a.toml", "-o", "a.exr", "--samples", "32", "--truth", "--window",
                           "1300,1300,400,400", "--threads", "1")
        self.assertEqual(sorted(s.percent for s in shown), [s.percent for s in shown])
        self.assertEqual([s.percent for s in shown].count(100), 1, shown)

    def test_of_several_apertures(self):
        shown = self.watch("render", "a.toml", "-o", "a.exr", "--samples", "4", "--white", "--f-numbers", "5.6,8",
                           "--window", "1300,1300,400,400", "--threads", "1")
        self.assertEqual(sorted(s.percent for s in shown), [s.percent for s in shown])
        self.assertTrue(any(50 <= s.percent < 60 for s in shown), shown)


if __name__ == "__main__":
    main()
