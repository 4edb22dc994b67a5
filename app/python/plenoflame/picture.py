"""Pictures of scenes without a window."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

from ._run import Error, need_vtk


if TYPE_CHECKING:
    from ._types import Array, Path
    from .light_field import LightField
    from .rays import Rays
    from .scene import Scene

_VIEWS = ("scene", "camera", "array", "flame")
_COLOURS = ("type", "status")


def picture(scene: Scene, path: Path | None = None, *, view: str = "scene", rays: Rays | None = None,
            light_field: LightField | None = None, colour_by: str = "type", pixel: tuple[int, int] | None = None,
            size: tuple[int, int] = (1200, 800), flame: bool = True, surfaces: bool = True, insets: bool = True,
            axes: bool = True) -> Array | None:
    """Draws a scene: the flame by temperature, solid surfaces, the camera, rays.

    scene: Scene; path: .png to write, or None: the picture is returned instead
    view: "scene" (with insets of the others), "camera", "array" (a few microlenses) or "flame" (and
        solid bodies, as large as they fit)
    rays: Rays; light_field: LightField, for the sensor; colour_by: "type" of the microlens or "status" of the rays
    pixel: (column, row) in the middle of "array"; size: of the picture in pixels

    Returns a numpy array (rows, columns, 3) of uint8 when path is None. Raises Error, among others when there is no
    display: run under xvfb-run then. Needs VTK.
    """
    drawing = need_vtk("picture()").vtkPlenoflameScenePicture()
    from ._vtk import events_of, vtk_to_numpy
    if view not in _VIEWS:
        raise Error(f"there is no view {view!r}; there are {', '.join(_VIEWS)}")
    if colour_by not in _COLOURS:
        raise Error(f"rays are not coloured by {colour_by!r}; there are {', '.join(_COLOURS)}")
    if not drawing.CanRender():
        raise Error(drawing.GetWhyNot())
    drawing.SetScene(scene.to_vtk())
    drawing.SetView(_VIEWS.index(view))
    if rays is not None:
        drawing.SetRays(rays.to_vtk())
    if light_field is not None:
        drawing.SetSensorImage(light_field.to_vtk())
    drawing.SetRayColoring(_COLOURS.index(colour_by))
    if pixel is not None:
        drawing.SetPixel(*pixel)
    drawing.SetSize(*size)
    drawing.SetShowFlame(flame)
    drawing.SetShowSurfaces(surfaces)
    drawing.SetShowInsets(insets)
    drawing.SetShowAxes(axes)
    with events_of(drawing):
        if path is not None:
            drawing.WritePNG(os.fspath(path))
        image = drawing.RenderToImage() if path is None else None
    if image is None:
        return None
    columns, rows, _ = image.GetDimensions()
    return vtk_to_numpy(image.GetPointData().GetScalars()).reshape(rows, columns, -1)[::-1].copy()
