from typing import Any, ClassVar, Iterator, Optional

from numpy import ndarray

from .scene import Scene

class RayBlock:
    STATUSES: ClassVar[tuple[str, ...]]
    pixel: ndarray
    microlens: ndarray
    type: ndarray
    replicate: ndarray
    status: ndarray
    ended_at: ndarray
    etendue: ndarray
    sampled_etendue: ndarray
    origin: ndarray
    direction: ndarray
    t_near: ndarray
    t_far: ndarray
    radiance: ndarray
    def __init__(self, table: Any) -> None: ...
    def __reduce__(self) -> tuple[Any, ...]: ...
    @property
    def table(self) -> Any: ...
    def __len__(self) -> int: ...
    @property
    def anchor(self) -> ndarray: ...
    @property
    def tile(self) -> int: ...
    @property
    def path(self) -> int: ...
    @property
    def channels(self) -> ndarray: ...
    def __getattr__(self, name: str) -> ndarray: ...

def ray_blocks(scene: Scene, samples: int, window: Optional[tuple[int, int, int, int]], precision: str,
               radiance: bool, seed: int, skip: bool, rays_per_block: int, threads: int) -> Iterator[RayBlock]: ...
