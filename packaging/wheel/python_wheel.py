"""Builds wheels of the Python package with CMake: what pip calls (PEP 517). It needs nothing that Debian does not have: CMake,
Ninja, pybind11, and the libraries of core and volumes (tools/setup.sh wheel)."""

import base64
import hashlib
import os
import pathlib
import re
import shutil
import subprocess
import sys
import sysconfig
import tarfile
import tempfile
import zipfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
SETTINGS = ["-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release", "-DBUILD_TESTING=OFF", "-DPLENOFLAME_WITH_PYTHON=ON",
            "-DPLENOFLAME_COMPILE_TOGETHER=ON",  # a third of the time
            "-DPLENOFLAME_WITH_CLI=OFF", "-DPLENOFLAME_WITH_VTK=OFF", "-DPLENOFLAME_WITH_DESKTOP=OFF", "-DCMAKE_INSTALL_LIBDIR=lib"]
LEFT_OUT = {"build", ".git", "__pycache__"}


def version():
    """The project's, which stands in CMakeLists.txt alone."""
    return re.search(r"^project\(plenoflame VERSION ([0-9.]+)", (ROOT / "CMakeLists.txt").read_text(), re.MULTILINE)[1]


def tag():
    python = f"cp{sys.version_info.major}{sys.version_info.minor}"
    return f"{python}-{python}-{re.sub('[-.]', '_', sysconfig.get_platform())}"


CLASSIFIERS = ["Intended Audience :: Science/Research", "Operating System :: POSIX :: Linux",
               "Programming Language :: Python :: 3", "Topic :: Scientific/Engineering :: Physics", "Typing :: Typed"]
EXTRAS = {"operators": ["scipy"], "notebooks": ["tqdm", "xarray"]}


def metadata():
    classifiers = "".join(f"Classifier: {name}\n" for name in CLASSIFIERS)
    extras = "".join(f"Provides-Extra: {extra}\n" + "".join(f'Requires-Dist: {name}; extra == "{extra}"\n' for name in names)
                     for extra, names in EXTRAS.items())
    return ("Metadata-Version: 2.1\nName: plenoflame\n"
            f"Version: {version()}\nSummary: What a light-field camera sees of a flame\n"
            "Author: The Plenoflame developers\nLicense: Apache-2.0\nProject-URL: Homepage, https://plenoflame.invalid/\n"
            "Keywords: light field,plenoptic camera,flame,pyrometry,tomography\n"
            f"{classifiers}Requires-Python: >=3.9\nRequires-Dist: numpy\n{extras}"
            f"Description-Content-Type: text/markdown\n\n{(ROOT / 'README.md').read_text()}")


def _run(*command):
    try:
        subprocess.run([str(part) for part in command], check=True)
    except FileNotFoundError:
        raise SystemExit(f"building plenoflame needs {command[0]}: tools/setup.sh wheel") from None
    except subprocess.CalledProcessError:
        raise SystemExit("building plenoflame failed; CMake says above what is missing "
                         "(tools/setup.sh wheel installs all of it on Debian)") from None


def _build(folder):
    """Builds the package into a folder. PLENOFLAME_BUILD names one that is kept, so that the next build is quick."""
    build = pathlib.Path(os.environ.get("PLENOFLAME_BUILD") or folder / "build")
    _run("cmake", "-S", ROOT, "-B", build, *SETTINGS, f"-DPython3_EXECUTABLE={sys.executable}")
    _run("cmake", "--build", build, "--target", "plenoflame_python")
    return build / "lib" / "python3" / "dist-packages" / "plenoflame"


def _record(name, content):
    digest = base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=").decode()
    return f"{name},sha256={digest},{len(content)}\n"


def _information():
    """The files of the wheel's .dist-info folder, but for its RECORD."""
    return {"METADATA": metadata(), "LICENSE": (ROOT / "LICENSE").read_text(),
            "WHEEL": f"Wheel-Version: 1.0\nGenerator: plenoflame\nRoot-Is-Purelib: false\nTag: {tag()}\n"}


def prepare_metadata_for_build_wheel(metadata_directory, config_settings=None):
    """Returns the folder's name. Without it pip builds everything to read the version."""
    folder = f"plenoflame-{version()}.dist-info"
    (pathlib.Path(metadata_directory) / folder).mkdir()
    for name, text in _information().items():
        (pathlib.Path(metadata_directory) / folder / name).write_text(text)
    return folder


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    """Returns the wheel's file name. The scenes of examples/ are not part of it."""
    name = f"plenoflame-{version()}-{tag()}.whl"
    information = f"plenoflame-{version()}.dist-info"
    with tempfile.TemporaryDirectory(prefix="plenoflame-wheel-") as temporary:
        package = _build(pathlib.Path(temporary))
        contents = {f"plenoflame/{path.name}": path.read_bytes() for path in sorted(package.iterdir())
                    if path.is_file() and not path.name.startswith("vtkPlenoflame")}  # of an earlier build with VTK
    contents.update({f"{information}/{file}": text.encode() for file, text in _information().items()})
    record = f"{information}/RECORD"
    contents[record] = ("".join(_record(*item) for item in contents.items()) + f"{record},,\n").encode()
    with zipfile.ZipFile(pathlib.Path(wheel_directory) / name, "w", zipfile.ZIP_DEFLATED) as wheel:
        for path, content in contents.items():
            wheel.writestr(path, content)
    return name


def build_sdist(sdist_directory, config_settings=None):
    """Returns the archive's file name: the source tree without what was built."""
    stem = f"plenoflame-{version()}"
    with tempfile.TemporaryDirectory(prefix="plenoflame-sdist-") as temporary:
        copy = pathlib.Path(temporary) / stem
        shutil.copytree(ROOT, copy, ignore=lambda _folder, names: LEFT_OUT & set(names))
        (copy / "PKG-INFO").write_text(metadata())
        with tarfile.open(pathlib.Path(sdist_directory) / f"{stem}.tar.gz", "w:gz") as archive:
            archive.add(copy, stem)
    return f"{stem}.tar.gz"
