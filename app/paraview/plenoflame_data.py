"""What Plenoflame computes as data of ParaView's VTK, and light fields back."""

import json

import numpy
import plenoflame
from plenoflame import _core
from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkPoints, vtkStringArray
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkCompositeDataSet, vtkPolyData


def _image_arrays(image, arrays):
    """Adds pictures (rows, columns), row 0 at the top, as point data; VTK's rows run upwards."""
    for name, values in arrays.items():
        array = numpy_to_vtk(numpy.ascontiguousarray(values[::-1]).ravel(), deep=True)
        array.SetName(name)
        image.GetPointData().AddArray(array)
    image.GetPointData().SetActiveScalars(next(iter(arrays)))


def fill_picture(output, arrays, pixel=1.0, corner=(0.5, 0.5)):
    """Fills an image. pixel: spacing; corner: the middle of the lower left pixel."""
    rows, columns = next(iter(arrays.values())).shape
    output.SetDimensions(columns, rows, 1)
    output.SetSpacing(pixel, pixel, 1)
    output.SetOrigin(*corner, 0)
    _image_arrays(output, arrays)


def _note(data, name, value):
    array = vtkStringArray()
    array.SetName(name)
    array.InsertNextValue(value)
    data.GetFieldData().AddArray(array)


def light_field_to_image(field, output):
    """A light field as an image of one point a pixel; everything but its pictures is the field data "plenoflame.state"."""
    state = field._data.State()
    pictures = state.pop("images")
    order = [name for channel in state["channels"] for name in (channel, channel + ".error")] + list(state["layers"])
    x, y, _, height = state["window"]
    fill_picture(output, {name: pictures[name] for name in order if name in pictures}, 1,
             (x + 0.5, state["sensor"][1] - y - height + 0.5))
    _note(output, "plenoflame.state", json.dumps(state))


def image_to_light_field(image):
    """Raises plenoflame.Error for an image that is no light field."""
    said = image.GetFieldData().GetAbstractArray("plenoflame.state")
    if said is None:
        raise plenoflame.Error("the input is no light field of Plenoflame: open an .exr, or take the source Plenoflame Light Field")
    state = json.loads(said.GetValue(0))
    columns, rows, _ = image.GetDimensions()
    data = image.GetPointData()
    state["images"] = {data.GetArrayName(i): vtk_to_numpy(data.GetArray(i)).reshape(rows, columns)[::-1]
                       for i in range(data.GetNumberOfArrays())}
    return plenoflame.LightField(_core.LightField.FromState(state))


def voxels_to_image(voxels, output):
    """Voxels with their full transform: origin, spacing, and the directions of their axes (turned or sheared)."""
    arrays, spacing, origin, directions = plenoflame.flame_arrays(voxels)
    for name, values in arrays.items():
        output.SetDimensions(*values.shape)
        array = numpy_to_vtk(values.ravel(order="F"), deep=True)
        array.SetName(name)
        output.GetPointData().AddArray(array)
    output.SetSpacing(*spacing)
    output.SetOrigin(*origin)
    output.SetDirectionMatrix(*(directions[axis][row] for row in range(3) for axis in range(3)))
    output.GetPointData().SetActiveScalars("temperature" if "temperature" in arrays else next(iter(arrays)))


def _points(values):
    points = vtkPoints()
    points.SetData(numpy_to_vtk(numpy.ascontiguousarray(values), deep=True))
    return points


def _cells(offsets, connectivity):
    cells = vtkCellArray()
    cells.SetData(*(numpy_to_vtkIdTypeArray(values.astype(numpy.int64), deep=True) for values in (offsets, connectivity)))
    return cells


def _add(data, name, values):
    array = numpy_to_vtk(numpy.ascontiguousarray(values), deep=True)
    array.SetName(name)
    data.AddArray(array)


def rays_to_polydata(rays, output):
    """One line a ray; arrays as docs/rays.md names them."""
    output.SetPoints(_points(rays.points))
    output.SetLines(_cells(rays.offsets, numpy.arange(len(rays.points))))
    for name, values in rays._data["arrays"].items():
        _add(output.GetPointData() if len(values) == len(rays.points) and name in
             ("surface", "refractive_index", "distance", "temperature", "absorption") else output.GetCellData(), name, values)


def camera_to_blocks(scene, output):
    """The camera's surfaces as named blocks."""
    source = _core.CameraSource()
    source.SetInputDataObject(scene._scene)
    source.Run(lambda _fraction: 0, lambda _warning: None)
    for number, (name, mesh) in enumerate(source.GetOutput().items()):
        block = vtkPolyData()
        block.SetPoints(_points(mesh["points"]))
        block.SetPolys(_cells(mesh["offsets"], mesh["connectivity"]))
        if len(mesh["normals"]):
            _add(block.GetPointData(), "Normals", mesh["normals"])
            block.GetPointData().SetActiveNormals("Normals")
        for array in ("surface", "type", "microlens"):
            if len(mesh[array]):
                _add(block.GetCellData(), array, mesh[array])
        output.SetBlock(number, block)
        output.GetMetaData(number).Set(vtkCompositeDataSet.NAME(), name)
