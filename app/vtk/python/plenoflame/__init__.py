"""What a light-field (plenoptic) camera sees of a flame.

    import plenoflame
    scene = plenoflame.Scene("examples/lenslets-30.toml")
    scene["camera.sensor.columns"] = 200
    light_field = scene.render(samples=16)
    light_field.flux          # numpy array (rows, columns), row 0 at the top, [W]
    light_field.views(grid=5).sheet
    light_field.refocus(0.98).image
    scene.rays(pixels=[(150, 150)]).polydata
    scene.design()["focal_length_m"]

Results are at home in numpy, xarray and notebooks: numpy.asarray(views), light_field.to_xarray(), pickle.dumps(found), a
picture and the main numbers where a notebook shows them, a bar with progress=True.

Every function raises plenoflame.Error with the message that the command `plenoflame` would print. The package is built
with VTK or without it. With it the VTK classes behind it are in plenoflame.vtk, and whatever holds one gives it as
`.scene`, `.image` or `.polydata`; without it plenoflame.vtk is None, and picture(), import_flame(), Scene.camera() and
those attributes raise Error. Everything else is the same, to the last bit.

Units are SI. Numbers of a scene know their unit (Quantity); they are set from text with a unit, as in its file. While
something is computed, other threads of Python go on.
"""

from ._arguments import guarded as _guarded
from ._library import vtk
from ._run import Error
from ._values import Quantity
from ._version import __version__
from .flame import Flame, flame_arrays, flame_from_arrays, flame_generators, import_flame, make_flame, read_flame, write_flame
from .light_field import Export, FocusStack, LightField, Refocused, Views, export_formats, read_light_field
from .picture import picture
from .ray_blocks import RayBlock
from .rays import Rays
from .reconstruction import Reconstruction, reconstruct
from .scene import Scene

__all__ = ["Error", "Export", "Flame", "FocusStack", "LightField", "Quantity", "RayBlock", "Rays",
           "Reconstruction", "Refocused", "Scene", "Views", "__version__", "export_formats", "flame_arrays",
           "flame_from_arrays", "flame_generators", "import_flame", "make_flame", "picture", "read_flame",
           "read_light_field", "reconstruct", "vtk", "write_flame"]

for _name in __all__:
    if _name not in ("Export", "vtk"):
        globals()[_name] = _guarded(globals()[_name])
