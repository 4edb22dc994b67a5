"""Flames in OpenVDB files."""

import os

from . import vtkPlenoflame as vtk
from ._run import errors_of, update


def read_flame(path, *, grid="", local_frame=False):
    """Reads the grids of a .vdb file as vtkImageData, with the arrays "temperature" [K] and "absorption" [1/m], or any
    one grid by its name. Origin, spacing and direction matrix place it as the file says. With local_frame it stands
    unrotated at the origin, and the result is (image, vtkMatrix4x4 to the world). Raises Error."""
    reader = vtk.vtkPlenoflameFlameReader()
    reader.SetFileName(os.fspath(path))
    reader.SetGridName(grid)
    reader.SetLocalFrame(local_frame)
    image = update(reader).GetOutput()
    return (image, reader.GetLocalToWorld()) if local_frame else image


def import_flame(path, *, temperature="T", temperature_unit="K", absorption="", absorption_unit="1/m", soot="",
                 soot_function=0.26, wavelength=650e-9, constant=0.0, voxel_size=0.0, bounds=None, length_scale=1.0,
                 step=0, solution=None):
    """A flame from a simulation's file, on voxels: a vtkImageData as write_flame takes it.

    temperature: its array; absorption (array), soot (array of volume fraction) or constant [1/m]: exactly one of them
    voxel_size: [m], 0: a 128th of the longest side; bounds: (x low, x high, y low, ...) [m]
    length_scale: metre per unit of the mesh; step: of a series of times; solution: the .q of a PLOT3D grid

    Raises Error.
    """
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
    """Writes a vtkImageData as the grids of a flame. temperature, absorption: names of its arrays, in K and 1/m;
    ambient: temperature outside [K]; half: values with 16 bits. Raises Error."""
    writer = vtk.vtkPlenoflameFlameWriter()
    writer.SetInputData(image)
    writer.SetFileName(os.fspath(path))
    writer.SetTemperatureArray(temperature)
    writer.SetAbsorptionArray(absorption)
    writer.SetAmbientTemperature(ambient)
    writer.SetHalf(half)
    with errors_of(writer):
        writer.Write()
