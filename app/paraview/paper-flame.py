"""State of ParaView: the paper's flame, its camera, and the rays of three pixels, with shortened distances. File > Load State, or
pvpython paper-flame.py.

PLENOFLAME_EXAMPLES names the folder of the example scenes where they are not in their usual places."""

import inspect
import os
import pathlib

from paraview.simple import (Calculator, ColorBy, GetActiveViewOrCreate, GetColorTransferFunction, GetOpacityTransferFunction,
                             GetScalarBar, LoadPlugin, OutputPort, Render, Show, Text, Tube)

try:
    here = pathlib.Path(__file__).resolve().parent
except NameError:  # the window runs the text of the file
    here = pathlib.Path("/usr/lib/x86_64-linux-gnu/plenoflame/paraview")
places = [os.environ.get("PLENOFLAME_EXAMPLES"), here.parent.parent.parent / "examples",
          "/usr/share/plenoflame/examples"]
scenes = [pathlib.Path(place) / "lenslets-30.toml" for place in places if place]
scene = next((path for path in scenes if path.exists()), None)
if scene is None:
    raise RuntimeError("lenslets-30.toml is not there: install the package plenoflame, or say in PLENOFLAME_EXAMPLES where it is")

if not hasattr(inspect, "getargspec"):  # Debian's ParaView 5.11.0 needs it to load plugins in Python (start/sitecustomize.py)
    inspect.getargspec = inspect.getfullargspec
LoadPlugin(str(here / "Plenoflame.py"), remote=False, ns=globals())
view = GetActiveViewOrCreate("RenderView")

# The optical axis is x. Empty stretches before and behind the lens are drawn shorter by these lengths [m].
SENSOR, FLAME = 0.34, 0.885
SHORTER = f"(coordsX + if(coordsX < -0.2, {SENSOR}, 0) - if(coordsX > 0.5, {FLAME}, 0))*iHat + coordsY*jHat + coordsZ*kHat"


def shortened(source):
    made = Calculator(Input=source)
    made.CoordinateResults, made.Function = 1, SHORTER
    return made


paper = PlenoflameScene(registrationName="paper's flame", FileName=str(scene), FlameResolution=160)
camera = Show(shortened(OutputPort(paper, 0)), view)
camera.ColorArrayName = [None, ""]
camera.DiffuseColor = camera.AmbientColor = (0.62, 0.80, 0.95)
camera.Opacity, camera.Specular, camera.Ambient = 0.35, 0.8, 0.2
volume = Show(OutputPort(paper, 1), view)
volume.SetRepresentationType("Volume")
volume.Position = (-FLAME, 0, 0)
ColorBy(volume, ("POINTS", "temperature"))
colours, opacity = GetColorTransferFunction("temperature"), GetOpacityTransferFunction("temperature")
colours.ApplyPreset("Inferno (matplotlib)", True)
colours.RescaleTransferFunction(1000, 2000)
opacity.Points = [1000, 0, 0.5, 0, 1150, 0.9, 0.5, 0, 1500, 0.45, 0.5, 0, 2000, 0.2, 0.5, 0]
volume.ScalarOpacityUnitDistance = 0.005
for name, pixel, colour in (("rays of a pixel", (150, 70), (0.34, 0.71, 0.91)), ("rays of a pixel in the middle", (150, 150), (0.94, 0.63, 0.10)),
                            ("rays of a lower pixel", (150, 230), (0.10, 0.72, 0.50))):
    rays = PlenoflameRays(registrationName=name, SceneFile=str(scene), Pixel=pixel, Rays=24)
    lines = Show(Tube(Input=shortened(rays), Radius=0.0003), view)
    lines.ColorArrayName = [None, ""]
    lines.DiffuseColor = lines.AmbientColor = colour
words = Show(Text(Text="distances shortened: the sensor is 449 mm behind the lens, the flame 1 m before it"), view)
words.WindowLocation, words.FontSize = "Lower Left Corner", 20
bar = GetScalarBar(colours, view)
bar.Title, bar.ComponentTitle = "temperature [K]", ""
bar.Visibility, bar.Orientation, bar.ScalarBarLength = 1, "Vertical", 0.4
bar.WindowLocation, bar.Position = "Any Location", (0.92, 0.08)
bar.RangeLabelFormat, bar.AddRangeLabels, bar.LabelFontSize, bar.TitleFontSize = "%.0f", 0, 20, 20
typeface = pathlib.Path("/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf")  # of the other pictures
if typeface.exists():
    words.FontFamily = bar.LabelFontFamily = bar.TitleFontFamily = "File"
    words.FontFile = bar.LabelFontFile = bar.TitleFontFile = str(typeface)
view.Background = (0.05, 0.05, 0.06)
view.UseColorPaletteForBackground = 0
view.OrientationAxesVisibility = 0
Render(view)  # the first picture chooses a camera
view.CameraPosition, view.CameraFocalPoint, view.CameraViewUp = (0.32, -1, 0.30), (0.008, 0, -0.006), (0, 0, 1)
view.CameraParallelProjection, view.CameraParallelScale = 1, 0.0875
Render(view)
