"""Manual pages and completions that are made of the help texts."""

import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

import command

TOOLS = pathlib.Path(__file__).resolve().parent.parent.parent / "tools"


class Manual(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = pathlib.Path(tempfile.mkdtemp())
        for tool in ("man_pages.py", "completions.py"):
            subprocess.run([sys.executable, "-B", TOOLS / tool, command.COMMAND, cls.folder], check=True, timeout=300)

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.folder)

    def help(self, *names):
        return subprocess.run([command.COMMAND, *names, "--help"], capture_output=True, text=True, check=True,
                              timeout=60).stdout

    def completed(self, *words):
        """What bash offers for the last of the words."""
        script = (f". {self.folder / 'plenoflame.bash'}; COMP_WORDS=(\"$@\"); COMP_CWORD=$(($# - 1)); _plenoflame;"
                  " printf '%s\\n' \"${COMPREPLY[@]}\"")
        return subprocess.run(["bash", "-c", script, "bash", *words], capture_output=True, text=True, check=True,
                              cwd=self.folder, timeout=60).stdout.split()

    def test_every_command_has_a_page_with_all_its_options(self):
        names = re.findall(r"^  ([a-z]+)  ", self.help().partition("Subcommands:")[2], re.MULTILINE)
        self.assertIn("render", names)
        for name in names:
            page = (self.folder / f"plenoflame-{name}.1").read_text().replace("\\-", "-")
            for option in re.findall(r"^  (?:-\w, )?(--[a-z-]+)", self.help(name), re.MULTILINE):
                self.assertIn(f"\\fB{option}\\fR", page, name)

    def test_descriptions_are_sentences(self):
        for page in self.folder.glob("*.1"):
            description = re.search(r"^\.SH DESCRIPTION\n(.*)\n", page.read_text(), re.MULTILINE)[1]
            self.assertRegex(description, r"[^.]\.$", page.name)

    def test_pages_begin_no_line_with_a_command_of_roff_that_was_text(self):
        known = {".TH", ".SH", ".TP", ".nf", ".fi"}
        for page in self.folder.glob("*.1"):
            for line in page.read_text().splitlines():
                if line.startswith("."):
                    self.assertIn(line.split()[0], known, page.name)

    def test_bash_completes_commands_options_and_files(self):
        self.assertEqual(self.completed("plenoflame", "rend"), ["render"])
        self.assertEqual(self.completed("plenoflame", "render", "--samp"), ["--samples"])
        self.assertEqual(self.completed("plenoflame", "views", "--samp"), [])
        self.assertEqual(self.completed("plenoflame", "render", "-o", "plenoflame-ren"), ["plenoflame-render.1"])
        if "import" in self.help("flame").partition("Subcommands:")[2]:
            self.assertIn("import", self.completed("plenoflame", "flame", "imp"))
            self.assertIn("--soot", self.completed("plenoflame", "flame", "import", "--soo"))

    def test_other_shells_accept_theirs(self):
        for shell, name in (("bash", "plenoflame.bash"), ("zsh", "_plenoflame"), ("fish", "plenoflame.fish")):
            if shutil.which(shell):
                subprocess.run([shell, "-n", self.folder / name], check=True, timeout=60)
        for name in ("_plenoflame", "plenoflame.fish"):
            self.assertIn("time-limit", (self.folder / name).read_text())


unittest.main()
