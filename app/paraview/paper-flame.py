"""State of ParaView: the paper's flame, its camera, and the rays of two pixels. File > Load State, or pvpython paper-flame.py.

PLENOFLAME_EXAMPLES names the folder of the example scenes where they are not in their usual places."""

import inspect
import os
import pathlib

from paraview.simple import (ColorBy, GetActiveViewOrCreate, GetColorTransferFunction, LoadPlugin, OutputPort, Render,
                             ResetCamera, Show)

try:
    here = pathlib.Path(__file__).resolve().parent
except NameError:  # the window runs the text of the file
    here = pathlib.Path("/usr/lib/x86_64-linux-gnu/plenoflame/paraview")
places = [os.environ.get("PLENOFLAME_EXAMPLES"), here.parent.parent.parent / "examples",
          "/usr/share/plenoflame/examples"]
scenes = [pathlib.Path(place) / "paper-flame-1m.toml" for place in places if place]
scene = next((path for path in scenes if path.exists()), None)
if scene is None:
    raise RuntimeError("paper-flame-1m.toml is not there: install the package plenoflame, or say in PLENOFLAME_EXAMPLES where it is")

if not hasattr(inspect, "getargspec"):  # Debian's ParaView 5.11.0 needs it to load plugins in Python (start/sitecustomize.py)
    inspect.getargspec = inspect.getfullargspec
LoadPlugin(str(here / "Plenoflame.py"), remote=False, ns=globals())
view = GetActiveViewOrCreate("RenderView")

paper = PlenoflameScene(registrationName="paper's flame", FileName=str(scene))
camera, flame = OutputPort(paper, 0), OutputPort(paper, 1)
shown = Show(camera, view)
shown.ColorArrayName = [None, ""]
shown.Opacity = 0.5
volume = Show(flame, view)
volume.SetRepresentationType("Volume")
ColorBy(volume, ("POINTS", "temperature"))
GetColorTransferFunction("temperature").ApplyPreset("Black-Body Radiation", True)
for name, pixel, colour in (("rays of a pixel", (1500, 1500), (0.9, 0.62, 0.0)),
                            ("rays of a lower pixel", (1500, 2100), (0.34, 0.71, 0.91))):
    rays = PlenoflameRays(registrationName=name, SceneFile=str(scene), Pixel=pixel, Rays=32)
    lines = Show(rays, view)
    lines.ColorArrayName = [None, ""]
    lines.DiffuseColor = lines.AmbientColor = colour
view.Background = (0.1, 0.1, 0.12)
view.UseColorPaletteForBackground = 0
view.CameraPosition, view.CameraFocalPoint, view.CameraViewUp = (0.45, -1.6, 0.5), (0.45, 0, 0), (0, 0, 1)
ResetCamera(view)
width, height = view.ViewSize
view.CameraViewAngle = 30 / min(max(width / height, 1), 2.3)  # the scene is long: wide views come nearer
Render(view)
