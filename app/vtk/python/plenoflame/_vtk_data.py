"""Running VTK's algorithms, and what they give: vtkImageData, vtkPolyData and vtkTable."""

import contextlib
import ctypes
import re

import numpy
from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray, vtk_to_numpy
from vtkmodules.util.vtkConstants import VTK_STRING
from vtkmodules.vtkCommonCore import vtkCommand, vtkPoints, vtkStringArray
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkImageData, vtkPolyData, vtkTable
from vtkmodules.vtkIOXML import vtkXMLPolyDataWriter

from . import vtkPlenoflame
from ._run import Error, deliver

# Through ctypes the interpreter's lock is given up while an algorithm runs; VTK's own Update() holds it.
_PROGRESS = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_double)
_MESSAGE = ctypes.CFUNCTYPE(None, ctypes.c_int, ctypes.c_char_p)
_update = ctypes.CDLL(vtkPlenoflame.__file__).plenoflame_update
_update.argtypes = [ctypes.c_void_p, _PROGRESS, _MESSAGE]
_update.restype = ctypes.c_int


def _text(message):
    """The message within VTK's 'ERROR: In FILE, line N\\nCLASS (ADDRESS): MESSAGE'."""
    match = re.search(r"\(0x[0-9a-f]+\): (.*)", message, re.DOTALL)
    return (match[1] if match else message).strip()


@contextlib.contextmanager
def errors_of(*objects):
    """Raises Error for the first error event of these objects, and passes their warning events on."""
    errors, cautions, tags = [], [], []

    def note(into):
        def callback(_caller, _event, text):
            into.append(_text(text))
        callback.CallDataType = VTK_STRING
        return callback

    for subject in objects:
        tags.append((subject, subject.AddObserver(vtkCommand.ErrorEvent, note(errors))))
        tags.append((subject, subject.AddObserver(vtkCommand.WarningEvent, note(cautions))))
    try:
        yield
    finally:
        for subject, tag in tags:
            subject.RemoveObserver(tag)
    deliver(errors, cautions)


def run(algorithm, on_progress, on_message):
    """Runs an algorithm, with Python's lock released. Neither function may raise."""
    def on_text(is_error, text):
        on_message(is_error, _text(text.decode(errors="replace")))

    _update(int(algorithm.__this__[1:].partition("_")[0], 16), _PROGRESS(on_progress), _MESSAGE(on_text))


def write(writer):
    """Has a writer write its file."""
    with errors_of(writer):
        writer.Write()


def image_array(image, name):
    """An array of a vtkImageData as numpy (rows, columns), row 0 at the top. Shares its memory."""
    columns, rows, _ = image.GetDimensions()
    values = image.GetPointData().GetArray(name)
    if values is None:
        present = [image.GetPointData().GetArrayName(i) for i in range(image.GetPointData().GetNumberOfArrays())]
        raise Error(f"the image has no array '{name}'; it has {', '.join(present) or 'none'}")
    return vtk_to_numpy(values).reshape(rows, columns)[::-1]


def image_texts(image, name):
    """What the field data of a light field says, as a list of texts or numbers."""
    array = image.GetFieldData().GetAbstractArray("plenoflame." + name)
    if array is None:
        raise Error(f"the image is no light field: it has no field data 'plenoflame.{name}'")
    return [array.GetValue(i) for i in range(array.GetNumberOfValues())]


def touch(image):
    """Says that values may have changed."""
    image.Modified()


_apply = ctypes.CDLL(vtkPlenoflame.__file__).plenoflame_operator_apply
_apply.argtypes = [ctypes.c_void_p, ctypes.c_int, ctypes.c_void_p, ctypes.c_void_p]
_apply.restype = ctypes.c_int


def numbers(array):
    """An array of VTK as numpy; shares its memory, and keeps it."""
    return vtk_to_numpy(array)


def of_numbers(values):
    """The other way round, a copy."""
    return numpy_to_vtk(numpy.ascontiguousarray(values, dtype=float), deep=True)


def operator_times(algorithm, transpose, vector, size):
    """A x, or A^T x, of a vtkPlenoflameOperator, with Python's lock released."""
    result = numpy.empty(size)
    if not _apply(int(algorithm.__this__[1:].partition("_")[0], 16), int(transpose), vector.ctypes.data, result.ctypes.data):
        raise Error("the operator could not be applied: not enough memory")
    return result


def views_of(algorithm, array):
    """All views that the filter made, and the contact sheet."""
    blocks = algorithm.GetOutput()
    views = [image_array(blocks.GetBlock(i), array).copy() for i in range(blocks.GetNumberOfBlocks())]
    return views, image_array(algorithm.GetContactSheet(), array).copy()


def ray_points(rays):
    return vtk_to_numpy(rays.GetPoints().GetData())


def ray_offsets(rays):
    return vtk_to_numpy(rays.GetLines().GetOffsetsArray())


def ray_surfaces(rays):
    names = rays.GetFieldData().GetAbstractArray("surfaces")
    return [names.GetValue(i) for i in range(names.GetNumberOfValues())]


