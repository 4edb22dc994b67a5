"""Flames back from pictures of them."""

from __future__ import annotations

import functools
import json
import os
import pathlib
import tempfile
from typing import TYPE_CHECKING

import numpy

from . import _check, _core, _home
from ._options import Settings, cameras_of
from ._run import Error, errors_of, made, update
from .flame import Flame
from .light_field import LightField, read_light_field
from .scene import OPERATOR


if TYPE_CHECKING:
    from typing import Any, Mapping, Sequence

    from ._types import Array, Path, Progress
    from .operators import Operator
    from .scene import Scene

    Image = LightField | Path

_FIELDS = ("emission", "temperature", "absorption")
_DIMENSIONS = {"voxels": 3, "rings": 2, "layers": 1}


def _field(name, about):
    return property(lambda self: self._fields.get(name), doc=about)


class Reconstruction(_home.AtHome):
    """What reconstruct() found. Fields are numpy arrays over the unknowns, e.g. (rings, heights) or (x, y, z), and None
    where they are not known:

    temperature [K] (0: none), absorption [1/m], emission [W/(m^3 sr)], each with NAME_deviation; resolved: 1 where the
    pictures decide, 0 where the penalty does; resolved_absorption.

    numpy.asarray(found) is the temperature, or else the emission: of rings upright (heights from the top, radii), of voxels
    [x, y, z]. to_xarray() is a Dataset of all fields: rings with the axes z, r, voxels with z, y, x.
    """

    def __init__(self, algorithm: Any, unknowns: str) -> None:
        self._algorithm = algorithm  # None when unpickled
        self.unknowns: str = unknowns  #: "voxels", "rings" or "layers"
        self.complete: bool = algorithm.complete  #: False when it was stopped early: what was reached by then
        self.flame: Flame = Flame(algorithm.output)  #: the fields on voxels, as Scene.add_flame takes it
        self.figures: dict[str, Any] = json.loads(algorithm.figures)  #: as `plenoflame reconstruct --json` prints them
        self.report: str = algorithm.report  #: the same as text, a line each
        shape = algorithm.shape
        while len(shape) > 1 and shape[-1] == 1:
            shape.pop()
        self.shape: tuple[int, ...] = tuple(shape)  #: unknowns along each axis
        self._fields = {name: values.reshape(self.shape) for name, values in algorithm.fields.items()}

    def __repr__(self) -> str:
        state = "" if self.complete else ", stopped early"
        return f"<plenoflame.Reconstruction, {' x '.join(map(str, self.shape))} unknowns: {', '.join(self._fields)}{state}>"

    def _main(self):
        return next(name for name in ("temperature", *self._fields) if name in self._fields)

    def _values(self):
        values = self._fields[self._main()]
        return values.T[::-1] if self.unknowns == "rings" and values.ndim == 2 else values

    def _labelled(self, xarray):
        full = (*self.shape, *(1,) * (_DIMENSIONS[self.unknowns] - len(self.shape)))
        places = self.places.reshape(*full, 3)
        if self.unknowns == "voxels":
            axes = {name: (places[(slice(None), 0, 0) if k == 0 else (0, slice(None), 0) if k == 1 else (0, 0)][..., k], name, "m")
                    for k, name in enumerate("xyz")}
        elif self.unknowns == "rings":
            along = places[0] - places[0, 0]
            stands = not along[:, :2].any()
            axes = {"r": (numpy.linalg.norm(places[:, 0] - places[0, 0], axis=-1), "distance from the axis", "m"),
                    "z": (places[0, :, 2], "z", "m") if stands
                    else (numpy.linalg.norm(along, axis=-1), "height above the lowest ring", "m")}
        else:
            axes = {"layer": (numpy.arange(full[0]) / full[0], "share of the outermost layer's semi-axes", "")}
        backwards = dict(reversed(axes.items()))  # z up in the plot
        return xarray.Dataset({name: _home.labelled(xarray, values.reshape(full).transpose(), name, _home.unit_of(name), backwards)
                               for name, values in self._fields.items()})

    def _summary(self):
        yield "unknowns", f"{' x '.join(map(str, self.shape))}, {self.unknowns}"
        for name, values in self._fields.items():
            yield name.replace("_", " "), _home.span(values, _home.unit_of(name))
        yield "chi^2 per row", f"{self.figures['chi_squared']:.4g}"
        yield "iterations", self.figures["iterations"]
        if not self.complete:
            yield "state", "stopped early"
        if "warning" in self.figures:
            yield "warning", self.figures["warning"]

    def _preview(self):
        values = self._values()
        if values.ndim == 1:
            return None
        return _home.small_picture(values.max(1).T[::-1] if values.ndim == 3 else values, hot=self._main() == "temperature")

    def __getstate__(self) -> dict[str, Any]:
        """All of it, with the file that save() writes in place of the algorithm."""
        places, residuals, explained = self.places, self.residuals, self.explained
        return {**vars(self), "_algorithm": None, "_file": self._content(), "places": places, "residuals": residuals,
                "explained": explained}

    def _content(self):
        """The bytes of the .vdb file."""
        if self._algorithm is None:
            return self._file
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "found.vdb")
            with errors_of(self._algorithm):
                self._algorithm.write(path)
            return pathlib.Path(path).read_bytes()

    temperature: Array | None = _field("temperature", "[K]; 0: what emits next to nothing has none.")
    temperature_deviation: Array | None = _field("temperature_deviation", "[K] standard deviation.")
    absorption: Array | None = _field("absorption", "[1/m]")
    absorption_deviation: Array | None = _field("absorption_deviation", "[1/m] standard deviation, where it was solved for.")
    emission: Array | None = _field("emission", "[W/(m^3 sr)] into the channel.")
    emission_deviation: Array | None = _field("emission_deviation", "[W/(m^3 sr)] standard deviation.")
    resolved: Array | None = _field("resolved", "Diagonal of the resolution matrix, 0 to 1.")
    resolved_absorption: Array | None = _field("resolved_absorption", "The same of the absorption, where it was solved for.")

    @functools.cached_property
    def places(self) -> Array:
        """Place of each unknown in the world [m]: shape + (3,)."""
        return self._algorithm.places.reshape((*self.shape, 3))

    @property
    def history(self) -> Array:
        """chi^2 per row, iteration by iteration."""
        return numpy.array(self.figures["history"])

    @functools.cached_property
    def residuals(self) -> list[Array]:
        """What the flame does not explain of each picture [W]: arrays (rows, columns), of the cameras of the first channel,
        then of the second."""
        return self._algorithm.residuals

    @functools.cached_property
    def explained(self) -> list[Array]:
        """What it does [W]."""
        return self._algorithm.explained

    def save(self, path: Path) -> None:
        """Writes the grids as `plenoflame reconstruct -o` does. Raises Error."""
        name = _check.file(path, ".vdb")
        if self._algorithm is None:
            pathlib.Path(name).write_bytes(self._file)
            return
        with errors_of(self._algorithm):
            self._algorithm.write(name)


