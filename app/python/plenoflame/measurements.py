"""What is measured in light fields: frames of a sensor, temperatures, ground truth; and cameras of calibrations."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, NamedTuple

import numpy

from . import _check, _core, _home
from ._run import Error, errors_of, made, update
from ._values import text_of


if TYPE_CHECKING:
    from typing import Any, Mapping, Sequence

    from ._types import Array, Path
    from .light_field import LightField
    from .scene import Scene

_NOISE = ("shot", "read", "dark", "defects")
_LAWS = (None, "grey", "soot", "power")


class Frames(NamedTuple):
    """Frames as a sensor gives them: digital numbers (frames, rows, columns), uint16; exposure time [s]; electrons per
    number; the number without light; pixels that are full, of each frame."""

    numbers: Array
    exposure_time: float
    gain: float
    black_level: float
    saturated: Array


class MicroImages(NamedTuple):
    """Micro-images, an entry each: microlens (n, 2), its type, centre (column, row) (n, 2) and radius in pixels."""

    lens: Array
    type: Array
    centre: Array
    radius: Array


class Projections(NamedTuple):
    """Images of points through microlenses, an entry each: number of the point, microlens (n, 2), its type; column and
    row (n, 2) of the ray through the lens' middle (NaN: stopped) and of the centroid of all light; spread of the light [pixels], and the
    lens' share in it."""

    point: Array
    lens: Array
    type: Array
    chief: Array
    light: Array
    spread: Array
    share: Array


class Truth(NamedTuple):
    """Ground truth of a raw image: MicroImages, Projections, and a LightField with the layers of chief rays, or None."""

    micro_images: MicroImages
    projections: Projections
    chief_rays: LightField | None


class Corners(NamedTuple):
    """Images of a pattern's points through microlenses, an entry each: number of the surface; column and row in the
    pattern; place in the world and in the camera's frame [m], (n, 3); microlens (n, 2) and its type; column and row of the image (n, 2);
    spread of the light [pixels], and the lens' share in it."""

    surface: Array
    column: Array
    row: Array
    point: Array
    in_camera: Array
    lens: Array
    type: Array
    image: Array
    spread: Array
    share: Array


class ImportedCamera(NamedTuple):
    """What import_camera() read: the Scene of the camera; formats of the files; what was assumed; warnings."""

    scene: Scene
    formats: list[str]
    notes: list[str]
    warnings: list[str]


class Temperatures(_home.AtHome):
    """Temperatures by the ratio of two colours. numpy.asarray(found) is the temperature [K], (rows, columns), 0 where there is none."""

    def __init__(self, light_field: LightField, figures: dict[str, Any]) -> None:
        """LightField.pyrometry() makes it."""
        self.light_field: LightField = light_field  #: its channel is the temperature; save() writes what `plenoflame pyrometry -o` does
        self.figures: dict[str, Any] = figures  #: mean, deviation, lowest, highest, expected_deviation, scale_error [K]; pixels, bins, law, ...

    def __repr__(self) -> str:
        return f"<plenoflame.Temperatures, {self.figures['mean']:.4g} K in {self.figures['pixels']} pixels>"

    @property
    def temperature(self) -> Array:
        """Of each pixel [K]; 0: none."""
        return self.light_field["temperature"]

    @property
    def error(self) -> Array | None:
        """Standard error of each [K]; None where the light field has none."""
        return self.light_field["temperature.error"] if "temperature.error" in self.light_field._data.arrays else None

    def _values(self):
        return self.temperature

    def _labelled(self, xarray):
        x, y, width, height = self.light_field.window
        return _home.labelled(xarray, self.temperature, "temperature", "K", {
            "row": (-numpy.arange(y, y + height), "row, upwards", ""), "column": (numpy.arange(x, x + width), "column", "")})

    def _summary(self):
        for name in ("mean", "deviation", "lowest", "highest"):
            yield name, f"{self.figures[name]:.4g} K"
        yield "pixels", self.figures["pixels"]
        yield "law", self.figures["law"]

    def _preview(self):
        return _home.small_picture(self.temperature, hot=True)


