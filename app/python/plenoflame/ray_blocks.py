"""The rays that make a picture, block by block."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

from . import _core
from ._run import Error, errors_of, made
from .rays import Rays


if TYPE_CHECKING:
    from typing import Any, ClassVar

    from ._types import Array

_PRECISIONS = {"double": True, "single": False}
_PAUSE = 2e-4  # seconds


class RayBlock:
    """Rays of some pixels, behind the camera. Arrays are attributes, without a copy:

    pixel (n, 2): column, row; microlens (n, 2): q, r; type: of the microlens, -1 without one; replicate: the
    independent randomisation that the ray belongs to; status: number in RayBlock.STATUSES; ended_at: surface, -1;
    etendue: [m^2 sr] weight of the ray's radiance in the flux of its pixel, 0 for a ray that ended in the camera;
    sampled_etendue: the same before the camera; origin (n, 3) [m] from `anchor`; direction (n, 3): unit, away from the
    camera; t_near, t_far: [m] where light is collected, up to the first solid surface; radiance (n, channels)
    [W/(m^2 sr)], where it was asked for.
    """

    STATUSES: ClassVar[tuple[str, ...]] = Rays.STATUSES
    pixel: Array
    microlens: Array
    type: Array
    replicate: Array
    status: Array
    ended_at: Array
    etendue: Array
    sampled_etendue: Array
    origin: Array
    direction: Array
    t_near: Array
    t_far: Array
    radiance: Array

    def __init__(self, state: dict[str, Any]) -> None:
        """Plain values, as the library gives them."""
        self._data = state

    def to_vtk(self) -> Any:
        """The same as a vtkTable, whose columns are in the memory of the block. Raises Error without VTK."""
        from ._vtk import block_to_table
        return block_to_table(self._data)

    def __reduce__(self) -> tuple[Any, ...]:
        return RayBlock, (self._data,)

    def __len__(self) -> int:
        return self._data["rows"]

    def __repr__(self):
        return f"<plenoflame.RayBlock, {len(self)} rays of tile {self.tile}>"

    def _field(self, name):
        return self._data["fields"][name]

    @property
    def anchor(self) -> Array:
        """Place in the world that origins count from [m]: (3,)."""
        return self._field("anchor")

    @property
    def tile(self) -> int:
        """Number of the tile of 64 x 64 pixels, row by row in the window."""
        return int(self._field("tile")[0])

    @property
    def path(self) -> int:
        """Way through the camera: one for each wavelength where glasses disperse, else 0."""
        return int(self._field("path")[0])

    @property
    def channels(self) -> Array:
        """Numbers of the scene's channels that `radiance` has, in its order."""
        return self._field("channels")

    def __getattr__(self, name: str) -> Array:
        if name.startswith("_"):
            raise AttributeError(name)
        values = self._data["columns"].get(name)
        if values is None:
            raise AttributeError(f"a block of rays has no {name!r}" + (
                ": ask for it by ray_blocks(radiance=True)" if name == "radiance" else ""))
        return values.reshape(len(values), -1) if name == "radiance" else values


def ray_blocks(scene, samples, window, precision, radiance, seed, skip, rays_per_block, threads):
    """Scene.ray_blocks()."""
    if precision not in _PRECISIONS:
        raise Error(f"there is no precision {precision!r}; there are 'double' and 'single'")
    stream = made(_core.RayStream, samples=samples or int(scene["render.samples"]), window=window or (0, 0, 0, 0),
                  double_precision=_PRECISIONS[precision], radiance=radiance, seed=seed if seed >= 0 else None, skip=skip,
                  rays_per_block=rays_per_block, threads=threads)
    with errors_of(stream, scene._scene):
        stream.start(scene._scene)
    return _blocks(stream)


def _blocks(stream):
    try:
        while True:
            while not stream.is_ready():
                time.sleep(_PAUSE)  # Python's other threads work meanwhile, and Ctrl-C ends it
            with errors_of(stream):
                table = stream.next()
            if table is None:
                return
            yield RayBlock(table)
    finally:
        stream.stop()  # where the iteration ends early, too
