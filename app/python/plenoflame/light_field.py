"""Light fields, and the pictures that are made of them."""

from __future__ import annotations

import json
import os
import re
import threading
from typing import TYPE_CHECKING, NamedTuple

import numpy

from . import _check, _core, _home
from ._run import Error, made, update
from .measurements import Frames, MicroImages, Projections, Temperatures, Truth, exposed, temperatures, truth_of


if TYPE_CHECKING:
    from typing import Any, Iterable, Iterator, Sequence

    from ._types import Array, Path, Progress

_RESAMPLINGS = ("nearest", "barycentric", "paper9", "paper10")


class LightField(_home.AtHome):
    """The raw image of a plenoptic camera: radiant flux per pixel [W].

    Arrays are numpy views (rows, columns), row 0 at the top: what is written to them is what develop(), views() and the
    others see.

    numpy.asarray(light_field) is the flux of a single channel (rows, columns), in the same memory; of several it is a copy
    (rows, columns, channels). to_xarray() has the axes row, column, channel; places
    on the sensor count from its middle, x to the right of the picture.
    """

    def __init__(self, field: Any, relative_error: float = -1.0) -> None:
        """The library's light field; Scene.render(), read_light_field() and from_vtk() make it."""
        if not isinstance(field, _core.LightField):
            raise Error(f"field takes a light field of the library, not {type(field).__name__}; LightField.from_vtk() takes a "
                        "vtkImageData")
        self._data = field
        self.relative_error: float = relative_error  #: estimated relative RMSE over lit pixels; -1: not known
        self._filters = {}
        self._filtering = threading.Lock()  # a filter serves one thread at a time

    @staticmethod
    def from_vtk(image: Any) -> LightField:
        """A copy of a vtkImageData that is a light field, as to_vtk(), vtkPlenoflameLightFieldSource and
        vtkPlenoflameLightFieldReader give it. Raises Error."""
        from ._vtk import image_to_light_field
        return _light_field_of(image_to_light_field(image))

    def to_vtk(self) -> Any:
        """The same as a vtkImageData, an input for the filters of plenoflame.vtk. Its rows run upwards, as VTK's do, so it is a
        copy. Raises Error without VTK."""
        from ._vtk import light_field_to_image
        return light_field_to_image(self._data.state)

    def __reduce__(self) -> tuple[Any, ...]:
        return _light_field_of, (self._data.state, self.relative_error)

    def copy(self) -> LightField:
        """An independent copy."""
        return _light_field_of(*self.__reduce__()[1])

    def __repr__(self):
        rows, columns = self.flux.shape
        return f"<plenoflame.LightField, {columns} x {rows} pixels, channels {', '.join(self.channels)}>"

    def _values(self):
        return self.flux if len(self.channels) == 1 else self._stack()

    def _stack(self):
        """(rows, columns, channels)"""
        return numpy.stack([self[name] for name in self.channels], -1) if len(self.channels) > 1 else self.flux[..., None]

    def _labelled(self, xarray):
        sensor = _camera_of(self.scene_text)
        x, y, width, height = self.window
        pitch = float(sensor["camera.sensor.pixel_pitch"])
        pitch_y = float(sensor["camera.sensor.pixel_pitch_y"]) or pitch
        return _home.labelled(xarray, self._stack(), "flux", self.unit, {
            "row": (-_home.middles(sensor.rows, pitch_y)[y:y + height], "height on the sensor", "m"),
            "column": (_home.middles(sensor.columns, pitch)[x:x + width], "x on the sensor", "m"),
            "channel": (self.channels, "channel", "")})

    def _summary(self):
        x, y, width, height = self.window
        yield "pixels", f"{width} x {height}" + (f", from column {x}, row {y} of the sensor" if (x, y) != (0, 0) else "")
        for name in self.channels:
            yield name, f"{self[name].sum(dtype=float):.4g} {self.unit}, at most {self[name].max():.4g} {self.unit} a pixel"
        if self.relative_error >= 0:
            yield "error", f"{100 * self.relative_error:.3g} % of a lit pixel"
        if self.layers:
            yield "layers", ", ".join(self.layers)
        if not self.complete:
            yield "state", "stopped early"

    def _preview(self):
        return _home.small_picture(self.flux)

    channels: list[str] = _home.attribute("channels", "Names of the channels.")
    unit: str = _home.attribute("unit", "'W', and 'e-' or 'DN' of pictures that were imported so.")
    scene_text: str = _home.attribute("scene_text", "The scene that it was rendered from, as TOML.")
    window: tuple[int, ...] = _home.attribute("window", "The part of the sensor that it holds: (x, y, width, height) from the top left.")
    complete: bool = _home.attribute("complete", "False when the run was ended early.")

    def __getitem__(self, channel: str) -> Array:
        """Flux [W] of a channel by its name; NAME.error is its standard error; a layer by its name."""
        arrays = self._data.arrays
        if channel not in arrays:
            raise Error(f"the image has no array '{channel}'; it has {', '.join(arrays) or 'none'}")
        return arrays[channel]

    layers: list[str] = _home.attribute(
        "layers", "Names of further layers, 'truth.distance' among them (Scene.render with truth=True); read one as light_field['truth.distance'].")

    def __setitem__(self, channel: str, values: Any) -> None:
        """Writes new values into the memory of a channel or layer."""
        place = self[channel]
        place[...] = _check.array(channel, values, place.shape)

    @property
    def flux(self) -> Array:
        """Flux [W] of the first channel."""
        return self[self.channels[0]]

    @flux.setter
    def flux(self, values: Any) -> None:
        self[self.channels[0]] = values

    @property
    def error(self) -> Array:
        """Standard error [W] of the first channel's flux."""
        return self[self.channels[0] + ".error"]

    @error.setter
    def error(self, values: Any) -> None:
        values = _check.array("error", values, self.flux.shape)
        self._data.add_error()  # where there was none
        self[self.channels[0] + ".error"] = values

    def save(self, path: Path) -> None:
        """Writes the light field as EXR."""
        update(made(_core.LightFieldWriter, input=self._data, path=_check.file(path, ".exr", "; develop() makes a picture of it")))

    def _filter(self, kind, **attributes):
        """Kept, since a filter remembers the micro-images of the camera."""
        if kind not in self._filters:
            self._filters[kind] = made(kind, input=self._data)
        for name, value in attributes.items():
            setattr(self._filters[kind], name, value)
        return self._filters[kind]

    def develop(self, *, saturation: float = 0.0, bits: int = 14, curve: str = "display", channel: str = "",
                colour: bool = False) -> Array:
        """The picture: numpy array (rows, columns) of uint16. expose() and electrons() have the sensor's noise.

        saturation: flux [W] that gives the largest value; 0: 99.9 % of the lit pixels do not exceed it
        curve: "display" (sRGB) or "linear"
        colour: in colour, sRGB: (rows, columns, 3) of uint8; from channels with the responses cie_x, cie_y and cie_z, or else the
        first three as red, green and blue
        """
        if colour:
            picture = made(_core.Colour, input=self._data, saturation=_check.number("saturation", saturation, 0))
            return update(picture).output
        curve = _check.choice("curve", curve, ("linear", "display"))
        attributes = {"saturation": _check.number("saturation", saturation, 0), "bits": _check.whole("bits", bits, 1, 16),
                      "curve": getattr(_core.ToneCurve, curve), "channel": _check.text("channel", channel)}
        with self._filtering:
            return update(self._filter(_core.Develop, **attributes)).output

    def expose(self, exposure: str | float | None = None, *, noise: str | Sequence[str] = ("shot", "read", "dark", "defects"),
               noise_seed: int | None = None, frames: int = 1, dark: bool = False, channel: str = "", threads: int = 0) -> Frames:
        """Frames of camera.sensor, as `plenoflame develop --sensor` writes them. Returns Frames.

        exposure: [s], or a text with a unit; "auto": 99.9 % of the lit pixels are below the full well; None: the sensor's
        noise: the kinds that are simulated; noise_seed: None: the sensor's
        frames: their number, each with its own noise; dark: frames without light
        channel: "": the first; a sensor with a mosaic takes the first three

        Raises Error.

            >>> import plenoflame
            >>> field = plenoflame.Scene("small.toml").render(samples=2)
            >>> frames = field.expose("auto", frames=2)
            >>> frames.numbers.shape, frames.numbers.dtype
            ((2, 60, 60), dtype('uint16'))
        """
        return Frames(*exposed(self._data, exposure, None, noise, noise_seed, frames, dark, channel, threads, False).output)

    def electrons(self, exposure: str | float | None = None, *, channel_exposure: dict[str, str | float] | None = None,
                  noise: str | Sequence[str] = ("shot", "read", "dark", "defects"), noise_seed: int | None = None,
                  dark: bool = False, threads: int = 0) -> LightField:
        """The electrons of all channels in one frame, and their errors: a LightField with the unit "e-", as `plenoflame develop
        -o FILE.exr` writes it. Arguments as of expose().

        channel_exposure: {channel: exposure}, in place of exposure
        """
        return LightField(exposed(self._data, exposure, channel_exposure, noise, noise_seed, 1, dark, "", threads, True).electrons)

    def pyrometry(self, *, channels: str | Sequence[str] = (), filters: str | Sequence[str] = (), law: str | None = None,
                  exponent: float = 1.0, threshold: float = 0.01, least_signal: float = 2.0, bin: int | str | None = None,
                  cells: int = 3) -> Temperatures:
        """Temperatures from the ratio of two channels, or of two filters in the pupil, as `plenoflame pyrometry`. Returns
        Temperatures.

        channels: two names; none: the first two; filters: two names of camera.pupil_filters, in place of channels
        law: absorption against wavelength: "grey", "soot" (1/wavelength), "power" (wavelength^-exponent); None: that of the
        scene's flames
        threshold: least share of the largest value that gives a temperature; least_signal: least light, in standard errors
        bin: what is added before the ratio: None, N for blocks of N x N pixels, "micro-image", or "view" for cells x cells parts
        of each micro-image

        Raises Error.
        """
        found = temperatures(self._data, channels, filters, law, exponent, threshold, least_signal, bin, cells)
        return Temperatures(LightField(found.output), found.figures)

    def truth(self, points: Iterable[tuple[float, float, float]] = (), *, rays: int = 4096, chief_rays: bool = False,
              threads: int = 0, progress: Progress | None = None) -> Truth:
        """Ground truth of the raw image by its camera, as `plenoflame truth`. Returns Truth.

        points: (x, y, z) in the world [m], which are projected through all microlenses that see them
        rays: over the aperture, for the centroids of each point
        chief_rays: whether each pixel's chief ray is found, too: layers chief.x, .y, .z [m] and chief.dx, .dy, .dz

        Raises Error.
        """
        found = truth_of(self._data, points, rays, chief_rays, threads, progress)
        return Truth(MicroImages(*found.micro_images), Projections(*found.projections),
                     LightField(found.with_rays) if chief_rays else None)

    def views(self, grid: int = 7, *, spread: float = 0.7, resampling: str = "barycentric", white_correction: bool = True,
              channel: str = "", threads: int = 0, progress: Progress | None = None) -> Views:
        """Sub-aperture views: the scene from grid x grid places on the main lens. Returns Views.

        progress: True for a bar, or a function that is called with the fraction done; so of refocus() and focus_stack()

            >>> import plenoflame
            >>> views = plenoflame.Scene("small.toml").render(samples=2).views(3)
            >>> len(views), views[1, 1].shape == views[0, 2].shape
            (9, True)
        """
        attributes = {"resampling": getattr(_core.Resampling, _check.choice("resampling", resampling, _RESAMPLINGS)),
                      "grid": _check.whole("grid", grid, 1, 99), "spread": _check.number("spread", spread, 0, 1),
                      "white_correction": bool(white_correction), "channel": _check.text("channel", channel),
                      "threads": _check.threads(threads)}
        with self._filtering:
            views, sheet = update(self._filter(_core.Views, **attributes), progress, "views").output
            return Views(views, sheet, grid, "W/(m^2 sr)" if white_correction else "W", spread, self.scene_text)

    def _refocusing(self, kind, width, aperture, channel, threads):
        return self._filter(kind, width=_check.whole("width", width, 0, 20000),
                            aperture=_check.number("aperture", aperture, 1e-3, 1), channel=_check.text("channel", channel),
                            threads=_check.threads(threads))

    def refocus(self, depth: float, *, width: int = 0, aperture: float = 1.0, channel: str = "", threads: int = 0,
                progress: Progress | None = None) -> Refocused:
        """The picture focused on the plane at `depth` [m] in front of the main lens. Returns Refocused.

            >>> import plenoflame
            >>> plenoflame.Scene("small.toml").render(samples=2).refocus(1.0, width=20).image.shape[1]
            20
        """
        depth = _check.number("depth", depth)
        with self._filtering:
            refocus = self._refocusing(_core.Refocus, width, aperture, channel, threads)
            refocus.depth = depth
            update(refocus, progress, "refocus")
            return Refocused(refocus.output, depth, refocus.pixel, refocus.corner)

    def focus_stack(self, depths: Sequence[float], *, width: int = 0, aperture: float = 1.0, channel: str = "", threads: int = 0,
                    progress: Progress | None = None) -> FocusStack:
        """Pictures at several depths [m], ascending, at least three, and the one that is sharp everywhere. Returns
        FocusStack."""
        try:
            depths = [_check.number("depths", depth) for depth in depths]
        except TypeError:
            raise Error(f"depths takes a list of depths in metres, not {depths!r}") from None
        with self._filtering:
            stack = self._refocusing(_core.FocusStack, width, aperture, channel, threads)
            stack.depths = depths
            return FocusStack(*update(stack, progress, "focus stack").output, depths)

    def export(self, folder: Path, format: str = "npz", *, name: str = "lightfield", grid: int = 0, channel: str = "",
               channels: str | Sequence[str] = ()) -> Export:
        """Writes the files of another tool, as `plenoflame export`, all of them or none.

        folder: made when missing, else it must be empty; format: one of export_formats(); name: stem of the files;
        grid: views along each side, for formats of views; 0: as the tool expects
        channel: of grey pictures; channels: red, green and blue of colour pictures. With neither, pictures have the colours
        that the scene's channels are, where the tool knows colour; else they are grey, of the first channel

        Returns Export, with the names of the files and what should be known about them. Raises Error.
        """
        format = _check.choice("format", format, export_formats())
        stem = _check.text("name", name)
        if not stem or "/" in stem:
            raise Error("name: a name without folders; the folder is given with folder")
        channels = _check.names("channels", channels, "three names of channels")
        writer = made(_core.Export, input=self._data, folder=os.fspath(folder), format=format, name=stem,
                      grid=_check.whole("grid", grid, 0, 99), channel=_check.text("channel", channel), channels=",".join(channels))
        return Export(*update(writer).output)

    def compare(self, reference: LightField, *, channel: str = "") -> dict[str, Any]:
        """Error and bias against another light field that this one should equal: a dict of the figures that
        `plenoflame compare --json` prints, in SI units. Raises Error."""
        if not isinstance(reference, LightField):
            raise Error(f"reference takes a LightField, not {reference!r}")
        comparison = made(_core.Comparison, input=self._data, reference=reference._data, channel=_check.text("channel", channel))
        return json.loads(update(comparison).figures)


