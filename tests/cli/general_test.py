"""What holds for every command: help, version, exit statuses, where output goes."""

import re
import subprocess

from command import CommandTest, main


class General(CommandTest):
    def commands(self):
        text = self.succeeds("--help")
        listed = text.split("Subcommands:\n")[1]
        entries = re.findall(r"^  (\w+)((?:.|\n(?=   ))*)", listed, re.MULTILINE)
        return [name for name, about in entries if "which this build was made without" not in " ".join(about.split())]

    def test_version(self):
        text = self.succeeds("--version")
        self.assertRegex(text, r"\Aplenoflame \d+\.\d+\.\d+ \((commit [0-9a-f]{10}( with changes)?; )?parts: light fields[^\n]*; "
                         r"instruction set: (baseline|avx2|avx512)\)\n\Z")
        # Parts that are said to be there are there.
        for part, names in (("OpenVDB", ["flame"]), ("VTK", ["picture", "flame import"])):
            for name in names:
                lists = self.succeeds("--help") if " " not in name else self.succeeds(name.split()[0], "--help")
                self.assertEqual(part in text, f"needs {part}, which this build was made without" not in
                                 " ".join(lists.split()), name)


    def test_help_lists_commands(self):
        for name in ("develop", "compare", "info"):
            self.assertIn(name, self.commands())

    def test_every_help_has_an_example_that_names_the_command(self):
        for name in self.commands():
            text = self.succeeds(name, "--help")
            self.assertNotIn("{", text, "a flag's value in braces is no word that could be typed")
            self.assertRegex(text, r"\nExample:\n  plenoflame %s\b" % name)
            for line in text.splitlines():
                self.assertLessEqual(len(line), 96, line)
        self.assertEqual(text, self.succeeds(name, "-h"))

    def test_bad_use_is_status_2(self):
        self.fails(2, mentions=["a command is required", "plenoflame --help"])
        self.fails(2, "inof", mentions=["'inof'", "did you mean 'info'?"])
        self.fails(2, "quantum", mentions="unknown command 'quantum'")
        self.fails(2, "--fast", mentions="unknown option '--fast'")
        for name in self.commands():
            self.fails(2, name, mentions="plenoflame %s --help" % name)
        self.fails(2, name, "a", "b", "c", "d", "--nonsense", mentions="--help")

    def test_an_option_given_twice(self):
        self.fails(2, "render", "a.toml", "--samples", "1", "--samples", "2",
                   mentions=["--samples is given twice: '1' and '2'; give it once", "render --help"])
        text = self.run_command("render", "a.toml", *(("--seed", "3") * 3)).stderr
        self.assertIn("--seed is given 3 times", text)
        self.assertNotIn("At Most", text)

    def test_an_absorption_beyond_every_flame(self):
        for value in ("1e9 1/m", "1000001 1/m"):
            self.fails(2, "operator", "none.toml", "--absorption", value, "-o", "a.npz", mentions=["--absorption: ", "1e6 1/m"])
        self.fails(1, "operator", "none.toml", "--absorption", "999999 1/m", "-o", "a.npz", mentions="none.toml")

    def test_full_standard_output_is_a_failure(self):
        with open("/dev/full", "w") as full:
            result = self.run_command("--version", stdout=full)
        self.assertEqual(result.returncode, 1)
        self.assertRegex(result.stderr, r"\Aplenoflame: error: standard output [^\n]+\n\Z")

    def test_closed_pipe_does_not_hang(self):
        process = subprocess.Popen([__import__("command").COMMAND, "--help"], stdout=subprocess.PIPE,
                                   stderr=subprocess.DEVNULL)
        process.stdout.close()
        self.assertIsNotNone(process.wait(timeout=30))


if __name__ == "__main__":
    main()
