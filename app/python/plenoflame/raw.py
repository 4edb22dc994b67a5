"""Light fields and calibrations of a real camera's pictures."""

from __future__ import annotations

import io
import json
import os
from typing import TYPE_CHECKING, NamedTuple

import numpy

from . import _check, _core
from ._options import Settings, lengths
from ._run import Error, errors_of, made, update
from ._values import text_of
from .light_field import LightField
from .scene import Scene


if TYPE_CHECKING:
    from typing import Any, Mapping, Sequence

    from ._types import Array, Files, Path, Progress, Table


class Imported(NamedTuple):
    """What import_raw() made: a LightField, and a dict of the figures that `plenoflame import --json` prints."""

    light_field: LightField
    figures: dict[str, Any]


class White(NamedTuple):
    """What calibrate_white() found: a Scene with the array (None: the size of a pixel is not known); arrays with named
    columns, of all micro-images and of radii by f-number (None: of one); a dict of figures."""

    scene: Scene | None
    centres: Array
    radii: Array | None
    figures: dict[str, Any]


class Radiometry(NamedTuple):
    """What calibrate_radiometry() found: the text of the file that import_raw() takes as radiometry, and a dict of figures."""

    text: str
    figures: dict[str, Any]


class Boards(NamedTuple):
    """What calibrate_corners() found: an array with the columns pose, x, y (on the board [m]), column, row (in the picture
    [pixels]), q, r (the microlens), error, blur and blur_error [pixels], an entry for each corner; a dict of figures."""

    corners: Array
    figures: dict[str, Any]


class Geometry(NamedTuple):
    """What calibrate_geometry() found: a Scene with the camera; arrays with named columns, of the boards' places (pose,
    rms_pixel, x, y, z [m], r00 to r22: board to camera) and of what the fit leaves of each corner (residual_column, residual_row [pixels],
    NaN: left out); a dict of figures, in which values are the fitted ones with their errors."""

    scene: Scene
    poses: Array
    residuals: Array
    figures: dict[str, Any]


class Rig(NamedTuple):
    """What calibrate_rig() found: a Scene with all cameras, in the first one's world, and a dict of figures."""

    scene: Scene
    figures: dict[str, Any]

_RAW, _WHITE, _RADIOMETRY, _BOARDS, _GEOMETRY, _RIG = (Settings(kind.settings(), centres="Table", radii="Table") for kind in (
    _core.RawImport, _core.White, _core.Radiometry, _core.Boards, _core.Geometry, _core.Rig))
_CORNERS = ("pose", "x", "y", "column", "row")
_WITH_LENS = (*_CORNERS, "q", "r")
_WITH_BLUR = (*_WITH_LENS, "error", "blur", "blur_error")
_POSES = ("pose", "rms_pixel", "x", "y", "z", *(f"r{row}{column}" for row in range(3) for column in range(3)))


def _time(value):
    return lengths(value, "s")


def _label(key):
    """A key in front of files: a name, a number, or (temperature [K], time [s])."""
    if isinstance(key, tuple):
        return f"{lengths(key[0], 'K')}@{_time(key[1])}"
    return text_of(key)


def _path(value):
    if not isinstance(value, (str, os.PathLike)):
        raise Error(f"a picture is the name of a file, not {type(value).__name__}")
    return os.fspath(value)


def _labelled(values, text, label=_label):
    """Texts of a value, a list of them, or a dict of these: LABEL=TEXT then."""
    if isinstance(values, dict):
        return [f"{label(key)}={item}" for key, own in values.items() for item in _labelled(own, text)]
    return [text(value) for value in values] if isinstance(values, (list, tuple)) else [text(values)]


def _see(run, camera):
    """Gives an object of the library the camera."""
    if not isinstance(camera, Scene):
        raise Error(f"camera takes a Scene, not {camera!r}")
    run.camera = camera._scene


