"""Draws the picture of docs/user/paraview.md in ParaView 5.11: the state of the plugin, at twice the size of the page.

    PICTURE=$PWD/build/release/paraview.png tests/paraview/bare.sh build/release tools/draw_paraview.py
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
