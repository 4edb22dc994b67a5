"""Light fields and calibrations of a real camera's pictures."""

import collections
import io
import json
import os

import numpy

from . import _check, _core
from ._options import Settings, lengths
from ._run import Error, made, update
from ._values import text_of
from .light_field import LightField
from .scene import Scene

Imported = collections.namedtuple("Imported", "light_field figures")
Imported.__doc__ = "What import_raw() made: a LightField, and a dict of the figures that `plenoflame import --json` prints."

White = collections.namedtuple("White", "scene centres radii figures")
White.__doc__ = """What calibrate_white() found: a Scene with the array (None: the size of a pixel is not known); arrays with named
columns, of all micro-images and of radii by f-number (None: of one); a dict of figures."""

Radiometry = collections.namedtuple("Radiometry", "text figures")
Radiometry.__doc__ = "What calibrate_radiometry() found: the text of the file that import_raw() takes as radiometry, and a dict of figures."

_RAW, _WHITE, _RADIOMETRY = (Settings(kind.settings()) for kind in (_core.RawImport, _core.White, _core.Radiometry))


def _time(value):
    return lengths(value, "s")


def _label(key):
    """A key in front of files: a name, a number, or (temperature [K], time [s])."""
    if isinstance(key, tuple):
        return f"{lengths(key[0], 'K')}@{_time(key[1])}"
    return text_of(key)


def _labelled(values, text, label=_label):
    """Texts of a value, a list of them, or a dict of these: LABEL=TEXT then."""
    if isinstance(values, dict):
        return [f"{label(key)}={item}" for key, own in values.items() for item in _labelled(own, text)]
    return [text(value) for value in values] if isinstance(values, (list, tuple)) else [text(values)]


def _run(run, rows, camera, pictures, settings, progress, what):
    """Runs an object of the library. pictures: texts; settings: those of the caller."""
    if not (camera is None and what == "white" or isinstance(camera, Scene)):
        raise Error(f"camera takes a Scene, not {camera!r}")
    if camera is not None:
        run.camera = camera._scene
    for file in pictures:
        run.add_picture(file)
    times = _time if what == "radiometry" else _label
    for name, value in settings.items():
        if rows.rows[name][4] and value is not None:
            settings[name] = _labelled(value, _time if name == "exposure_time" else os.fspath, times)
        elif name in ("exposure_time", "temperature_error") and value is not None:
            settings[name] = lengths(value, "s" if name == "exposure_time" else "K")
    rows.set(run, settings)
    return update(run, progress, what)


def _table(text):
    return numpy.genfromtxt(io.StringIO(text), delimiter=",", names=True) if text else None


@_RAW.arguments_of
def import_raw(pictures, camera, *, threads=0, progress=None, **settings):
    """A light field of a real camera's pictures, as `plenoflame import`. Returns Imported.

        plenoflame.import_raw(["a.tif", "b.tif"], camera, dark="dark.tif", exposure_time=1e-3).light_field

    pictures: the name of a file, or several frames of one scene, which are averaged; or a dict of these by channels
    camera: a Scene with the camera and its channels
    Frames of corrections are a file or several, or dicts of these by channels; so are exposure times, [s] or texts with units

    {settings}

    threads: 0: one per processor
    progress: True for a bar, or a function that is called with the fraction done; a true result stops it

    Raises Error.
    """
    run = made(_core.RawImport, threads=_check.whole("threads", threads, 0, 1024))
    _run(run, _RAW, camera, _labelled(pictures, os.fspath), settings, progress, "import")
    return Imported(LightField(run.output), json.loads(run.figures))


@_WHITE.arguments_of
def calibrate_white(pictures, camera=None, *, threads=0, progress=None, **settings):
    """The microlens array by white pictures, as `plenoflame calibrate white`. Returns White.

    pictures: the name of a file, or several, which are averaged; or a dict of these by f-numbers; or a .csv of centres
    camera: a Scene with what is known of the camera; None: nothing

    {settings}

    threads: 0: one per processor
    progress: True for a bar, or a function that is called with the fraction done; a true result stops it

    Raises Error.
    """
    run = made(_core.White, threads=_check.whole("threads", threads, 0, 1024))
    _run(run, _WHITE, camera, _labelled(pictures, os.fspath), settings, progress, "white")
    scene, centres, radii = run.output
    return White(Scene(text=scene, name="camera.toml") if scene else None, _table(centres), _table(radii), json.loads(run.figures))


@_RADIOMETRY.arguments_of
def calibrate_radiometry(sources, camera, *, threads=0, progress=None, **settings):
    """The energy of a count by pictures of a blackbody, as `plenoflame calibrate radiometry`. Returns Radiometry.

        found = plenoflame.calibrate_radiometry({(1700, 50e-6): "blackbody.tif"}, camera, dark="dark.tif")

    sources: a dict of files, or lists of them, by temperatures [K], or by (temperature, exposure time [s])
    camera: a Scene with the camera and its channels
    dark and white may be dicts by exposure times [s]

    {settings}

    threads: 0: one per processor
    progress: True for a bar, or a function that is called with the fraction done; a true result stops it

    Raises Error.
    """
    if not isinstance(sources, dict):
        raise Error(f"sources takes a dict of files by temperatures, not {sources!r}")
    run = made(_core.Radiometry, threads=_check.whole("threads", threads, 0, 1024))
    pictures = _labelled(sources, os.fspath, lambda key: _label(key if isinstance(key, tuple) else lengths(key, "K")))
    _run(run, _RADIOMETRY, camera, pictures, settings, progress, "radiometry")
    return Radiometry(run.output, json.loads(run.figures))
