"""Draws the picture of docs/user/paraview.md in ParaView 5.11: the state of the plugin, at twice the size of the page.

    PICTURE=paraview.png xvfb-run -a -s "-screen 0 1920x1080x24" FOLDER/plenoflame-paraview --pvpython tools/draw_paraview.py

FOLDER is build/release/paraview. tools/make_pictures.sh does this, and tests/bare/run.sh --all in a system of its own: Debian's ParaView
excludes the VTK of the build.
"""

import os
import pathlib
import runpy

from paraview import simple

ROOT = pathlib.Path(__file__).resolve().parents[1]
SIZE = (1800, 800)

view = simple.CreateView("RenderView")
view.ViewSize = SIZE
os.environ.setdefault("PLENOFLAME_EXAMPLES", str(ROOT / "examples"))
plugins = pathlib.Path(os.environ["PV_PLUGIN_CONFIG_FILE"]).parent  # plenoflame-paraview sets it
state = runpy.run_path(str(plugins / "paper-flame.py"))  # kept: it holds what is drawn
simple.SaveScreenshot(os.environ["PICTURE"], view, ImageResolution=SIZE)
