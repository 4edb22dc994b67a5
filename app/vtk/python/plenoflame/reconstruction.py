"""Flames back from pictures of them."""

import json
import os

import numpy

from . import _check
from ._library import data, library
from ._options import cameras_of, in_our_words, lengths, set_options, unknowns_options, words
from ._run import Error, update
from .light_field import LightField, read_light_field

_FIELDS = ("emission", "temperature", "absorption")


class Reconstruction:
    """What reconstruct() found. Fields are numpy arrays over the unknowns, e.g. (rings, heights) or (x, y, z), and None
    where they are not known:

    temperature [K] (0: none), absorption [1/m], emission [W/(m^3 sr)], each with NAME_deviation; resolved: 1 where the
    pictures decide, 0 where the penalty does; resolved_absorption.
    """

    def __init__(self, algorithm):
        self.algorithm = algorithm  #: the vtkPlenoflameReconstruction, or what stands for it without VTK
        self.image = algorithm.GetOutput()  #: the fields on voxels, a vtkImageData (with VTK) as Scene.add_flame takes it
        self.figures = json.loads(algorithm.GetFiguresAsJson())  #: as `plenoflame reconstruct --json` prints them
        self.report = algorithm.GetReport()  #: the same as text, a line each
        shape = [algorithm.GetShape(axis) for axis in range(3)]
        while len(shape) > 1 and shape[-1] == 1:
            shape.pop()
        self.shape = tuple(shape)  #: unknowns along each axis
        self._fields = {algorithm.GetFieldName(i): data.numbers(algorithm.GetField(i)).reshape(self.shape)
                        for i in range(algorithm.GetNumberOfFields())}

    def __repr__(self):
        state = "" if self.complete else ", stopped early"
        return f"<plenoflame.Reconstruction, {' x '.join(map(str, self.shape))} unknowns: {', '.join(self._fields)}{state}>"

    @property
    def complete(self):
        """False when it was stopped early: what was reached by then."""
        return self.algorithm.IsComplete()

    @property
    def temperature(self):
        """[K]; 0: what emits next to nothing has none."""
        return self._fields.get("temperature")

    @property
    def temperature_deviation(self):
        """[K] standard deviation."""
        return self._fields.get("temperature_deviation")

    @property
    def absorption(self):
        """[1/m]"""
        return self._fields.get("absorption")

    @property
    def absorption_deviation(self):
        """[1/m] standard deviation, where it was solved for."""
        return self._fields.get("absorption_deviation")

    @property
    def emission(self):
        """[W/(m^3 sr)] into the channel."""
        return self._fields.get("emission")

    @property
    def emission_deviation(self):
        """[W/(m^3 sr)] standard deviation."""
        return self._fields.get("emission_deviation")

    @property
    def resolved(self):
        """Diagonal of the resolution matrix, 0 to 1."""
        return self._fields.get("resolved")

    @property
    def resolved_absorption(self):
        """The same of the absorption, where it was solved for."""
        return self._fields.get("resolved_absorption")

    @property
    def places(self):
        """Place of each unknown in the world [m]: shape + (3,)."""
        return data.numbers(self.algorithm.GetPlaces()).reshape((*self.shape, 3))

    @property
    def history(self):
        """chi^2 per row, iteration by iteration."""
        return numpy.array(self.figures["history"])

    @property
    def residuals(self):
        """What the flame does not explain of each picture [W]: arrays (rows, columns), of the cameras of the first channel,
        then of the second."""
        return self._pictures("residual")

    @property
    def explained(self):
        """What it does [W]."""
        return self._pictures("explained")

    def _pictures(self, name):
        return [data.image_array(self.algorithm.GetPicture(i), name).copy() for i in range(self.algorithm.GetNumberOfPictures())]

    def save(self, path):
        """Writes the grids as `plenoflame reconstruct -o` does. Raises Error."""
        with data.errors_of(self.algorithm):
            self.algorithm.Write(_check.file(path, ".vdb"))


def _set_earlier(algorithm, use, result):
    """A file's name is an option; of a Reconstruction the fields are handed over."""
    if result is None or isinstance(result, (str, os.PathLike)):
        return None if result is None else os.fspath(result)
    if not isinstance(result, Reconstruction):
        raise Error(f"{use} takes a Reconstruction or the name of a file, not {result!r}")
    with data.errors_of(algorithm):
        for name in _FIELDS:
            values = getattr(result, name)
            if values is not None:
                algorithm.SetEarlierField(use, name, data.of_numbers(values.ravel()))
    return None


