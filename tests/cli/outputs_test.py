"""No command writes over what it reads, nor one output over another, by whatever name."""

import os
import re

from command import CommandTest, main

# Each command has its inputs, each as an argument with FILE in it, its outputs, and what else must be given.
COMMANDS = {
    "render": (["FILE"], ["-o", "--stats"], []),
    "merge": (["FILE"], ["-o"], []),
    "submit": (["FILE"], ["-o"], ["--slurm"]),
    "sweep": (["FILE", "--table=FILE", "--random=FILE"], ["-o"], []),
    "rays": (["FILE", "--pixels=FILE"], ["-o"], ["--chief"]),
    "corners": (["FILE"], ["-o"], []),
    "bench": (["FILE"], ["-o"], []),
    "design": (["FILE"], ["-o", "--plots"], []),
    "optimize": (["FILE"], ["-o"], []),
    "develop": (["FILE"], ["-o"], []),
    "pyrometry": (["FILE", "--reference=FILE"], ["-o", "--picture", "--truth-picture"], []),
    "operator": (["FILE"], ["-o", "--pixels", "--places"], []),
    "truth": (["FILE", "--points=FILE"], ["-o", "--attach", "--projections", "--chief-rays"], []),
    "views": (["FILE", "--scene=FILE"], ["-o"], []),
    "refocus": (["FILE", "--scene=FILE"], ["-o"], []),
    "export": (["FILE", "--scene=FILE"], ["-o"], ["--format", "libpleno"]),
    "reconstruct": (["FILE", "--images=FILE", "--support=FILE", "--prior=FILE", "--start=FILE"],
                    ["-o", "--residual", "--report", "--refined"], []),
    "flame": (["--layers=FILE"], ["-o"], ["layered"]),
    "flame import": (["FILE", "--solution=FILE"], ["-o"], []),
    "picture": (["FILE", "--image=FILE", "--rays-file=FILE"], ["-o"], []),
    "import": (["FILE", "650nm=FILE", "--dark=FILE", "--flat=FILE", "--flat-dark=FILE", "--white=FILE", "--white-dark=650nm=FILE",
                "--radiometry=FILE", "--camera=FILE", "--defects=FILE"], ["-o"], []),
    "calibrate white": (["FILE", "4=FILE", "--dark=FILE", "--camera=FILE"], ["-o", "--centres", "--radii", "--picture"], []),
    "calibrate radiometry": (["1500 K=FILE", "--white=FILE", "--white=1 ms=FILE", "--white-dark=FILE", "--flat=FILE", "--flat-dark=FILE",
                              "--dark=FILE", "--camera=FILE"], ["-o"], []),
    "calibrate corners": (["FILE", "--white=FILE", "--dark=FILE", "--camera=FILE"], ["-o", "--picture"], []),
    "calibrate geometry": (["FILE", "--centres=FILE", "--radii=FILE", "--camera=FILE"], ["-o", "--residuals", "--poses", "--plot"], []),
    "calibrate rig": (["FILE=p.csv", "c.toml=FILE"], ["-o"], []),
    "compare": (["FILE"], ["--lenses", "--map"], ["b.exr"]),
    "camera import": (["FILE"], ["-o"], []),
    "info": (["FILE"], [], []),
}
# Options that name files or folders and are none of the two: what is kept, or gone on with.
OTHERS = {"render --resume", "reconstruct --resume", "bench --cache", "bench --compare", "submit --sweep", "submit --operator"}
LONG = {"-o": "--output"}


