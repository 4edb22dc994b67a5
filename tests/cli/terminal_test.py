"""What stands on a terminal of few columns: helps, results and tables are broken between words, not by the terminal. Where
the output goes elsewhere results have a line for each figure."""

import fcntl
import os
import pty
import struct
import subprocess
import termios

from command import COMMAND, CommandTest, main

SCENE = """[camera]
preset = "paper-plenoptic2"
[[flames]]
preset = "paper-layered"
position = ["1 m", "0 m", "-29 mm"]
"""


class Terminal(CommandTest):
    def setUp(self):
        super().setUp()
        self.write("a.toml", SCENE)

    def shown(self, columns, *arguments):
        """The lines of standard output on a terminal so wide."""
        ours, theirs = pty.openpty()
        fcntl.ioctl(theirs, termios.TIOCSWINSZ, struct.pack("HHHH", 24, columns, 0, 0))
        with subprocess.Popen([COMMAND, *arguments], cwd=self.folder, stdin=subprocess.DEVNULL, stdout=theirs,
                              stderr=subprocess.DEVNULL) as process:
            os.close(theirs)
            text = b""
            while True:
                try:
                    new = os.read(ours, 65536)
                except OSError:  # the other end is closed
                    break
                if not new:
                    break
                text += new
            os.close(ours)
            self.assertEqual(process.wait(), 0)
        return text.decode().replace("\r\n", "\n").splitlines()

    def assert_fits(self, columns, lines):
        self.assertGreater(len(lines), 5)
        for line in lines:
            self.assertLessEqual(len(line), columns, line)

    def words(self, lines):
        return [word for line in lines for word in line.split() if word != "\\"]

    def test_helps(self):
        for arguments in (("--help",), ("render", "--help"), ("submit", "--help"), ("calibrate", "white", "--help")):
            wide = self.run_command(*arguments, environment={**os.environ, "COLUMNS": "96"}).stdout.splitlines()
            for columns in (60, 80):
                lines = self.shown(columns, *arguments)
                self.assert_fits(columns, lines)
                self.assertEqual(self.words(lines), self.words(wide))
            self.assert_fits(80, self.run_command(*arguments, environment={**os.environ, "COLUMNS": ""}).stdout.splitlines())

    def test_results(self):
        self.run_command("render", "a.toml", "-o", "a.exr", "--samples", "2", "--window", "1480,1490,32,32", "--quiet")
        plain = self.succeeds("compare", "a.exr", "a.exr").splitlines()
        self.assertGreater(max(map(len, plain)), 60)
        lines = self.shown(60, "compare", "a.exr", "a.exr")
        self.assert_fits(60, lines)
        self.assertEqual(self.words(lines), self.words(plain))
        labels = [line.partition(":")[0] for line in plain]
        self.assertEqual([line.partition(":")[0] for line in lines if not line.startswith(" ")], labels)

    def test_the_table_of_bench(self):
        quick = ("bench", "a.toml", "--window", "1480,1490,20,20", "--samples", "4,16", "--estimators", "backward",
                 "--repeat", "1", "--reference-samples", "64", "--cache", "cache")
        plain = self.succeeds(*quick).splitlines()
        lines = self.shown(80, *quick)
        self.assert_fits(80, lines)
        names = plain[0].split()
        heads = [line.split() for line in lines if line.startswith("estimator")]
        self.assertGreater(len(heads), 1)
        self.assertEqual(heads[0] + [name for head in heads[1:] for name in head[2:]], names)
        self.assertTrue(all(head[:2] == names[:2] for head in heads))


if __name__ == "__main__":
    main()
