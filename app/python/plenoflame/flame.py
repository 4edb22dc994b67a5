"""Flames as voxels: made, read, imported and written."""

from __future__ import annotations

import ctypes
import json
import os
from typing import TYPE_CHECKING

import numpy

from . import _check, _core, _home
from ._arguments import refusal
from ._options import Settings
from ._run import Error, made, need_vtk, update


if TYPE_CHECKING:
    from typing import Any, Sequence

    from ._types import Array, Path, Progress


_IMPORT = Settings(_core.FlameImport.settings())


class Flame(_home.AtHome):
    """Fields on voxels: "temperature" [K], "absorption" [1/m], of emission lines [W/m^3], and of a reconstruction also
    "emission" [W/(m^3 sr)]. flame["temperature"] is an array [i, j, k], a view without a copy.

        >>> import plenoflame
        >>> candle = plenoflame.make_flame("candle", voxel_size="2 mm", height="40 mm")
        >>> candle
        <plenoflame.Flame, ... voxels: absorption, temperature>
        >>> candle["temperature"].dtype
        dtype('float32')

    numpy.asarray(flame) is the temperature, or the first field where there is none. to_xarray() is a Dataset of all
    fields with the axes z, y, x.
    """

    def __init__(self, voxels: Any) -> None:
        """Takes voxels of the library. from_vtk(), flame_from_arrays() and other functions make a flame."""
        if not isinstance(voxels, _core.Voxels):
            raise Error(f"voxels takes those of the library, not {type(voxels).__name__}; flame_from_arrays() takes arrays, "
                        "and Flame.from_vtk() a vtkImageData")
        self._data = voxels

    @staticmethod
    def from_vtk(image: Any) -> Flame:
        """A copy of the points' or cells' arrays of a vtkImageData, such as vtkPlenoflameFlameReader and
        vtkPlenoflameFlameImport give. Raises Error."""
        from ._vtk import image_to_flame
        return _flame_of(*image_to_flame(image))

    def to_vtk(self) -> Any:
        """The same as a vtkImageData whose arrays are in the flame's memory. Raises Error without VTK."""
        from ._vtk import flame_to_image
        return flame_to_image(*flame_arrays(self))

    def __reduce__(self) -> tuple[Any, ...]:
        return _flame_of, flame_arrays(self)

    def __repr__(self) -> str:
        arrays = self.arrays
        shape = " x ".join(map(str, self._values().shape)) if arrays else "no"
        return f"<plenoflame.Flame, {shape} voxels: {', '.join(sorted(arrays))}>"

    arrays: dict[str, Array] = _home.attribute("arrays", "{name: array [i, j, k]}, views without a copy.")
    spacing: tuple[float, float, float] = _home.attribute("spacing", "Between voxels along the three axes [m].")
    origin: tuple[float, float, float] = _home.attribute("origin", "Place of voxel [0, 0, 0] [m].")
    directions: list[tuple[float, float, float]] = _home.attribute("directions", "Unit vectors of the three axes.")

    def __getitem__(self, name: str) -> Array:
        arrays = self.arrays
        if name not in arrays:
            raise KeyError(f"the flame has no field {name!r}; it has {', '.join(sorted(arrays)) or 'none'}")
        return arrays[name]

    def _main(self):
        arrays = self.arrays
        return "temperature" if "temperature" in arrays else next(iter(arrays))

    def _values(self):
        return self[self._main()]

    def _labelled(self, xarray):
        axes = {}
        for axis, (name, count) in enumerate(zip("xyz", self._values().shape)):
            places = numpy.arange(count) * self.spacing[axis]
            own = self.directions[axis] == tuple(float(k == axis) for k in range(3))
            axes[name] = ((self.origin[axis] + places, name, "m") if own
                          else (places, f"{name} along the flame's own axes, from the first voxel", "m"))
        backwards = dict(reversed(axes.items()))  # z up and x to the right in the plot of a slice
        return xarray.Dataset({name: _home.labelled(xarray, values.transpose(), name, _home.unit_of(name), backwards)
                               for name, values in self.arrays.items()})

    def _summary(self):
        steps = " x ".join(f"{1e3 * step:.4g}" for step in self.spacing)
        yield "voxels", f"{' x '.join(map(str, self._values().shape))} of {steps} mm"
        for name, values in sorted(self.arrays.items()):
            yield name, _home.span(values, _home.unit_of(name))

    def _preview(self):
        """The largest values along y, x to the right and z up; temperatures where something absorbs."""
        arrays, main = self.arrays, self._main()
        values = arrays[main]
        if main == "temperature" and "absorption" in arrays:
            values = numpy.where(arrays["absorption"] > 0, values, 0)
        return _home.small_picture(values.max(1).T[::-1], hot=main == "temperature")


