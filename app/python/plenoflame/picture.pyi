from os import PathLike
from typing import Any, Optional, Union

from numpy.typing import NDArray

from .light_field import LightField
from .rays import Rays
from .scene import Scene

def picture(scene: Scene, path: Optional[Union[str, PathLike[str]]] = ..., *, view: str = ...,
            rays: Optional[Rays] = ..., light_field: Optional[LightField] = ..., colour_by: str = ...,
            pixel: Optional[tuple[int, int]] = ..., size: tuple[int, int] = ..., flame: bool = ..., surfaces: bool = ...,
            insets: bool = ..., axes: bool = ...) -> Optional[NDArray[Any]]: ...
