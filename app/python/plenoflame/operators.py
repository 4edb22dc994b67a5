"""The matrix from a flame's samples to the pixels' fluxes, as a linear operator of SciPy."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy
from scipy.sparse import csr_matrix
from scipy.sparse.linalg import LinearOperator

from . import _check, _core
from ._arguments import guarded
from ._home import attribute
from ._options import cameras_of
from ._run import Error, errors_of, made, update
from .light_field import LightField


if TYPE_CHECKING:
    from typing import Any, Callable, Sequence

    from ._types import Array


@guarded
class Operator(LinearOperator):
    """A: samples of a flame (emission [W/(m^3 sr)], or with a known absorption the source function [W/(m^2 sr)]) to the
    fluxes of pixels [W]. Scene.operator() makes it.

    A @ x, A.T @ y, A.matmat(X) and SciPy's solvers (lsqr, lsmr, svds) follow the rays again each time (of the form "drawn"
    draw them again, to the same bits), until A.matrix has been asked for: then they multiply by it. Both directions are exact transposes of each other, and run in threads with
    Python's lock released.
    """

    def __init__(self, algorithm: Any, sensors: list[tuple[int, int]], bin: int, request: tuple[Any, ...]) -> None:
        """sensors: rows and columns of the blocks of each camera's pixels; bin: pixels along a side of a block, 1 for cells
        of micro-images; request: scenes, settings and threads, by which a pickled one is made again."""
        self._algorithm = algorithm
        super().__init__(numpy.dtype(float), algorithm.shape)
        self._matrix = None
        self._sensors = sensors
        self._bin = bin
        self._request = request

    def __reduce__(self) -> tuple[Any, ...]:
        return _made_again, self._request

    def __repr__(self) -> str:
        return f"<plenoflame.Operator, {self.shape[0]} rows, {self.shape[1]} unknowns, {self.rays} rays>"

    @property
    def settings(self) -> dict[str, Any]:
        """The arguments of Scene.operator() that were given."""
        return dict(self._request[1])

    rays: int = attribute("rays", "Rays that make it.", "_algorithm")
    of_source: bool = attribute("of_source", "Whether samples are those of a source function; else of emission.", "_algorithm")

    @property
    def grid_shape(self) -> tuple[int, ...]:
        """Unknowns along each axis, e.g. (rings, heights); numbers x.reshape(A.grid_shape)."""
        shape = self._algorithm.grid_shape
        while len(shape) > 1 and shape[-1] == 1:
            shape.pop()
        return tuple(shape)

    pixels: Array = attribute(
        "pixels", "Of each row column and line of its (block's or cell's first) pixel, and the number of its camera: (rows, 3).", "_algorithm")
    places: Array = attribute("places", "Place of each unknown in the world [m]: (unknowns, 3); of a ring one of its points.", "_algorithm")
    volumes: Array = attribute("volumes", "Volume of each unknown [m^3]: (unknowns,).", "_algorithm")
    matrix_bytes: float = attribute("matrix_bytes", "What `matrix` takes, about.", "_algorithm")

    @property
    def matrix(self) -> csr_matrix:
        """The matrix as scipy.sparse.csr_matrix of single precision. Its `data` and `indices` are the memory of the
        library, not copies: they cannot be written to (A.matrix.copy() can), and outlive this object. Raises Error where
        there is not enough memory."""
        if self._matrix is None:
            self._algorithm.stored = True
            update(self._algorithm)
            parts = self._algorithm.values, self._algorithm.column_indices, self._algorithm.row_starts
            for part in parts:
                part.setflags(write=False)
            self._matrix = csr_matrix(parts, shape=self.shape, copy=False)
        return self._matrix

    def _times(self, transpose, vector):
        vector = numpy.ascontiguousarray(numpy.asarray(vector).ravel(), dtype=float)
        with errors_of():
            return self._algorithm.times(transpose, vector)

    def _dimensions(self, name, values, size):
        shape = numpy.shape(values)
        if len(shape) not in (1, 2) or shape[0] != size:
            raise ValueError(f"dimension mismatch: {name} has the shape {shape}, the operator {self.shape}; {name} takes {size} numbers")

    def matvec(self, x: Any) -> Array:
        self._dimensions("x", x, self.shape[1])
        return super().matvec(x)

    def rmatvec(self, x: Any) -> Array:
        self._dimensions("y", x, self.shape[0])
        return super().rmatvec(x)

    def matmat(self, X: Any) -> Array:
        self._dimensions("X", X, self.shape[1])
        return super().matmat(X)

    def rmatmat(self, X: Any) -> Array:
        self._dimensions("Y", X, self.shape[0])
        return super().rmatmat(X)

    def _matvec(self, x):
        return self._times(False, x)

    def _rmatvec(self, y):
        return self._times(True, y)

    def vjp(self, x: Array) -> tuple[Array, Callable[[Array], Array]]:
        """A x, and the function that takes a gradient with regard to it back to one with regard to x (which, as A is
        linear, is A^T): what automatic differentiation asks of a function."""
        return self @ x, lambda gradient: self.rmatvec(gradient)

    def rows(self, images: LightField | Array | Sequence[LightField | Array]) -> Array:
        """The fluxes of pictures as a vector of the rows, the inverse of image(): of blocks the sums over their pixels. Raises
        Error for rows that are parts of micro-images.

        images: a LightField or an array (rows, columns) of the sensor; of several cameras a list of them, in their order
        """
        scenes, settings, _ = self._request
        channel, bin = settings.get("channel"), settings.get("bin", 1)
        if bin in ("view", "micro-image"):
            raise Error(f"rows() needs rows of whole pixels, not bin={bin!r}")
        images = images if isinstance(images, (list, tuple)) else [images]
        if len(images) != len(scenes):
            raise Error(f"images takes a picture of each of {len(scenes)} cameras, not {len(images)}")
        result = numpy.empty(self.shape[0])
        for camera, (scene, image) in enumerate(zip(scenes, images)):
            if isinstance(image, LightField):
                image = image[channel] if channel else image.flux
            picture = numpy.asarray(image, dtype=float)
            if picture.shape != (scene.rows, scene.columns):
                raise Error(f"images takes the whole sensor, an array of the shape {(scene.rows, scene.columns)}, "
                            f"not {picture.shape}")
            lines, columns = self._sensors[camera]
            blocks = picture[:lines * self._bin, :columns * self._bin].reshape(lines, self._bin, columns, self._bin).sum((1, 3))
            own = self.pixels[:, 2] == camera
            result[own] = blocks[self.pixels[own, 1] // self._bin, self.pixels[own, 0] // self._bin]
        return result

    def image(self, fluxes: Array, camera: int = 0) -> Array:
        """Fluxes of the rows as a picture: numpy array (rows, columns) of a camera's pixels, or blocks of them; 0 where
        no ray meets the grid. Rows that are parts of micro-images are at their first pixel."""
        fluxes = numpy.asarray(fluxes)
        if fluxes.shape != (self.shape[0],):
            raise Error(f"fluxes takes {self.shape[0]} numbers, one for each row, not an array of the shape {fluxes.shape}")
        camera = _check.whole("camera", camera, 0, int(self.pixels[:, 2].max()))
        own = self.pixels[:, 2] == camera
        columns, lines = (self.pixels[own, axis] // self._bin for axis in (0, 1))
        picture = numpy.zeros(self._sensors[camera])
        picture[lines, columns] = fluxes[own]
        return picture


def make_operator(scene, rows, settings, threads, progress=None):
    """Scene.operator(). rows: Settings of an operator; settings: those that are given."""
    algorithm = made(_core.Operator, threads=_check.threads(threads))
    scenes = cameras_of(scene)
    rows.set(algorithm, settings)
    for one in scenes:
        algorithm.add_camera(one._scene)
    update(algorithm, progress, "operator")
    if algorithm.shape[0] == 0:
        raise Error("stopped before there was a result")
    bin = settings.get("bin", 1)
    side = 1 if str(bin) in ("view", "micro-image") else int(bin)
    return Operator(algorithm, [(one.rows // side, one.columns // side) for one in scenes], side, (scenes, settings, threads))


def _made_again(scenes, settings, threads):
    from .scene import OPERATOR
    return make_operator(scenes, OPERATOR, settings, threads)
