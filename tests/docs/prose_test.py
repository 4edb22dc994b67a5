#!/usr/bin/env python3
"""Tests that tools/prose.py sees each kind of bad sentence and passes its plain version."""

import contextlib
import io
import pathlib
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "tools"))
import prose  # noqa: E402

LONG = "The renderer " + "reads the scene and " * 6 + "stops."
GLOSSARY = "# Glossary\n\n## Words to avoid\n\n| word | say instead |\n|---|---|\n| driver | hero wavelength |\n\n## Next\n\n| word | x |\n"


class Prose(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = pathlib.Path(folder.name)
        self.write("docs/developer/glossary.md", GLOSSARY)
        self.write("README.md", "")
        self.write("CONTRIBUTING.md", "")

    def write(self, path, text):
        (self.root / path).parent.mkdir(parents=True, exist_ok=True)
        (self.root / path).write_text(text)

    def found(self, text, path="docs/user/page.md"):
        """(line, rule) of all findings in a file of this text."""
        self.write(path, text)
        lines = []
        prose.count(self.root, lines.append)
        return [(int(line.split(":")[1]), line.split(": ")[1]) for line in lines if line.startswith(path)]

    def test_each_rule_sees_the_bad_sentence_only(self):
        for rule, bad, good in (
                ("long", LONG, "The renderer reads the scene. " * 9),
                ("opening", "Of the rays, some end.", "Some rays end."),
                ("opening", "What is empty has no part.", "What is empty?"),
                ("opening", "Fine. **Those** that end are lost.", "Rays of those that end are lost. Whereas others pass."),
                ("diary", "A shorter way was tried.", "The program tries a shorter way."),
                ("gets", "## What input gets", "## What it does"),
                ("glossary", "The driver decides.", "Its drivers and the hero wavelength decide."),
                ("passive", "Rays are drawn, which are then cut.", "The sampler draws rays, which are then cut.")):
            self.assertEqual(self.found(f"{bad}\n"), [(1, rule)], bad)
            self.assertEqual(self.found(f"{good}\n"), [], good)

    def test_code_tables_formulas_and_addresses_are_ignored(self):
        self.assertEqual(self.found(f"```sh\n{LONG}\n```\n\n| {LONG} |\n\n    {LONG}\n\n<!-- {LONG}\n{LONG} -->\n"), [])
        self.assertEqual(self.found(f"$$ {LONG} $$\n\n$$\n{LONG}\n$$\n\nThe flux is ${LONG}$ at most.\n"), [])
        words = "The renderer reads the file " + "`--option value with words` " * 9 + "from [here](https://a.b/c d)"
        self.assertEqual(self.found(f"{words} and stops.\n"), [])

    def test_items_paragraphs_and_headings_end_a_sentence(self):
        half = "the renderer reads the scene and then writes its picture to a file"
        self.assertEqual(self.found(f"# {half}\n{half}\n- {half}\n1. {half}\n\n{half}\n"), [])

    def test_lines_are_those_of_the_sentence(self):
        self.assertEqual(self.found("# Title\n\nIt reads. It\nwrites.\nOf these\nnone end. What ends\nis lost.\n"), [(5, "opening"), (6, "opening")])

    def test_comments(self):
        source = "int a;\n/// Tells this.\n/// @param x Of all.\nint b;  // What it is.\nauto c = \"https://Of a\";\n// Words\n// go on\n\n"
        self.assertEqual(self.found(source, "core/src/a.h"), [(4, "opening")])
        self.assertEqual(self.found("#!/usr/bin/env What\na = 1  # Of all.\n", "app/python/a.py"), [(2, "opening")])
        self.assertEqual(self.found(f"# {LONG}\n", "core/CMakeLists.txt"), [(1, "long")])

    def test_generated_pages_have_rows_of_their_own(self):
        self.assertEqual([prose.folder_of(path) for path in ("README.md", "docs/a.md", "docs/user/a.md", "docs/reference/a.md",
                                                            "docs/numerics.md", "docs/theory/reconstruction.md", "core/src/a.cpp")],
                         ["README, CONTRIBUTING", "docs", "docs/user", "docs/reference", "docs/numerics.md",
                          "docs/theory", "core (comments)"])

    def test_length_of_a_page_depends_on_its_kind(self):
        pages = {"docs/user/a.md": 901, "docs/user/b.md": 900, "docs/theory/a.md": 901, "docs/theory/b.md": 1501,
                 "docs/reconstruct.md": 901, "docs/validation.md": 5000, "README.md": 5000}
        self.assertEqual([line.split(":")[0] for line in prose.too_long(pages)], ["docs/user/a.md", "docs/theory/b.md"])
        self.write("docs/user/a.md", f"# Title\n{LONG}\n")
        self.assertEqual(prose.count(self.root, lambda line: None)[1]["docs/user/a.md"], 1 + len(LONG.split()))

    def test_counts_may_not_rise(self):
        counts = {"docs": {"words": 9, "long": 2, "opening": 0, "diary": 1, "gets": 0, "glossary": 0, "passive": 0}}
        for limits, fits, said in (((2, 0, 1, 0, 0, 0), True, ""), ((1, 0, 1, 0, 0, 0), False, "docs: long: 2, limit 1"),
                                   ((2, 0, 3, 0, 0, 0), True, "docs: diary: 1, limit 3: lower the limit")):
            output = io.StringIO()
            with contextlib.redirect_stdout(output):
                self.assertEqual(prose.check(counts, {"docs": limits}), fits)
            self.assertIn(said, output.getvalue())
            self.assertEqual(bool(output.getvalue()), bool(said))


if __name__ == "__main__":
    unittest.main()
