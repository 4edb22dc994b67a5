"""Every notebook in examples/notebooks runs from the first cell to the last, and holds small pictures of such a run."""

import importlib.util
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import unittest

from package import COMMAND, ROOT, PackageTest, main

import plenoflame

FOLDER = ROOT / "examples" / "notebooks"
MISSING = [name for name in ("nbconvert", "ipykernel", "xarray", "matplotlib") if importlib.util.find_spec(name) is None]


class Notebooks(PackageTest):
    def test_names(self):
        self.assertEqual(sorted(path.stem for path in FOLDER.glob("*.ipynb")), ["first-picture", "raw-pictures"])

    def test_outputs_are_those_of_one_run_and_small(self):
        for path in FOLDER.glob("*.ipynb"):
            cells = [cell for cell in json.loads(path.read_text())["cells"] if cell["cell_type"] == "code"]
            self.assertEqual([cell["execution_count"] for cell in cells], list(range(1, len(cells) + 1)), path)
            outputs = [output for cell in cells for output in cell["outputs"]]
            self.assertEqual([output for output in outputs if output["output_type"] == "error"], [])
            pictures = [data["image/png"] for data in (output.get("data", {}) for output in outputs) if "image/png" in data]
            self.assertGreater(len(pictures), 1)
            self.assertLess(max(map(len, pictures)), 200000)
            self.assertLess(path.stat().st_size, 400000)

    def run_notebook(self, name):
        """As Jupyter would, in a copy of its folder; returns what it prints."""
        shutil.copytree(ROOT / "examples", self.folder / "examples", ignore=shutil.ignore_patterns("*.vdb"))
        tools = self.folder / "tools"
        tools.mkdir()
        (tools / "plenoflame").symlink_to(COMMAND)
        environment = {**os.environ, "PATH": f"{tools}:{os.environ['PATH']}", "HOME": str(self.folder), "TMPDIR": str(self.folder),
                       "PYTHONPATH": str(pathlib.Path(plenoflame.__file__).parents[1]), "PYDEVD_DISABLE_FILE_VALIDATION": "1"}
        run = subprocess.run([sys.executable, "-m", "nbconvert", "--to", "notebook", "--execute", "--stdout", f"{name}.ipynb"],
                             capture_output=True, text=True, env=environment, cwd=self.folder / "examples" / "notebooks")
        self.assertEqual(run.returncode, 0, run.stderr[-2000:])
        return "".join("".join(output["text"]) for cell in json.loads(run.stdout)["cells"] for output in cell.get("outputs", [])
                       if output.get("name") == "stdout")

    @unittest.skipIf(MISSING, f"not installed: {', '.join(MISSING)}")
    def test_first_picture(self):
        printed = self.run_notebook("first-picture")
        self.assertRegex(printed, r"\(180, 100\) 2\.\d+e-06 W")
        self.assertLess(float(re.search(r"(\d+) K RMS", printed)[1]), 100)

    @unittest.skipIf(MISSING, f"not installed: {', '.join(MISSING)}")
    def test_raw_pictures(self):
        """The measured flux is that of the flame within twice the scale's error."""
        words = self.run_notebook("raw-pictures").split()
        measured, truth = (float(words[words.index(name) + 1]) for name in ("measured", "truth"))
        self.assertLess(abs(measured / truth - 1), 2 * 0.016)


if __name__ == "__main__":
    main()
