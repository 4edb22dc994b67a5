"""Flames from Python."""

import numpy
from package import PackageTest, main
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkImageData
from vtkmodules.vtkIOXML import vtkXMLImageDataReader, vtkXMLImageDataWriter

import plenoflame


def image(temperature, absorption, spacing):
    """vtkImageData of two arrays (z, y, x)."""
    out = vtkImageData()
    out.SetDimensions(temperature.shape[::-1])
    out.SetSpacing(spacing, spacing, spacing)
    for name, values in (("temperature", temperature), ("absorption", absorption)):
        array = numpy_to_vtk(numpy.ascontiguousarray(values, numpy.float32).ravel(), deep=True)
        array.SetName(name)
        out.GetPointData().AddArray(array)
    return out


class Flames(PackageTest):
    def test_numpy_flame_is_rendered(self):
        """A homogeneous block: the command line finds what was written."""
        hot = numpy.full((20, 12, 12), 1700.0)
        block = image(hot, numpy.full_like(hot, 25.0), 2e-3)
        block.SetOrigin(-0.011, -0.011, 0)
        plenoflame.write_flame(self.folder / "block.vdb", block)
        grids = {grid["name"]: grid for grid in self.figures("info", "block.vdb")["grids"]}
        self.assertEqual(grids["temperature"]["maximum"], 1700)
        self.assertEqual(grids["absorption"]["maximum"], 25)
        read = plenoflame.read_flame(self.folder / "block.vdb").image
        numpy.testing.assert_array_equal(vtk_to_numpy(read.GetPointData().GetArray("absorption")), 25)
        numpy.testing.assert_allclose(read.GetOrigin(), (-0.011, -0.011, 0), atol=1e-17)

    def test_vti_becomes_a_flame(self):
        """The scene's flame through VTK's own .vti, then as .vdb, is the same."""
        flame = self.scene().flame(24).image
        writer = vtkXMLImageDataWriter()
        writer.SetFileName(str(self.folder / "f.vti"))
        writer.SetInputData(flame)
        self.assertTrue(writer.Write())
        reader = vtkXMLImageDataReader()
        reader.SetFileName(str(self.folder / "f.vti"))
        reader.Update()
        plenoflame.write_flame(self.folder / "f.vdb", reader.GetOutput())
        back = plenoflame.read_flame(self.folder / "f.vdb").image
        # Unburnt space at the rims need not be stored: compare the voxels that are, by their place.
        numpy.testing.assert_allclose(back.GetSpacing(), flame.GetSpacing(), rtol=1e-12)
        start = numpy.rint((numpy.array(back.GetOrigin()) - flame.GetOrigin()) / flame.GetSpacing()).astype(int)
        size = back.GetDimensions()
        for name in ("temperature", "absorption"):
            whole = vtk_to_numpy(flame.GetPointData().GetArray(name)).reshape(flame.GetDimensions()[::-1])
            part = whole[start[2]:start[2] + size[2], start[1]:start[1] + size[1], start[0]:start[0] + size[0]]
            numpy.testing.assert_array_equal(
                vtk_to_numpy(back.GetPointData().GetArray(name)).reshape(size[::-1]), part)
        self.assertGreater(vtk_to_numpy(back.GetPointData().GetArray("absorption")).max(), 0)

    def test_scene_is_sampled(self):
        flame = self.scene().flame(50).image
        temperature = vtk_to_numpy(flame.GetPointData().GetArray("temperature"))
        self.assertEqual(temperature.max(), 1900)
        self.assertEqual(max(flame.GetDimensions()), 50)

    def test_errors(self):
        with self.assertRaisesRegex(plenoflame.Error, "missing.vdb"):
            plenoflame.read_flame(self.folder / "missing.vdb")
        block = image(numpy.ones((2, 2, 2)), numpy.ones((2, 2, 2)), 1e-3)
        with self.assertRaisesRegex(plenoflame.Error, "the data has temperature, absorption"):
            plenoflame.write_flame(self.folder / "x.vdb", block, absorption="kappa")


if __name__ == "__main__":
    main()
