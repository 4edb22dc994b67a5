"""Renders what a light-field (plenoptic) camera sees of a flame, and reconstructs the flame from such pictures.

    import plenoflame
    scene = plenoflame.Scene("examples/lenslets-30.toml")
    scene["camera.sensor.columns"] = 200
    light_field = scene.render(samples=16)
    light_field.flux          # numpy array (rows, columns), row 0 at the top, [W]
    light_field.views(grid=5).sheet
    light_field.refocus(0.98).image
    scene.rays(pixels=[(150, 150)]).points
    scene.design()["focal_length_m"]

Results convert to numpy and xarray: numpy.asarray(views), light_field.to_xarray(). They can be pickled. A notebook shows a
result with a picture and its main numbers, and a progress bar with progress=True.

Every function raises plenoflame.Error with the message that the command `plenoflame` would print. A wrong keyword raises
TypeError, which names the nearest right keyword.

The package works without VTK. With VTK, to_vtk() makes its objects of scenes, light fields, flames and rays, and from_vtk()
reads them. The module plenoflame.vtk has the classes of VTK pipelines; import it separately. picture(), import_flame() and
Scene.camera() need VTK, and raise Error without it.

Units are SI. A number of a scene has its unit (Quantity); set it by text with a unit, as in the scene file. Other threads of
Python continue during a computation.
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
from .sweep import Sweep, SweepRun

__all__ = ["Boards", "Corners", "Error", "Export", "Flame", "FocusStack", "Frames", "Geometry", "Imported", "ImportedCamera",
           "LightField", "MicroImages", "Optimized", "Projections", "Quantity", "Radiometry", "RayBlock", "Rays",
           "Reconstruction", "Refocused", "Rig", "Scene", "Sweep", "SweepRun", "Temperatures", "Truth", "Views", "White", "__version__",
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
