"""What the scripts that draw docs/images share: the built command and Python package, and matplotlib without a window.

PLENOFLAME names the command (build/release/app/cli/plenoflame). Packages: tools/setup.sh python dev
"""

import os
import pathlib
import shutil
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[1]
COMMAND = pathlib.Path(os.environ.get("PLENOFLAME", ROOT / "build/release/app/cli/plenoflame")).resolve()
PACKAGES = COMMAND.parents[2] / "lib/python3/dist-packages"
sys.path.insert(0, str(PACKAGES))

try:
    import matplotlib
    import numpy  # noqa: F401
    import plenoflame  # noqa: F401
    import scipy  # noqa: F401
    from PIL import Image
except ImportError as missing:
    sys.exit(f"{pathlib.Path(sys.argv[0]).name}: {missing}: tools/setup.sh python dev, and cmake --build build/release")
matplotlib.use("Agg")


def working_folder(name):
    """Where a script keeps what it computes: its first argument, or out/NAME."""
    path = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ROOT / "out" / name).resolve()
    path.mkdir(parents=True, exist_ok=True)
    return path


def run(*arguments, where=None):
    """Runs the command in the folder `where`, in silence."""
    subprocess.run([str(COMMAND), *map(str, arguments)], cwd=where, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def make(where, steps):
    """Runs the commands {file: arguments} whose files are not in the folder `where` yet."""
    for file, arguments in steps.items():
        if not (where / file).exists():
            run(*arguments.split(), where=where)


def candle_case(name, scene, steps):
    """The folder of this name with examples/SCENE.toml, its candle, and the files of the commands (see make)."""
    folder = working_folder(name)
    (folder / "examples").mkdir(exist_ok=True)
    shutil.copy(ROOT / f"examples/{scene}.toml", folder / "examples")
    make(folder, {"examples/candle.vdb": "flame candle -o examples/candle.vdb"} | steps)
    return folder


def turbulent_flame(where, voxel_size=1):
    """The path of the turbulent flame with voxels of this size [mm], written to this folder unless it is there."""
    where.mkdir(parents=True, exist_ok=True)
    if not (where / "turbulent.vdb").exists():
        subprocess.run(["/usr/bin/python3", ROOT / "examples/python/turbulent_flame.py", str(voxel_size), where], check=True,
                       env={**os.environ, "PYTHONPATH": str(PACKAGES)}, stdout=subprocess.DEVNULL)
    return where / "turbulent.vdb"


def save(figure, name, dpi):
    """Writes docs/images/NAME without the alpha channel of matplotlib, and with fewer colours where it is large."""
    target = ROOT / "docs/images" / name
    figure.savefig(target, dpi=dpi)
    picture = Image.open(target).convert("RGB")
    picture.save(target, optimize=True)
    if target.stat().st_size > 4e5:
        picture.quantize(255).save(target, optimize=True)
    print(target)
