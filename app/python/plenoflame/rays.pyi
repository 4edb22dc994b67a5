from os import PathLike
from typing import Any, ClassVar, Union

from numpy.typing import NDArray

class Rays:
    STATUSES: ClassVar[tuple[str, ...]]
    pixel: NDArray[Any]
    microlens: NDArray[Any]
    type: NDArray[Any]
    status: NDArray[Any]
    ended_at: NDArray[Any]
    solid: NDArray[Any]
    wavelength: NDArray[Any]
    weight: NDArray[Any]
    radiance: NDArray[Any]
    optical_thickness: NDArray[Any]
    surface: NDArray[Any]
    refractive_index: NDArray[Any]
    distance: NDArray[Any]
    temperature: NDArray[Any]
    absorption: NDArray[Any]
    def __init__(self, state: dict[str, Any]) -> None: ...
    def to_vtk(self) -> Any: ...
    def __reduce__(self) -> tuple[Any, ...]: ...
    def __len__(self) -> int: ...
    @property
    def points(self) -> NDArray[Any]: ...
    @property
    def offsets(self) -> NDArray[Any]: ...
    @property
    def surfaces(self) -> list[str]: ...
    def __getattr__(self, name: str) -> NDArray[Any]: ...
    def path(self, i: int) -> NDArray[Any]: ...
    def save(self, path: Union[str, PathLike[str]]) -> None: ...
