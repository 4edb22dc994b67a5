"""Base of the tests of the Python package: a folder of its own, and a small scene."""

import importlib.util
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

if os.environ.get("PLENOFLAME_ALONE"):
    sys.modules["vtkmodules"] = None  # as on a machine without VTK

import plenoflame

VTK = "PLENOFLAME_ALONE" not in os.environ and importlib.util.find_spec("plenoflame.vtkPlenoflame") is not None
needs_vtk = unittest.skipUnless(VTK, "the package was built without VTK")

ROOT = pathlib.Path(os.environ["PLENOFLAME_ROOT"])
COMMAND = os.environ["PLENOFLAME_COMMAND"]
EXAMPLE = ROOT / "examples" / "lenslets-30.toml"


class PackageTest(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory(prefix="plenoflame-python-")
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name)

    def scene(self, pixels=80):
        """The middle of the example, as a sensor of its own."""
        scene = plenoflame.Scene(EXAMPLE)
        scene["camera.sensor.columns"] = pixels
        scene["camera.sensor.rows"] = pixels
        return scene

    def command(self, *arguments, status=0):
        """Runs the command line, which shares no Python with the package. Returns its standard output, or what it
        prints on standard error when it is to fail."""
        result = subprocess.run([COMMAND, *map(str, arguments)], capture_output=True, text=True, cwd=self.folder)
        self.assertEqual(result.returncode, status, result.stderr)
        return result.stdout if status == 0 else result.stderr

    def figures(self, *arguments):
        return json.loads(self.command(*arguments, "--json"))


main = unittest.main
