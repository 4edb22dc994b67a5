#!/usr/bin/env python3
"""Tests tools/site_source.py on a small documentation: what it changes for MkDocs, and what it finds wrong."""

import importlib.util
import pathlib
import shutil
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
specification = importlib.util.spec_from_file_location("site_source", ROOT / "tools/site_source.py")
site_source = importlib.util.module_from_spec(specification)
sys.dont_write_bytecode = True
specification.loader.exec_module(site_source)


class Site(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = pathlib.Path(folder.name).resolve() / "project"
        for name, text in {"README.md": "# P\n[a](docs/user/a.md#b)\n", "CHANGELOG.md": "# C\n",
                           "CONTRIBUTING.md": "# D\n", "docs/README.md": "# All\n\n## One\n- [A](user/a.md): a\n",
                           "docs/user/a.md": "# A\n", "docs/images/p.png": "", "examples/x.toml": "x"}.items():
            self.write(name, text)
        (self.root / "packaging/site").mkdir(parents=True)
        for name in ("mkdocs.yml", "site.css", "formulas.js"):
            shutil.copy(ROOT / "packaging/site" / name, self.root / "packaging/site")
        self.out = self.root.parent / "out"

    def write(self, name, text):
        path = self.root / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)

    def page(self, text):
        self.write("docs/user/a.md", text)
        site_source.prepare(self.root, self.out)
        return (self.out / "source/user/a.md").read_text()

    def test_lists_and_tables_follow_an_empty_line(self):
        self.assertEqual(self.page("text\n- a\n  more\n- b\n  - c\n"), "text\n\n- a\n  more\n- b\n    - c\n")
        self.assertEqual(self.page("text\n| a |\n|---|\n| b |\n"), "text\n\n| a |\n|---|\n| b |\n")

    def test_code_stays_as_it_is(self):
        page = "```sh\ntext\n- [a](nowhere)\n```\n"
        self.assertEqual(self.page(page), page)

    def test_links(self):
        self.assertEqual(self.page("[x](../../examples/x.toml)\n"), "[x](../files/examples/x.toml)\n")
        self.assertEqual((self.out / "source/files/examples/x.toml").read_text(), "x")
        self.assertEqual(self.page("![p\nq](../images/p.png)\n"), "[![p\nq](../images/p.png)](../images/p.png)\n")
        self.assertEqual(self.page('<img src="../images/p.png" width="9" alt="q">\n'), "[![q](../images/p.png)](../images/p.png)\n")
        self.assertEqual((self.out / "source/overview.md").read_text(), "# P\n[a](user/a.md#b)\n")

    def test_navigation(self):
        self.write("docs/README.md", "# All\n## Ways\n1. [First](user/a.md): a\n## One\n- [A](user/a.md): a\n")
        self.assertEqual(site_source.listed(self.root, 2, numbered=False), [("One", [("A", "user/a.md")])])

    def test_ways(self):
        self.write("docs/b.md", "# B\n")
        self.write("docs/README.md", "# All\n## Ways\n### X\n1. [Aa](user/a.md): a\n2. [Bb](b.md): b\n\n### Y\n1. [Bb](b.md): b\n"
                   "## One\n- [A](user/a.md)\n- [B](b.md)\n")
        self.assertEqual(self.page("# A\n"),
                         "# A\n\n**X**, 1 of 2. Previous: [All ways](../index.md). Next: [Bb](../b.md).\n{: .way }\n")
        self.assertEqual((self.out / "source/b.md").read_text().count("{: .way }"), 2)
        self.assertNotIn(".way", (self.out / "source/index.md").read_text())

    def test_formulas(self):
        page = "The flux $P_1 * r$ is\n\n$$ P=\\sum_i w_i * r_i $$\n"
        self.assertEqual(self.page(page), page)
        self.assertIn("renderMathInElement", (self.out / "source/formulas.js").read_text())
        self.assertIn("formulas.js", (self.out / "mkdocs.yml").read_text())

    def test_what_is_not_there(self):
        for text in ("[a](b.md)", "[a](../../../outside.md)"):
            with self.assertRaisesRegex(SystemExit, "leads to no file"):
                self.page(text)
        self.write("docs/user/b.md", "# B\n")
        with self.assertRaisesRegex(SystemExit, r"docs/README.md does not list docs/user/b.md"):
            self.page("# A\n")

    def test_check(self):
        site = self.root.parent / "site"
        (site / "user").mkdir(parents=True)
        (site / "index.html").write_text('<a href="user/a.html#here">a</a><img src="https://b.org/c.png">')
        (site / "user/a.html").write_text('<h2 id="here">A</h2><a href="..">up</a>')
        self.assertEqual(list(site_source.check(site)), [])
        (site / "user/a.html").write_text('<h2 id="there">A</h2><img src="p.png">')
        self.assertEqual(list(site_source.check(site)), [
            "index.html: user/a.html#here: the page has no such place", "user/a.html: p.png: there is no such file"])


if __name__ == "__main__":
    unittest.main()