def _flame_of(arrays, spacing, origin, directions):
    """A Flame of arrays [i, j, k] of numbers, which are copied."""
    voxels = _core.Voxels(next(iter(arrays.values())).shape if arrays else (0, 0, 0), origin, spacing, directions)
    for name, values in arrays.items():
        voxels.add(name, values)
    return Flame(voxels)


def voxels_of(flame):
    """The voxels of a Flame. Raises Error for anything else."""
    if not isinstance(flame, Flame):
        raise Error(f"flame takes a Flame, as make_flame() and flame_from_arrays() give it, not {type(flame).__name__}")
    return flame._data


def flame_generators() -> list[dict[str, Any]]:
    """The flames that can be generated: a list of {"name", "what", "parameters": [{"name", "about", "value", "unit"}]}.
    Each value is the default, as text with its unit."""
    return json.loads(_core.flame_generators())


def make_flame(name: str, *, progress: Progress | None = None, **parameters: str | float) -> Flame:
    """A generated flame, as `plenoflame flame NAME` makes it: a Flame with "temperature" [K],
    "absorption" [1/m], and one field per emission line [W/m^3].

        >>> import plenoflame
        >>> candle = plenoflame.make_flame("candle", voxel_size="2 mm", height="40 mm")
        >>> sorted(candle.arrays)
        ['absorption', 'temperature']

    parameters: those of flame_generators(), as text with units, or as numbers where there is no unit; progress: True for a
    bar, or a function that is called with the fraction done. Raises Error.
    """
    known = {flame["name"]: [parameter["name"] for parameter in flame["parameters"]] for flame in flame_generators()}
    for key in parameters:
        if key not in known.get(name, parameters):
            raise TypeError(refusal("make_flame", key, known[name]))
    generator = made(_core.FlameGenerator, name=_check.text("name", name),
                     parameters={key: getattr(value, "text", str(value)) for key, value in parameters.items()})
    return Flame(update(generator, progress, "flame").output)


def flame_from_arrays(temperature: Any, absorption: Any, *, spacing: float | Sequence[float], origin: Sequence[float] = (0, 0, 0),
                      **lines: Any) -> Flame:
    """A Flame of numpy arrays, for Scene.add_flame and write_flame.

    temperature [K], absorption [1/m]: arrays [i, j, k] of the samples at origin + (i, j, k) spacing
    spacing: between samples [m], one number or three; origin: the place of sample [0, 0, 0] [m]
    lines: further arrays by name, such as **{"CH*": array}, the emission of a line [W/m^3]

    Raises Error.
    """
    steps = (spacing,) * 3 if not hasattr(spacing, "__len__") else spacing
    steps = _check.several("spacing", steps, 3, "one length or three in metres", _check.number)
    if not min(steps) > 0:
        raise Error(f"spacing takes lengths above 0, not {spacing!r}")
    start = _check.several("origin", origin, 3, "three lengths in metres", _check.number)
    arrays = {}
    shape = None
    for name, values in {"temperature": temperature, "absorption": absorption, **lines}.items():
        try:
            values = numpy.asarray(values, dtype=numpy.float32)
        except (TypeError, ValueError):
            raise Error(f"{name} is no array of numbers") from None
        if values.ndim != 3 or min(values.shape) < 2:
            raise Error(f"{name} has the shape {values.shape}; three axes of at least 2 samples are needed")
        if shape is None:
            shape = values.shape
        if values.shape != shape:
            raise Error(f"{name} has the shape {values.shape}, the temperature {shape}; they must be equal")
        arrays[name] = values
    return _flame_of(arrays, steps, start, [(1, 0, 0), (0, 1, 0), (0, 0, 1)])


