from os import PathLike
from typing import Any, Optional, Sequence, Union

_Path = Union[str, PathLike[str]]

def read_flame(path: _Path, *, grid: str = ..., local_frame: bool = ...) -> Any: ...
def import_flame(path: _Path, *, temperature: str = ..., temperature_unit: str = ..., absorption: str = ...,
                 absorption_unit: str = ..., soot: str = ..., soot_function: float = ..., wavelength: float = ...,
                 constant: float = ..., voxel_size: float = ..., bounds: Optional[Sequence[float]] = ...,
                 length_scale: float = ..., step: int = ..., solution: Optional[_Path] = ...) -> Any: ...
def write_flame(path: _Path, image: Any, *, temperature: str = ..., absorption: str = ..., ambient: float = ...,
                half: bool = ...) -> None: ...