def _camera_of(text):
    """The camera that a light field was taken with, as a Scene without anything else. It opens no file: where the text names
    one, it is left out."""
    from .scene import Scene
    parts = [part for part in re.split(r"(?m)^(?=\[)", text) if part.startswith(("[camera", "[[camera"))]
    return Scene(text=re.sub(r"(?m)^.*\b(file|preset|filter)\b *=.*$", "", "".join(parts)))


def _light_field_of(state, relative_error=-1.0):
    return LightField(_core.LightField.from_state(state), relative_error)


def export_formats() -> list[str]:
    """Names of the formats of LightField.export."""
    return _core.export_formats()


class Export(NamedTuple):
    """What LightField.export wrote: names of files, and notes."""

    files: list[str]
    notes: list[str]


class Views(_home.AtHome):
    """Sub-aperture views; indexed [row, column] of the grid, each a numpy array (rows, columns).

    numpy.asarray(views) is all of them in the same memory, [row, column of the grid, row, column of the view]. to_xarray() has
    the axes u, v (x and height on the main lens) and y, x (on the microlens array, from the middle of the view).
    """

    def __init__(self, views: list[Array], sheet: Array, grid: int, unit: str, spread: float, scene_text: str) -> None:
        self.grid: int = grid
        self.unit: str = unit
        self.sheet: Array = sheet  #: all of them side by side
        self._views = numpy.stack(views).reshape(grid, grid, *views[0].shape)
        self._spread = spread
        self._scene_text = scene_text

    def __repr__(self) -> str:
        rows, columns = self._views.shape[2:]
        return f"<plenoflame.Views, {self.grid} x {self.grid} views of {columns} x {rows} pixels, {self.unit}>"

    def _values(self):
        return self._views

    def _labelled(self, xarray):
        camera = _camera_of(self._scene_text)
        # Row by row in the grid: to the right and down.
        pupil = self._spread * camera.design()["entrance_pupil_m"][1]
        places = _home.middles(self.grid, pupil / self.grid)
        step = float(camera["camera.array.pitch"]) * (0.75 ** 0.25 if camera["camera.array.lattice"] == "hexagonal" else 1)
        rows, columns = self._views.shape[2:]
        return _home.labelled(
            xarray, self._views.transpose(1, 0, 2, 3), "radiance" if "sr" in self.unit else "flux", self.unit, {
                "u": (places, "x on the main lens", "m"),
                "v": (-places, "height on the main lens", "m"),
                "y": (-_home.middles(rows, step), "height on the microlens array", "m"),
                "x": (_home.middles(columns, step), "x on the microlens array", "m")})

    def _summary(self):
        rows, columns = self._views.shape[2:]
        return [("views", f"{self.grid} x {self.grid}"), ("pixels of each", f"{columns} x {rows}"),
                ("values", _home.span(self._views, self.unit))]

    def _preview(self):
        return _home.small_picture(self.sheet)

    def __getitem__(self, place: tuple[int, int]) -> Array:
        row, column = place
        if not (0 <= row < self.grid and 0 <= column < self.grid):
            raise IndexError(f"view {row}, {column} of {self.grid} x {self.grid}")
        return self._views[row, column]

    def epipolar(self, *, row: int | None = None, column: int | None = None) -> Array:
        """Epipolar slice: one row (or column) of the scene as the viewpoint moves along the middle row (column) of the
        grid, a view per row of the slice. What stands at one depth draws straight lines; their slope is the
        disparity."""
        if (row is None) == (column is None):
            raise Error("epipolar takes either a row or a column")
        middle = (self.grid - 1) // 2
        if row is not None:
            row = _check.whole("row", row, 0, self[0, 0].shape[0] - 1)
            return numpy.stack([self[middle, v][row] for v in range(self.grid)])
        column = _check.whole("column", column, 0, self[0, 0].shape[1] - 1)
        return numpy.stack([self[v, middle][:, column] for v in range(self.grid)])

    def __len__(self) -> int:
        return self.grid ** 2

    def __iter__(self) -> Iterator[Array]:
        return iter(self._views.reshape(-1, *self._views.shape[2:]))


