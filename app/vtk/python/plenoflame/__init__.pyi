from typing import Any

from ._run import Error as Error
from .flame import import_flame as import_flame, read_flame as read_flame, write_flame as write_flame
from .light_field import LightField as LightField, Refocused as Refocused, Views as Views
from .light_field import read_light_field as read_light_field
from .picture import picture as picture
from .rays import Rays as Rays
from .scene import Scene as Scene

__all__: list[str]
vtk: Any
