from typing import Any, ClassVar, Iterator, Optional

from numpy.typing import NDArray

from .scene import Scene

class RayBlock:
    STATUSES: ClassVar[tuple[str, ...]]
    pixel: NDArray[Any]
    microlens: NDArray[Any]
    type: NDArray[Any]
    replicate: NDArray[Any]
    status: NDArray[Any]
    ended_at: NDArray[Any]
    etendue: NDArray[Any]
    sampled_etendue: NDArray[Any]
    origin: NDArray[Any]
    direction: NDArray[Any]
    t_near: NDArray[Any]
    t_far: NDArray[Any]
    radiance: NDArray[Any]
    def __init__(self, state: dict[str, Any]) -> None: ...
    def to_vtk(self) -> Any: ...
    def __reduce__(self) -> tuple[Any, ...]: ...
    def __len__(self) -> int: ...
    @property
    def anchor(self) -> NDArray[Any]: ...
    @property
    def tile(self) -> int: ...
    @property
    def path(self) -> int: ...
    @property
    def channels(self) -> NDArray[Any]: ...
    def __getattr__(self, name: str) -> NDArray[Any]: ...

def ray_blocks(scene: Scene, samples: int, window: Optional[tuple[int, int, int, int]], precision: str,
               radiance: bool, seed: int, skip: bool, rays_per_block: int, threads: int) -> Iterator[RayBlock]: ...
