"""Flames from the files of simulation programs: the same linear field in every format that can be written here, by VTK's
own writers or byte by byte after the format's description. What comes back is known at every voxel."""

import itertools
import json
import pathlib
import struct

import h5py
import numpy
from fields import soot, temperature, voxels
from package import PackageTest, main
from vtkmodules.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import (VTK_HEXAHEDRON, vtkImageData, vtkMultiBlockDataSet, vtkRectilinearGrid,
                                           vtkStructuredGrid, vtkUnstructuredGrid)
from vtkmodules.vtkIOExodus import vtkExodusIIWriter
from vtkmodules.vtkIOLegacy import vtkDataSetWriter
from vtkmodules.vtkIOXML import (vtkXMLImageDataWriter, vtkXMLMultiBlockDataWriter, vtkXMLRectilinearGridWriter,
                                 vtkXMLStructuredGridWriter, vtkXMLUnstructuredGridWriter)

import plenoflame

SIZE = (0.04, 0.03, 0.05)       # of the box [m]; its low corner:
LOW = numpy.array((-0.02, -0.015, 0.01))
NODES = (9, 7, 11)              # along x, y, z


def axes(shape=NODES):
    return [LOW[k] + numpy.linspace(0, SIZE[k], shape[k]) for k in range(3)]


def lattice():
    """Places of the nodes (nz, ny, nx, 3): x runs fastest, as most formats have it."""
    x, y, z = axes()
    return numpy.stack(numpy.broadcast_arrays(x, y[:, None], z[:, None, None]), -1)


def filled(grid, points, cells=False):
    """The grid with the arrays T and fv."""
    data = grid.GetCellData() if cells else grid.GetPointData()
    for name, values in (("T", temperature(points)), ("fv", soot(points))):
        array = numpy_to_vtk(numpy.ascontiguousarray(values.ravel()), deep=True)
        array.SetName(name)
        data.AddArray(array)
    return grid


def image_grid():
    grid = vtkImageData()
    grid.SetDimensions(NODES)
    grid.SetOrigin(LOW)
    grid.SetSpacing(*(SIZE[k] / (NODES[k] - 1) for k in range(3)))
    return filled(grid, lattice())


def rectilinear_grid():
    grid = vtkRectilinearGrid()
    grid.SetDimensions(NODES)
    for setter, values in zip((grid.SetXCoordinates, grid.SetYCoordinates, grid.SetZCoordinates), axes()):
        setter(numpy_to_vtk(values, deep=True))
    return filled(grid, lattice())


def structured_grid(points=None):
    grid = vtkStructuredGrid()
    grid.SetDimensions(NODES)
    points = lattice() if points is None else points
    grid.SetPoints(vtkPoints())
    grid.GetPoints().SetData(numpy_to_vtk(points.reshape(-1, 3), deep=True))
    return filled(grid, points)