class Refocused(_home.AtHome):
    """A refocused picture. numpy.asarray(refocused) is its image, in the same memory; to_xarray() has the axes y, x."""

    def __init__(self, image: Array, depth: float, pixel: float, corner: Sequence[float] = (0.0, 0.0)) -> None:
        self.image: Array = image  #: radiance [W/(m^2 sr)], numpy array (rows, columns)
        self.depth: float = depth  #: [m] in front of the main lens
        self.pixel: float = pixel  #: [m] side of a pixel on the object plane
        self.corner: tuple[float, ...] = tuple(corner)  #: [m] upper left corner of the picture on that plane, in the camera's x and y

    @property
    def x(self) -> Array:
        """Camera's x of the columns' middles on the object plane [m], to the right."""
        return self.corner[0] + (numpy.arange(self.image.shape[1]) + 0.5) * self.pixel

    @property
    def y(self) -> Array:
        """Camera's y of the rows' middles on the object plane [m], downwards."""
        return self.corner[1] + (numpy.arange(self.image.shape[0]) + 0.5) * self.pixel

    def __repr__(self) -> str:
        rows, columns = self.image.shape
        return f"<plenoflame.Refocused, {columns} x {rows} pixels, {self.depth:g} m in front of the main lens>"

    def _values(self):
        return self.image

    def _labelled(self, xarray):
        return _home.labelled(xarray, self.image, "radiance", "W/(m^2 sr)", {
            "y": (-self.y, "height on the plane in focus", "m"), "x": (self.x, "x on the plane in focus", "m")})

    def _summary(self):
        rows, columns = self.image.shape
        return [("pixels", f"{columns} x {rows}"), ("focused on", f"{self.depth:.4g} m"),
                ("pixel there", f"{1e3 * self.pixel:.4g} mm"), ("values", _home.span(self.image, "W/(m^2 sr)"))]

    def _preview(self):
        return _home.small_picture(self.image)