def _set_earlier(algorithm, use, result):
    """A file's name is an option; of a Reconstruction the fields are handed over."""
    if result is None or isinstance(result, (str, os.PathLike)):
        return None if result is None else os.fspath(result)
    if not isinstance(result, Reconstruction):
        raise Error(f"{use} takes a Reconstruction or the name of a file, not {result!r}")
    with errors_of(algorithm):
        for name in _FIELDS:
            values = getattr(result, name)
            if values is not None:
                algorithm.set_earlier(use, name, values.ravel())
    return None


def _pictures_of(images, scenes):
    """[(LightField, name)] in the order of the cameras."""
    if isinstance(images, dict):
        names = [scene.camera_name for scene in scenes]
        if set(images) != set(names):
            raise Error(f"images has pictures of {', '.join(map(repr, images))}; the cameras are {', '.join(map(repr, names))}")
        images = [images[name] for name in names]
    elif not isinstance(images, (list, tuple)):
        images = [images]
    if len(images) != len(scenes):
        raise Error(f"{len(scenes)} cameras but {len(images)} pictures: each camera needs one of its own")
    found = []
    for number, image in enumerate(images, 1):
        if isinstance(image, (str, os.PathLike)):
            found.append((read_light_field(image), os.fspath(image)))
        elif isinstance(image, LightField):
            found.append((image, "the picture" if len(images) == 1 else f"picture {number}"))
        else:
            raise Error(f"images takes LightFields or names of files, not {image!r}")
    return found


def _with_operator(algorithm, operator, settings):
    """The settings with those of an operator."""
    if not hasattr(operator, "grid_shape"):
        raise Error(f"operator takes one of Scene.operator(), not {operator!r}")
    own = operator.settings
    for name, value in settings.items():
        there = own.get(name, OPERATOR.rows[name][2]) if name in OPERATOR.rows else value
        if value is not None and value != there:
            raise Error(f"{name} is that of the operator, {there!r}, not {value!r}")
    algorithm.set_built(operator._algorithm)
    return {**settings, **own}


_SETTINGS = Settings(_core.reconstruct_settings(), prior="Reconstruction | Path", start="Reconstruction | Path",
                     basis="str | None", bin="int | str", refine="str | Sequence[str]")


@_SETTINGS.arguments_of
def reconstruct(scene: Scene | Sequence[Scene], images: Image | Sequence[Image] | Mapping[str, Image], *,
                operator: Operator | None = None, threads: int = 0, progress: Progress | None = None, **settings: Any) -> Reconstruction:
    """The flame back from pictures of it, as `plenoflame reconstruct` (docs/reconstruct.md), whose options these are.

        found = plenoflame.reconstruct(scene, scene.render(512), unknowns="rings", grid=(16, 32), absorption="scene")
        found.temperature, found.temperature_deviation
        scene.add_flame(found.flame)

    scene: a Scene, or several; all cameras of each, or the one that is chosen
    images: a LightField or the name of its file, a list of them in the order of the cameras, or a dict by their names
    start, prior: a Reconstruction or a file; lengths are in metres, or texts with units; absorption in 1/m

    {settings}

    operator: one that Scene.operator() has made of these cameras. Its unknowns, rows and rays are used, so that several pictures
    need them once; and its matrix, if A.matrix was asked for

    Returns Reconstruction; if `progress` ended the run early, with what was reached until then. Raises Error with the sentence
    of the command. Ctrl-C raises KeyboardInterrupt; what was reached by then is its `reconstruction` (None: nothing yet).
    """
    algorithm = made(_core.Reconstruction, threads=_check.threads(threads))
    scenes = cameras_of(scene)
    pictures = _pictures_of(images, scenes)
    if operator is not None:
        settings = _with_operator(algorithm, operator, settings)
    for use in ("start", "prior"):
        settings[use] = _set_earlier(algorithm, use, settings.get(use))
    _SETTINGS.set(algorithm, settings)
    for one, (picture, name) in zip(scenes, pictures):
        algorithm.add_camera(one._scene, picture._data, name)
    unknowns = settings.get("unknowns", "voxels")
    try:
        update(algorithm, progress, "reconstruct")
    except KeyboardInterrupt as interrupt:
        interrupt.reconstruction = Reconstruction(algorithm, unknowns) if algorithm.has_result else None
        raise
    if not algorithm.has_result:
        raise Error("stopped before there was a result")
    return Reconstruction(algorithm, unknowns)
