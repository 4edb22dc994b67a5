"""Running the library without VTK, and what it gives: pictures, voxels, rays and blocks of rays as numpy arrays."""

import contextlib

from . import _core
from ._run import Error, deliver


@contextlib.contextmanager
def errors_of(*objects):
    """Raises Error for what these objects refuse, and passes their warnings on."""
    errors = []
    try:
        yield
    except _core.Failure as failure:
        errors.append(str(failure))
    deliver(errors, [text for subject in objects if hasattr(subject, "TakeWarnings") for text in subject.TakeWarnings()])


def run(algorithm, on_progress, on_message):
    """Runs an algorithm, with Python's lock released. Neither function may raise."""
    try:
        algorithm.Run(on_progress, lambda text: on_message(0, text))
    except _core.Failure as failure:
        on_message(1, str(failure))


def write(writer):
    """Has a writer write its file."""
    errors = []
    run(writer, lambda _fraction: 0, lambda is_error, text: errors.append(text) if is_error else None)
    deliver(errors, [])


def image_array(image, name):
    """An array of a light field as numpy (rows, columns), row 0 at the top. Shares its memory."""
    if isinstance(image, dict):
        return image[name]
    values = image.Array(name)
    if values is None:
        raise Error(f"the image has no array '{name}'; it has {', '.join(image.ArrayNames()) or 'none'}")
    return values


def image_texts(image, name):
    """What a light field says about itself, as a list of texts or numbers."""
    return {"channels": image.Channels, "layers": image.Layers, "scene": lambda: [image.SceneText()],
            "window": image.Window, "complete": lambda: [image.Complete()],
            "unit": lambda: [image.State()["texts"][3]]}[name]()


def touch(_image):
    """Says that values may have changed: nothing is remembered of them."""


def numbers(array):
    """Arrays of the library are those of numpy; they keep its memory."""
    return array


def of_numbers(values):
    return values


def operator_times(algorithm, transpose, vector, _size):
    """A x, or A^T x, of an operator, with Python's lock released."""
    return algorithm.Times(transpose, vector)


def views_of(algorithm, _array):
    """All views that the filter made, and the contact sheet."""
    return algorithm.GetViews()


def ray_points(rays):
    return rays["points"]


def ray_offsets(rays):
    return rays["offsets"]


def ray_surfaces(rays):
    return rays["surfaces"]


def ray_array(rays, name):
    """None where there is none."""
    return rays["arrays"].get(name)


def write_rays(path, rays):
    try:
        _core.WriteRays(path, rays)
    except _core.Failure as failure:
        deliver([str(failure)], [])


def table_rows(table):
    return table["rows"]


def table_field(table, name):
    return table["fields"][name]


def table_column(table, name):
    """None where there is none."""
    return table["columns"].get(name)


VOXELS = "voxels"


def is_voxels(value):
    return isinstance(value, _core.Voxels)


def voxels_from(arrays, spacing, origin):
    """Fields {name: array [i, j, k] of float32} as voxels."""
    shape = next(iter(arrays.values())).shape
    voxels = _core.Voxels(shape, origin, spacing, [(1, 0, 0), (0, 1, 0), (0, 0, 1)])
    for name, values in arrays.items():
        voxels.Add(name, values)
    return voxels


def voxel_arrays(voxels):
    """{name: array [i, j, k]}, spacing, origin, and the directions of the three axes."""
    return {name: voxels.Array(name) for name in voxels.ArrayNames()}, voxels.Spacing(), voxels.Origin(), voxels.Direction()


def state_of(data):
    """Plain values that hold all of a light field, of voxels or of rays."""
    if isinstance(data, dict):
        return data
    if isinstance(data, _core.LightField):
        return {"light field": data.State()}
    arrays, spacing, origin, directions = voxel_arrays(data)
    return {"voxels": {name: values.copy() for name, values in arrays.items()},
            "place": (data.Size(), origin, spacing, directions)}


def data_of(state):
    """The data of a state."""
    if "light field" in state:
        return _core.LightField.FromState(state["light field"])
    if "voxels" not in state:
        return state
    voxels = _core.Voxels(*state["place"])
    for name, values in state["voxels"].items():
        voxels.Add(name, values)
    return voxels
