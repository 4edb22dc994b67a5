"""The rays that make a picture, block by block."""

import time

from ._library import data, library, need_vtk
from ._run import Error
from .rays import Rays

_PRECISIONS = {"double": True, "single": False}
_PAUSE = 2e-4  # seconds


class RayBlock:
    """Rays of some pixels, behind the camera. Arrays are attributes, numpy views of `table` (with
    VTK, a vtkTable) without a copy:

    pixel (n, 2): column, row; microlens (n, 2): q, r; type: of the microlens, -1 without one; replicate: the
    independent randomisation that the ray belongs to; status: number in RayBlock.STATUSES; ended_at: surface, -1;
    etendue: [m^2 sr] weight of the ray's radiance in the flux of its pixel, 0 for a ray that ended in the camera;
    sampled_etendue: the same before the camera; origin (n, 3) [m] from `anchor`; direction (n, 3): unit, away from the
    camera; t_near, t_far: [m] where light is collected, up to the first solid surface; radiance (n, channels)
    [W/(m^2 sr)], where it was asked for.
    """

    STATUSES = Rays.STATUSES

    def __init__(self, table):
        self._data = table

    def __reduce__(self):
        return _block_of, (data.state_of(self._data),)

    @property
    def table(self):
        """The vtkTable. Raises Error without VTK."""
        need_vtk("RayBlock.table")
        return self._data

    def __len__(self):
        return data.table_rows(self._data)

    def __repr__(self):
        return f"<plenoflame.RayBlock, {len(self)} rays of tile {self.tile}>"

    def _field(self, name):
        return data.table_field(self._data, name)

    @property
    def anchor(self):
        """Place in the world that origins count from [m]: (3,)."""
        return self._field("anchor")

    @property
    def tile(self):
        """Number of the tile of 64 x 64 pixels, row by row in the window."""
        return int(self._field("tile")[0])

    @property
    def path(self):
        """Way through the camera: one for each wavelength where glasses disperse, else 0."""
        return int(self._field("path")[0])

    @property
    def channels(self):
        """Numbers of the scene's channels that `radiance` has, in its order."""
        return self._field("channels")

    def __getattr__(self, name):
        if name.startswith("_"):
            raise AttributeError(name)
        values = data.table_column(self._data, name)
        if values is None:
            raise AttributeError(f"a block of rays has no {name!r}" + (
                ": ask for it by ray_blocks(radiance=True)" if name == "radiance" else ""))
        return values.reshape(len(values), -1) if name == "radiance" else values


def _block_of(state):
    return RayBlock(data.data_of(state))


def ray_blocks(scene, samples, window, precision, radiance, seed, skip, rays_per_block, threads):
    """Scene.ray_blocks()."""
    if precision not in _PRECISIONS:
        raise Error(f"there is no precision {precision!r}; there are 'double' and 'single'")
    stream = library.RayStream()
    stream.SetSamples(samples or int(scene["render.samples"]))
    if window is not None:
        stream.SetWindow(*window)
    stream.SetDoublePrecision(_PRECISIONS[precision])
    stream.SetRadiance(radiance)
    stream.SetSeed(seed)
    stream.SetSkip(skip)
    stream.SetRaysPerBlock(rays_per_block)
    stream.SetNumberOfThreads(threads)
    with data.errors_of(stream, scene._scene):
        stream.Start(scene._scene)
    return _blocks(stream)


def _blocks(stream):
    try:
        while True:
            while not stream.IsReady():
                time.sleep(_PAUSE)  # which, other than VTK's functions, lets Python's other threads work, and Ctrl-C end it
            with data.errors_of(stream):
                table = stream.Next()
            if table is None:
                return
            yield RayBlock(table)
    finally:
        stream.Stop()  # where the iteration ends early, too