def hexahedra():
    grid = vtkUnstructuredGrid()
    points = lattice()
    grid.SetPoints(vtkPoints())
    grid.GetPoints().SetData(numpy_to_vtk(points.reshape(-1, 3), deep=True))
    number = numpy.arange(points.size // 3).reshape(points.shape[:3])
    for k, j, i in itertools.product(*(range(n - 1) for n in points.shape[:3])):
        corners = [(0, 0, 0), (0, 0, 1), (0, 1, 1), (0, 1, 0), (1, 0, 0), (1, 0, 1), (1, 1, 1), (1, 1, 0)]
        grid.InsertNextCell(VTK_HEXAHEDRON, 8, [int(number[k + c, j + b, i + a]) for c, b, a in corners])
    return filled(grid, points)


def write(writer, path, data):
    writer.SetFileName(str(path))
    writer.SetInputData(data)
    assert writer.Write()
    return path


class Formats(PackageTest):
    def check(self, path, hot="T", rtol=1e-6, **options):
        """Temperature and soot, inside of the box, at every voxel."""
        options = {"soot": "fv", "voxel_size": 1.3e-3, **options}
        points, values, kappa = voxels(plenoflame.import_flame(path, temperature=hot, **options))
        inside = ((points > LOW + 1e-4) & (points < LOW + SIZE - 1e-4)).all(axis=1)
        self.assertGreater(inside.sum(), 10000)
        numpy.testing.assert_allclose(values[inside], temperature(points[inside]), rtol=rtol)
        if options["soot"]:
            expected = 6 * numpy.pi * 0.26 * soot(points[inside]) / 650e-9
            numpy.testing.assert_allclose(kappa[inside], expected, rtol=rtol)

    def test_vtk_xml(self):
        self.check(write(vtkXMLImageDataWriter(), self.folder / "a.vti", image_grid()))
        self.check(write(vtkXMLRectilinearGridWriter(), self.folder / "a.vtr", rectilinear_grid()))
        self.check(write(vtkXMLStructuredGridWriter(), self.folder / "a.vts", structured_grid()))
        self.check(write(vtkXMLUnstructuredGridWriter(), self.folder / "a.vtu", hexahedra()))

    def test_lattice_of_an_image_is_kept(self):
        path = write(vtkXMLImageDataWriter(), self.folder / "a.vti", image_grid())
        points, values, kappa = voxels(plenoflame.import_flame(path, soot="fv"))
        self.assertEqual((kappa > 0).sum(), numpy.prod(NODES))
        nodes = lattice().reshape(-1, 3)
        numpy.testing.assert_allclose(points[kappa > 0], nodes, rtol=1e-12, atol=1e-15)
        numpy.testing.assert_array_equal(values[kappa > 0], temperature(nodes).astype(numpy.float32))

    def test_vtk_blocks(self):
        """Two halves as blocks of a .vtm."""
        blocks = vtkMultiBlockDataSet()
        points = lattice()
        for number, half in enumerate((points[:, :, :5], points[:, :, 4:])):
            grid = vtkStructuredGrid()
            grid.SetDimensions(half.shape[2], half.shape[1], half.shape[0])
            grid.SetPoints(vtkPoints())
            grid.GetPoints().SetData(numpy_to_vtk(numpy.ascontiguousarray(half.reshape(-1, 3)), deep=True))
            blocks.SetBlock(number, filled(grid, half))
        self.check(write(vtkXMLMultiBlockDataWriter(), self.folder / "a.vtm", blocks))

    def test_vtk_legacy(self):
        for name, grid in (("i", image_grid()), ("r", rectilinear_grid()), ("s", structured_grid()), ("u", hexahedra())):
            writer = vtkDataSetWriter()
            writer.SetFileTypeToBinary()
            self.check(write(writer, self.folder / (name + ".vtk"), grid))

    def test_paraview_collection_is_a_series(self):
        """Times out of order; the second step in two pieces."""
        points = lattice()
        (self.folder / "parts").mkdir()
        for name, rows, shift in (("a", slice(0, 11), 0), ("b", slice(0, 6), 100), ("c", slice(5, 11), 100)):
            part = points[rows]
            grid = vtkStructuredGrid()
            grid.SetDimensions(part.shape[2], part.shape[1], part.shape[0])
            grid.SetPoints(vtkPoints())
            grid.GetPoints().SetData(numpy_to_vtk(numpy.ascontiguousarray(part.reshape(-1, 3)), deep=True))
            array = numpy_to_vtk(temperature(part).ravel() + shift, deep=True)
            array.SetName("T")
            grid.GetPointData().AddArray(array)
            write(vtkXMLStructuredGridWriter(), self.folder / "parts" / (name + ".vts"), grid)
        entries = [("0.5", "b"), ("0.25", "a"), ("0.5", "c")]
        (self.folder / "run.pvd").write_text(
            '<?xml version="1.0"?>\n<VTKFile type="Collection" version="0.1"><Collection>' +
            "".join(f'<DataSet timestep="{t}" part="0" file="parts/{n}.vts"/>' for t, n in entries) +
            "</Collection></VTKFile>\n")
        files = self.figures("flame", "import", "run.pvd", "--constant", "9 1/m", "--voxel-size", "2 mm", "-o",
                             "s.vdb")["files"]
        self.assertEqual([(entry["file"], entry["time_s"]) for entry in files],
                         [("s_0000.vdb", 0.25), ("s_0001.vdb", 0.5)])
        for shift, entry in ((0, files[0]), (100, files[1])):
            points, hot, kappa = voxels(plenoflame.read_flame(self.folder / entry["file"]))
            inside = kappa > 0
            self.assertGreater(inside.sum(), 5000)
            numpy.testing.assert_allclose(hot[inside], temperature(points[inside]) + shift, rtol=1e-6)
        self.check(self.folder / "run.pvd", step=0, soot="", constant=1)

    def test_broken_collections(self):
        def refused(text, pattern):
            (self.folder / "b.pvd").write_text(text)
            with self.assertRaisesRegex(plenoflame.Error, pattern):
                plenoflame.import_flame(self.folder / "b.pvd", constant=1)
        refused("<VTKFile", "b.pvd' is no .pvd file")
        refused("<VTKFile><Collection/></VTKFile>", "names no files")
        refused('<VTKFile><Collection><DataSet timestep="x" file="a.vtu"/></Collection></VTKFile>', "DataSet 0 .* no number")
        refused('<VTKFile><Collection><DataSet timestep="1" file="b.pvd"/></Collection></VTKFile>', "names another one")
        refused('<VTKFile><Collection><DataSet timestep="1" file="none.vtu"/></Collection></VTKFile>', "none.vtu")

    def test_exodus(self):
        writer = vtkExodusIIWriter()
        writer.WriteAllTimeStepsOff()
        self.check(write(writer, self.folder / "a.exo", hexahedra()))

    def test_vtk_hdf(self):
        with h5py.File(self.folder / "a.vtkhdf", "w") as file:
            group = file.create_group("VTKHDF")
            group.attrs["Version"] = (1, 0)
            group.attrs["Type"] = numpy.bytes_("ImageData")
            group.attrs["WholeExtent"] = [0, NODES[0] - 1, 0, NODES[1] - 1, 0, NODES[2] - 1]
            group.attrs["Origin"] = LOW
            group.attrs["Spacing"] = [SIZE[k] / (NODES[k] - 1) for k in range(3)]
            group.attrs["Direction"] = [1.0, 0, 0, 0, 1, 0, 0, 0, 1]
            data = group.create_group("PointData")
            data["T"], data["fv"] = temperature(lattice()), soot(lattice())
        self.check(self.folder / "a.vtkhdf")

    def test_plot3d(self):
        """A curved grid and its solution, single precision, as Fortran writes them unformatted. Of a gas at rest the
        temperature is p / (rho R) with p = (gamma - 1) e: VTK takes 1.4 for gamma and 1 for R."""
        points = lattice().astype("<f4")

        def record(data):
            return struct.pack("<i", len(data)) + data + struct.pack("<i", len(data))
        size = struct.pack("<3i", *NODES)
        (self.folder / "g.xyz").write_bytes(record(size) + record(numpy.moveaxis(points, -1, 0).tobytes()))
        rho = numpy.full(points.shape[:3], 0.5, "<f4")
        energy = (temperature(points.astype(float)) * rho / 0.4).astype("<f4")
        q = numpy.stack([rho, 0 * rho, 0 * rho, 0 * rho, energy])
        (self.folder / "g.q").write_bytes(record(size) + record(struct.pack("<4f", 0.1, 0, 1e4, 0)) + record(q.tobytes()))
        self.check(self.folder / "g.xyz", hot="Temperature", soot="", constant=5, solution=self.folder / "g.q", rtol=3e-6)
        with self.assertRaisesRegex(plenoflame.Error, "name the file of its solution"):
            plenoflame.import_flame(self.folder / "g.xyz", constant=1)

    def test_plot3d_metadata_is_a_series(self):
        """Two solutions on one grid, named by a file of metadata that stands in the working folder."""
        points = lattice().astype("<f4")
        size = struct.pack("<3i", *NODES)

        def record(data):
            return struct.pack("<i", len(data)) + data + struct.pack("<i", len(data))
        (self.folder / "g.xyz").write_bytes(record(size) + record(numpy.moveaxis(points, -1, 0).tobytes()))
        rho = numpy.full(points.shape[:3], 0.5, "<f4")
        entries = []
        for number, shift in enumerate((0, 100)):
            energy = ((temperature(points.astype(float)) + shift) * rho / 0.4).astype("<f4")
            q = numpy.stack([rho, 0 * rho, 0 * rho, 0 * rho, energy])
            (self.folder / f"g{number}.q").write_bytes(
                record(size) + record(struct.pack("<4f", 0.1, 0, 1e4, 0)) + record(q.tobytes()))
            entries.append({"time": 0.5 * number, "xyz": "g.xyz", "q": f"g{number}.q"})
        (self.folder / "g.p3d").write_text(json.dumps({"auto-detect-format": True, "filenames": entries, "functions": [120]}))
        files = self.figures("flame", "import", "g.p3d", "--temperature", "Temperature", "--constant", "9 1/m",
                             "--voxel-size", "2 mm", "-o", "s.vdb")["files"]
        self.assertEqual([entry["time_s"] for entry in files], [0, 0.5])
        for shift, entry in ((0, files[0]), (100, files[1])):
            points, hot, kappa = voxels(plenoflame.read_flame(self.folder / entry["file"]))
            inside = kappa > 0
            self.assertGreater(inside.sum(), 5000)
            numpy.testing.assert_allclose(hot[inside], temperature(points[inside]) + shift, rtol=3e-6)

    def test_netcdf(self):
        """Classic format, version 1: lists of dimensions, attributes and variables, then the values, big-endian."""
        def name(text):
            return struct.pack(">i", len(text)) + text.encode() + b"\0" * (-len(text) % 4)
        variables = [(n, (k,), v) for k, (n, v) in enumerate(zip("xyz", axes()))]
        variables += [("T", (2, 1, 0), temperature(lattice())), ("fv", (2, 1, 0), soot(lattice()))]
        none = struct.pack(">ii", 0, 0)

        def header(begin):
            out = b"CDF\1" + struct.pack(">iii", 0, 10, 3)
            out += b"".join(name(n) + struct.pack(">i", len(v)) for n, v in zip("xyz", axes())) + none
            out += struct.pack(">ii", 11, len(variables))
            for n, over, values in variables:
                out += (name(n) + struct.pack(f">{1 + len(over)}i", len(over), *over) + none +
                        struct.pack(">iii", 6, 8 * values.size, begin))
                begin += 8 * values.size
            return out
        (self.folder / "a.nc").write_bytes(header(len(header(0))) +
                                           b"".join(v.astype(">f8").tobytes() for _, _, v in variables))
        self.check(self.folder / "a.nc")

    def test_cgns(self):
        """A structured zone, node by node (SIDS to HDF5 mapping)."""
        def node(parent, name, label, kind="MT", data=None):
            group = parent.create_group(name, track_order=True)
            for key, text, length in (("name", name, 33), ("label", label, 33), ("type", kind, 3)):
                group.attrs.create(key, numpy.bytes_(text), dtype=h5py.string_dtype("ascii", length))
            group.attrs.create("flags", [1], dtype="<i4")
            if data is not None:
                group[" data"] = data
            return group

        def text(value):
            return numpy.frombuffer(value.encode(), "<i1")
        with h5py.File(self.folder / "a.cgns", "w", track_order=True) as file:
            for key, value, length in (("name", "HDF5 MotherNode", 33), ("label", "Root Node of HDF5 File", 33),
                                       ("type", "MT", 3)):
                file.attrs.create(key, numpy.bytes_(value), dtype=h5py.string_dtype("ascii", length))
            file[" format"] = text("IEEE_LITTLE_32\0")
            file[" hdf5version"] = text("HDF5 Version 1.8.17".ljust(33, "\0"))
            node(file, "CGNSLibraryVersion", "CGNSLibraryVersion_t", "R4", numpy.array([3.2], "<f4"))
            base = node(file, "Base", "CGNSBase_t", "I4", numpy.array([3, 3], "<i4"))
            counts = numpy.array([NODES, [n - 1 for n in NODES], [0, 0, 0]], "<i4")
            zone = node(base, "Zone", "Zone_t", "I4", counts)
            node(zone, "ZoneType", "ZoneType_t", "C1", text("Structured"))
            coordinates = node(zone, "GridCoordinates", "GridCoordinates_t")
            for k, name in enumerate("XYZ"):
                node(coordinates, "Coordinate" + name, "DataArray_t", "R8", numpy.ascontiguousarray(lattice()[..., k]))
            solution = node(zone, "Solution", "FlowSolution_t")
            node(solution, "GridLocation", "GridLocation_t", "C1", text("Vertex"))
            node(solution, "T", "DataArray_t", "R8", temperature(lattice()))
            node(solution, "fv", "DataArray_t", "R8", soot(lattice()))
        self.check(self.folder / "a.cgns")

    def write_amrex(self, boxes):
        """boxes: per level a list of (low, high) in cells; each level twice as fine as the one before."""
        cells = numpy.array([8, 6, 10])
        folder = self.folder / "plt00010"
        size = [numpy.array(SIZE) / (cells * 2 ** level) for level in range(len(boxes))]

        def numbers(values):
            return "(" + ",".join(str(int(v)) for v in values) + ")"

        def box(low, high):
            return f"({numbers(low)} {numbers(high)} (0,0,0))"
        header = ["HyperCLaw-V1.1", "2", "T", "fv", "3", "0.125", str(len(boxes) - 1),
                  " ".join(map(repr, LOW.tolist())), " ".join(map(repr, (LOW + SIZE).tolist())),
                  " ".join(["2"] * (len(boxes) - 1)),
                  " ".join(box((0, 0, 0), cells * 2 ** level - 1) for level in range(len(boxes))),
                  " ".join(["10"] * len(boxes)), *(" ".join(map(repr, s.tolist())) for s in size), "0", "0"]
        for level, own in enumerate(boxes):
            header += [f"{level} {len(own)} 0.125", "10"]
            path = folder / f"Level_{level}"
            path.mkdir(parents=True)
            extremes, data, places = [], b"", []
            for low, high in own:
                low, high = numpy.array(low), numpy.array(high)
                header += [f"{a!r} {b!r}" for a, b in zip((LOW + low * size[level]).tolist(),
                                                          (LOW + (high + 1) * size[level]).tolist())]
                centres = [LOW[k] + (numpy.arange(low[k], high[k] + 1) + 0.5) * size[level][k] for k in range(3)]
                points = numpy.stack(numpy.broadcast_arrays(centres[0], centres[1][:, None], centres[2][:, None, None]), -1)
                places.append(len(data))
                data += (f"FAB ((8, (64 11 52 0 1 12 0 1023)),(8, (8 7 6 5 4 3 2 1))){box(low, high)} 2\n".encode() +
                         (temperature(points) + 40 * level).astype("<f8").tobytes() + soot(points).astype("<f8").tobytes())
                extremes.append((temperature(points), soot(points)))
            (path / "Cell_D_00000").write_bytes(data)
            text = ["1", "1", "2", "0", f"({len(own)} 0", *(box(*b) for b in own), ")", str(len(own)),
                    *(f"FabOnDisk: Cell_D_00000 {place}" for place in places), ""]
            for extreme in (numpy.min, numpy.max):
                text += [f"{len(own)},2", *(",".join(repr(float(extreme(v))) for v in pair) + "," for pair in extremes), ""]
            (path / "Cell_H").write_text("\n".join(text))
            header.append(f"Level_{level}/Cell")
        (folder / "Header").write_text("\n".join(header) + "\n")
        return folder

    def test_amrex(self):
        """Values of cells; a finer level over the middle, 40 K hotter, so that one sees whose values came."""
        folder = self.write_amrex([[((0, 0, 0), (7, 5, 4)), ((0, 0, 5), (7, 5, 9))], [((4, 4, 6), (11, 7, 15))]])
        points, values, kappa = voxels(plenoflame.import_flame(folder, soot="fv", voxel_size=1.3e-3))
        # Means of the cells around a node are exact away from the rims of the boxes.
        inner = numpy.zeros(len(points), bool)
        for low, high in (((1, 1, 1), (7, 5, 4)), ((1, 1, 6), (7, 5, 9))):
            step = numpy.array(SIZE) / (8, 6, 10)
            inner |= ((points > LOW + numpy.array(low) * step) & (points < LOW + numpy.array(high) * step)).all(axis=1)
        step = numpy.array(SIZE) / (16, 12, 20)
        fine = ((points > LOW + numpy.array((4, 4, 6)) * step) & (points < LOW + numpy.array((12, 8, 16)) * step)).all(axis=1)
        rim = fine & ~((points > LOW + numpy.array((5, 5, 7)) * step) &
                       (points < LOW + numpy.array((11, 7, 15)) * step)).all(axis=1)
        inner &= ~rim
        self.assertGreater((inner & fine).sum(), 200)
        self.assertGreater((inner & ~fine).sum(), 2000)
        numpy.testing.assert_allclose(values[inner], (temperature(points) + 40 * fine)[inner], rtol=1e-6)
        numpy.testing.assert_allclose(kappa[inner], 6 * numpy.pi * 0.26 * soot(points[inner]) / 650e-9, rtol=1e-6)
        # Elsewhere within half a cell's change of the field.
        inside = ((points > LOW) & (points < LOW + SIZE)).all(axis=1)
        self.assertLess(numpy.abs(values - temperature(points) - 40 * fine)[inside].max(), 70)

    def test_ensight_gold_binary(self):
        points = lattice().astype("<f4")

        def line(text):
            return text.encode().ljust(80, b"\0")
        number = numpy.arange(1, points.size // 3 + 1, dtype="<i4").reshape(points.shape[:3])
        n = [slice(None, -1), slice(1, None)]
        corners = [(0, 0, 0), (0, 0, 1), (0, 1, 1), (0, 1, 0), (1, 0, 0), (1, 0, 1), (1, 1, 1), (1, 1, 0)]
        cells = numpy.stack([number[n[c], n[b], n[a]] for c, b, a in corners], -1).astype("<i4")
        (self.folder / "e.geo").write_bytes(
            line("C Binary") + line("test") + line("test") + line("node id off") + line("element id off") + line("part") +
            struct.pack("<i", 1) + line("box") + line("coordinates") + struct.pack("<i", points.size // 3) +
            numpy.moveaxis(points, -1, 0).tobytes() + line("hexa8") + struct.pack("<i", cells.size // 8) + cells.tobytes())
        for name, values in (("T", temperature(points.astype(float))), ("fv", soot(points.astype(float)))):
            (self.folder / ("e." + name)).write_bytes(line(name) + line("part") + struct.pack("<i", 1) +
                                                      line("coordinates") + values.astype("<f4").tobytes())
        (self.folder / "e.case").write_text("FORMAT\ntype: ensight gold\nGEOMETRY\nmodel: e.geo\nVARIABLE\n"
                                            "scalar per node: T e.T\nscalar per node: fv e.fv\n")
        self.check(self.folder / "e.case")

    def test_openfoam_of_many_cells_and_times(self):
        """Binary-free case: values of cells at two times; VTK averages them to the points."""
        nodes = lattice()
        nz, ny, nx = (n - 1 for n in nodes.shape[:3])
        number = numpy.arange(nodes.size // 3).reshape(nodes.shape[:3])
        cell = numpy.arange(nx * ny * nz).reshape(nz, ny, nx)
        inner, rim = [], []
        for k, j, i in itertools.product(range(nz + 1), range(ny + 1), range(nx + 1)):
            # The faces across x, y, z at the low corner of a cell; normals from the lower cell outwards.
            for a, size, quad in ((0, nx, [(0, 0), (1, 0), (1, 1), (0, 1)]), (1, ny, [(0, 0), (0, 1), (1, 1), (1, 0)]),
                                  (2, nz, [(0, 0), (1, 0), (1, 1), (0, 1)])):
                place = [i, j, k]
                others = [b for b in range(3) if b != a]
                if any(place[b] == (nx, ny, nz)[b] for b in others):
                    continue
                ids = []
                for steps in quad:
                    corner = list(place)
                    for b, step in zip(others, steps):
                        corner[b] += step
                    ids.append(int(number[corner[2], corner[1], corner[0]]))
                above = int(cell[k, j, i]) if place[a] < size else None
                below = list(place)
                below[a] -= 1
                below = int(cell[below[2], below[1], below[0]]) if place[a] > 0 else None
                if below is None:
                    rim.append((above, ids[::-1]))
                elif above is None:
                    rim.append((below, ids))
                else:
                    inner.append((below, above, ids))
        inner.sort()

        def put(place, kind, text):
            path = self.folder / place
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(f"FoamFile {{ version 2.0; format ascii; class {kind}; object {path.name}; }}\n{text}\n")

        def listed(items):
            return f"{len(items)}\n(\n" + "\n".join(items) + "\n)"
        put("constant/polyMesh/points", "vectorField", listed([f"({p[0]!r} {p[1]!r} {p[2]!r})"
                                                               for p in nodes.reshape(-1, 3).tolist()]))
        faces = [ids for _, _, ids in inner] + [ids for _, ids in rim]
        put("constant/polyMesh/faces", "faceList", listed([f"4({' '.join(map(str, ids))})" for ids in faces]))
        put("constant/polyMesh/owner", "labelList", listed([str(o) for o, _, _ in inner] + [str(o) for o, _ in rim]))
        put("constant/polyMesh/neighbour", "labelList", listed([str(n) for _, n, _ in inner]))
        put("constant/polyMesh/boundary", "polyBoundaryMesh",
            f"1\n(walls {{ type wall; nFaces {len(rim)}; startFace {len(inner)}; }})")
        put("system/controlDict", "dictionary", "application none; startTime 0; endTime 2; deltaT 1; writeControl "
            "timeStep; writeInterval 1; timeFormat general; timePrecision 6;")
        middles = sum(nodes[c:c + nz, b:b + ny, a:a + nx] for c, b, a in itertools.product((0, 1), repeat=3)) / 8
        for time, shift in ((1, 0), (2, 50)):
            put(f"{time}/T", "volScalarField", "dimensions [0 0 0 1 0 0 0];\ninternalField nonuniform List<scalar> " +
                listed([repr(float(v)) for v in temperature(middles).ravel() + shift]) +
                ";\nboundaryField { walls { type zeroGradient; } }")
        (self.folder / "case.foam").touch()
        files = self.figures("flame", "import", "case.foam", "--constant", "4 1/m", "--voxel-size", "1.3 mm", "-o",
                             "f.vdb")["files"]
        self.assertEqual([entry["time_s"] for entry in files], [1, 2])
        step = numpy.array(SIZE) / (nx, ny, nz)
        for shift, entry in ((0, files[0]), (50, files[1])):
            points, hot, kappa = voxels(plenoflame.read_flame(self.folder / entry["file"]))
            deep = ((points > LOW + step) & (points < LOW + SIZE - step)).all(axis=1)
            self.assertGreater(deep.sum(), 5000)
            numpy.testing.assert_allclose(hot[deep], temperature(points[deep]) + shift, rtol=1e-5)

    def test_tecplot(self):
        points = lattice()
        columns = numpy.column_stack([points.reshape(-1, 3), temperature(points).ravel(), soot(points).ravel()])
        (self.folder / "a.tec").write_text(
            'TITLE = "box"\nVARIABLES = "X" "Y" "Z" "T" "fv"\nZONE T="all", I=%d, J=%d, K=%d, DATAPACKING=POINT\n' % NODES +
            "\n".join(" ".join(f"{v:.9e}" for v in row) for row in columns) + "\n")
        self.check(self.folder / "a.tec")

    def test_what_this_vtk_cannot_read(self):
        for name, pattern in (("a.xdmf", "without a reader of Xdmf"), ("a.cas.h5", "export from Fluent as CGNS"),
                              ("a.cas", "export from Fluent as CGNS"), ("a.h5", "CONVERGE are not read"),
                              ("a.fds", "no reader for this ending")):
            (self.folder / name).write_bytes(b"x")
            with self.assertRaisesRegex(plenoflame.Error, pattern):
                plenoflame.import_flame(self.folder / name, constant=1)

    def test_damaged_files_are_refused(self):
        """Cut in half, each is an error with its name, and no crash."""
        whole = {}
        whole["a.vti"] = write(vtkXMLImageDataWriter(), self.folder / "w.vti", image_grid())
        whole["a.vtu"] = write(vtkXMLUnstructuredGridWriter(), self.folder / "w.vtu", hexahedra())
        whole["a.vtk"] = write(vtkDataSetWriter(), self.folder / "w.vtk", structured_grid())
        for name, path in whole.items():
            data = pathlib.Path(path).read_bytes()
            (self.folder / name).write_bytes(data[:len(data) // 2])
            message = self.command("flame", "import", name, "--constant", "1 1/m", "-o", "x.vdb", status=1)
            self.assertRegex(message, r"\Aplenoflame: error: [^\n]*" + name + r"[^\n]*\n\Z")
            self.assertFalse((self.folder / "x.vdb").exists())


if __name__ == "__main__":
    main()
