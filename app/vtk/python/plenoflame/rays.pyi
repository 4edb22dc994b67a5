from os import PathLike
from typing import Any, ClassVar, Union

from numpy import ndarray

class Rays:
    STATUSES: ClassVar[tuple[str, ...]]
    pixel: ndarray
    microlens: ndarray
    type: ndarray
    status: ndarray
    ended_at: ndarray
    solid: ndarray
    wavelength: ndarray
    weight: ndarray
    radiance: ndarray
    optical_thickness: ndarray
    surface: ndarray
    refractive_index: ndarray
    distance: ndarray
    temperature: ndarray
    absorption: ndarray
    def __init__(self, polydata: Any) -> None: ...
    @property
    def polydata(self) -> Any: ...
    def __reduce__(self) -> tuple[Any, ...]: ...
    def __len__(self) -> int: ...
    @property
    def points(self) -> ndarray: ...
    @property
    def offsets(self) -> ndarray: ...
    @property
    def surfaces(self) -> list[str]: ...
    def __getattr__(self, name: str) -> ndarray: ...
    def path(self, i: int) -> ndarray: ...
    def save(self, path: Union[str, PathLike[str]]) -> None: ...
