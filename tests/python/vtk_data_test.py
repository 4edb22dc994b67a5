"""to_vtk() and from_vtk(): the values of the VTK classes to the bit, and memory that is shared. References are those classes,
VTK's own files and numpy."""

import gc
import subprocess
import sys

import numpy
from package import PackageTest, main
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkStringArray
from vtkmodules.vtkCommonDataModel import vtkImageData
from vtkmodules.vtkIOXML import vtkXMLImageDataReader, vtkXMLImageDataWriter

import plenoflame
from plenoflame import _core, vtk


def address(values):
    return values.__array_interface__["data"][0]


def content(attributes):
    """[(name, names of components, values)] of point, cell, row or field data."""
    found = []
    for i in range(attributes.GetNumberOfArrays()):
        array = attributes.GetAbstractArray(i)
        components = [array.GetComponentName(k) for k in range(array.GetNumberOfComponents())]
        values = ([array.GetValue(k) for k in range(array.GetNumberOfValues())] if isinstance(array, vtkStringArray)
                  else vtk_to_numpy(array))
        found.append((array.GetName(), components, values))
    return found


def updated(algorithm, scene):
    algorithm.SetInputDataObject(scene.to_vtk())
    algorithm.Update()
    return algorithm.GetOutput()


class Conversions(PackageTest):
    def same(self, attributes, expected):
        one, other = (sorted(content(data), key=lambda entry: entry[0]) for data in (attributes, expected))
        self.assertEqual([entry[:2] for entry in one], [entry[:2] for entry in other])
        for (name, _, values), (_, _, wanted) in zip(one, other):
            if isinstance(wanted, list):
                self.assertEqual(values, wanted, name)
            else:
                self.assertEqual(values.dtype, wanted.dtype, name)
                numpy.testing.assert_array_equal(values, wanted, name)

    def test_the_package_loads_no_vtk(self):
        program = ("import sys, plenoflame; before = [name for name in sys.modules if 'vtk' in name]; plenoflame.vtk; "
                   "print(before, 'vtkmodules.vtkCommonCore' in sys.modules)")
        run = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
        self.assertEqual(run.stdout, "[] True\n")

    def test_a_light_field_is_that_of_the_source(self):
        scene = self.scene(60)
        field = scene.render(samples=4, window=(10, 12, 40, 30), truth=True)
        source = vtk.vtkPlenoflameLightFieldSource()
        source.SetSamples(4)
        source.SetWindow(10, 12, 40, 30)
        source.SetTruth(True)
        expected, image = updated(source, scene), field.to_vtk()
        self.same(image.GetPointData(), expected.GetPointData())
        self.same(image.GetFieldData(), expected.GetFieldData())
        for read in ("GetExtent", "GetOrigin", "GetSpacing"):
            self.assertEqual(getattr(image, read)(), getattr(expected, read)())
        self.assertEqual(image.GetPointData().GetScalars().GetName(), "red_650nm")
        field.save(self.folder / "a.exr")
        plenoflame.LightField.from_vtk(expected).save(self.folder / "b.exr")
        self.assertEqual((self.folder / "a.exr").read_bytes(), (self.folder / "b.exr").read_bytes())

    def test_texts_of_a_light_field_pass_the_pipeline(self):
        """The part of a picture that it is, for example, which a merge needs."""
        state = self.scene(20).render(samples=2)._data.state
        state["attributes"] = {"maker": "a", "serial number": "b c"}
        field = plenoflame.LightField(_core.LightField.from_state(state))
        writer = vtk.vtkPlenoflameLightFieldWriter()
        writer.SetInputDataObject(field.to_vtk())
        writer.SetFileName(str(self.folder / "a.exr"))
        self.assertTrue(writer.Write())
        reader = vtk.vtkPlenoflameLightFieldReader()
        reader.SetFileName(str(self.folder / "a.exr"))
        reader.Update()
        for back in (plenoflame.read_light_field(self.folder / "a.exr"), plenoflame.LightField.from_vtk(reader.GetOutput())):
            self.assertEqual(back._data.state["attributes"], state["attributes"])
        older = field.to_vtk()  # a file of VTK's from before texts were kept
        for name in ("texts", "text_names"):
            older.GetFieldData().RemoveArray("plenoflame." + name)
        self.assertEqual(plenoflame.LightField.from_vtk(older)._data.state["attributes"], {})
        writer.SetInputDataObject(older)
        self.assertTrue(writer.Write())

    def through_a_file(self, image):
        """As ParaView does it."""
        writer, reader = vtkXMLImageDataWriter(), vtkXMLImageDataReader()
        for one in (writer, reader):
            one.SetFileName(str(self.folder / "a.vti"))
        writer.SetInputData(image)
        self.assertTrue(writer.Write())
        reader.Update()
        return reader.GetOutput()

    def test_vti_is_still_a_light_field(self):
        field = self.scene().render(samples=4, window=(10, 12, 60, 50))
        read = plenoflame.LightField.from_vtk(self.through_a_file(field.to_vtk()))
        numpy.testing.assert_array_equal(read.flux, field.flux)
        numpy.testing.assert_array_equal(read.error, field.error)
        self.assertEqual((read.window, read.scene_text), (field.window, field.scene_text))
        numpy.testing.assert_array_equal(read.refocus(1.0).image, field.refocus(1.0).image)

    def test_vti_is_still_a_flame(self):
        flame = self.scene().flame(24)
        back = plenoflame.Flame.from_vtk(self.through_a_file(flame.to_vtk()))
        self.assertEqual((back.spacing, back.origin), (flame.spacing, flame.origin))
        for name in ("temperature", "absorption"):
            numpy.testing.assert_array_equal(back[name], flame[name])

    def turned(self):
        """A flame whose axes are none of the world's."""
        directions = [(0.6, 0.8, 0), (-0.8, 0.6, 0), (0, 0, 1)]
        voxels = _core.Voxels((3, 4, 5), (1, -2, 0.5), (1e-3, 2e-3, 3e-3), directions)
        values = 1000.0 + numpy.arange(60).reshape(3, 4, 5)
        voxels.add("temperature", values)
        voxels.add("absorption", values / 100)
        return plenoflame.Flame(voxels)

    def test_a_flame_shares_its_memory(self):
        flame = self.turned()
        image = flame.to_vtk()
        for name in ("temperature", "absorption"):
            self.assertEqual(address(vtk_to_numpy(image.GetPointData().GetArray(name))), address(flame[name]))
        self.assertEqual(image.GetScalarComponentAsDouble(2, 3, 1, 0), flame["temperature"][2, 3, 1])
        place = [0.0] * 3
        image.TransformIndexToPhysicalPoint(2, 3, 1, place)
        expected = (1 + 0.6 * 2e-3 - 0.8 * 6e-3, -2 + 0.8 * 2e-3 + 0.6 * 6e-3, 0.5 + 3e-3)
        numpy.testing.assert_allclose(place, expected, rtol=1e-14)
        back = plenoflame.Flame.from_vtk(image)
        self.assertEqual((back.spacing, back.origin, back.directions), (flame.spacing, flame.origin, flame.directions))
        numpy.testing.assert_array_equal(back["absorption"], flame["absorption"])

    def test_a_flame_is_that_of_the_reader_and_of_the_source(self):
        plenoflame.write_flame(self.folder / "a.vdb", plenoflame.make_flame("candle", voxel_size="2 mm", lines="ch"))
        reader = vtk.vtkPlenoflameFlameReader()
        reader.SetFileName(str(self.folder / "a.vdb"))
        reader.Update()
        source = vtk.vtkPlenoflameFlameSource()
        source.SetResolution(16)
        for flame, image in ((plenoflame.read_flame(self.folder / "a.vdb"), reader.GetOutput()),
                             (self.scene().flame(16), updated(source, self.scene()))):
            for one, other in ((flame.to_vtk(), image), (plenoflame.Flame.from_vtk(image).to_vtk(), image)):
                self.same(one.GetPointData(), other.GetPointData())
                self.assertEqual((one.GetDimensions(), one.GetOrigin(), one.GetSpacing()),
                                 (other.GetDimensions(), other.GetOrigin(), other.GetSpacing()))

    def test_parts_of_an_image_and_its_cells_stand_where_they_are(self):
        image = vtkImageData()
        image.SetExtent(2, 4, -1, 2, 0, 4)
        image.SetOrigin(1, 2, 3)
        image.SetSpacing(0.5, 0.25, 0.125)
        for data, count in ((image.GetCellData(), 2 * 3 * 4), (image.GetPointData(), 3 * 4 * 5)):
            for name, values in (("temperature", numpy.arange(count)), ("velocity", numpy.ones((count, 3)))):
                array = numpy_to_vtk(values, deep=True)
                array.SetName(name)
                data.AddArray(array)
            flame = plenoflame.Flame.from_vtk(image)
            half = 0.5 * (data is image.GetCellData())
            self.assertEqual(list(flame.arrays), ["temperature"])
            self.assertEqual(flame["temperature"].size, count)
            self.assertEqual(flame["temperature"][1, 2, 3], values.shape[0] and 1 + flame["temperature"].shape[0] * (
                2 + 3 * flame["temperature"].shape[1]))
            self.assertEqual(flame.origin, (1 + (2 + half) * 0.5, 2 + (half - 1) * 0.25, 3 + half * 0.125))

    def test_rays_are_those_of_the_source_and_share_their_memory(self):
        scene = self.scene()
        rays = scene.rays(pixels=[(40, 41)], rays=8, flame_samples=3)
        source = vtk.vtkPlenoflameRayPathSource()
        source.AddPixel(40, 41)
        source.SetRaysPerPixel(8)
        source.SetFlameSamples(3)
        expected, lines = updated(source, scene), rays.to_vtk()
        for read in ("GetPointData", "GetCellData", "GetFieldData"):
            self.same(getattr(lines, read)(), getattr(expected, read)())
        for read in (lambda data: data.GetPoints().GetData(), lambda data: data.GetLines().GetOffsetsArray(),
                     lambda data: data.GetLines().GetConnectivityArray()):
            numpy.testing.assert_array_equal(vtk_to_numpy(read(lines)), vtk_to_numpy(read(expected)))
        self.assertEqual(address(vtk_to_numpy(lines.GetPoints().GetData())), address(rays.points))
        for data in (lines.GetPointData(), lines.GetCellData()):
            for name, _, values in content(data):
                self.assertEqual(address(values), address(getattr(rays, name)), name)

    def test_rays_that_are_none_are_no_lines(self):
        rays = self.scene().rays(pixels=[(40, 41)], rays=2, status="missed")
        self.assertEqual((len(rays), rays.to_vtk().GetNumberOfLines()), (0, 0))

    def test_a_block_of_rays_shares_its_memory(self):
        block = next(self.scene().ray_blocks(2, radiance=True))
        table = block.to_vtk()
        self.assertEqual(table.GetNumberOfRows(), len(block))
        for name in ("pixel", "origin", "etendue", "radiance"):
            self.assertEqual(address(vtk_to_numpy(table.GetColumnByName(name))), address(getattr(block, name)))
        numpy.testing.assert_array_equal(vtk_to_numpy(table.GetFieldData().GetArray("anchor")), block.anchor)

    def test_shared_memory_outlives_its_owner(self):
        rays, flame = self.scene().rays(random=20, rays=8), self.turned()
        lines, image = rays.to_vtk(), flame.to_vtk()
        kept = rays.points.copy(), rays.weight.copy(), flame["temperature"].copy()
        cells = rays.offsets.copy(), numpy.arange(len(rays.points))
        del rays, flame
        gc.collect()
        trash = [numpy.ones_like(values) for values in kept for _ in range(200)]
        numpy.testing.assert_array_equal(vtk_to_numpy(lines.GetPoints().GetData()), kept[0])
        numpy.testing.assert_array_equal(vtk_to_numpy(lines.GetCellData().GetArray("weight")), kept[1])
        numpy.testing.assert_array_equal(vtk_to_numpy(lines.GetLines().GetOffsetsArray()), cells[0])
        numpy.testing.assert_array_equal(vtk_to_numpy(lines.GetLines().GetConnectivityArray()), cells[1])
        found = vtk_to_numpy(image.GetPointData().GetArray("temperature"))
        del lines, image
        gc.collect()
        trash += [numpy.ones_like(values) for values in kept for _ in range(200)]
        numpy.testing.assert_array_equal(found, kept[2].ravel(order="F"))

    def test_a_scene_has_its_camera_and_its_flames_in_memory(self):
        scene = self.scene(40)
        hot = numpy.full((5, 6, 7), 1500.0)
        scene.remove("flames", 0)
        scene.add_flame(plenoflame.flame_from_arrays(hot, hot / 100, spacing=5e-3), position="1 m, 0 m, -10 mm")
        source = vtk.vtkPlenoflameLightFieldSource()
        source.SetSamples(2)
        image = updated(source, scene)
        self.assertGreater(scene.render(2).flux.max(), 0)
        numpy.testing.assert_array_equal(plenoflame.LightField.from_vtk(image).flux, scene.render(2).flux)
        several = plenoflame.Scene(text=scene.text.replace("[camera]\n", "[[cameras]]\n").replace("[camera.", "[cameras.")
                                   .replace('name = ""', 'name = "left"', 1).split("[[flames]]")[0])
        several.camera_name = "left"
        self.assertEqual((several.to_vtk().GetCamera(), several.to_vtk().GetText()), ("left", several.text))

    def test_what_is_refused(self):
        empty = vtkImageData()
        for message, action in (("no light field of Plenoflame: .*'plenoflame.window'", lambda: plenoflame.LightField.from_vtk(empty)),
                                ("no array of single numbers", lambda: plenoflame.Flame.from_vtk(empty)),
                                ("image takes a vtkImageData, not int", lambda: plenoflame.Flame.from_vtk(3)),
                                ("image takes a vtkImageData, not Flame", lambda: plenoflame.LightField.from_vtk(self.turned())),
                                (r"LightField.from_vtk\(\) takes a vtkImageData", lambda: plenoflame.LightField(empty)),
                                (r"Flame.from_vtk\(\) a vtkImageData", lambda: plenoflame.Flame(empty)),
                                ("flame takes a Flame", lambda: plenoflame.write_flame(self.folder / "a.vdb", empty))):
            with self.assertRaisesRegex(plenoflame.Error, message):
                action()
        image = self.scene(20).render(samples=2).to_vtk()
        image.SetDimensions(10, 40, 1)
        with self.assertRaisesRegex(plenoflame.Error, "10 x 40 points, but its field data says 20 x 20"):
            plenoflame.LightField.from_vtk(image)
        broken = self.scene(20)
        broken["camera.array.diameter"] = "5 mm"  # wider than the pitch
        with self.assertRaisesRegex(plenoflame.Error, "diameter"):
            broken.to_vtk()


if __name__ == "__main__":
    main()
