"""Runs a script in pvpython under a virtual X server: run.py PVPYTHON XVFB_RUN SCRIPT. Without ParaView 5.11 and its Python
modules it does so in a minimal Debian (bare.sh), and ends with 77, which skips the test, where none can be made."""

import os
import pathlib
import subprocess
import sys

pvpython, xvfb_run, script = sys.argv[1:]
plugins = pathlib.Path(os.environ["PLENOFLAME_PLUGIN"]).parent
display = [xvfb_run, "-a", "-s", "-noreset -screen 0 1280x1024x24"]
found = ""
if pvpython and not (pvpython + xvfb_run).count("NOTFOUND"):
    found = subprocess.run([*display, pvpython, "-c", "import paraview.simple; print('version', paraview.__version__)"],
                           capture_output=True, text=True).stdout
os.environ["PVPYTHON"] = pvpython
here = "version 5.11." in found
command = [*display, plugins / "plenoflame-paraview", "--pvpython"] if here else [pathlib.Path(__file__).with_name("bare.sh"), plugins.parent]
done = subprocess.run([*command, script], capture_output=True, text=True)
print(done.stdout, done.stderr)
sys.exit(done.returncode if done.returncode or "all of it passed" in done.stdout else 1)
