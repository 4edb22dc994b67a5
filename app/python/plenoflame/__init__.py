"""What a light-field (plenoptic) camera sees of a flame.

    import plenoflame
    scene = plenoflame.Scene("examples/lenslets-30.toml")
    scene["camera.sensor.columns"] = 200
    light_field = scene.render(samples=16)
    light_field.flux          # numpy array (rows, columns), row 0 at the top, [W]
    light_field.views(grid=5).sheet
    light_field.refocus(0.98).image
    scene.rays(pixels=[(150, 150)]).points
    scene.design()["focal_length_m"]

Results are at home in numpy, xarray and notebooks: numpy.asarray(views), light_field.to_xarray(), pickle.dumps(found), a
picture and the main numbers where a notebook shows them, a bar with progress=True.

Every function raises plenoflame.Error with the message that the command `plenoflame` would print, and TypeError for a wrong
keyword, with the nearest right one.

The package works without VTK. Where VTK is there, to_vtk() gives scenes, light fields, flames and rays as its objects, and
from_vtk() takes them back; plenoflame.vtk has the classes of VTK pipelines, and is loaded when it is asked for. picture(),
import_flame() and Scene.camera() need it, and raise Error without it.

Units are SI. Numbers of a scene know their unit (Quantity); they are set from text with a unit, as in its file. While
something is computed, other threads of Python go on.
"""

from ._arguments import guarded as _guarded
from ._run import Error, need_vtk as _need_vtk
from ._values import Quantity
from ._version import __version__
from .flame import Flame, flame_arrays, flame_from_arrays, flame_generators, import_flame, make_flame, read_flame, write_flame
from .light_field import Export, FocusStack, LightField, Refocused, Views, export_formats, merge, read_light_field
from .measurements import Corners, Frames, ImportedCamera, MicroImages, Projections, Temperatures, Truth, import_camera
from .picture import picture
from .raw import (Boards, Geometry, Imported, Radiometry, Rig, White, calibrate_corners, calibrate_geometry, calibrate_radiometry,
                  calibrate_rig, calibrate_white, import_raw)
from .ray_blocks import RayBlock
from .rays import Rays
from .reconstruction import Reconstruction, reconstruct
from .scene import Optimized, Scene

__all__ = ["Boards", "Corners", "Error", "Export", "Flame", "FocusStack", "Frames", "Geometry", "Imported", "ImportedCamera",
           "LightField", "MicroImages", "Optimized", "Projections", "Quantity", "Radiometry", "RayBlock", "Rays",
           "Reconstruction", "Refocused", "Rig", "Scene", "Temperatures", "Truth", "Views", "White", "__version__",
           "calibrate_corners", "calibrate_geometry", "calibrate_radiometry", "calibrate_rig", "calibrate_white",
           "export_formats", "flame_arrays", "flame_from_arrays", "flame_generators", "import_camera", "import_flame",
           "import_raw", "make_flame", "merge", "picture", "read_flame", "read_light_field", "reconstruct", "write_flame"]

for _name in __all__:
    if not hasattr(globals()[_name], "_fields"):  # named tuples have no keywords of their own
        globals()[_name] = _guarded(globals()[_name])


def __getattr__(name):
    if name == "vtk":
        return _need_vtk("plenoflame.vtk")
    raise AttributeError(f"module 'plenoflame' has no attribute {name!r}")
