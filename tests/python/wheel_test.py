"""The wheel that `pip install .` makes of the source tree: installed alone into an empty folder, it renders. CMake's part
stands already in the build tree, so it is not done again here."""

import email
import importlib.util
import os
import pathlib
import shlex
import subprocess
import sys
import tarfile
import tomllib
import zipfile

import numpy
from package import ROOT, PackageTest, main

import plenoflame

PROGRAM = """
import sys
sys.modules["vtkmodules"] = None
sys.path.insert(0, sys.argv[1])
import importlib.metadata, numpy, plenoflame
assert importlib.metadata.version("plenoflame") == plenoflame.__version__
assert plenoflame.__file__.startswith(sys.argv[1]), plenoflame.__file__
numpy.save(sys.argv[3], plenoflame.Scene(sys.argv[2]).render(samples=2).flux)
"""


class Wheel(PackageTest):
    def setUp(self):
        super().setUp()
        specification = importlib.util.spec_from_file_location("python_wheel", ROOT / "packaging/wheel/python_wheel.py")
        self.backend = importlib.util.module_from_spec(specification)
        specification.loader.exec_module(self.backend)

    def test_the_wheel_works_alone(self):
        self.backend._build = lambda _folder: pathlib.Path(plenoflame.__file__).parent
        wheel = self.folder / self.backend.build_wheel(self.folder)
        names = zipfile.ZipFile(wheel).namelist()
        self.assertIn("plenoflame/scene.pyi", names)
        self.assertEqual([name for name in names if "vtkPlenoflame" in name or "__pycache__" in name], [])
        site = self.folder / "site"
        made = subprocess.run([sys.executable, "-m", "pip", "install", "--no-deps", "--no-index", "--disable-pip-version-check",
                               "--target", str(site), str(wheel)], capture_output=True, text=True)
        self.assertEqual(made.returncode, 0, made.stderr)
        self.scene(60).save(self.folder / "a.toml")
        environment = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
        # No display, no home, another language: it is all the same.
        environment.update(HOME="/nonexistent", LANG="de_DE.UTF-8", LC_ALL="C")
        environment.pop("DISPLAY", None)
        run = subprocess.run([sys.executable, "-c", PROGRAM, str(site), str(self.folder / "a.toml"), str(self.folder / "a.npy")],
                             capture_output=True, text=True, env=environment, cwd="/")
        self.assertEqual(run.returncode, 0, run.stderr)
        numpy.testing.assert_array_equal(numpy.load(self.folder / "a.npy"), self.scene(60).render(samples=2).flux)

    def test_the_page_s_commands_work_without_a_network(self):
        """As docs/scripting.md has them, where CMake has nothing to do but to hand over what it built before."""
        block = (ROOT / "docs/scripting.md").read_text().split("## Without VTK")[1].split("```sh\n")[1].split("```")[0]
        tree = self.folder / "tree"
        tree.mkdir()
        for name in ("packaging", "pyproject.toml", "CMakeLists.txt", "README.md", "LICENSE", "examples"):
            (tree / name).symlink_to(ROOT / name)
        tools = self.folder / "tools"
        tools.mkdir()
        built = pathlib.Path(plenoflame.__file__).parent
        (tools / "cmake").write_text(f'#!/bin/sh\n[ "$1" = --build ] || exit 0\nmkdir -p "$2/lib/python3/dist-packages"\n'
                                     f'cp -r {shlex.quote(str(built))} "$2/lib/python3/dist-packages/plenoflame"\n')
        (tools / "cmake").chmod(0o755)
        environment = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
        environment.update(HOME=str(self.folder), PATH=f"{tools}:{os.environ['PATH']}", PIP_NO_INDEX="1",
                           PIP_DISABLE_PIP_VERSION_CHECK="1")
        run = subprocess.run(["bash", "-ec", block], capture_output=True, text=True, env=environment, cwd=tree)
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertIn("<plenoflame.Scene, 1000 x 1000 pixels", run.stdout)

    def test_the_metadata_are_those_of_the_project(self):
        project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
        said = email.message_from_string(self.backend.metadata())
        self.assertEqual((said["Name"], said["Summary"], said["Requires-Python"]),
                         (project["name"], project["description"], project["requires-python"]))
        self.assertEqual(said["Author"], project["authors"][0]["name"])
        self.assertEqual(said["License"], project["license"]["text"])
        self.assertEqual(said["Keywords"].split(","), project["keywords"])
        self.assertEqual(said.get_all("Classifier"), project["classifiers"])
        extras = [f'{name}; extra == "{extra}"' for extra, names in project["optional-dependencies"].items() for name in names]
        self.assertEqual(said.get_all("Requires-Dist"), project["dependencies"] + extras)
        self.assertEqual(said.get_all("Provides-Extra"), list(project["optional-dependencies"]))
        self.assertEqual(said.get_payload(), (ROOT / "README.md").read_text())
        self.assertIn("Apache License", self.backend._information()["LICENSE"])
        self.assertEqual(said.get_all("Project-URL"), [f"{name}, {url}" for name, url in project["urls"].items()])

    def test_the_source_archive_builds(self):
        """It holds what the backend needs, and nothing that was built."""
        name = self.backend.build_sdist(self.folder)
        with tarfile.open(self.folder / name) as archive:
            names = set(archive.getnames())
        stem = name[:-len(".tar.gz")]
        for wanted in ("pyproject.toml", "CMakeLists.txt", "packaging/wheel/python_wheel.py", "app/python/module.cpp", "PKG-INFO"):
            self.assertIn(f"{stem}/{wanted}", names)
        self.assertEqual([path for path in names if path.startswith((f"{stem}/build/", f"{stem}/.git/"))], [])


if __name__ == "__main__":
    main()