def exposed(field, exposure, channel_exposure, noise, noise_seed, frames, dark, channel, threads, as_electrons):
    """The library's object that has exposed a light field."""
    kinds = _check.names("noise", noise, "names of kinds of noise")
    for kind in kinds:
        _check.choice("kind of noise", kind, _NOISE)
    if channel_exposure is not None and exposure is not None:
        raise Error("exposure and channel_exposure exclude each other")
    if not (channel_exposure is None or isinstance(channel_exposure, dict)):
        raise Error(f"channel_exposure takes a dict of times by channels, not {channel_exposure!r}")
    sensor = made(_core.Sensor, input=field, channel=_check.text("channel", channel),
                  count=_check.whole("frames", frames, 1, 10000), light=not dark, as_electrons=as_electrons,
                  exposure=-1.0 if exposure is None else _check.seconds("exposure", exposure),
                  channel_exposure={name: _check.seconds("channel_exposure", time)
                                    for name, time in (channel_exposure or {}).items()},
                  noise_seed=None if noise_seed is None else _check.whole("noise_seed", noise_seed, 0, 2 ** 63 - 1),
                  threads=_check.threads(threads), **{kind: kind in kinds for kind in _NOISE})
    return update(sensor)


def temperatures(field, channels, filters, law, exponent, threshold, least_signal, bin, cells):
    """The library's object that has found the temperatures of a light field."""
    pyrometry = made(_core.Pyrometry, input=field, law=_check.choice("law", law, _LAWS) or "",
                     channels=_check.names("channels", channels, "names of channels"),
                     filters=_check.names("filters", filters, "names of filters"),
                     exponent=_check.number("exponent", exponent, -20, 20),
                     threshold=_check.number("threshold", threshold, 0, 1),
                     least_signal=_check.number("least_signal", least_signal, 0, 1e6))
    if bin in ("micro-image", "view"):
        pyrometry.cells = _check.whole("cells", cells, 1, 100) if bin == "view" else 1
    elif bin is not None:
        pyrometry.block = _check.whole("bin", bin, 1, 65536)
    return update(pyrometry)


def truth_of(field, points, rays, chief_rays, threads, progress):
    """The library's object that has found the ground truth of a light field."""
    truth = made(_core.Truth, input=field, rays=_check.whole("rays", rays, 1), chief_rays=bool(chief_rays),
                 points=[_check.several("points", point, 3, "points x, y, z in metres", _check.number) for point in points],
                 threads=_check.threads(threads))
    return update(truth, progress, "truth")


def corners_of(scene, rays, threads, progress):
    """Scene.corners()."""
    corners = made(_core.Corners, scene=scene, rays=_check.whole("rays", rays, 1), threads=_check.threads(threads))
    return Corners(*update(corners, progress, "corners").output)


def import_camera(files: Path | Sequence[Path], *, format: str | None = None,
                  values: Mapping[str, Any] | None = None) -> ImportedCamera:
    """The camera of calibration files of another tool, as `plenoflame camera import`. Returns ImportedCamera.

        camera = plenoflame.import_camera("intrinsics.js", values={"camera.sensor.pixel_pitch": "5.5 um"}).scene

    files: the name of a file, or several; what the first does not say, a later one may
    format: of which tool; None: the content says so
    values: values of the scene by their keys, which replace those of the files; camera.lens.f_number is one, too

    Raises Error, with all values that are missing.
    """
    names = [os.fspath(name) for name in ([files] if isinstance(files, (str, os.PathLike)) else files)]
    if not names:
        raise Error("files takes the name of a file, or several")
    if not (values is None or isinstance(values, dict)):
        raise Error(f"values takes a dict of values by their keys, not {values!r}")
    settings = [f"{key}={text_of(value)}" for key, value in (values or {}).items()]
    with errors_of():
        text, formats, notes, warnings = _core.import_camera(names, settings, "" if format is None else _check.text("format", format))
    from .scene import Scene
    return ImportedCamera(Scene(text=text, name="camera.toml"), formats, notes, warnings)
