"""The examples in the package's docstrings do what they say."""

import doctest
import importlib
import inspect
import os
import pathlib
import unittest

from package import VTK, PackageTest, main

import plenoflame

MODULES = ["plenoflame"] + ["plenoflame." + path.stem for path in sorted(pathlib.Path(plenoflame.__file__).parent.glob("*.py"))
                            if not path.stem.startswith("_") and (VTK or path.stem != "vtk")]


class Finder(doctest.DocTestFinder):
    """Looks behind the check of keywords (_arguments.py)."""

    def _from_module(self, module, object):
        return super()._from_module(module, inspect.unwrap(object) if inspect.isfunction(object) else object)


class Docstrings(PackageTest):
    def test_examples(self):
        """In a folder with the scene small.toml, as the examples name it."""
        self.scene(60).save(self.folder / "small.toml")
        before = os.getcwd()
        os.chdir(self.folder)
        self.addCleanup(os.chdir, before)
        tried = 0
        for name in MODULES:
            suite = doctest.DocTestSuite(importlib.import_module(name), optionflags=doctest.ELLIPSIS,
                                         test_finder=Finder())
            result = unittest.TestResult()
            suite.run(result)
            self.assertEqual([text for _, text in result.errors + result.failures], [], name)
            tried += result.testsRun
        self.assertGreaterEqual(tried, 6, "examples in docstrings")


if __name__ == "__main__":
    main()
