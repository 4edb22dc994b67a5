"""Sweeps: sets of many runs, whatever their order, threads and parts; what bad tables and rules get."""

import csv
import filecmp
import os
import shutil

from command import CommandTest, main

SCENE = """[camera]
preset = "paper-plenoptic2"
[[flames]]
preset = "paper-layered"
position = ["1 m", "0 m", "-29 mm"]
"""
TABLE = """flames[0].position,flames[0].brightness
"1 m, 0 m, -29 mm",1
"1 m, 2 mm, -29 mm",0.5
"1 m, -2 mm, -29 mm",
"""
OPTIONS = ("--window", "1400,1400,64,64", "--samples", "4", "--lattice", "4,4,6", "--quiet")


class Sweeps(CommandTest):
    def setUp(self):
        super().setUp()
        self.write("a.toml", SCENE)
        self.write("runs.csv", TABLE)

    def sweep(self, folder, *options, table="runs.csv"):
        self.succeeds("sweep", "a.toml", "--table", table, "-o", folder, *OPTIONS, *options)

    def assert_same(self, one, other):
        def files(folder):
            return sorted(os.path.relpath(os.path.join(path, name), self.path(folder))
                          for path, _, names in os.walk(self.path(folder)) for name in names)
        self.assertEqual(files(one), files(other))
        self.assertEqual(filecmp.cmpfiles(self.path(one), self.path(other), files(one), shallow=False)[1:], ([], []))

    def index(self, folder):
        with open(self.path(folder + "/index.csv"), newline="", encoding="utf-8") as file:
            return list(csv.DictReader(file))

    def test_parts_threads_and_a_break_make_the_same_set(self):
        for format_name in ("exr", "hdf5"):
            options = ("--format", format_name, "--test-share", "34%")
            self.sweep(format_name, *options, "--threads", "1")
            for k in (2, 1):
                self.sweep("p" + format_name, *options, "--part", f"{k}/2", "--threads", "2")
            parts = [f"p{format_name}-part-{k}-of-2" for k in (1, 2)]
            self.succeeds("merge", *parts, "-o", "all" + format_name)
            self.assert_same(format_name, "all" + format_name)
        for end in ("json", "exr"):
            os.remove(self.path(f"exr/runs/000001.{end}"))
        self.sweep("exr", "--format", "exr", "--test-share", "34%")
        self.assert_same("exr", "allexr")
        self.assertEqual([row["split"] for row in self.index("exr")].count("test"), 1)

    def test_a_run_is_the_picture_that_render_makes(self):
        self.sweep("set")
        row = self.index("set")[1]
        self.succeeds("render", "a.toml", "--set", "flames[0].position=1 m, 2 mm, -29 mm", "--set", "flames[0].brightness=0.5",
                      *OPTIONS[:4], "--quiet", "--seed", row["seed"], "-o", "one.exr")
        self.assertEqual(self.read("one.exr"), self.read("set/" + row["picture"]))

    def test_bad_tables(self):
        def refused(text, *mentions):
            self.write("bad.csv", text)
            self.fails(1, "sweep", "a.toml", "--table", "bad.csv", "-o", "x", *OPTIONS, mentions=["bad.csv:", *mentions])
        refused("flames[0].brightnes\n1\n", "bad.csv:2:1", "flames[0].brightness")
        refused("flames[0].name,flames[0].brightness\na,1\nb,red\n", "bad.csv:3:3", "red")
        refused("flames[0].brightness\n1,2\n", "bad.csv:2", "2 cells")
        refused("flames[0].brightness\n", "no row")
        refused("flames[0].position\n\"1 m\n", "bad.csv:2:1", "quote")
        self.assertNotIn("x", self.files())

    def test_bad_rules(self):
        def refused(text, *mentions):
            self.write("bad.toml", "runs = 3\n[[random]]\nkey = \"flames[0].brightness\"\n" + text)
            self.fails(1, "sweep", "a.toml", "--random", "bad.toml", "-o", "x", *OPTIONS, mentions=["bad.toml:", *mentions])
        refused("uniform = [2, 1]\n", "bad.toml:4:11", "least")
        refused("unifrom = [1, 2]\n", "bad.toml:4:11", "unifrom")
        refused("log_uniform = [0, 2]\n", "bad.toml:4:15", "above 0")
        refused("uniform = [\"1 m\", \"2 mm\"]\n", "same unit")
        refused("uniform = [\"1 m\", \"2 m\"]\n", "bad.toml:3:7", "run 0", "brightness")
        refused("", "no rule")

    def test_random_values_lie_where_the_rules_say(self):
        self.write("rules.toml", "[[random]]\nkey = \"flames[0].brightness\"\nlog_uniform = [0.5, 2]\n")
        self.succeeds("sweep", "a.toml", "--random", "rules.toml", "--runs", "4", "-o", "set", *OPTIONS)
        values = [float(row["flames[0].brightness"]) for row in self.index("set")]
        self.assertEqual(len(set(values)), 4)
        self.assertTrue(all(0.5 <= value <= 2 for value in values), values)

    def test_parts_that_do_not_fit_and_other_sweeps(self):
        self.sweep("p", "--part", "1/2")
        self.fails(1, "merge", "p-part-1-of-2", "-o", "all", mentions="part 2 of 2 is missing")
        self.fails(1, "merge", "p-part-1-of-2", "p-part-1-of-2", "-o", "all", mentions="are both part 1/2")
        self.write("other.csv", TABLE.replace("0.5", "0.6"))
        self.sweep("q", "--part", "2/2", table="other.csv")
        self.fails(1, "merge", "p-part-1-of-2", "q-part-2-of-2", "-o", "all", mentions=["no part of the sweep", "table"])
        self.fails(1, "sweep", "a.toml", "--table", "other.csv", "-o", "p", "--part", "1/2", *OPTIONS, mentions="differs in table")
        self.assertNotIn("all", self.files())

    def test_no_room_for_a_run_leaves_those_that_are_done(self):
        self.sweep("set")
        os.remove(self.path("set/runs/000002.json"))
        self.fails(1, "sweep", "a.toml", "--table", "runs.csv", "-o", "set", *OPTIONS, largest_file=20000, mentions="000002")
        self.assertIn("000001.json", os.listdir(self.path("set/runs")))
        self.sweep("set")

    def test_no_room_for_the_packed_set_leaves_the_runs(self):
        self.sweep("set", "--format", "hdf5")
        whole = self.read("set/set.h5")
        shutil.rmtree(self.path("set"))
        # Each run's picture has room, all three together have not.
        self.fails(1, "sweep", "a.toml", "--table", "runs.csv", "-o", "set", *OPTIONS, "--format", "hdf5",
                   largest_file=len(whole) * 2 // 3, mentions="set.h5")
        self.assertEqual(sorted(n for n in os.listdir(self.path("set/runs")) if n.endswith(".json")),
                         [f"00000{k}.json" for k in range(3)])
        self.assertNotIn("set.h5", os.listdir(self.path("set")))
        self.sweep("set", "--format", "hdf5")
        self.assertEqual(self.read("set/set.h5"), whole)


if __name__ == "__main__":
    main()
