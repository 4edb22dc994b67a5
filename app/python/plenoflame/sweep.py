"""Sweeps: many runs of a scene with values of their own."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple, overload

from . import _core
from ._options import Settings
from ._run import Error, errors_of
from .flame import make_flame

if TYPE_CHECKING:
    from typing import Any

    from .scene import Scene

SETTINGS = Settings(_core.Sweep.settings())


class SweepRun(NamedTuple):
    """A run of a sweep. run.scene.render(seed=run.seed) is the command's picture."""

    number: int
    values: dict[str, str]  # by the keys of the scene
    test: bool  # it is for testing
    seed: int  # of its picture
    scene: Scene  # with these values


class Sweep(Sequence[SweepRun]):
    """The runs of a sweep, from Scene.sweep(). The scene of a run is made when the run is asked for; a value that it
    refuses then raises Error with its place."""

    def __init__(self, scene: Scene, settings: dict[str, Any]) -> None:
        """Takes the arguments of Scene.sweep()."""
        self._scene = scene.copy()
        self._drawn = _core.Sweep()
        SETTINGS.set(self._drawn, settings)
        with errors_of():
            self._drawn.draw()

    def __repr__(self):
        return f"<plenoflame.Sweep, {len(self)} runs>"

    def __len__(self) -> int:
        return len(self._drawn)

    @overload
    def __getitem__(self, number: int) -> SweepRun: ...
    @overload
    def __getitem__(self, number: slice) -> list[SweepRun]: ...

    def __getitem__(self, number):
        places = range(len(self))[number]
        return self._run(places) if isinstance(places, int) else [self._run(one) for one in places]

    def _run(self, number):
        values, test, seed = self._drawn.run(number)
        scene = self._scene.copy()
        made = {}  # flames by their paths: parameters, and the generator by ""
        for place, (key, value) in enumerate(values):
            parts = re.fullmatch(r"(flames[^.]*)\.generator(?:\.(.+))?", key)
            try:
                if not key:  # a row without values
                    continue
                if parts:
                    made.setdefault(parts[1], {})[parts[2] or ""] = value
                else:
                    scene[key] = value
            except Error as error:
                with errors_of():
                    self._drawn.refuse(number, place, str(error))
        for flame, parameters in made.items():
            if scene[f"{flame}.kind"] != "vdb":
                raise Error(f'{flame}.generator: a generated flame takes the place of a file; give the scene\'s flame kind = "vdb"')
            if "" not in parameters:
                raise Error(f'{flame}.generator is missing; name the generator of the flame, such as {flame}.generator = "candle"')
            scene._keep_flame(make_flame(parameters.pop(""), **parameters), flame)
        return SweepRun(number, {key: value for key, value in values if key}, test, seed, scene)
