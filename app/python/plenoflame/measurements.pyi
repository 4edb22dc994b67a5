from os import PathLike
from typing import Any, Mapping, NamedTuple, Optional, Sequence, Union

from numpy.typing import NDArray

from ._home import AtHome
from ._run import Progress
from .light_field import LightField
from .scene import Scene

_Path = Union[str, PathLike[str]]

class Frames(NamedTuple):
    numbers: NDArray[Any]
    exposure_time: float
    gain: float
    black_level: float
    saturated: NDArray[Any]

class MicroImages(NamedTuple):
    lens: NDArray[Any]
    type: NDArray[Any]
    centre: NDArray[Any]
    radius: NDArray[Any]

class Projections(NamedTuple):
    point: NDArray[Any]
    lens: NDArray[Any]
    type: NDArray[Any]
    chief: NDArray[Any]
    light: NDArray[Any]
    spread: NDArray[Any]
    share: NDArray[Any]

class Truth(NamedTuple):
    micro_images: MicroImages
    projections: Projections
    chief_rays: Optional[LightField]

class Corners(NamedTuple):
    surface: NDArray[Any]
    column: NDArray[Any]
    row: NDArray[Any]
    point: NDArray[Any]
    in_camera: NDArray[Any]
    lens: NDArray[Any]
    type: NDArray[Any]
    image: NDArray[Any]
    spread: NDArray[Any]
    share: NDArray[Any]

class ImportedCamera(NamedTuple):
    scene: Scene
    formats: list[str]
    notes: list[str]
    warnings: list[str]

class Temperatures(AtHome):
    light_field: LightField
    figures: dict[str, Any]
    def __init__(self, light_field: LightField, figures: dict[str, Any]) -> None: ...
    def __repr__(self) -> str: ...
    @property
    def temperature(self) -> NDArray[Any]: ...
    @property
    def error(self) -> Optional[NDArray[Any]]: ...

def exposed(field: Any, exposure: Any, channel_exposure: Any, noise: Any, noise_seed: Any, frames: Any, dark: Any, channel: Any,
            threads: Any, as_electrons: bool) -> Any: ...
def temperatures(field: Any, channels: Any, filters: Any, law: Any, exponent: Any, threshold: Any, least_signal: Any, bin: Any,
                 cells: Any) -> Any: ...
def truth_of(field: Any, points: Any, rays: Any, chief_rays: Any, threads: Any, progress: Optional[Progress]) -> Any: ...
def corners_of(scene: Any, rays: Any, threads: Any, progress: Optional[Progress]) -> Corners: ...
def import_camera(files: Union[_Path, Sequence[_Path]], *, format: Optional[str] = ...,
                  values: Optional[Mapping[str, Any]] = ...) -> ImportedCamera: ...
