#!/usr/bin/env python3
"""Tests run_blocks.py on small pages, with a stand-in for the command that prints its arguments."""

import pathlib
import tempfile
import unittest

import run_blocks

PAGE = pathlib.Path("page.md")


class Blocks(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = pathlib.Path(folder.name)
        (self.root / "examples").mkdir()
        (self.root / "examples" / "a.toml").write_text("a")
        self.log = self.root / "log"
        self.command = self.root / "command"
        self.command.write_text(f'#!/bin/sh\necho "$@" >>"{self.log}"\n[ "$1" != broken ]\n')
        self.command.chmod(0o755)

    def run_page(self, text):
        failures = run_blocks.run(run_blocks.blocks(PAGE, text), self.command, self.root)
        return failures, self.log.read_text().splitlines() if self.log.exists() else []

    def test_only_marked_blocks_run(self):
        page = "```sh\nplenoflame one\n```\n<!-- run -->\n```sh\nplenoflame two\n```\n"
        self.assertEqual(self.run_page(page), ([], ["two"]))

    def test_options_are_set(self):
        page = ("<!-- run: render --samples 2 --window 0,0,8,8; flame --voxel 2mm -->\n```sh\n"
                "plenoflame render examples/a.toml --samples 64 -o a.exr\n"
                "plenoflame render examples/a.toml --samples=64\nplenoflame flame candle\n"
                "plenoflame info a.exr\n```\n")
        self.assertEqual(self.run_page(page), ([], [
            "render examples/a.toml -o a.exr --samples 2 --window 0,0,8,8",
            "render examples/a.toml --samples 2 --window 0,0,8,8",
            "flame candle --voxel 2mm", "info a.exr"]))

    def test_shared_folder_and_output_lines(self):
        page = ("<!-- run -->\n```sh\ntest -f examples/a.toml\necho x > made\n```\n"
                "<!-- run -->\n```sh\n$ test -f made\nnot a command\n$ plenoflame info\n```\n")
        self.assertEqual(self.run_page(page), ([], ["info"]))

    def test_failures_are_seen(self):
        for body in ("plenoflame broken", "false\ntrue", "false | cat", "test -f nowhere", "echo $unset"):
            failures, _ = self.run_page(f"text\n<!-- run -->\n```sh\n{body}\n```\n")
            self.assertEqual(len(failures), 1, body)
            self.assertIn("page.md:4: status", failures[0])

    def test_marks_must_fit(self):
        for page in ("<!-- run -->\n", "<!-- run -->\ntext\n```sh\nx\n```\n", "<!-- run -->\n```sh\nx\n",
                     "<!-- run: render 3 -->\n```sh\nx\n```\n"):
            with self.assertRaises(ValueError):
                run_blocks.blocks(PAGE, page)

    def test_time_limit(self):
        limit, run_blocks.TIME_LIMIT = run_blocks.TIME_LIMIT, 0.2
        try:
            failures, _ = self.run_page("<!-- run -->\n```sh\nsleep 5\n```\n")
        finally:
            run_blocks.TIME_LIMIT = limit
        self.assertEqual(len(failures), 1)

    def test_links(self):
        good = "[a](examples/a.toml#b) [b](https://example.org/x) `[c](d)` [e](#f)\n```\n[g](h)\n```\n"
        self.assertEqual(list(run_blocks.broken_links(PAGE, good, self.root)), [])
        bad = "text\n![picture](docs/images/none.png)\n"
        self.assertEqual(list(run_blocks.broken_links(PAGE, bad, self.root)),
                         ["page.md:2: no such file: docs/images/none.png"])


if __name__ == "__main__":
    unittest.main()
