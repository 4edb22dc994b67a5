"""Paths of rays."""

from __future__ import annotations

from typing import TYPE_CHECKING

from . import _check, _core
from ._run import errors_of


if TYPE_CHECKING:
    from typing import Any, ClassVar

    from ._types import Array, Path


class Rays:
    """Rays from the sensor to the scene. What docs/rays.md says about a .vtp file holds for them; its arrays are
    attributes, without a copy:

    per ray: pixel (n, 2), microlens (n, 2), type, status, ended_at, solid, wavelength (n, channels), weight, radiance (n,
    channels), optical_thickness; per vertex: points (m, 3), surface, refractive_index, distance, temperature,
    absorption. Ray i has the vertices offsets[i] to offsets[i + 1].
    """

    STATUSES: ClassVar[tuple[str, ...]] = ("reached", "vignetted", "total internal reflection", "missed")
    pixel: Array
    microlens: Array
    type: Array
    status: Array
    ended_at: Array
    solid: Array
    wavelength: Array
    weight: Array
    radiance: Array
    optical_thickness: Array
    surface: Array
    refractive_index: Array
    distance: Array
    temperature: Array
    absorption: Array

    def __init__(self, state: dict[str, Any]) -> None:
        """Plain values, as the library gives them."""
        self._data = state

    def to_vtk(self) -> Any:
        """The same as a vtkPolyData of lines, whose arrays are in the memory of the rays. Raises Error without VTK."""
        from ._vtk import rays_to_polydata
        return rays_to_polydata(self._data)

    def __reduce__(self) -> tuple[Any, ...]:
        return Rays, (self._data,)

    def __len__(self) -> int:
        return len(self.offsets) - 1

    def __repr__(self):
        return f"<plenoflame.Rays, {len(self)} rays, {len(self.points)} vertices>"

    @property
    def points(self) -> Array:
        """Vertices in the world [m]: (m, 3)."""
        return self._data["points"]

    @property
    def offsets(self) -> Array:
        """Where each ray's vertices begin, and the last one's end: (n + 1,)."""
        return self._data["offsets"]

    @property
    def surfaces(self) -> list[str]:
        """Names of the surfaces, by number."""
        return self._data["surfaces"]

    def __getattr__(self, name: str) -> Array:
        if name.startswith("_"):
            raise AttributeError(name)
        if name not in self._data["arrays"]:
            raise AttributeError(f"rays have no {name!r}")
        return self._data["arrays"][name]

    def path(self, i: int) -> Array:
        """Vertices of ray i [m]: (k, 3)."""
        begin, end = self.offsets[i:i + 2]
        return self.points[begin:end]

    def save(self, path: Path) -> None:
        """Writes the rays as .vtp, which ParaView opens."""
        with errors_of():
            _core.write_rays(_check.file(path, ".vtp"), self._data)