class FocusStack:
    """Pictures at several depths, and what they tell together. All have the same size, and a pixel stands for the same
    direction in each."""

    def __init__(self, all_in_focus: Array, depth: Array, confidence: Array, planes: list[Array], depths: list[float]) -> None:
        self.all_in_focus: Array = all_in_focus  #: radiance [W/(m^2 sr)] at the depth that fits best, pixel by pixel
        self.depth: Array = depth  #: [m] for opaque scenes: a flame is transparent and has no single depth
        self.confidence: Array = confidence  #: 0: all depths fit alike; towards 1: one fits much better
        self.planes: list[Array] = planes  #: the pictures at `depths`, radiance
        self.depths: list[float] = depths  #: [m]


def read_light_field(path: Path) -> LightField:
    """Reads a light field (.exr) that Plenoflame wrote. Raises Error."""
    return LightField(update(made(_core.LightFieldReader, path=os.fspath(path))).output)


def merge(pictures: Iterable[LightField | Path]) -> LightField:
    """One light field of several: parts of one picture, windows side by side, or the mean of different seeds, as `plenoflame merge`.

        plenoflame.merge([scene.render(64, seed=1), scene.render(64, seed=2)]).error

    pictures: LightFields, or names of files, of one scene

    Raises Error.
    """
    inputs = []
    for number, picture in enumerate(pictures, 1):
        if isinstance(picture, LightField):
            inputs.append((f"picture {number}", picture._data))
        elif isinstance(picture, (str, os.PathLike)):
            inputs.append((os.fspath(picture), None))
        else:
            raise Error(f"pictures takes LightFields or names of files, not {picture!r}")
    return LightField(update(made(_core.Merge, inputs=inputs)).output)
