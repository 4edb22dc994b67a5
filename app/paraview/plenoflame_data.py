"""The camera as blocks of ParaView's VTK; to_vtk() of the package gives everything else, which ParaView gets as its own."""

import numpy
from plenoflame import _core
from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkMultiBlockDataSet, vtkPolyData


def owned(data):
    """A copy in memory of VTK, which ParaView may keep for longer than Python keeps the arrays."""
    copy = data.NewInstance()
    copy.DeepCopy(data)
    return copy


def _add(data, name, values):
    array = numpy_to_vtk(numpy.ascontiguousarray(values), deep=True)
    array.SetName(name)
    data.AddArray(array)


def _polygons(mesh):
    block, points, cells = vtkPolyData(), vtkPoints(), vtkCellArray()
    points.SetData(numpy_to_vtk(mesh["points"], deep=True))
    cells.SetData(*(numpy_to_vtkIdTypeArray(mesh[name].astype(numpy.int64), deep=True) for name in ("offsets", "connectivity")))
    block.SetPoints(points)
    block.SetPolys(cells)
    if len(mesh["normals"]):
        _add(block.GetPointData(), "Normals", mesh["normals"])
        block.GetPointData().SetActiveNormals("Normals")
    for array in ("surface", "type", "microlens"):
        if len(mesh[array]):
            _add(block.GetCellData(), array, mesh[array])
    return block


def camera_to_blocks(scene):
    """The camera's surfaces as a vtkMultiBlockDataSet of named blocks."""
    output = vtkMultiBlockDataSet()
    source = _core.CameraSource()
    source.scene = scene._scene
    source.run(lambda _fraction: 0, lambda _warning: None)
    for number, (name, mesh) in enumerate(source.output.items()):
        output.SetBlock(number, _polygons(mesh))
        output.GetMetaData(number).Set(output.NAME(), name)
    return output