def ray_array(rays, name):
    """None where there is none."""
    for group in (rays.GetCellData(), rays.GetPointData()):
        array = group.GetArray(name)
        if array is not None:
            values = vtk_to_numpy(array)
            return values.reshape(len(values), -1) if name in ("wavelength", "radiance") else values
    return None


def write_rays(path, rays):
    writer = vtkXMLPolyDataWriter()
    writer.SetFileName(path)
    writer.SetInputData(rays)
    with errors_of(writer):
        if not writer.Write():
            raise Error(f"cannot write '{path}'")


def table_rows(table):
    return table.GetNumberOfRows()


def table_field(table, name):
    return vtk_to_numpy(table.GetFieldData().GetArray(name))


def table_column(table, name):
    """None where there is none."""
    array = table.GetColumnByName(name)
    return None if array is None else vtk_to_numpy(array)


VOXELS = "vtkImageData"


def is_voxels(value):
    return isinstance(value, vtkImageData)


def voxels_from(arrays, spacing, origin):
    """Fields {name: array [i, j, k] of float32} as voxels; the first is the one that is shown."""
    image = vtkImageData()
    image.SetOrigin(*origin)
    image.SetSpacing(*spacing)
    for name, values in arrays.items():
        image.SetDimensions(*values.shape)
        array = numpy_to_vtk(values.ravel(order="F"), deep=True)
        array.SetName(name)
        image.GetPointData().AddArray(array)
    image.GetPointData().SetActiveScalars(next(iter(arrays)))
    return image


def voxel_arrays(image):
    """{name: array [i, j, k]}, spacing, origin, and the directions of the three axes."""
    data, matrix = image.GetPointData(), image.GetDirectionMatrix()
    arrays = {data.GetArrayName(i): vtk_to_numpy(data.GetArray(i)).reshape(image.GetDimensions(), order="F")
              for i in range(data.GetNumberOfArrays())}
    directions = [tuple(matrix.GetElement(k, axis) for k in range(3)) for axis in range(3)]
    return arrays, image.GetSpacing(), image.GetOrigin(), directions


def _arrays(data):
    """[(name, numpy array or list of texts)]"""
    found = []
    for i in range(data.GetNumberOfArrays()):
        array = data.GetAbstractArray(i)
        if isinstance(array, vtkStringArray):
            found.append((array.GetName(), [array.GetValue(k) for k in range(array.GetNumberOfValues())]))
        else:
            found.append((array.GetName(), vtk_to_numpy(array).copy()))
    return found


def _add(data, arrays):
    for name, values in arrays:
        if isinstance(values, list):
            array = vtkStringArray()
            for text in values:
                array.InsertNextValue(text)
        else:
            array = numpy_to_vtk(numpy.ascontiguousarray(values), deep=True)
        array.SetName(name)
        data.AddArray(array)


def state_of(data):
    """A dict of plain values that holds all of a vtkImageData, a vtkTable, or a vtkPolyData with lines."""
    if isinstance(data, vtkTable):
        return {"row": _arrays(data.GetRowData()), "field": _arrays(data.GetFieldData())}
    state = {"point": _arrays(data.GetPointData()), "cell": _arrays(data.GetCellData()),
             "field": _arrays(data.GetFieldData())}
    scalars = data.GetPointData().GetScalars()
    state["scalars"] = scalars.GetName() if scalars else None
    if isinstance(data, vtkImageData):
        matrix = data.GetDirectionMatrix()
        state["image"] = (data.GetExtent(), data.GetSpacing(), data.GetOrigin(),
                          [matrix.GetElement(i, j) for i in range(3) for j in range(3)])
        return state
    lines = data.GetLines()
    points = data.GetPoints()
    state["points"] = vtk_to_numpy(points.GetData()).copy() if points else numpy.empty((0, 3))
    state["lines"] = (vtk_to_numpy(lines.GetOffsetsArray()).copy(), vtk_to_numpy(lines.GetConnectivityArray()).copy())
    return state


def data_of(state):
    """The vtkImageData, vtkTable or vtkPolyData of a state."""
    if "row" in state:
        data = vtkTable()
        _add(data.GetRowData(), state["row"])
        _add(data.GetFieldData(), state["field"])
        return data
    if "image" in state:
        extent, spacing, origin, direction = state["image"]
        data = vtkImageData()
        data.SetExtent(*extent)
        data.SetSpacing(*spacing)
        data.SetOrigin(*origin)
        data.SetDirectionMatrix(*direction)
    else:
        data = vtkPolyData()
        points = vtkPoints()
        points.SetData(numpy_to_vtk(state["points"], deep=True))
        data.SetPoints(points)
        lines = vtkCellArray()
        lines.SetData(*[numpy_to_vtkIdTypeArray(values.astype(numpy.int64), deep=True) for values in state["lines"]])
        data.SetLines(lines)
    _add(data.GetPointData(), state["point"])
    _add(data.GetCellData(), state["cell"])
    _add(data.GetFieldData(), state["field"])
    if state["scalars"]:
        data.GetPointData().SetActiveScalars(state["scalars"])
    return data
