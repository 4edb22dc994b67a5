"""Analytic fields that simulations are made of in the tests, and the voxels of what was imported."""

import itertools

import numpy
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import VTK_TETRA, vtkUnstructuredGrid


def temperature(p):
    """[K], linear: what interpolation within tetrahedra gives back exactly."""
    return 1200 + 4000 * p[..., 0] - 2500 * p[..., 1] + 3000 * p[..., 2]


def soot(p):
    return 1e-6 + 2e-5 * p[..., 2] + 1e-5 * p[..., 0]


def voxels(image):
    """(points (n, 3), temperature, absorption) of an imported flame."""
    image = image.to_vtk()
    points = numpy.array([image.GetPoint(i) for i in range(image.GetNumberOfPoints())])
    data = image.GetPointData()
    return points, vtk_to_numpy(data.GetArray("temperature")), vtk_to_numpy(data.GetArray("absorption"))


def mesh(cells=6, seed=4):
    """Tetrahedra that fill a box of 40 x 40 x 60 mm: cells^3 boxes with displaced corners, cut into six each."""
    n = cells + 1
    lattice = numpy.stack(numpy.meshgrid(*[numpy.arange(n)] * 3, indexing="ij"), -1).reshape(-1, 3)
    inner = ((lattice > 0) & (lattice < cells)).astype(float)
    moved = lattice + 0.25 * inner * (2 * numpy.random.default_rng(seed).random(lattice.shape) - 1)
    points = (moved / cells - (0.5, 0.5, 0)) * (0.04, 0.04, 0.06)
    grid = vtkUnstructuredGrid()
    grid.SetPoints(vtkPoints())
    grid.GetPoints().SetData(numpy_to_vtk(points, deep=True))
    number = {tuple(place): i for i, place in enumerate(lattice)}
    for corner in itertools.product(range(cells), repeat=3):
        for order in itertools.permutations(range(3)):
            place, ids = list(corner), [number[corner]]
            for axis in order:
                place[axis] += 1
                ids.append(number[tuple(place)])
            a, b, c, d = points[ids]
            if numpy.dot(numpy.cross(b - a, c - a), d - a) < 0:
                ids[2], ids[3] = ids[3], ids[2]
            grid.InsertNextCell(VTK_TETRA, 4, ids)
    for name, values in (("T", temperature(points)), ("fv", soot(points)), ("k", 5 + 100 * points[:, 2])):
        array = numpy_to_vtk(values, deep=True)
        array.SetName(name)
        grid.GetPointData().AddArray(array)
    vector = numpy_to_vtk(points, deep=True)
    vector.SetName("U")
    grid.GetPointData().AddArray(vector)
    return grid