def flame_arrays(flame: Flame) -> tuple[dict[str, Array], Sequence[float], Sequence[float], list[Sequence[float]]]:
    """The arrays of a flame's voxels, the inverse of flame_from_arrays: (arrays, spacing, origin, directions).

    arrays: {name: array [i, j, k]}, views without a copy; spacing: three lengths [m]; origin: the place of sample
    [0, 0, 0] [m]; directions: unit vectors of the three axes, so that sample [i, j, k] stands at
    origin + i spacing[0] directions[0] + j spacing[1] directions[1] + k spacing[2] directions[2]. Raises Error.

        >>> import numpy, plenoflame
        >>> temperature = numpy.linspace(300, 1800, 24).reshape(2, 3, 4)
        >>> flame = plenoflame.flame_from_arrays(temperature, 0 * temperature + 2, spacing=1e-3)
        >>> arrays, spacing, origin, directions = plenoflame.flame_arrays(flame)
        >>> arrays["temperature"].shape, spacing
        ((2, 3, 4), (0.001, 0.001, 0.001))
    """
    voxels_of(flame)
    return flame.arrays, flame.spacing, flame.origin, flame.directions


def read_flame(path: Path, *, grid: str = "") -> Flame:
    """Reads the grids of a .vdb file as a Flame with "temperature" [K] and "absorption" [1/m], or any one grid by its name. A
    file with neither of them, as a reconstruction of emission alone, gives all its grids. Origin, spacing and directions
    place it as the file says. Raises Error."""
    return Flame(update(made(_core.FlameReader, path=os.fspath(path), grid=grid)).output)


@_IMPORT.arguments_of
def import_flame(path: Path, *, step: int = 0, progress: Progress | None = None, **settings: Any) -> Flame:
    """A flame from a simulation's file, on voxels: a Flame. Needs VTK.

    {settings}
    step: of a series of times

    Exactly one of absorption, soot and constant is given. Lengths are in metres and constant in 1/m, or texts with units.
    Raises Error.
    """
    request = _core.FlameImport()
    _IMPORT.set(request, settings)
    source = need_vtk("import_flame()").vtkPlenoflameFlameImport()
    source.SetFileName(os.fspath(path))
    source.SetTimeStep(step)
    for name, value in request.properties.items():
        getattr(source, "Set" + name)(value)
    return Flame.from_vtk(update(source, progress, "import", _run_import).GetOutput())


def _run_import(source, on_progress, on_message):
    """Through ctypes the interpreter's lock is given up meanwhile; VTK's own Update() holds it."""
    from . import vtkPlenoflameImport
    from ._vtk import text_of_event
    progress_type = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_double)
    message_type = ctypes.CFUNCTYPE(None, ctypes.c_int, ctypes.c_char_p)
    run = ctypes.CDLL(vtkPlenoflameImport.__file__).plenoflame_update
    run.argtypes = [ctypes.c_void_p, progress_type, message_type]

    def on_text(is_error, text):
        on_message(is_error, text_of_event(text.decode(errors="replace")))

    run(int(source.__this__[1:].partition("_")[0], 16), progress_type(on_progress), message_type(on_text))


def write_flame(path: Path, flame: Flame, *, temperature: str = "temperature", absorption: str = "absorption",
                ambient: float = 293.15, half: bool = False) -> None:
    """Writes a Flame as grids. temperature, absorption: names of its arrays, in K and 1/m;
    ambient: temperature outside [K]; half: values with 16 bits. Of the other arrays those of emission lines are
    written: "CH*", "C2*", "OH*" and "Na_D". A warning names the rest. Raises Error."""
    update(made(_core.FlameWriter, input=voxels_of(flame), path=os.fspath(path), temperature=temperature, absorption=absorption,
                ambient=ambient, half=half))
