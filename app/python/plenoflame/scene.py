"""A scene: a camera, its flames, and how to render them."""

from __future__ import annotations

import json
import os
from typing import TYPE_CHECKING, NamedTuple

from . import _check, _core, _home
from ._arguments import refusal
from ._options import Settings
from ._run import Error, errors_of, made, need_vtk, update
from ._values import text_of, tree, value_of
from .flame import Flame, voxels_of
from .light_field import LightField
from .measurements import corners_of
from .ray_blocks import ray_blocks
from .rays import Rays
from .sweep import SETTINGS as SWEEP, Sweep


if TYPE_CHECKING:
    from typing import Any, Iterable, Iterator, Sequence

    from ._types import Path, Progress, Value
    from .measurements import Corners
    from .operators import Operator
    from .ray_blocks import RayBlock

_ESTIMATORS = {None: None, "backward": _core.Estimator.backward, "forward": _core.Estimator.forward}

OPERATOR = Settings(_core.operator_settings(), basis="str | None", bin="int | str")
_OPTIMIZE = Settings(_core.Optimize.settings())


class Optimized(NamedTuple):
    """What Scene.optimize() found: a Scene with the better camera, and a dict of figures before and after."""

    scene: Scene
    figures: dict[str, Any]


class Scene(_home.Shown):
    """The scene of a TOML file.

    Values are read and set by the paths of docs/reference/scene.md. Numbers come as numbers in SI units that know their
    unit (Quantity), tables as dicts, lists of tables as lists; they are set from text with a unit, from a Quantity, or
    from plain numbers where the key has no unit:

        >>> import plenoflame
        >>> scene = plenoflame.Scene("small.toml")
        >>> scene["camera.lens.surfaces[0].radius"] = "30 mm"
        >>> scene["camera.lens.surfaces[0].radius"]
        Quantity(0.03, 'm')
        >>> scene["camera.lens.surfaces[0].radius"] *= 1.1
        >>> scene.get_text("camera.lens.surfaces[0].radius")
        '33 mm'
        >>> scene["flames"][0]["kind"]
        'layered'

    A scene with several cameras ([[cameras]]) is about the one that scene.camera_name names: what is rendered, designed and
    traced. Pictures of all of them:

        pictures = {name: scene.with_camera(name).render() for name in scene.cameras}

    scene.to_vtk() is the same as an input for the algorithms of plenoflame.vtk.
    """

    def __init__(self, path: Path | None = None, *, text: str | None = None, name: Path = "scene.toml") -> None:
        """Reads the file `path`, or takes `text` in the same form (`name` stands for the file in messages and is where
        relative paths start). Raises Error with file, line and column."""
        if (path is None) == (text is None):
            raise TypeError("give either a path or text=")
        self._name = os.path.abspath(os.fspath(name if path is None else path))
        self._images = {}  # flames in memory by their names: (Flame, ambient temperature)
        self._scene = _core.Scene()
        with errors_of(self._scene):
            if text is None:
                self._scene.read_file(os.fspath(path))
            else:
                self._scene.read_text(text, os.fspath(name))

    def __repr__(self):
        several = len(self.cameras) > 1 and not self.camera_name
        cameras = "cameras " + ", ".join(self.cameras) if several else f"{self.columns} x {self.rows} pixels"
        return (f"<plenoflame.Scene, {cameras}, {self.list_size('flames')} flames, "
                f"channels {', '.join(self.channels)}>")

    def _summary(self):
        if len(self.cameras) > 1:
            yield "cameras", ", ".join(self.cameras) + (f"; chosen: {self.camera_name}" if self.camera_name else "")
        if len(self.cameras) == 1 or self.camera_name:
            yield "sensor", f"{self.columns} x {self.rows} pixels"
            try:
                design = self.design()
            except Error as error:
                yield "camera", error
            else:
                yield "lens", f"f = {1e3 * design['focal_length_m']:.4g} mm, f/{design['f_number']:.3g}"
                if design.get("object_distance_m"):
                    yield "focused on", f"{design['object_distance_m']:.4g} m"
        yield "channels", ", ".join(self.channels)
        yield "flames", ", ".join(flame["name"] or flame["kind"] for flame in self["flames"]) or "none"

    def _preview(self):
        try:
            one = self if self.camera_name or len(self.cameras) == 1 else self.with_camera(self.cameras[0])
            return one.flame(48)._preview()
        except Error:  # no flame, or one of emission alone
            return None

    def to_vtk(self) -> Any:
        """A vtkPlenoflameScene of the same text, camera and flames in memory, an input for the algorithms of plenoflame.vtk. What
        is changed of this scene afterwards plays no part there. Raises Error without VTK."""
        scene = need_vtk("Scene.to_vtk()").vtkPlenoflameScene()
        from ._vtk import events_of
        with events_of(scene):
            if scene.ReadText(self.text, self._name):
                for name, (flame, ambient) in self._images.items():
                    scene.SetFlameImage(name, flame.to_vtk(), ambient)
                scene.SetCamera(self.camera_name)
        return scene

    @property
    def cameras(self) -> list[str]:
        """Names of the cameras; that of a single one may be empty."""
        return self._scene.cameras

    @property
    def camera_name(self) -> str:
        """Name of the camera that the scene is about; empty: the only one. Setting it raises Error for a name that no
        camera has. Values and texts are those of all cameras, whichever is chosen."""
        return self._scene.camera

    @camera_name.setter
    def camera_name(self, name: str) -> None:
        with errors_of(self._scene):
            self._scene.camera = name

    def with_camera(self, name: str) -> Scene:
        """A copy that is about another camera."""
        copy = self.copy()
        copy.camera_name = name
        return copy

    @property
    def frames(self) -> range:
        """Numbers of the frames of flames that change with time, a range; empty where nothing does, or where neither a
        series nor camera.sensor.frame_rate says how many there are per second."""
        with errors_of(self._scene):
            first, last = self._scene.frames
        return range(first, last + 1)

    def at_frame(self, number: int) -> Scene:
        """A copy in which nothing changes any more: the scene at the begin of a frame's exposure. Raises Error for a
        number that is not among frames, or a file that is missing."""
        copy = self.copy()
        with errors_of(copy._scene):
            copy._scene.move_to_frame(number)
        return copy

    def at_time(self, seconds: float) -> Scene:
        """The same at a time in s since the begin of the first frame."""
        copy = self.copy()
        with errors_of(copy._scene):
            copy._scene.move_to_time(seconds)
        return copy

    @property
    def columns(self) -> int:
        """Columns of the sensor. Raises Error where there are several cameras and none is chosen."""
        with errors_of(self._scene):
            return self._scene.columns

    @property
    def rows(self) -> int:
        """Rows of the sensor, as columns."""
        with errors_of(self._scene):
            return self._scene.rows

    @property
    def channels(self) -> list[str]:
        """Names of the channels."""
        return self._scene.channels

    @property
    def text(self) -> str:
        """The whole scene as TOML, presets resolved."""
        with errors_of(self._scene):
            return self._scene.text

    def save(self, path: Path) -> None:
        """Writes the scene to a TOML file. A scene with a flame in memory has no file: write_flame() first, and set the
        flame's "file"."""
        for number in range(self.list_size("flames")):
            if self[f"flames[{number}].file"] in self._images:
                raise Error(f"flames[{number}] is in memory: write it with write_flame(), and set flames[{number}].file")
        with errors_of(self._scene):
            self._scene.write_file(os.fspath(path))

    def keys(self) -> list[str]:
        """Paths of all values."""
        return self._scene.paths

    def __iter__(self) -> Iterator[str]:
        return iter(self.keys())

    def __getitem__(self, path: str) -> Any:
        """The value at a path: a number (Quantity where it has a unit), text, true or false, or a tuple of numbers; a
        table as a dict, a list of tables as a list. Raises KeyError for an unknown path."""
        try:
            with errors_of(self._scene):
                text = self._scene.value_json(path)
            return value_of(text)
        except Error as error:
            below = [key for key in self.keys() if key.startswith((path + ".", path + "["))]
            if below:
                return tree(path, {key: self[key] for key in below})
            try:
                self.list_size(path)
            except Error:
                raise KeyError(str(error)) from None
            return []

    def get_text(self, path: str) -> str:
        """The value at a path as a scene file has it, with its unit. Raises KeyError for an unknown path."""
        try:
            with errors_of(self._scene):
                return self._scene.value(path)
        except Error as error:
            raise KeyError(str(error)) from None

    def __setitem__(self, path: str, value: Value) -> None:
        """Sets a value from text with a unit or a Quantity, or from a number, bool or list of them where the key has no
        unit. Raises Error, with the scene unchanged."""
        value = text_of(value)
        with errors_of(self._scene):
            self._scene.set_value(path, value)

    def list_size(self, path: str) -> int:
        """Items of a list of tables, such as "flames" or "camera.lens.surfaces"."""
        with errors_of(self._scene):
            return self._scene.list_size(path)

    def insert(self, path: str, position: int) -> None:
        """Inserts an item with default values into a list of tables."""
        with errors_of(self._scene):
            self._scene.insert(path, _check.whole("position", position, -1))

    def remove(self, path: str, position: int) -> None:
        """Removes an item from a list of tables."""
        with errors_of(self._scene):
            self._scene.remove(path, _check.whole("position", position, -1))

    def add_flame(self, flame: Flame, *, lines: Sequence[str] = (), ambient: float = 293.15, **values: Value) -> None:
        """Adds a flame from memory: a Flame, as make_flame, flame_from_arrays, import_flame and read_flame give
        it. It lasts as long as the scene and its copies; a file of the scene cannot hold it.

            scene.add_flame(plenoflame.flame_from_arrays(T, kappa, spacing=1e-3), position="1 m, 0 m, -20 mm")

        lines: emission lines that it has arrays for, e.g. ["ch"]; ambient: temperature outside [K]; values: of the
        flame by their keys, as scene["flames[0].KEY"] takes them. Raises Error, or TypeError for an unknown key, with the scene
        unchanged.
        """
        voxels = voxels_of(flame)
        ambient = _check.number("ambient", ambient, 0)
        name = f"memory:{len(self._images)}"
        place = self.list_size("flames")
        with errors_of(self._scene):
            self._scene.set_flame(name, voxels, ambient)
        self.insert("flames", place)
        path = f"flames[{place}]"
        try:
            while self.list_size(path + ".layers") > 0:
                self.remove(path + ".layers", 0)
            values = {"name": f"flame {place + 1}", **values, "kind": "vdb", "file": name}
            for number, line in enumerate(lines):
                self.insert(path + ".lines", number)
                values[f"lines[{number}].kind"] = line
            known = [key[len(path) + 1:] for key in self.keys() if key.startswith(path + ".")]
            for key, value in values.items():
                if key not in known:
                    raise TypeError(refusal("Scene.add_flame", key, known))
                self[f"{path}.{key}"] = value
        except (Error, TypeError):
            self.remove("flames", place)
            raise
        self._images[name] = (flame, ambient)

    def _keep_flame(self, flame, path):
        """A flame of kind "vdb" is one in memory."""
        name = f"memory:{len(self._images)}"
        ambient = 293.15
        with errors_of(self._scene):
            self._scene.set_flame(name, voxels_of(flame), ambient)
        self[f"{path}.file"] = name
        self._images[name] = (flame, ambient)

    def check(self) -> None:
        """Checks that the values go together. Raises Error for what is impossible, warns about what is probably not
        meant."""
        with errors_of(self._scene):
            self._scene.validate()

    def copy(self) -> Scene:
        """An independent copy."""
        copy = Scene.__new__(Scene)
        copy._name = self._name
        copy._images = dict(self._images)
        copy._scene = _core.Scene(self._scene)
        return copy

    __copy__ = copy

    def __deepcopy__(self, _memo: Any) -> Scene:
        return self.copy()

    def __reduce__(self) -> tuple[Any, ...]:
        return _scene_of, (self.text, self._name, self._images, self.camera_name)

    def design(self) -> dict[str, Any]:
        """What a camera can do, as `plenoflame design --json` prints it: a dict with SI units; None is infinite."""
        with errors_of(self._scene):
            text = self._scene.design_json()
        return json.loads(text)

    def render(self, samples: int = 0, *, seed: int = -1, estimator: str | None = None,
               window: tuple[int, int, int, int] | None = None, target_error: float = 0.0, time_limit: float = 0.0,
               threads: int = 0, truth: bool = False, white: bool = False, progress: Progress | None = None) -> LightField:
        """Renders the light field.

        samples: rays per pixel and microlens (backward), energy bundles in all (forward); 0: as the scene says
        seed: -1: the scene's
        estimator: "backward", "forward"; None: the scene's
        window: (x, y, width, height) of the sensor, from the top left; None: all
        target_error: relative RMSE over lit pixels at which to stop; time_limit: in seconds; 0: none
        threads: 0: one per processor; the result does not depend on it
        truth: adds layers of ground truth, such as "truth.distance"
        white: a white picture: light of 1 W/(m^2 sr) from everywhere in place of the flames
        progress: True for a bar, or a function that is called with the fraction done; a true result ends the run early, with what is there until then

        Returns a LightField. Raises Error.

            >>> import plenoflame
            >>> field = plenoflame.Scene("small.toml").render(samples=2)
            >>> field.flux.shape, field.channels
            ((60, 60), ['red_650nm'])
        """
        if not 0 <= _check.number("target_error", target_error) < 1:
            raise Error(f"target_error: a share above 0 and below 1, e.g. 0.01, not {target_error!r}")
        source = made(_core.LightFieldSource, scene=self._scene, samples=_check.whole("samples", samples) or None,
                      seed=_seed_of(seed), estimator=_ESTIMATORS[_check.choice("estimator", estimator, _ESTIMATORS)],
                      target_error=target_error or None, time_limit=_check.number("time_limit", time_limit, 0) or None,
                      threads=_check.threads(threads), truth=bool(truth), white=bool(white))
        if window is not None:
            source.window = self._window_of(window)
        update(source, progress, "render")
        with errors_of():  # stopped before there was a picture
            return LightField(source.output, relative_error=source.relative_error)

    def _window_of(self, window):
        x, y, width, height = _check.several("window", window, 4, "four whole numbers x, y, width, height")
        if width < 1 or height < 1 or x + width > self.columns or y + height > self.rows:
            raise Error(f"window reaches beyond the sensor of {self.columns} x {self.rows} pixels")
        return x, y, width, height

    def rays(self, *, pixels: Iterable[tuple[int, int]] = (), microlenses: Iterable[tuple[int, int]] = (),
             points: Iterable[tuple[float, float, float]] = (), random: int = 0, chief: bool = False, rays: int = 64,
             flame_samples: int = 0, status: str | Iterable[str] | None = None, lens_type: int | None = None, most: int = 0,
             seed: int = -1, threads: int = 0) -> Rays:
        """Paths of rays; bundles are added to one another.

        pixels: (column, row), all rays of each; microlenses: (q, r); points: (x, y, z) in the world [m], towards the
        camera; random: so many pixels at random; chief: the chief ray of every microlens
        rays: per pixel and microlens, and per point
        flame_samples: vertices within the flames, with temperature and absorption
        status: any of "reached", "vignetted", "total internal reflection", "missed"; None: all
        lens_type: of the microlens; most: at most so many rays, drawn evenly (sums are no fluxes then)

        Returns Rays. Raises Error.

            >>> import plenoflame
            >>> rays = plenoflame.Scene("small.toml").rays(pixels=[(30, 30)], rays=4)
            >>> bool((rays.pixel == (30, 30)).all()), rays.points.shape[1]
            (True, 3)
        """
        rays = _check.whole("rays", rays, 2)
        source = made(
            _core.RayPathSource, scene=self._scene,
            pixels=[_check.several("pixels", pixel, 2, "pairs of whole numbers, column and row", low=-2 ** 31) for pixel in pixels],
            microlenses=[_check.several("microlenses", lens, 2, "pairs of whole numbers, q and r", low=-2 ** 31)
                         for lens in microlenses],
            points=[_check.several("points", point, 3, "points x, y, z in metres", _check.number) for point in points],
            random=_check.whole("random", random), chief=bool(chief), rays_per_pixel=rays, rays_per_point=rays,
            flame_samples=_check.whole("flame_samples", flame_samples), seed=_seed_of(seed), most=_check.whole("most", most),
            threads=_check.threads(threads))
        if lens_type is not None:
            source.lens_type = _check.whole("lens_type", lens_type)
        if status is not None:
            chosen = [status] if isinstance(status, str) else list(status)
            unknown = set(chosen) - set(Rays.STATUSES)
            if unknown:
                raise Error(f"there is no status {sorted(unknown)[0]!r}; there are {', '.join(Rays.STATUSES)}")
            source.statuses = [name in chosen for name in Rays.STATUSES]
        return Rays(update(source).output)

    def ray_blocks(self, samples: int = 0, *, window: tuple[int, int, int, int] | None = None, precision: str = "double",
                   radiance: bool = False, seed: int = -1, skip: bool = True, rays_per_block: int = 65536,
                   threads: int = 0) -> Iterator[RayBlock]:
        """The rays that make the picture, as an iterator of RayBlock: a pixel's flux is the sum of etendue * radiance over
        its rays. They are traced while the blocks are worked on, a few blocks ahead.

        samples: rays per pixel and microlens; 0: as the scene says
        window: (x, y, width, height) of the sensor, from the top left; None: all
        precision: "double" or "single", of the tracer and of the arrays
        radiance: whether the radiance of each ray is found, too
        seed: -1: the scene's; skip: False: also rays of pixels and microlenses that cannot see the scene
        rays_per_block: about so many
        threads: 0: one per processor. All rays of a pixel come in an order that does not depend on it; with 1 the blocks
        do, too

        Raises Error.

            >>> import plenoflame
            >>> scene = plenoflame.Scene("small.toml")
            >>> flux = sum((b.etendue * b.radiance[:, 0]).sum() for b in scene.ray_blocks(2, radiance=True))
            >>> bool(abs(flux / scene.render(samples=2).flux.sum() - 1) < 1e-4)
            True
        """
        return ray_blocks(self, samples, window, precision, radiance, seed, skip, rays_per_block, threads)

    def corners(self, rays: int = 4096, *, threads: int = 0, progress: Progress | None = None) -> Corners:
        """Where the points of calibration patterns (corners of checkerboards, dots) are, in the world and in the raw image, as
        `plenoflame corners`. Returns Corners.

        rays: over the aperture, for each point

        Raises Error for a scene without such patterns.
        """
        return corners_of(self._scene, rays, threads, progress)

    @_OPTIMIZE.arguments_of
    def optimize(self, *, progress: Progress | None = None, **settings: Any) -> Optimized:
        """A better camera, as `plenoflame optimize`. Returns Optimized; this scene stays as it is.

            better = scene.optimize(merit="volume", height=0.06, depths=(0.99, 1.01), vary=("focal", "spacing")).scene

        {settings}

        Lengths are in metres, or texts with units.

        Raises Error.
        """
        run = made(_core.Optimize, camera=self._scene)
        _OPTIMIZE.set(run, settings)
        better = self.copy()
        better._scene = update(run, progress, "optimize").output
        return Optimized(better, json.loads(run.figures))

    @OPERATOR.arguments_of
    def operator(self, *, threads: int = 0, progress: Progress | None = None, **settings: Any) -> Operator:
        """The matrix from a flame's samples to the pixels' fluxes, as `plenoflame operator` writes it (docs/reconstruct.md):
        a scipy.sparse.linalg.LinearOperator that follows rays, and with .matrix a csr_matrix. Needs SciPy.

            A = scene.operator(unknowns="rings", grid=(16, 32))
            x = scipy.sparse.linalg.lsqr(A, y)[0]

        {settings}

        Lengths are in metres, or texts with units. Without absorption samples are those of emission, else of the source function.

        Of a scene with several cameras: all of them, one after the other, unless one is chosen. Returns Operator. Raises
        Error.
        """
        try:
            from .operators import make_operator
        except ImportError as error:  # SciPy is needed for nothing else
            raise Error(f"operator() needs SciPy (Debian's python3-scipy, or pip install scipy): {error}") from None
        return make_operator(self, OPERATOR, settings, threads, progress)

    @SWEEP.arguments_of
    def sweep(self, **settings: Any) -> Sweep:
        """The runs of `plenoflame sweep`, a sequence of SweepRun:

            for run in scene.sweep(random="rules.toml", runs=100):
                picture = run.scene.render(samples=16, seed=run.seed)

        {settings}

        Raises Error.
        """
        return Sweep(self, settings)

    def camera(self, **settings: Any) -> Any:
        """The camera's geometry as a vtkMultiBlockDataSet: vtkPlenoflameCameraSource, with its properties set by name,
        e.g. LevelOfDetail=2, Window=(100, 100, 64, 64)."""
        source = need_vtk("Scene.camera()").vtkPlenoflameCameraSource()
        self.columns  # raises Error where several cameras wait for a choice
        from ._vtk import events_of
        source.SetInputDataObject(self.to_vtk())
        for name, value in settings.items():
            if not hasattr(source, "Set" + name):
                known = [method[3:] for method in dir(source) if method.startswith("Set")]
                raise TypeError(refusal("Scene.camera", name, known))
            getattr(source, "Set" + name)(value)
        with events_of(source, source.GetExecutive()):
            source.Update()
        return source.GetOutput()

    def flame(self, resolution: int = 128) -> Flame:
        """The flames sampled on a lattice: a Flame with "temperature" [K] and "absorption" [1/m]."""
        resolution = _check.whole("resolution", resolution, 2, 1024)
        return Flame(update(made(_core.FlameSource, scene=self._scene, resolution=resolution)).output)


def _seed_of(seed):
    """None is the scene's."""
    seed = _check.whole("seed", seed, -1, 2 ** 63 - 1)
    return seed if seed >= 0 else None


def _scene_of(text, name, images, camera=""):
    scene = Scene(text=text, name=name)
    scene.camera_name = camera
    for key, (flame, ambient) in images.items():
        scene._images[key] = (flame, ambient)
        with errors_of(scene._scene):
            scene._scene.set_flame(key, voxels_of(flame), ambient)
    return scene
