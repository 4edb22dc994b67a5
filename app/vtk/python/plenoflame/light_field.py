"""Light fields, and the pictures that are made of them."""

import os

from . import vtkPlenoflame as vtk
from ._run import Error, image_array, update

_RESAMPLINGS = {"nearest": 0, "barycentric": 1, "paper9": 2, "paper10": 3}


class LightField:
    """The raw image of a plenoptic camera: radiant flux per pixel [W].

    Arrays are numpy views (rows, columns) of the vtkImageData `image`, row 0 at the top: change one, and the other
    changes with it.
    """

    def __init__(self, image, relative_error=-1.0):
        """Takes a vtkImageData as vtkPlenoflameLightFieldSource and vtkPlenoflameLightFieldReader give it."""
        self.image = image
        self.relative_error = relative_error  #: estimated relative RMSE over lit pixels; -1: not known
        self._filters = {}

    def __repr__(self):
        rows, columns = self.flux.shape
        return f"<plenoflame.LightField, {columns} x {rows} pixels, channels {', '.join(self.channels)}>"

    def _texts(self, name):
        array = self.image.GetFieldData().GetAbstractArray("plenoflame." + name)
        if array is None:
            raise Error(f"the image is no light field: it has no field data 'plenoflame.{name}'")
        return [array.GetValue(i) for i in range(array.GetNumberOfValues())]

    @property
    def channels(self):
        """Names of the channels."""
        return self._texts("channels")

    @property
    def scene_text(self):
        """The scene that it was rendered from, as TOML."""
        return self._texts("scene")[0]

    @property
    def window(self):
        """The part of the sensor that it holds: (x, y, width, height) from the top left."""
        return tuple(int(value) for value in self._texts("window"))

    @property
    def complete(self):
        """False when the run was ended early."""
        return bool(self._texts("complete")[0])

    def __getitem__(self, channel):
        """Flux [W] of a channel by its name."""
        return image_array(self.image, channel)

    @property
    def flux(self):
        """Flux [W] of the first channel."""
        return self[self.channels[0]]

    @property
    def error(self):
        """Standard error [W] of the first channel's flux."""
        return self[self.channels[0] + ".error"]

    def save(self, path):
        """Writes the light field as EXR."""
        writer = vtk.vtkPlenoflameLightFieldWriter()
        writer.SetInputData(self.image)
        writer.SetFileName(os.fspath(path))
        from ._run import errors_of
        with errors_of(writer):
            writer.Write()

    def _filter(self, kind):
        """Kept, since a filter remembers the micro-images of the camera."""
        if kind not in self._filters:
            self._filters[kind] = kind()
            self._filters[kind].SetInputData(self.image)
        self.image.Modified()  # values may have been changed through numpy
        return self._filters[kind]

    def develop(self, *, saturation=0.0, bits=14, curve="display", channel=""):
        """What a sensor makes of it: numpy array (rows, columns) of uint16.

        saturation: flux [W] that gives the largest value; 0: 99.9 % of the lit pixels do not exceed it
        curve: "display" (sRGB) or "linear"
        """
        if curve not in ("linear", "display"):
            raise Error(f"there is no curve {curve!r}; there are 'linear' and 'display'")
        develop = self._filter(vtk.vtkPlenoflameDevelop)
        develop.SetSaturation(saturation)
        develop.SetBits(bits)
        develop.SetCurve(["linear", "display"].index(curve))
        develop.SetChannel(channel)
        return image_array(update(develop).GetOutput(), "digital_number").copy()

    def views(self, grid=7, *, spread=0.7, resampling="barycentric", white_correction=True, channel="", threads=0):
        """Sub-aperture views: the scene from grid x grid places on the main lens. Returns Views."""
        if resampling not in _RESAMPLINGS:
            raise Error(f"there is no resampling {resampling!r}; there are {', '.join(_RESAMPLINGS)}")
        views = self._filter(vtk.vtkPlenoflameViews)
        views.SetGrid(grid)
        views.SetSpread(spread)
        views.SetResampling(_RESAMPLINGS[resampling])
        views.SetWhiteCorrection(white_correction)
        views.SetChannel(channel)
        views.SetNumberOfThreads(threads)
        update(views)
        return Views(views, grid, "radiance" if white_correction else "flux")

    def refocus(self, depth, *, width=0, aperture=1.0, channel="", threads=0):
        """The picture focused on the plane at `depth` [m] in front of the main lens. Returns Refocused."""
        refocus = self._filter(vtk.vtkPlenoflameRefocus)
        refocus.SetDepth(depth)
        refocus.SetWidth(width)
        refocus.SetAperture(aperture)
        refocus.SetChannel(channel)
        refocus.SetNumberOfThreads(threads)
        update(refocus)
        return Refocused(image_array(refocus.GetOutput(), "radiance").copy(), depth, refocus.GetPixelSize())


class Views:
    """Sub-aperture views; indexed [row, column] of the grid, each a numpy array (rows, columns)."""

    def __init__(self, algorithm, grid, array):
        blocks = algorithm.GetOutput()
        self.grid = grid
        self.unit = "W/(m^2 sr)" if array == "radiance" else "W"
        self._views = [image_array(blocks.GetBlock(i), array).copy() for i in range(blocks.GetNumberOfBlocks())]
        self.sheet = image_array(algorithm.GetContactSheet(), array).copy()  #: all of them side by side

    def __getitem__(self, place):
        row, column = place
        if not (0 <= row < self.grid and 0 <= column < self.grid):
            raise IndexError(f"view {row}, {column} of {self.grid} x {self.grid}")
        return self._views[row * self.grid + column]

    def __len__(self):
        return len(self._views)

    def __iter__(self):
        return iter(self._views)


class Refocused:
    """A refocused picture."""

    def __init__(self, image, depth, pixel):
        self.image = image  #: radiance [W/(m^2 sr)], numpy array (rows, columns)
        self.depth = depth  #: [m] in front of the main lens
        self.pixel = pixel  #: [m] side of a pixel on the object plane


def read_light_field(path):
    """Reads a light field (.exr) that Plenoflame wrote. Raises Error."""
    reader = vtk.vtkPlenoflameLightFieldReader()
    reader.SetFileName(os.fspath(path))
    return LightField(update(reader).GetOutput())