class Outputs(CommandTest):
    helps = {}  # by command; they are the same for all tests

    def setUp(self):
        super().setUp()
        self.lacked = {}  # by command: arguments that it wants besides

    def present(self):
        """The commands that this build has."""
        for name, about in COMMANDS.items():
            text = self.helps.get(name) or self.helps.setdefault(name, self.run_command(*name.split(), "--help").stdout)
            if "which this build was made without" not in " ".join(text.split()) and text:
                yield name, about, text

    def with_what_is_required(self, words):
        """The command line with the arguments that it wants besides: files that are not there, which nothing is to look at."""
        while True:
            missing = re.search(r"error: (\S+) is required", self.run_command(*words).stderr)
            if not missing:
                return words
            words = words + [missing[1] + "=x.none" if missing[1].startswith("-") else "x.none"]

    def refused(self, words, mentions, name=None):
        """`words`, with what else they lack, end with a message. Runs of the command `name` lack about the same."""
        lacked = self.lacked.setdefault(name, []) if name else []
        options = {word.split("=")[0] for word in words}
        words = words + [word for word in lacked if not word.startswith("-") or word.split("=")[0] not in options]
        result = self.run_command(*words)
        if " is required" in result.stderr:
            complete = self.with_what_is_required(words)
            lacked.extend(complete[len(words):])
            result = self.run_command(*complete)
        self.is_failure(result, 2, mentions)

    def test_every_option_that_names_files_is_in_the_table(self):
        for name, (inputs, outputs, _), text in self.present():
            known = {LONG.get(o, o) for o in outputs} | {re.match("--[a-z-]+", i).group() for i in inputs if i.startswith("--")}
            for line in re.findall(r"^  +((?:-\w, )?--[a-z-]+ .*)", text.split("\nExample")[0], re.MULTILINE):
                option, rest = re.search(r"(--[a-z-]+) (.*)", line).groups()
                word = rest.split("  ")[0].split(" ")[0].strip("[]")
                if re.search(r"FILE|DIR|\.\w+\b|RAW|MAP", word) and option != "--set":
                    self.assertIn(option, known | {other.split(" ")[-1] for other in OTHERS if other.rsplit(" ", 1)[0] == name},
                                  (name, line))

    def test_no_output_is_an_input(self):
        content = b"this is read"
        for name, (inputs, outputs, rest), text in self.present():
            # Every input and every output: a command compares each with all of the others' kind.
            pairs = range(max(len(inputs), len(outputs)) if outputs else 0)
            for i, j in sorted((k % len(inputs), k % len(outputs)) for k in pairs):
                given, output = inputs[i], outputs[j]
                for kind in ("same", "dotted", "symbolic", "hard"):
                    self.write("in.file", content)
                    other = {"same": "in.file", "dotted": "./sub/.././in.file"}.get(kind, "link")
                    os.makedirs(self.path("sub"), exist_ok=True)
                    if os.path.lexists(self.path("link")):
                        os.remove(self.path("link"))
                    if kind == "symbolic":
                        os.symlink("sub/../in.file", self.path("link"))
                    elif kind == "hard":
                        os.link(self.path("in.file"), self.path("link"))
                    long = LONG.get(output, output)
                    words = [*name.split(), given.replace("FILE", "in.file"), *rest, "%s=%s" % (long, other)]
                    with self.subTest(words=words):
                        self.refused(words, [long + ": '" + other + "' is a file that this command reads"], name)
                        self.assertEqual(self.read("in.file"), content)
                    if kind == "same" and name != "render":
                        break  # the other names are resolved in the same way

    def test_no_output_is_another_one(self):
        for name, (inputs, outputs, rest), text in self.present():
            for first, second in zip(outputs, outputs[1:]):
                names = [LONG.get(o, o) for o in (first, second)]
                if os.path.lexists(self.path("link.out")):
                    os.remove(self.path("link.out"))
                os.symlink("not-there-yet.out", self.path("link.out"))
                for other in ("a.out", "././a.out", os.path.join(self.folder, "a.out"), None):
                    values = ["not-there-yet.out", "link.out"] if other is None else ["a.out", other]
                    words = [*name.split(), inputs[0].replace("FILE", "x.none"), *rest]
                    words += ["%s=%s" % pair for pair in zip(names, values)]
                    with self.subTest(words=words):
                        self.refused(words, ["are the same file", *names], name)
                    if name != "design":
                        break
        self.fails(2, "reconstruct", "x.none", "--images=x.none", "-o", "a.vdb", "--residual", "r.exr", "./r.exr",
                   mentions="--residual names the same file twice")

    def test_a_file_that_the_scene_names_is_read(self):
        self.write("s.toml", '[camera]\npreset = "paper-plenoptic2"\n[[channels]]\nname = "a"\nkind = "curve"\nfile = "c.csv"\n')
        self.write("c.csv", "1,2\n")
        self.fails(2, "operator", "s.toml", "-o", "a.npz", "--pixels", "c.csv", "--center", "1 m, 0 m, 0 m", "--size", "1 cm, 1 cm, 1 cm", mentions="'c.csv' is a file that this command reads")

    def test_endings_tell_what_is_written(self):
        present = {name for name, _, _ in self.present()}
        self.write("s.toml", '[camera]\npreset = "paper-plenoptic2"\n')
        for line, ending in (("render s.toml -o a.png", ".exr"), ("import x.tif -o a.png", ".exr"),
                             ("operator s.toml -o a.exr", ".npz"), ("rays s.toml --pixel 5,5 -o a.exr", ".vtp"),
                             ("corners s.toml -o a.exr", ".csv"), ("merge r.exr q.exr -o a.png", ".exr"), ("develop r.exr -o a.csv", ".png"),
                             ("pyrometry r.exr -o a.csv", ".exr"), ("pyrometry r.exr --picture a.exr", ".png"),
                             ("pyrometry r.exr --truth-picture a.exr", "--truth-picture: 'a.exr' must end in .png"),
                             ("camera import s.xml -o a.exr", ".toml"), ("calibrate white w.tif --camera s.toml -o a.exr", ".toml"),
                             ("calibrate corners b.tif --camera s.toml --board 5x4 --cell 5mm -o a.exr", ".csv"),
                             ("calibrate corners b.tif --camera s.toml --board 5x4 --cell 5mm -o a.csv --picture a.exr", ".png"),
                             ("calibrate geometry b.csv --camera s.toml -o a.exr", ".toml"),
                             ("calibrate radiometry 1500=b.tif --camera s.toml -o a.exr", ".toml"),
                             ("calibrate rig s.toml=b.csv t.toml=c.csv -o a.exr", ".toml"),
                             ("calibrate white w.tif --camera s.toml --picture a.exr", ".png"),
                             ("picture s.toml -o a.exr", ".png"), ("design s.toml -o a.exr", ".toml"),
                             ("flame import x.vtu -o a.exr", ".vdb"),
                             ("reconstruct s.toml --images x.exr -o a.vdb --refined a.exr", ".toml")):
            if line.split(" ")[0] not in present and " ".join(line.split()[:2]) not in present:
                continue
            with self.subTest(line=line):
                self.refused(line.split(), ["must end in", ending])
        self.fails(2, "operator", "s.toml", "-o", "", mentions="--output: '' must end in .npz")

    def test_a_folder_that_is_merged_is_no_output(self):
        os.mkdir(self.path("set"))
        self.fails(2, "merge", "set", "-o", "./set", mentions="this command reads")

    def test_a_device_may_be_named_twice(self):
        result = self.run_command("calibrate", "geometry", "x.csv", "--camera", "x.toml", "-o", "/dev/null", "--poses", "/dev/null")
        self.assertNotIn("same file", result.stderr)

    def test_bench_keeps_the_run_that_it_compares_with(self):
        self.write("a.json", "{}")
        self.fails(2, "bench", "s.toml", "-o", "a", "--compare", "./a.json", mentions="this command reads")


if __name__ == "__main__":
    main()
