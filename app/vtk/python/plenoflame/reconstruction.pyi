from os import PathLike
from typing import Any, Callable, Mapping, Optional, Sequence, Union

from numpy import ndarray

from .light_field import LightField
from .scene import Scene

_Path = Union[str, PathLike[str]]
_Image = Union[LightField, _Path]
_Place = Union[str, Sequence[float]]

class Reconstruction:
    algorithm: Any
    image: Any
    figures: dict[str, Any]
    report: str
    shape: tuple[int, ...]
    def __init__(self, algorithm: Any) -> None: ...
    def __repr__(self) -> str: ...
    @property
    def complete(self) -> bool: ...
    @property
    def temperature(self) -> Optional[ndarray]: ...
    @property
    def temperature_deviation(self) -> Optional[ndarray]: ...
    @property
    def absorption(self) -> Optional[ndarray]: ...
    @property
    def absorption_deviation(self) -> Optional[ndarray]: ...
    @property
    def emission(self) -> Optional[ndarray]: ...
    @property
    def emission_deviation(self) -> Optional[ndarray]: ...
    @property
    def resolved(self) -> Optional[ndarray]: ...
    @property
    def resolved_absorption(self) -> Optional[ndarray]: ...
    @property
    def places(self) -> ndarray: ...
    @property
    def history(self) -> ndarray: ...
    @property
    def residuals(self) -> list[ndarray]: ...
    @property
    def explained(self) -> list[ndarray]: ...
    def save(self, path: _Path) -> None: ...

def reconstruct(scene: Union[Scene, Sequence[Scene]], images: Union[_Image, Sequence[_Image], Mapping[str, _Image]], *,
                find: str = ..., unknowns: str = ..., grid: Union[None, int, str, Sequence[int]] = ...,
                center: Optional[_Place] = ..., size: Optional[_Place] = ..., axis: Optional[_Place] = ...,
                basis: Optional[str] = ..., absorption: Union[None, str, float] = ...,
                channel: Union[None, str, Sequence[str]] = ...,
                absorption_ratios: Union[None, float, Sequence[float]] = ..., noise: float = ...,
                support: Optional[_Path] = ..., all_voxels: bool = ..., solver: str = ...,
                smoothing: Union[None, str, Sequence[float]] = ..., strength: Optional[float] = ...,
                iterations: int = ..., subsets: Optional[int] = ...,
                relaxation: Optional[float] = ..., prior: Union[None, Reconstruction, _Path] = ...,
                start: Union[None, Reconstruction, _Path] = ..., rays: int = ..., bin: Union[int, str] = ..., cells: Optional[int] = ...,
                draws: int = ...,
                probes: int = ..., spread: Union[str, Sequence[_Place]] = ..., memory: int = ..., form: str = ..., seed: Optional[int] = ...,
                truth: bool = ..., threads: int = ..., progress: Optional[Callable[[float], Any]] = ...) -> Reconstruction: ...
