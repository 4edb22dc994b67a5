"""Arguments as the texts that the command's options take."""

from . import _check
from ._run import Error, errors_of
from ._values import Quantity, text_of


def lengths(value, unit="m"):
    """A text, or numbers in metres, as a text with units."""
    if isinstance(value, (str, Quantity)):
        return text_of(value)
    if isinstance(value, (list, tuple)) or hasattr(value, "tolist"):
        return ", ".join(lengths(part, unit) for part in value)
    return f"{_check.number('a length', value)!r} {unit}"


def words(value):
    """A text, a number, or several of them with commas between."""
    if isinstance(value, (list, tuple)):
        return ",".join(words(part) for part in value)
    return text_of(value)


def set_options(algorithm, **options):
    """Sets those that are not None on an algorithm with SetOption()."""
    with errors_of(algorithm):
        for name, value in options.items():
            if value is not None:
                algorithm.set_option(name.replace("_", "-"), value)


def unknowns_options(unknowns, grid, center, size, axis, basis, absorption, channel):
    """Options that operators and reconstructions have in common."""
    if absorption is not None and not isinstance(absorption, str):
        absorption = lengths(absorption, "1/m")
    return {"unknowns": unknowns, "grid": None if grid is None else words(grid),
            "center": None if center is None else lengths(center), "size": None if size is None else lengths(size),
            "axis": None if axis is None else lengths(axis), "basis": basis, "absorption": absorption,
            "channel": None if channel is None else words(channel)}


def cameras_of(scene):
    """A scene for each of its cameras; of several scenes, one after the other."""
    from .scene import Scene
    scenes = scene if isinstance(scene, (list, tuple)) else [scene]
    found = []
    for one in scenes:
        if not isinstance(one, Scene):
            raise Error(f"scene takes a Scene, or a list of them, not {one!r}")
        chosen = [one.camera_name] if one.camera_name else one.cameras
        # Copies: what is changed of the scene afterwards plays no part.
        found += [one.with_camera(name) if name else one.copy() for name in chosen]
    if not found:
        raise Error("scene takes a Scene, or a list of them, not an empty list")
    return found
