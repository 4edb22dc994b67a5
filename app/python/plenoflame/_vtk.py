"""Results as VTK's data, and back. The Python modules of any VTK do, also those of ParaView."""

import contextlib
import re

import numpy

from ._run import Error, deliver

try:
    from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray, vtk_to_numpy
    from vtkmodules.util.vtkConstants import VTK_STRING
    from vtkmodules.vtkCommonCore import vtkCommand, vtkPoints, vtkStringArray
    from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkImageData, vtkPolyData, vtkTable
except ImportError as _missing:
    raise Error("to_vtk() and from_vtk() need VTK: install its Python modules (Debian package python3-vtk9, or pip install "
                f"vtk; {_missing})") from None

_OF_A_RAY = {"pixel": ("column", "row"), "microlens": ("q", "r")}
_OF_A_VERTEX = ("surface", "refractive_index", "distance", "temperature", "absorption")
_TEXTS = ("scene", "estimator", "version", "unit")


def _add(data, name, values, components=()):
    """Adds an array that shows the memory of `values`, where that is in one piece."""
    array = numpy_to_vtk(numpy.ascontiguousarray(values))
    array.SetName(name)
    for number, component in enumerate(components):
        array.SetComponentName(number, component)
    data.AddArray(array)


def _add_texts(data, name, texts):
    array = vtkStringArray()
    array.SetName(name)
    for text in texts:
        array.InsertNextValue(text)
    data.AddArray(array)


def _an_image(image):
    if not isinstance(image, vtkImageData):
        raise Error(f"image takes a vtkImageData, not {type(image).__name__}")
    return image


def picture_to_image(arrays, pixel=1.0, corner=(0.5, 0.5)):
    """An image of pictures (rows, columns), row 0 at the top; VTK's rows run upwards. pixel: spacing; corner: the
    middle of the lower left pixel."""
    image, (rows, columns) = vtkImageData(), next(iter(arrays.values())).shape
    image.SetDimensions(columns, rows, 1)
    image.SetSpacing(pixel, pixel, 1)
    image.SetOrigin(*corner, 0)
    for name, values in arrays.items():
        _add(image.GetPointData(), name, values[::-1].ravel())
    image.GetPointData().SetActiveScalars(next(iter(arrays)))
    return image


def light_field_to_image(state):
    """Everything but the pictures is field data, as vtkPlenoflameLightFieldSource gives it."""
    x, y, _, height = state["window"]
    order = [name for channel in state["channels"] for name in (channel, channel + ".error")] + state["layers"]
    image = picture_to_image({name: state["images"][name] for name in order if name in state["images"]}, 1,
                             (x + 0.5, state["sensor"][1] - y - height + 0.5))
    data = image.GetFieldData()
    texts = {"channels": state["channels"], "layers": state["layers"],
             **{name: [text] for name, text in zip(_TEXTS, state["texts"])}, "seed": [str(state["seed"])],
             "number_names": list(state["numbers"]), "text_names": list(state["attributes"]),
             "texts": list(state["attributes"].values())}
    numbers = {"sensor": state["sensor"], "window": state["window"], "samples": [state["samples"]],
               "complete": [state["complete"]], "numbers": list(state["numbers"].values())}
    for name, values in texts.items():
        _add_texts(data, "plenoflame." + name, values)
    for name, values in numbers.items():
        _add(data, "plenoflame." + name, numpy.array(values, dtype=float))
    return image


def image_to_light_field(image):
    """The state of the light field. Raises Error where an image is none."""
    data, points = _an_image(image).GetFieldData(), image.GetPointData()

    def said(name):
        array = data.GetAbstractArray("plenoflame." + name)
        if array is None:
            raise Error(f"the image is no light field of Plenoflame: it has no field data 'plenoflame.{name}'")
        return [array.GetValue(i) for i in range(array.GetNumberOfValues())]

    named = data.HasArray("plenoflame.text_names")  # older files have none
    window, (columns, rows, _) = [int(value) for value in said("window")], image.GetDimensions()
    if window[2:] != [columns, rows]:
        raise Error(f"the image has {columns} x {rows} points, but its field data says {window[2]} x {window[3]}")
    return {"images": {points.GetArrayName(i): vtk_to_numpy(points.GetArray(i)).reshape(rows, columns)[::-1]
                       for i in range(points.GetNumberOfArrays())},
            "channels": said("channels"), "layers": said("layers"), "sensor": [int(value) for value in said("sensor")],
            "window": window, "texts": [said(name)[0] for name in _TEXTS], "seed": int(said("seed")[0]),
            "samples": said("samples")[0], "complete": bool(said("complete")[0]),
            "numbers": dict(zip(said("number_names"), said("numbers"))), 
            "attributes": dict(zip(said("text_names"), said("texts"))) if named else {}}