def _pictures_of(images, scenes):
    """[(LightField, name)] in the order of the cameras."""
    if isinstance(images, dict):
        names = [scene.camera_name for scene in scenes]
        if set(images) != set(names):
            raise Error(f"images has pictures of {', '.join(map(repr, images))}; the cameras are {', '.join(map(repr, names))}")
        images = [images[name] for name in names]
    elif not isinstance(images, (list, tuple)):
        images = [images]
    if len(images) != len(scenes):
        raise Error(f"{len(scenes)} cameras but {len(images)} pictures: each camera needs one of its own")
    found = []
    for number, image in enumerate(images, 1):
        if isinstance(image, (str, os.PathLike)):
            found.append((read_light_field(image), os.fspath(image)))
        elif isinstance(image, LightField):
            found.append((image, "the picture" if len(images) == 1 else f"picture {number}"))
        else:
            raise Error(f"images takes LightFields or names of files, not {image!r}")
    return found


def reconstruct(scene, images, *, find="emission", unknowns="voxels", grid=None, center=None, size=None, axis=None, basis=None,
                absorption=None, channel=None, absorption_ratios=None, noise=0, support=None, all_voxels=False,
                solver="fista", smoothing=None, strength=None, iterations=300, subsets=None,
                relaxation=None, prior=None, start=None, rays=64, bin=1, cells=None, draws=30, probes=16, spread=(), memory=2000,
                form="auto", seed=None, truth=False, threads=0, progress=None):
    """The flame back from pictures of it, as `plenoflame reconstruct` (docs/reconstruct.md), whose options these are.

        found = plenoflame.reconstruct(scene, scene.render(512), unknowns="rings", grid=(16, 32), absorption="scene")
        found.temperature, found.temperature_deviation
        scene.add_flame(found.image)

    scene: a Scene, or several; all cameras of each, or the one that is chosen
    images: a LightField or the name of its file, a list of them in the order of the cameras, or a dict by their names
    find: "emission", "temperature" (with known absorption, on the renderer's formulas), "both" (of two channels)
    grid: numbers of unknowns; center, size, axis: in metres, or texts with units
    absorption: None, "scene", or a value [1/m]
    start, prior: a Reconstruction or a file
    memory: of a stored matrix [MB]; beyond it rays are followed again in each iteration
    form: what is kept: the "matrix", its "rays", or nothing: rays are "drawn" again in each iteration; "auto": the first that
    there is memory for
    progress: called with the fraction done; a true result ends the run early, with what was reached until then

    Returns Reconstruction. Raises Error with the sentence of the command. Ctrl-C raises KeyboardInterrupt; what was reached
    by then is its `reconstruction` (None: nothing yet).
    """
    algorithm = library.Reconstruction()
    scenes = cameras_of(scene)
    pictures = _pictures_of(images, scenes)
    options = unknowns_options(unknowns, grid, center, size, axis, basis, absorption, channel)
    numbers = {"noise": noise, "strength": strength, "relaxation": relaxation, "iterations": iterations, "subsets": subsets,
               "rays": rays, "bin": bin, "cells": cells, "draws": draws, "probes": probes, "memory": memory, "seed": seed,
               "smoothing": smoothing, "absorption_ratios": absorption_ratios}
    options.update({name: None if value is None else words(value) for name, value in numbers.items()})
    options.update(form=form, find=find, solver=solver,
                   support=None if support is None else os.fspath(support), start=_set_earlier(algorithm, "start", start),
                   prior=_set_earlier(algorithm, "prior", prior), truth=str(bool(truth)).lower(),
                   all_voxels=str(bool(all_voxels)).lower())
    options = {name: value if value is None else _check.text(name, value) for name, value in options.items()}
    set_options(algorithm, **options)
    for place in [spread] if isinstance(spread, str) else spread:
        set_options(algorithm, spread=lengths(place))
    algorithm.SetNumberOfThreads(_check.whole("threads", threads, 0, 1024))
    for one, (picture, name) in zip(scenes, pictures):
        algorithm.AddCamera(one._scene, picture._data, name)
    try:
        with in_our_words():
            update(algorithm, progress)
    except KeyboardInterrupt as interrupt:
        interrupt.reconstruction = Reconstruction(algorithm) if algorithm.HasResult() else None
        raise
    if not algorithm.HasResult():
        raise Error("stopped before there was a result")
    return Reconstruction(algorithm)
