"""A scene: a camera, its flames, and how to render them."""

import json
import os

from . import vtkPlenoflame as vtk
from ._run import Error, errors_of, update
from .light_field import LightField
from .rays import Rays

_ESTIMATORS = {None: 0, "backward": 1, "forward": 2}


class Scene:
    """The scene of a TOML file.

    Values are read and set by the paths of docs/reference/scene.md, as text with units:

        scene["camera.lens.surfaces[0].radius"] = "30 mm"

    scene.scene is the vtkPlenoflameScene, an input for the algorithms of plenoflame.vtk.
    """

    def __init__(self, path=None, *, text=None, name="scene.toml"):
        """Reads the file `path`, or takes `text` in the same form (`name` stands for the file in messages and is where
        relative paths start). Raises Error with file, line and column."""
        if (path is None) == (text is None):
            raise TypeError("give either a path or text=")
        self.scene = vtk.vtkPlenoflameScene()
        with errors_of(self.scene):
            if text is None:
                self.scene.ReadFile(os.fspath(path))
            else:
                self.scene.ReadText(text, os.fspath(name))

    def __repr__(self):
        return (f"<plenoflame.Scene, {self.columns} x {self.rows} pixels, {self.list_size('flames')} flames, "
                f"channels {', '.join(self.channels)}>")

    @property
    def columns(self):
        """Columns of the sensor."""
        return self.scene.GetNumberOfColumns()

    @property
    def rows(self):
        """Rows of the sensor."""
        return self.scene.GetNumberOfRows()

    @property
    def channels(self):
        """Names of the channels."""
        return [self.scene.GetChannelName(i) for i in range(self.scene.GetNumberOfChannels())]

    @property
    def text(self):
        """The whole scene as TOML, presets resolved."""
        with errors_of(self.scene):
            return self.scene.GetText()

    def save(self, path):
        """Writes the scene to a TOML file."""
        with errors_of(self.scene):
            self.scene.WriteFile(os.fspath(path))

    def keys(self):
        """Paths of all values."""
        return [self.scene.GetPath(i) for i in range(self.scene.GetNumberOfPaths())]

    def __iter__(self):
        return iter(self.keys())

    def __getitem__(self, path):
        """The value at a path, as text with its unit. Raises KeyError for an unknown path."""
        try:
            with errors_of(self.scene):
                return self.scene.GetValue(path)
        except Error as error:
            raise KeyError(str(error)) from None

    def __setitem__(self, path, value):
        """Sets a value from text with a unit, or from a number, bool or list of them where the key has no unit. Raises
        Error, with the scene unchanged."""
        with errors_of(self.scene):
            self.scene.SetValue(path, _as_text(value))

    def list_size(self, path):
        """Items of a list of tables, such as "flames" or "camera.lens.surfaces"."""
        with errors_of(self.scene):
            return self.scene.GetListSize(path)

    def insert(self, path, position):
        """Inserts an item with default values into a list of tables."""
        with errors_of(self.scene):
            self.scene.InsertListItem(path, position)

    def remove(self, path, position):
        """Removes an item from a list of tables."""
        with errors_of(self.scene):
            self.scene.RemoveListItem(path, position)

    def check(self):
        """Checks that the values go together. Raises Error for what is impossible, warns about what is probably not
        meant."""
        with errors_of(self.scene):
            self.scene.Validate()

    def copy(self):
        """An independent copy."""
        copy = Scene.__new__(Scene)
        copy.scene = vtk.vtkPlenoflameScene()
        copy.scene.DeepCopy(self.scene)
        return copy

    def design(self):
        """What a camera can do, as `plenoflame design --json` prints it: a dict with SI units; None is infinite."""
        with errors_of(self.scene):
            text = self.scene.GetDesignAsJson()
        return json.loads(text)

    def render(self, samples=0, *, seed=-1, estimator=None, window=None, target_error=0.0, time_limit=0.0, threads=0,
               progress=None):
        """Renders the light field.

        samples: rays per pixel and microlens (backward), energy bundles in all (forward); 0: as the scene says
        seed: -1: the scene's
        estimator: "backward", "forward"; None: the scene's
        window: (x, y, width, height) of the sensor, from the top left; None: all
        target_error: relative RMSE over lit pixels at which to stop; time_limit: in seconds; 0: none
        threads: 0: one per processor; the result does not depend on it
        progress: called with the fraction done; a true result ends the run early, with what is there until then

        Returns a LightField. Raises Error.
        """
        if estimator not in _ESTIMATORS:
            raise Error(f"there is no estimator {estimator!r}; there are 'backward' and 'forward'")
        source = vtk.vtkPlenoflameLightFieldSource()
        source.SetInputDataObject(self.scene)
        source.SetSamples(samples)
        source.SetSeed(seed)
        source.SetEstimator(_ESTIMATORS[estimator])
        source.SetTargetError(target_error)
        source.SetTimeLimit(time_limit)
        source.SetNumberOfThreads(threads)
        if window is not None:
            source.SetWindow(*window)
        update(source, progress)
        return LightField(source.GetOutput(), relative_error=source.GetRelativeError())

    def rays(self, *, pixels=(), microlenses=(), points=(), random=0, chief=False, rays=64, flame_samples=0,
             status=None, lens_type=None, most=0, seed=-1, threads=0):
        """Paths of rays; bundles are added to one another.

        pixels: (column, row), all rays of each; microlenses: (q, r); points: (x, y, z) in the world [m], towards the
        camera; random: so many pixels at random; chief: the chief ray of every microlens
        rays: per pixel and microlens, and per point
        flame_samples: vertices within the flames, with temperature and absorption
        status: any of "reached", "vignetted", "total internal reflection", "missed"; None: all
        lens_type: of the microlens; most: at most so many rays, drawn evenly (sums are no fluxes then)

        Returns Rays. Raises Error.
        """
        source = vtk.vtkPlenoflameRayPathSource()
        source.SetInputDataObject(self.scene)
        for column, row in pixels:
            source.AddPixel(column, row)
        for q, r in microlenses:
            source.AddMicrolens(q, r)
        for x, y, z in points:
            source.AddObjectPoint(x, y, z)
        source.SetNumberOfRandomPixels(random)
        source.SetChiefRays(chief)
        source.SetRaysPerPixel(rays)
        source.SetRaysPerPoint(rays)
        source.SetFlameSamples(flame_samples)
        source.SetSeed(seed)
        source.SetMaximumNumberOfRays(most)
        source.SetNumberOfThreads(threads)
        if lens_type is not None:
            source.SetSelectedType(lens_type)
        if status is not None:
            chosen = [status] if isinstance(status, str) else list(status)
            unknown = set(chosen) - set(Rays.STATUSES)
            if unknown:
                raise Error(f"there is no status {sorted(unknown)[0]!r}; there are {', '.join(Rays.STATUSES)}")
            for number, name in enumerate(Rays.STATUSES):
                source.SetStatusSelected(number, name in chosen)
        update(source)
        return Rays(source.GetOutput())

    def camera(self, **settings):
        """The camera's geometry as a vtkMultiBlockDataSet: vtkPlenoflameCameraSource, with its properties set by name,
        e.g. LevelOfDetail=2, Window=(100, 100, 64, 64)."""
        source = vtk.vtkPlenoflameCameraSource()
        source.SetInputDataObject(self.scene)
        for name, value in settings.items():
            getattr(source, "Set" + name)(value)
        return update(source).GetOutput()

    def flame(self, resolution=128):
        """The flames sampled on a lattice: a vtkImageData with "temperature" [K] and "absorption" [1/m]."""
        source = vtk.vtkPlenoflameFlameSource()
        source.SetInputDataObject(self.scene)
        source.SetResolution(resolution)
        return update(source).GetOutput()


def _as_text(value):
    if isinstance(value, str):
        return value
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, (list, tuple)):
        return ", ".join(map(_as_text, value))
    return repr(value)
