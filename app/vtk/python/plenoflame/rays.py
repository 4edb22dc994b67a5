"""Paths of rays."""

from . import _check
from ._library import data, need_vtk


class Rays:
    """Rays from the sensor to the scene. What docs/rays.md says about a .vtp file holds for `polydata` (with VTK); its
    arrays are attributes, numpy views without a copy:

    per ray: pixel (n, 2), microlens (n, 2), type, status, ended_at, solid, wavelength (n, channels), weight, radiance (n,
    channels), optical_thickness; per vertex: points (m, 3), surface, refractive_index, distance, temperature,
    absorption. Ray i has the vertices offsets[i] to offsets[i + 1].
    """

    STATUSES = ("reached", "vignetted", "total internal reflection", "missed")

    def __init__(self, polydata):
        self._data = polydata

    @property
    def polydata(self):
        """The vtkPolyData. Raises Error without VTK."""
        need_vtk("Rays.polydata")
        return self._data

    def __reduce__(self):
        return _rays_of, (data.state_of(self._data),)

    def __len__(self):
        return len(self.offsets) - 1

    def __repr__(self):
        return f"<plenoflame.Rays, {len(self)} rays, {len(self.points)} vertices>"

    @property
    def points(self):
        """Vertices in the world [m]: (m, 3)."""
        return data.ray_points(self._data)

    @property
    def offsets(self):
        """Where each ray's vertices begin, and the last one's end: (n + 1,)."""
        return data.ray_offsets(self._data)

    @property
    def surfaces(self):
        """Names of the surfaces, by number."""
        return data.ray_surfaces(self._data)

    def __getattr__(self, name):
        if name.startswith("_"):
            raise AttributeError(name)
        array = data.ray_array(self._data, name)
        if array is None:
            raise AttributeError(f"rays have no {name!r}")
        return array

    def path(self, i):
        """Vertices of ray i [m]: (k, 3)."""
        begin, end = self.offsets[i:i + 2]
        return self.points[begin:end]

    def save(self, path):
        """Writes the rays as .vtp, which ParaView opens."""
        data.write_rays(_check.file(path, ".vtp"), self._data)


def _rays_of(state):
    return Rays(data.data_of(state))
