from os import PathLike
from typing import Any, Mapping, Optional, Sequence, Union

from numpy.typing import NDArray

from ._home import AtHome
from ._run import Progress
from .flame import Flame
from .light_field import LightField
from .operators import Operator
from .scene import Scene

_Path = Union[str, PathLike[str]]
_Image = Union[LightField, _Path]
_Place = Union[str, Sequence[float]]

class Reconstruction(AtHome):
    unknowns: str
    complete: bool
    flame: Flame
    figures: dict[str, Any]
    report: str
    shape: tuple[int, ...]
    places: NDArray[Any]
    residuals: list[NDArray[Any]]
    explained: list[NDArray[Any]]
    def __init__(self, algorithm: Any, unknowns: str) -> None: ...
    def __repr__(self) -> str: ...
    def __getstate__(self) -> dict[str, Any]: ...
    @property
    def temperature(self) -> Optional[NDArray[Any]]: ...
    @property
    def temperature_deviation(self) -> Optional[NDArray[Any]]: ...
    @property
    def absorption(self) -> Optional[NDArray[Any]]: ...
    @property
    def absorption_deviation(self) -> Optional[NDArray[Any]]: ...
    @property
    def emission(self) -> Optional[NDArray[Any]]: ...
    @property
    def emission_deviation(self) -> Optional[NDArray[Any]]: ...
    @property
    def resolved(self) -> Optional[NDArray[Any]]: ...
    @property
    def resolved_absorption(self) -> Optional[NDArray[Any]]: ...
    @property
    def history(self) -> NDArray[Any]: ...
    def save(self, path: _Path) -> None: ...

def reconstruct(scene: Union[Scene, Sequence[Scene]], images: Union[_Image, Sequence[_Image], Mapping[str, _Image]], *,
                unknowns: str = ..., grid: Union[None, int, str, Sequence[int]] = ..., center: Optional[_Place] = ...,
                size: Optional[_Place] = ..., axis: Optional[_Place] = ..., basis: Optional[str] = ...,
                absorption: Union[None, str, float] = ..., find: str = ..., channel: Union[None, str, Sequence[str]] = ...,
                absorption_error: float = ..., absorption_ratios: Union[None, float, Sequence[float]] = ..., noise: float = ...,
                support: Optional[_Path] = ..., all_voxels: bool = ..., solver: str = ...,
                smoothing: Union[None, str, Sequence[float]] = ..., strength: Optional[float] = ..., iterations: int = ...,
                subsets: Optional[int] = ..., relaxation: Optional[float] = ...,
                prior: Union[None, Reconstruction, _Path] = ..., start: Union[None, Reconstruction, _Path] = ...,
                resume: Optional[_Path] = ..., rays: int = ..., bin: Union[int, str] = ..., cells: int = ..., draws: int = ...,
                probes: int = ..., spread: Union[str, Sequence[_Place]] = ..., refine: Optional[str] = ..., memory: int = ...,
                form: str = ..., truth: bool = ..., seed: Optional[int] = ..., operator: Optional[Operator] = ...,
                threads: int = ..., progress: Optional[Progress] = ...) -> Reconstruction: ...