def _run(run, rows, camera, pictures, settings, progress, what):
    """Runs an object of the library. pictures: texts; settings: those of the caller."""
    if camera is not None or what != "white":
        _see(run, camera)
    if not pictures:
        raise Error(f"{'sources' if what == 'radiometry' else 'pictures'} names no picture")
    for file in pictures:
        run.add_picture(file)
    times = _time if what == "radiometry" else _label
    for name, value in settings.items():
        if rows.rows[name][4] and value is not None:
            settings[name] = _labelled(value, _time if name == "exposure_time" else _path, times)
        elif name in ("exposure_time", "temperature_error") and value is not None:
            settings[name] = lengths(value, "s" if name == "exposure_time" else "K")
    rows.set(run, settings)
    return update(run, progress, what)


def _table(text):
    return numpy.atleast_1d(numpy.genfromtxt(io.StringIO(text), delimiter=",", names=True)) if text else None


def _rows(name, table, *columns):
    """Rows of numbers of an array: one with named columns, or (n, as many as some of these have). columns: tuples of names."""
    table = numpy.asarray(table)
    if table.dtype.names:
        for names in columns:
            if set(names) <= set(table.dtype.names):
                used = table[table["used"] > 0] if "used" in table.dtype.names else table
                table = numpy.stack([numpy.atleast_1d(used[column]) for column in names], 1)
                break
        else:
            raise Error(f"{name} takes the columns {', '.join(columns[-1])}, not {', '.join(table.dtype.names)}")
    if table.ndim != 2 or table.shape[1] not in map(len, columns) or not len(table):
        raise Error(f"{name} takes an array of the shape {' or '.join(f'(n, {len(names)})' for names in columns)}, not {table.shape}")
    if not (table.dtype.kind in "iuf" and numpy.isfinite(table).all()):
        raise Error(f"{name} takes finite numbers")
    return table


@_RAW.arguments_of
def import_raw(pictures: Files, camera: Scene, *, threads: int = 0, progress: Progress | None = None, **settings: Any) -> Imported:
    """A light field of a real camera's pictures, as `plenoflame import`. Returns Imported.

        plenoflame.import_raw(["a.tif", "b.tif"], camera, dark="dark.tif", exposure_time=1e-3).light_field

    pictures: the name of a file, or several frames of one scene, which are averaged; or a dict of these by channels
    camera: a Scene with the camera and its channels
    Frames of corrections are a file or several, or dicts of these by channels; so are exposure times, [s] or texts with units

    {settings}

    Raises Error.
    """
    run = made(_core.RawImport, threads=_check.threads(threads))
    _run(run, _RAW, camera, _labelled(pictures, _path), settings, progress, "import")
    return Imported(LightField(run.output), json.loads(run.figures))


@_WHITE.arguments_of
def calibrate_white(pictures: Files, camera: Scene | None = None, *, threads: int = 0, progress: Progress | None = None,
                    **settings: Any) -> White:
    """The microlens array by white pictures, as `plenoflame calibrate white`. Returns White.

    pictures: the name of a file, or several, which are averaged; or a dict of these by f-numbers; or a .csv of centres
    camera: a Scene with what is known of the camera; None: nothing

    {settings}

    Raises Error.
    """
    run = made(_core.White, threads=_check.threads(threads))
    _run(run, _WHITE, camera, _labelled(pictures, _path), settings, progress, "white")
    scene, centres, radii = run.output
    return White(Scene(text=scene, name="camera.toml") if scene else None, _table(centres), _table(radii), json.loads(run.figures))


@_RADIOMETRY.arguments_of
def calibrate_radiometry(sources: Mapping[Any, Path | Sequence[Path]], camera: Scene, *, threads: int = 0, progress: Progress | None = None,
                         **settings: Any) -> Radiometry:
    """The energy of a count by pictures of a blackbody, as `plenoflame calibrate radiometry`. Returns Radiometry.

        found = plenoflame.calibrate_radiometry({(1700, 50e-6): "blackbody.tif"}, camera, dark="dark.tif")

    sources: a dict of files, or lists of them, by temperatures [K], or by (temperature, exposure time [s])
    camera: a Scene with the camera and its channels
    dark and white may be dicts by exposure times [s]

    {settings}

    Raises Error.
    """
    if not isinstance(sources, dict):
        raise Error(f"sources takes a dict of files by temperatures, not {sources!r}")
    run = made(_core.Radiometry, threads=_check.threads(threads))
    pictures = _labelled(sources, _path, lambda key: _label(key if isinstance(key, tuple) else lengths(key, "K")))
    _run(run, _RADIOMETRY, camera, pictures, settings, progress, "radiometry")
    return Radiometry(run.output, json.loads(run.figures))


