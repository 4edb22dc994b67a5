"""Flames as voxels: made, read, imported and written. Voxels are a vtkImageData with VTK and an object of the package's
own without; flame_arrays() gives the arrays of both."""

import json
import os

import numpy

from . import _check
from ._library import data, library, need_vtk
from ._run import Error, update


def flame_generators():
    """The flames that can be generated: a list of {"name", "what", "parameters": [{"name", "about", "value", "unit"}]}.
    Each value is the default, as text with its unit."""
    return json.loads(library.FlameGenerator.GetGeneratorsAsJson())


def make_flame(name, **parameters):
    """A generated flame, as `plenoflame flame NAME` makes it: voxels with the arrays "temperature" [K],
    "absorption" [1/m], and one per emission line [W/m^3].

        >>> import plenoflame
        >>> candle = plenoflame.make_flame("candle", voxel_size="2 mm", height="40 mm")
        >>> sorted(plenoflame.flame_arrays(candle)[0])
        ['absorption', 'temperature']

    parameters: those of flame_generators(), as text with units, or as numbers where there is no unit. Raises Error.
    """
    generator = library.FlameGenerator()
    generator.SetFlameName(_check.text("name", name))
    for key, value in parameters.items():
        generator.SetParameter(key, getattr(value, "text", str(value)))
    return update(generator).GetOutput()


def flame_from_arrays(temperature, absorption, *, spacing, origin=(0, 0, 0), **lines):
    """A flame of numpy arrays: voxels as make_flame gives them, for Scene.add_flame and write_flame.

    temperature [K], absorption [1/m]: arrays [i, j, k] of the samples at origin + (i, j, k) spacing
    spacing: between samples [m], one number or three; origin: the place of sample [0, 0, 0] [m]
    lines: further arrays by name, e.g. **{"CH*": array}, the emission of a line [W/m^3]

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
    return data.voxels_from(arrays, steps, start)


def flame_arrays(image):
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
    if not data.is_voxels(image):
        raise Error(f"image takes a {data.VOXELS}, as make_flame() gives it, not {type(image).__name__}")
    return data.voxel_arrays(image)


def read_flame(path, *, grid="", local_frame=False):
    """Reads the grids of a .vdb file as voxels, with the arrays "temperature" [K] and "absorption" [1/m], or any
    one grid by its name. A file with neither of them, as a reconstruction of emission alone, gives all its grids. Origin, spacing and direction matrix place it as the file says. With local_frame it stands
    unrotated at the origin, and the result is (image, vtkMatrix4x4 to the world); that needs VTK. Raises Error."""
    if local_frame:
        need_vtk("read_flame(local_frame=True)")
    reader = library.FlameReader()
    reader.SetFileName(os.fspath(path))
    reader.SetGridName(grid)
    if local_frame:
        reader.SetLocalFrame(True)
    image = update(reader).GetOutput()
    return (image, reader.GetLocalToWorld()) if local_frame else image


def import_flame(path, *, temperature="T", temperature_unit="K", absorption="", absorption_unit="1/m", soot="",
                 soot_function=0.26, wavelength=650e-9, constant=0.0, voxel_size=0.0, bounds=None, length_scale=1.0,
                 step=0, solution=None):
    """A flame from a simulation's file, on voxels: a vtkImageData as write_flame takes it. Needs VTK.

    temperature: its array; absorption (array), soot (array of volume fraction) or constant [1/m]: exactly one of them
    voxel_size: [m], 0: a 128th of the longest side; bounds: (x low, x high, y low, ...) [m]
    length_scale: metre per unit of the mesh; step: of a series of times; solution: the .q of a PLOT3D grid

    Raises Error.
    """
    need_vtk("import_flame()")
    from . import vtkPlenoflameImport
    source = vtkPlenoflameImport.vtkPlenoflameFlameImport()
    source.SetFileName(os.fspath(path))
    if solution is not None:
        source.SetSolutionFileName(os.fspath(solution))
    source.SetTemperatureArray(temperature)
    source.SetTemperatureUnit(temperature_unit)
    source.SetAbsorptionArray(absorption)
    source.SetAbsorptionUnit(absorption_unit)
    source.SetSootArray(soot)
    source.SetSootFunction(soot_function)
    source.SetWavelength(wavelength)
    source.SetConstantAbsorption(constant)
    source.SetVoxelSize(voxel_size)
    if bounds is not None:
        source.SetBounds(*bounds)
    source.SetLengthScale(length_scale)
    source.SetTimeStep(step)
    return update(source).GetOutput()


def write_flame(path, image, *, temperature="temperature", absorption="absorption", ambient=293.15, half=False):
    """Writes voxels as the grids of a flame. temperature, absorption: names of its arrays, in K and 1/m;
    ambient: temperature outside [K]; half: values with 16 bits. Raises Error."""
    if not data.is_voxels(image):
        raise Error(f"image takes a {data.VOXELS}, as make_flame() gives it, not {type(image).__name__}")
    writer = library.FlameWriter()
    writer.SetInputData(image)
    writer.SetFileName(os.fspath(path))
    writer.SetTemperatureArray(temperature)
    writer.SetAbsorptionArray(absorption)
    writer.SetAmbientTemperature(ambient)
    writer.SetHalf(half)
    data.write(writer)
