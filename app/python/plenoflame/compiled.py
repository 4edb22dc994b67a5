"""Cameras whose rays have been found once, for pictures of many flames."""

import json
import os
import pathlib
import tempfile

from . import _core
from ._run import Error, errors_of


class CompiledCamera:
    """A camera whose rays have been found once: of each pixel a few, with weights, in place of its whole bundle.
    Scene.compile() and read_bundle() make it, and Scene.render(compiled=...) renders by it.

    >>> import plenoflame
    >>> scene = plenoflame.Scene("small.toml")
    >>> camera = scene.compile(level=1, samples=16)
    >>> scene["flames[0].brightness"] = 0.5
    >>> scene.render(compiled=camera).flux.shape
    (60, 60)
    """

    def __init__(self, algorithm):
        self._camera = algorithm
        text = algorithm.figures
        if not text:
            raise Error("stopped before the camera was compiled")
        self._figures = json.loads(text)

    def __repr__(self):
        return f"<plenoflame.CompiledCamera, {self.rays} rays of {self.pixels} pixels, window {self.window}>"

    def __reduce__(self):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "camera.bundle")
            self.save(path)
            return _camera_of, (pathlib.Path(path).read_bytes(),)

    @property
    def window(self):
        """(x, y, width, height) of the sensor, from the top left."""
        return tuple(self._figures["window"])

    @property
    def region(self):
        """Box of the world outside of which flames must have no light: two corners (x, y, z) [m]."""
        return tuple(tuple(corner) for corner in self._figures["region_m"])

    @property
    def rays(self):
        """Number of rays that are kept, in two sets."""
        return self._figures["rays"]

    @property
    def pixels(self):
        """Number of pixels that see the region by at least one of the rays."""
        return int(self._figures["pixels"])

    @property
    def error(self):
        """The error that was asked for."""
        return self._figures["error"]

    @property
    def seed(self):
        """Seed of its rays."""
        return self._figures["seed"]

    def save(self, path):
        """Writes it for --compiled of the command, and read_bundle(). Raises Error."""
        with errors_of(self._camera):
            self._camera.write(os.fspath(path))


def _camera_of(content):
    """A file that is mapped stays in memory without its name."""
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "camera.bundle")
        pathlib.Path(path).write_bytes(content)
        return read_bundle(path)


def read_bundle(path):
    """A compiled camera of a file (.bundle), which is mapped into memory: it has to stay. Raises Error.

    Returns CompiledCamera.
    """
    algorithm = _core.CompiledCamera()
    with errors_of(algorithm):
        algorithm.read(os.fspath(path))
    return CompiledCamera(algorithm)
