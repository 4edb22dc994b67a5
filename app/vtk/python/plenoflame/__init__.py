"""What a light-field (plenoptic) camera sees of a flame.

    import plenoflame
    scene = plenoflame.Scene("examples/lenslets-30.toml")
    scene["camera.sensor.columns"] = "200"
    light_field = scene.render(samples=16)
    light_field.flux          # numpy array (rows, columns), row 0 at the top, [W]; shared with VTK
    light_field.views(grid=5).sheet
    light_field.refocus(0.98).image
    scene.rays(pixels=[(150, 150)]).polydata
    scene.design()["focal_length_m"]

Every function raises plenoflame.Error with the message that the command `plenoflame` would print. The VTK classes
behind it are in plenoflame.vtk; whatever holds one gives it as `.scene`, `.image` or `.polydata`.

Units are SI. Quantities of a scene are texts with a unit, as in its file.
"""

from . import vtkPlenoflame as vtk
from ._run import Error
from .flame import import_flame, read_flame, write_flame
from .light_field import LightField, Refocused, Views, read_light_field
from .picture import picture
from .rays import Rays
from .scene import Scene

__all__ = ["Error", "LightField", "Rays", "Refocused", "Scene", "Views", "import_flame", "picture", "read_flame",
           "read_light_field", "vtk", "write_flame"]
