from ._run import Error as Error
from ._values import Quantity as Quantity
from ._version import __version__ as __version__
from .flame import Flame as Flame, flame_arrays as flame_arrays, flame_from_arrays as flame_from_arrays
from .flame import flame_generators as flame_generators
from .flame import import_flame as import_flame, make_flame as make_flame
from .flame import read_flame as read_flame, write_flame as write_flame
from .light_field import Export as Export, FocusStack as FocusStack, LightField as LightField
from .light_field import Refocused as Refocused, Views as Views, export_formats as export_formats
from .light_field import merge as merge, read_light_field as read_light_field
from .measurements import Corners as Corners, Frames as Frames, ImportedCamera as ImportedCamera, MicroImages as MicroImages
from .measurements import Projections as Projections, Temperatures as Temperatures, Truth as Truth
from .measurements import import_camera as import_camera
from .picture import picture as picture
from .raw import Imported as Imported, Radiometry as Radiometry, White as White, import_raw as import_raw
from .raw import calibrate_radiometry as calibrate_radiometry, calibrate_white as calibrate_white
from .raw import Boards as Boards, Geometry as Geometry, Rig as Rig, calibrate_corners as calibrate_corners
from .raw import calibrate_geometry as calibrate_geometry, calibrate_rig as calibrate_rig
from .ray_blocks import RayBlock as RayBlock
from .rays import Rays as Rays
from .reconstruction import Reconstruction as Reconstruction, reconstruct as reconstruct
from .scene import Optimized as Optimized, Scene as Scene
from . import vtk as vtk

__all__: list[str]