def flame_to_image(arrays, spacing, origin, directions):
    """Arrays [i, j, k] share their memory with the image's."""
    image = vtkImageData()
    image.SetSpacing(*spacing)
    image.SetOrigin(*origin)
    image.SetDirectionMatrix(*(directions[axis][row] for row in range(3) for axis in range(3)))
    for name, values in arrays.items():
        image.SetDimensions(*values.shape)
        _add(image.GetPointData(), name, values.ravel(order="F"))
    if arrays:
        image.GetPointData().SetActiveScalars("temperature" if "temperature" in arrays else next(iter(arrays)))
    return image


def image_to_flame(image):
    """(arrays [i, j, k], spacing, origin, directions) of its points, or of its cells, whose values stand in their middles."""
    extent = numpy.reshape(_an_image(image).GetExtent(), (3, 2))
    for data, of_cells in ((image.GetPointData(), False), (image.GetCellData(), True)):
        arrays = [data.GetArray(i) for i in range(data.GetNumberOfArrays())]
        arrays = [array for array in arrays if array is not None and array.GetName() and array.GetNumberOfComponents() == 1]
        if arrays:
            break
    else:
        raise Error("the image has no array of single numbers")
    matrix, spacing = image.GetDirectionMatrix(), image.GetSpacing()
    directions = [tuple(matrix.GetElement(row, axis) for row in range(3)) for axis in range(3)]
    first = (extent[:, 0] + 0.5 * of_cells) * spacing
    origin = tuple(image.GetOrigin() + first @ numpy.array(directions))
    shape = extent[:, 1] - extent[:, 0] + (not of_cells)
    return ({array.GetName(): vtk_to_numpy(array).reshape(shape, order="F") for array in arrays}, spacing, origin, directions)


def rays_to_polydata(rays):
    """One line a ray; arrays as docs/rays.md names them, in the memory of the rays."""
    polydata = vtkPolyData()
    points, lines = vtkPoints(), vtkCellArray()
    points.SetData(numpy_to_vtk(rays["points"]))
    # vtkCellArray keeps the memory of what it is given, and not the array that holds it.
    lines.SetData(*(numpy_to_vtkIdTypeArray(values, deep=True) for values in (rays["offsets"], numpy.arange(len(rays["points"])))))
    polydata.SetPoints(points)
    polydata.SetLines(lines)
    for name, values in rays["arrays"].items():
        data = polydata.GetPointData() if name in _OF_A_VERTEX else polydata.GetCellData()
        _add(data, name, values, rays["channels"] if name in ("wavelength", "radiance") else _OF_A_RAY.get(name, ()))
    _add_texts(polydata.GetFieldData(), "surfaces", rays["surfaces"])
    return polydata


def block_to_table(block):
    """Columns in the memory of the block."""
    table = vtkTable()
    for name, values in block["columns"].items():
        _add(table.GetRowData(), name, values)
    for name, values in block["fields"].items():
        _add(table.GetFieldData(), name, values)
    return table


def text_of_event(message):
    """The message within VTK's 'ERROR: In FILE, line N\\nCLASS (ADDRESS): MESSAGE'."""
    match = re.search(r"\(0x[0-9a-f]+\): (.*)", message, re.DOTALL)
    return (match[1] if match else message).strip()


@contextlib.contextmanager
def events_of(*objects):
    """Raises Error for the first error event of these objects of VTK, and passes their warning events on."""
    errors, cautions, tags = [], [], []

    def note(into):
        def callback(_caller, _event, text):
            into.append(text_of_event(text))
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