@_BOARDS.arguments_of
def calibrate_corners(pictures: Path | Sequence[Path], camera: Scene, *, threads: int = 0, progress: Progress | None = None,
                      **settings: Any) -> Boards:
    """The corners of checkerboards, or dots, in the micro-images of raw pictures, as `plenoflame calibrate corners`. Returns Boards.

        found = plenoflame.calibrate_corners(["a.tif", "b.tif"], camera, board=(9, 6), cell=5e-3, white="white.tif")

    pictures: the name of a file, or several, of one board, each in a pose of its own, counted from 0
    camera: a Scene with the camera, as found by calibrate_white

    {settings}

    Lengths are in metres, or texts with units.

    Raises Error where no picture shows the board.
    """
    run = made(_core.Boards, threads=_check.threads(threads))
    _run(run, _BOARDS, camera, _labelled(pictures, _path), settings, progress, "corners")
    return Boards(_table(run.output), json.loads(run.figures))


@_GEOMETRY.arguments_of
def calibrate_geometry(corners: Table, camera: Scene, *, progress: Progress | None = None, **settings: Any) -> Geometry:
    """Distances, focal length and decentre by corners of a board that was seen in several poses, as `plenoflame calibrate geometry`.
    Returns Geometry.

        found = plenoflame.calibrate_geometry(boards.corners, camera, centres=white.centres, radii=white.radii)

    corners: of calibrate_corners; an array (n, 5) of pose, x, y on the board [m], column, row in pixels, (n, 7) with q, r of the
    microlens, or (n, 10) with error, blur and error of the blur [pixels]; or the name of a file of these. Pixel (0, 0) has its centre at
    (0.5, 0.5)
    camera: a Scene with the camera to start with: nominal values will do

    {settings}

    centres and radii are those of calibrate_white, arrays (n, 4) of q, r, column, row and of type, f-number, radius, error, or names of files

    Raises Error for values that the corners do not determine.
    """
    run = _core.Geometry()
    _see(run, camera)
    if isinstance(corners, (str, os.PathLike)):
        run.set_corners(os.fspath(corners))
    else:
        run.set_table("corners", _rows("corners", corners, _WITH_BLUR, _WITH_LENS, _CORNERS))
    for name, columns in (("centres", ("q", "r", "column", "row")), ("radii", ("type", "f_number", "radius", "error"))):
        if not isinstance(settings.get(name), (type(None), str, os.PathLike)):
            run.set_table(name, _rows(name, settings.pop(name), columns))
    _GEOMETRY.set(run, settings)
    scene, poses, residuals = update(run, progress, "geometry").output
    return Geometry(Scene(text=scene, name="camera.toml"), _table(poses), _table(residuals), json.loads(run.figures))


@_RIG.arguments_of
def calibrate_rig(cameras: Sequence[Geometry | tuple[Scene, Table]], *, progress: Progress | None = None, **settings: Any) -> Rig:
    """Places of several cameras, by boards that they have seen together, as `plenoflame calibrate rig`. Returns Rig.

        rig = plenoflame.calibrate_rig([left, right]).scene

    cameras: what calibrate_geometry returned of each; or pairs of a Scene and its poses, an array (n, 14) or the name of a file. A
    pose's number stands for one place of the board, and the first camera stays

    {settings}

    Lengths are in metres, or texts with units.

    Raises Error for cameras that have no pose in common.
    """
    run = _core.Rig()
    for number, camera in enumerate(cameras):
        scene, poses = camera[:2] if isinstance(camera, (tuple, list)) and len(camera) > 1 else (camera, None)
        if not isinstance(scene, Scene):
            raise Error(f"cameras[{number}] takes what calibrate_geometry() returned, or a Scene and its poses, not {camera!r}")
        is_file = isinstance(poses, (str, os.PathLike))
        with errors_of():
            run.add_camera(scene._scene, scene._name, os.fspath(poses) if is_file else _rows(f"cameras[{number}]", poses, _POSES))
    _RIG.set(run, settings)
    return Rig(Scene(text=update(run, progress, "rig").output, name="rig.toml"), json.loads(run.figures))
