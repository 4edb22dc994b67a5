"""Runs a script in pvpython under a virtual X server: run.py PVPYTHON XVFB_RUN SCRIPT. Ends with 77, which skips the test,
where ParaView 5.11 with its Python modules is not installed."""

import os
import pathlib
import subprocess
import sys


def skip(why):
    print(f"skipped: {why}. Debian: apt-get install --no-install-recommends paraview, and its package python3-paraview, which "
          "cannot be installed beside python3-vtk9; PLENOFLAME_PVPYTHON names another pvpython.")
    sys.exit(77)


pvpython, xvfb_run, script = sys.argv[1:]
if pvpython.endswith("NOTFOUND") or not pvpython:
    skip("there is no pvpython")
if xvfb_run.endswith("NOTFOUND"):
    skip("there is no xvfb-run (tools/setup.sh vtk)")
display = [xvfb_run, "-a", "-s", "-noreset -screen 0 1280x1024x24"]
starter = pathlib.Path(os.environ["PLENOFLAME_PLUGIN"]).parent / "plenoflame-paraview"
os.environ["PVPYTHON"] = pvpython
probe = subprocess.run([*display, pvpython, "-c", "import paraview.simple; print('version', paraview.__version__)"],
                       capture_output=True, text=True)
if "version 5.11." not in probe.stdout:
    skip(f"{pvpython} is not ParaView 5.11 with its Python modules: {(probe.stdout + probe.stderr).strip()[-300:]}")
done = subprocess.run([*display, str(starter), "--pvpython", script], capture_output=True, text=True)
print(done.stdout, done.stderr)
sys.exit(done.returncode if done.returncode or "all of it passed" in done.stdout else 1)
