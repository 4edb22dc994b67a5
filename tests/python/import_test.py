"""Flames from simulations: analytic fields on meshes, known at every voxel."""

import json
import math
import signal
import subprocess
import time

import numpy
from fields import mesh, soot, temperature, voxels
from package import COMMAND, PackageTest, main
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonDataModel import VTK_TETRA, vtkImageData, vtkPolyData, vtkUnstructuredGrid
from vtkmodules.vtkFiltersCore import vtkCellCenters
from vtkmodules.vtkIOLegacy import vtkUnstructuredGridWriter
from vtkmodules.vtkIOXML import vtkXMLDataSetWriter, vtkXMLPolyDataWriter, vtkXMLUnstructuredGridWriter

import plenoflame

FOAM = """FoamFile {{ version 2.0; format ascii; class {kind}; object {name}; }}
{text}
"""


class Import(PackageTest):
    def written(self, grid, name="a.vtu"):
        writer = vtkXMLUnstructuredGridWriter() if name.endswith("u") else vtkUnstructuredGridWriter()
        writer.SetFileName(str(self.folder / name))
        writer.SetInputData(grid)
        writer.Write()
        return self.folder / name

    def inside(self, points, margin=1e-4):
        return ((numpy.abs(points[:, :2]) < 0.02 - margin).all(axis=1) & (points[:, 2] > margin) &
                (points[:, 2] < 0.06 - margin))

    def test_linear_field_is_exact_in_every_voxel(self):
        for name in ("a.vtu", "b.vtk"):
            path = self.written(mesh(), name)
            image = plenoflame.import_flame(path, soot="fv", soot_function=0.3, wavelength=500e-9, voxel_size=2e-3)
            points, hot, kappa = voxels(image)
            inside = self.inside(points)
            self.assertGreater(inside.sum(), 5000)
            numpy.testing.assert_allclose(hot[inside], temperature(points[inside]), rtol=1e-6)
            # Bohren and Huffman, ch. 5: kappa = 6 pi E f_v / lambda.
            expected = 6 * math.pi * 0.3 * soot(points[inside]) / 500e-9
            numpy.testing.assert_allclose(kappa[inside], expected, rtol=1e-6)

    def test_outside_there_is_no_absorption_and_temperature_goes_on(self):
        points, hot, kappa = voxels(plenoflame.import_flame(self.written(mesh()), constant=20, voxel_size=2e-3))
        beyond = (numpy.abs(points[:, :2]) > 0.0201).any(axis=1) | (points[:, 2] < -1e-4) | (points[:, 2] > 0.0601)
        self.assertEqual(kappa[beyond].max(), 0)
        numpy.testing.assert_array_equal(numpy.unique(kappa), [0, 20])
        # One voxel beyond a side: no ambient temperature is mixed in.
        near = beyond & (numpy.abs(points[:, :2]) < 0.0225).all(axis=1) & (numpy.abs(points[:, 2] - 0.03) < 0.02)
        self.assertGreater(near.sum(), 100)
        self.assertGreater(hot[near].min(), 1000)

    def test_linear_cell_data_are_right_up_to_the_rim(self):
        """On a lattice and on displaced tetrahedra: middles of cells know a linear field, and so does the mesh's rim."""
        image = vtkImageData()
        image.SetDimensions(9, 9, 9)
        image.SetSpacing(5e-3, 5e-3, 7.5e-3)
        image.SetOrigin(-0.02, -0.02, 0)
        for data in (image, mesh()):
            centres = vtkCellCenters()
            centres.SetInputData(data)
            centres.Update()
            middles = vtk_to_numpy(centres.GetOutput().GetPoints().GetData()).astype(float)
            cells = data.NewInstance()
            cells.CopyStructure(data)
            for name, values in (("T", temperature(middles)), ("fv", soot(middles))):
                array = numpy_to_vtk(values, deep=True)
                array.SetName(name)
                cells.GetCellData().AddArray(array)
            writer = vtkXMLDataSetWriter()
            path = self.folder / ("cells." + ("vti" if data is image else "vtu"))
            writer.SetFileName(str(path))
            writer.SetInputData(cells)
            self.assertTrue(writer.Write())
            points, hot, kappa = voxels(plenoflame.import_flame(path, soot="fv", voxel_size=1e-3))
            inside = self.inside(points)
            self.assertGreater(inside.sum(), 50000)
            numpy.testing.assert_allclose(hot[inside], temperature(points[inside]), rtol=2e-6)
            expected = 6 * math.pi * 0.26 * soot(points[inside]) / 650e-9
            numpy.testing.assert_allclose(kappa[inside], expected, rtol=2e-6)

    def test_cell_data_stay_between_what_is_there(self):
        """A jump from 0 to 20 1/m at the rim leaves no negative and no doubled values."""
        image = vtkImageData()
        image.SetDimensions(9, 9, 9)
        image.SetSpacing(5e-3, 5e-3, 5e-3)
        for name, values in (("T", numpy.full(512, 1500.0)), ("k", numpy.where(numpy.arange(512) % 8 < 1, 20.0, 0.0))):
            array = numpy_to_vtk(values, deep=True)
            array.SetName(name)
            image.GetCellData().AddArray(array)
        writer = vtkXMLDataSetWriter()
        writer.SetFileName(str(self.folder / "jump.vti"))
        writer.SetInputData(image)
        writer.Write()
        _, hot, kappa = voxels(plenoflame.import_flame(self.folder / "jump.vti", absorption="k", voxel_size=1e-3))
        numpy.testing.assert_allclose(hot[kappa > 0], 1500, rtol=1e-6)
        self.assertEqual(kappa.min(), 0)
        self.assertLessEqual(kappa.max(), 30)

    def test_what_is_numerically_nothing_is_dropped(self):
        def active(tail):
            flame = mesh()
            points = vtk_to_numpy(flame.GetPoints().GetData())
            array = numpy_to_vtk(numpy.where(points[:, 2] < 0.03, 20.0, tail), deep=True)
            array.SetName("k")
            flame.GetPointData().AddArray(array)
            _, _, kappa = voxels(plenoflame.import_flame(self.written(flame), absorption="k", voxel_size=2e-3))
            return numpy.count_nonzero(kappa)
        self.assertEqual(active(1e-38), active(0.0))
        # A thousandth of a percent over a metre is little, but it is light: the share of the densest does not matter.
        self.assertGreater(active(1e-5), active(0.0))

    def test_units_bounds_and_scale(self):
        path = self.written(mesh())
        image = plenoflame.import_flame(path, temperature_unit="degC", absorption="k", absorption_unit="1/cm",
                                        length_scale=1e-1, voxel_size=2e-4,
                                        bounds=(-1e-3, 1e-3, -1e-3, 1e-3, 2e-3, 4e-3))
        points, hot, kappa = voxels(image)
        inside = ((points > (-1.01e-3, -1.01e-3, 1.99e-3)) & (points < (1.01e-3, 1.01e-3, 4.01e-3))).all(axis=1)
        self.assertEqual(inside.sum(), 10**3)
        numpy.testing.assert_allclose(hot[inside], temperature(points[inside] * 10) + 273.15, rtol=1e-6)
        numpy.testing.assert_allclose(kappa[inside], 100 * (5 + 100 * 10 * points[inside][:, 2]), rtol=1e-6)

    def test_command_writes_the_same(self):
        path = self.written(mesh())
        self.command("flame", "import", path, "--soot", "fv", "--voxel-size", "2 mm", "-o", "f.vdb")
        points, hot, kappa = voxels(plenoflame.read_flame(self.folder / "f.vdb"))
        inside = self.inside(points)
        self.assertGreater(inside.sum(), 5000)
        numpy.testing.assert_allclose(hot[inside], temperature(points[inside]), rtol=1e-6)
        numpy.testing.assert_allclose(kappa[inside], 6 * math.pi * 0.26 * soot(points[inside]) / 650e-9, rtol=1e-6)

    def test_several_files_are_a_series(self):
        for number in range(3):
            self.written(mesh(2, number), f"s{number}.vtu")
        files = self.figures("flame", "import", "s0.vtu", "s1.vtu", "s2.vtu", "--constant", "9 1/m", "--voxel-size",
                             "5 mm", "-o", "s.vdb")["files"]
        self.assertEqual([entry["file"] for entry in files], ["s_0000.vdb", "s_0001.vdb", "s_0002.vdb"])

    def test_an_interrupted_series_leaves_whole_files(self):
        self.written(mesh(2))
        process = subprocess.Popen([COMMAND, "flame", "import", *["a.vtu"] * 2000, "--constant", "9 1/m", "--voxel-size",
                                    "1 mm", "-o", "s.vdb"], cwd=self.folder, stderr=subprocess.PIPE, text=True)
        self.addCleanup(process.kill)
        while process.poll() is None and not (self.folder / "s_0002.vdb").exists():
            time.sleep(0.01)
        process.send_signal(signal.SIGINT)
        _, errors = process.communicate()
        self.assertEqual(process.returncode, 1, errors)
        self.assertIn("stopped; the files of a series that were written are complete", errors)
        files = sorted(path.name for path in self.folder.iterdir() if path.name != "a.vtu")
        self.assertLess(len(files), 2000)
        self.assertEqual(files, [f"s_{number:04d}.vdb" for number in range(len(files))])
        for name in files:
            self.figures("info", name)

    def test_time_steps_of_ensight(self):
        """A cube of one hexahedron at two times, written by hand."""
        (self.folder / "e.case").write_text(
            "FORMAT\ntype: ensight gold\nGEOMETRY\nmodel: e.geo\nVARIABLE\nscalar per node: 1 T e*.T\n"
            "TIME\ntime set: 1\nnumber of steps: 2\nfilename start number: 0\nfilename increment: 1\n"
            "time values: 0.0 0.25\n")
        corners = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
        numbers = "".join(f"{p[k] * 0.01:12.5e}\n" for k in range(3) for p in corners)
        (self.folder / "e.geo").write_text(
            "test\ntest\nnode id off\nelement id off\npart\n" + f"{1:10d}\ncube\ncoordinates\n{8:10d}\n" + numbers +
            f"hexa8\n{1:10d}\n" + "".join(f"{i:10d}" for i in range(1, 9)) + "\n")
        for step in (0, 1):
            (self.folder / f"e{step}.T").write_text(
                f"T\npart\n{1:10d}\ncoordinates\n" + f"{1000 + 500 * step:12.5e}\n" * 8)
        files = self.figures("flame", "import", "e.case", "--constant", "9 1/m", "-o", "e.vdb")["files"]
        self.assertEqual([entry["time_s"] for entry in files], [0, 0.25])
        for entry, hot in zip(files, (1000, 1500)):
            grids = {grid["name"]: grid for grid in entry["grids"]}
            self.assertEqual((grids["temperature"]["maximum"], grids["absorption"]["maximum"]), (hot, 9))
        self.figures("flame", "import", "e.case", "--constant", "9 1/m", "--step", "1", "-o", "one.vdb")
        self.assertTrue((self.folder / "one.vdb").exists())

    def test_openfoam(self):
        """A cube of one cell, written by hand."""
        def write(place, kind, text):
            path = self.folder / place
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(FOAM.format(kind=kind, name=path.name, text=text))

        write("constant/polyMesh/points", "vectorField", "8\n((0 0 0) (.02 0 0) (.02 .02 0) (0 .02 0)"
              " (0 0 .02) (.02 0 .02) (.02 .02 .02) (0 .02 .02))")
        write("constant/polyMesh/faces", "faceList", "6\n(4(0 3 2 1) 4(4 5 6 7) 4(0 1 5 4) 4(1 2 6 5) 4(2 3 7 6)"
              " 4(3 0 4 7))")
        write("constant/polyMesh/owner", "labelList", "6\n(0 0 0 0 0 0)")
        write("constant/polyMesh/neighbour", "labelList", "0\n()")
        write("constant/polyMesh/boundary", "polyBoundaryMesh", "1\n(walls { type wall; nFaces 6; startFace 0; })")
        write("system/controlDict", "dictionary", "application none; startTime 0; endTime 1; deltaT 1; writeControl "
              "timeStep; writeInterval 1; timeFormat general; timePrecision 6;")
        for name, value in (("T", 1650), ("kappa", 12.5)):
            write(f"1/{name}", "volScalarField", "dimensions [0 0 0 0 0 0 0];\ninternalField nonuniform List<scalar> "
                  f"1({value});\nboundaryField {{ walls {{ type zeroGradient; }} }}")
        (self.folder / "case.foam").touch()
        image = plenoflame.import_flame(self.folder / "case.foam", absorption="kappa", voxel_size=2e-3)
        _, hot, kappa = voxels(image)
        self.assertGreater((kappa == 12.5).sum(), 700)
        self.assertEqual(set(numpy.unique(kappa)), {0, 12.5})
        numpy.testing.assert_allclose(hot[kappa > 0], 1650)

    def test_raw_bricks(self):
        """x runs fastest."""
        hot = numpy.arange(5 * 4 * 3, dtype="<f4").reshape(5, 4, 3) + 1000  # z, y, x
        hot.tofile(self.folder / "T.raw")
        (self.folder / "b.json").write_text(json.dumps(
            {"dimensions": [3, 4, 5], "spacing_m": [1e-3] * 3, "origin_m": [0.1, 0.2, 0.3], "arrays": {"T": "T.raw"}}))
        points, values, kappa = voxels(plenoflame.import_flame(self.folder / "b.json", constant=3))
        inside = kappa > 0
        self.assertEqual(inside.sum(), 60)
        index = numpy.rint((points[inside] - (0.1, 0.2, 0.3)) / 1e-3).astype(int)
        numpy.testing.assert_allclose(values[inside], hot[index[:, 2], index[:, 1], index[:, 0]], rtol=1e-6)

    def fails(self, pattern, path, **options):
        with self.assertRaisesRegex(plenoflame.Error, pattern):
            plenoflame.import_flame(path, **options)

    def test_bad_input(self):
        grid = mesh(2)
        path = self.written(grid)
        self.fails("no array 'temp'; it has T, U, fv, k", path, temperature="temp", constant=1)
        self.fails("no array 'soot'; it has", path, soot="soot")
        self.fails("'U' has 3 components", path, absorption="U")
        self.fails("exactly one of", path)
        self.fails("exactly one of", path, constant=1, soot="fv")
        self.fails("missing.vtu", self.folder / "missing.vtu", constant=1)
        (self.folder / "a.docx").write_text("x")
        self.fails("no reader for this ending; known are .vti", self.folder / "a.docx", constant=1)
        (self.folder / "broken.vtu").write_text("<VTKFile")
        self.fails("broken.vtu", self.folder / "broken.vtu", constant=1)
        self.fails("no AMReX plotfile", self.folder, constant=1)
        self.fails("temperature_unit: 'F'", path, constant=1, temperature_unit="F")
        self.fails("leave nothing", path, constant=1, bounds=(1, 2, 1, 2, 1, 2))
        self.fails("more than 1e9", path, constant=1, voxel_size=1e-6)

    def test_values_that_are_no_numbers(self):
        grid = mesh(2)
        grid.GetPointData().GetArray("T").SetValue(7, math.nan)
        self.fails("'T' is nan at point 7", self.written(grid), constant=1)

    def test_cells_inside_out(self):
        grid = mesh(2)
        turned = vtkUnstructuredGrid()
        turned.DeepCopy(grid)
        cell = turned.GetCell(5).GetPointIds()
        ids = [cell.GetId(k) for k in (1, 0, 2, 3)]
        cells = vtkUnstructuredGrid()
        cells.SetPoints(grid.GetPoints())
        cells.GetPointData().ShallowCopy(grid.GetPointData())
        for i in range(grid.GetNumberOfCells()):
            points = ids if i == 5 else [grid.GetCell(i).GetPointId(k) for k in range(4)]
            cells.InsertNextCell(VTK_TETRA, 4, points)
        self.fails("1 of .* cells are inside out, the first is cell 5", self.written(cells), constant=1)

    def test_surface_has_no_volume(self):
        surface = vtkPolyData()
        surface.SetPoints(mesh(2).GetPoints())
        writer = vtkXMLPolyDataWriter()
        writer.SetFileName(str(self.folder / "s.vtu"))
        writer.SetInputData(surface)
        writer.Write()
        self.fails("no cells with a volume", self.folder / "s.vtu", constant=1)


if __name__ == "__main__":
    main()
