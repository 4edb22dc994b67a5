from os import PathLike
from typing import Any, Mapping, NamedTuple, Optional, Sequence, Union

from numpy.typing import NDArray

from ._run import Progress
from .light_field import LightField
from .scene import Scene

_Path = Union[str, PathLike[str]]
_Files = Union[_Path, Sequence[_Path], Mapping[str, Union[_Path, Sequence[_Path]]]]
_Timed = Union[_Path, Sequence[_Path], Mapping[Any, Union[_Path, Sequence[_Path]]]]
_Table = Union[_Path, NDArray[Any]]
_Sides = Union[None, str, Sequence[int]]
_Sources = Mapping[Any, Union[_Path, Sequence[_Path]]]

class Imported(NamedTuple):
    light_field: LightField
    figures: dict[str, Any]

class White(NamedTuple):
    scene: Optional[Scene]
    centres: NDArray[Any]
    radii: Optional[NDArray[Any]]
    figures: dict[str, Any]

class Radiometry(NamedTuple):
    text: str
    figures: dict[str, Any]

class Boards(NamedTuple):
    corners: NDArray[Any]
    figures: dict[str, Any]

class Geometry(NamedTuple):
    scene: Scene
    poses: NDArray[Any]
    residuals: NDArray[Any]
    figures: dict[str, Any]

class Rig(NamedTuple):
    scene: Scene
    figures: dict[str, Any]

def import_raw(pictures: _Files, camera: Scene, *, channel: Optional[str] = ..., unit: Optional[str] = ...,
               dark: Optional[_Files] = ..., flat: Optional[_Files] = ..., flat_dark: Optional[_Files] = ...,
               white: Optional[_Files] = ..., white_dark: Optional[_Files] = ..., defects: Optional[_Path] = ...,
               gain: Optional[float] = ..., read_noise: Optional[float] = ..., black_level: Optional[float] = ...,
               exposure_time: Union[None, str, float, Mapping[str, Union[str, float]]] = ..., saturation: Optional[float] = ...,
               noise: Optional[str] = ..., radiometry: Union[_Path, Sequence[_Path]] = ...,
               window: Union[None, str, Sequence[int]] = ..., size: _Sides = ..., bits: Optional[int] = ...,
               endian: str = ..., skip: Optional[int] = ..., shift: int = ..., turn: Union[int, str] = ..., mirror: bool = ...,
               threads: int = ..., progress: Optional[Progress] = ...) -> Imported: ...
def calibrate_white(pictures: _Timed, camera: Optional[Scene] = ..., *, dark: Union[None, _Path, Sequence[_Path]] = ...,
                    pixel_pitch: Union[None, str, float] = ..., mosaic: Optional[str] = ..., no_tilt: bool = ...,
                    size: _Sides = ..., bits: Optional[int] = ..., endian: str = ..., skip: Optional[int] = ...,
                    shift: int = ..., turn: Union[int, str] = ..., mirror: bool = ..., threads: int = ...,
                    progress: Optional[Progress] = ...) -> White: ...
def calibrate_radiometry(sources: _Sources, camera: Scene, *, white: Optional[_Timed] = ..., white_dark: Optional[_Files] = ...,
                         flat: Optional[_Files] = ..., flat_dark: Optional[_Files] = ..., dark: Optional[_Timed] = ...,
                         channel: Optional[str] = ..., exposure_time: Union[None, str, float] = ...,
                         temperature_error: Union[None, str, float] = ..., emissivity: float = ...,
                         emissivity_error: float = ..., etendue_error: float = ..., part: Union[None, str, Sequence[int]] = ...,
                         size: _Sides = ..., bits: Optional[int] = ..., endian: str = ..., skip: Optional[int] = ...,
                         shift: int = ..., turn: Union[int, str] = ..., mirror: bool = ..., threads: int = ...,
                         progress: Optional[Progress] = ...) -> Radiometry: ...
def calibrate_corners(pictures: Union[_Path, Sequence[_Path]], camera: Scene, *, board: Union[str, Sequence[int]], cell: Union[str, float],
                      dots: bool = ..., white: Union[None, _Path, Sequence[_Path]] = ...,
                      dark: Union[None, _Path, Sequence[_Path]] = ..., size: _Sides = ..., bits: Optional[int] = ..., endian: str = ...,
                      skip: Optional[int] = ..., shift: int = ..., turn: Union[int, str] = ..., mirror: bool = ..., threads: int = ...,
                      progress: Optional[Progress] = ...) -> Boards: ...
def calibrate_geometry(corners: _Table, camera: Scene, *, centres: Optional[_Table] = ..., radii: Optional[_Table] = ...,
                       f_number_error: float = ..., microlens_error: float = ..., free: Union[None, str, Sequence[str]] = ...,
                       pupil: float = ..., progress: Optional[Progress] = ...) -> Geometry: ...
def calibrate_rig(cameras: Sequence[Union[Geometry, tuple[Scene, _Table]]], *, size: Union[None, str, float] = ...,
                  progress: Optional[Progress] = ...) -> Rig: ...
