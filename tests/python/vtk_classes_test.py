"""The VTK classes from Python, as VTK's own are used: properties, printing, events, pipelines."""

import re

import numpy
from package import ROOT, PackageTest, main
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonExecutionModel import vtkAlgorithm
from vtkmodules.vtkImagingCore import vtkImageShiftScale
from vtkmodules.vtkIOXML import (vtkXMLImageDataReader, vtkXMLImageDataWriter, vtkXMLMultiBlockDataReader,
                                 vtkXMLMultiBlockDataWriter, vtkXMLPolyDataReader, vtkXMLPolyDataWriter)

import plenoflame
from plenoflame import vtk


def classes():
    return {name: kind for name, kind in vars(vtk).items() if name.startswith("vtkPlenoflame") and isinstance(kind, type)}


def printed(thing):
    """What PrintSelf says, without what changes by itself."""
    return [line for line in str(thing).split("\n") if not re.search(r"Modified|Reference Count|Progress|Debug", line)]


class Classes(PackageTest):
    def events_of(self, algorithm, event):
        """The texts (of errors) or the progress at each event."""
        seen = []

        def note(caller, _, text=None):
            seen.append(caller.GetProgress() if event == "ProgressEvent" else text)
        if event == "ErrorEvent":
            note.CallDataType = "string0"
        algorithm.AddObserver(event, note)
        return seen

    def test_the_documentation_names_them_all(self):
        page = (ROOT / "docs" / "scripting.md").read_text()
        named = set(re.findall(r"`(vtkPlenoflame\w+)`", page))
        self.assertEqual(set(classes()), named)
        self.assertGreaterEqual(len(classes()), 14)

    def test_every_property_is_printed_and_modifies(self):
        count = 0
        for name, kind in classes().items():
            inherited = set(dir(kind.__mro__[1]))
            for setter in (m for m in dir(kind) if m.startswith("Set") and m not in inherited):
                thing = kind()
                if (name, setter) == ("vtkPlenoflameScene", "SetCamera"):  # takes a camera that there is
                    thing.ReadText("".join(f'[[cameras]]\nname = "{camera}"\npreset = "paper-plenoptic2"\n'
                                           for camera in ("one", "other")), "two.toml")
                getter, set_to = getattr(thing, "Get" + setter[3:], None), getattr(thing, setter)
                try:
                    old = getter()
                except TypeError:  # there is none, or it takes arguments
                    continue
                if isinstance(old, bool):
                    candidates = [(not old,)]
                elif isinstance(old, (int, float)):
                    candidates = [(old + 1,), (old - 1,), (0.5 * old,)]
                elif isinstance(old, tuple):
                    candidates = [tuple(k + 1 for k in range(len(old)))]
                elif isinstance(old, str) or "FileName" in setter:
                    candidates = [("other",)]
                else:
                    continue  # objects: picture_test.py has them
                with self.subTest(f"{name}.{setter}"):
                    before, time = printed(thing), thing.GetMTime()
                    for new in candidates:  # some are outside of the property's range
                        set_to(*new)
                        if getter() != old:
                            break
                    self.assertNotEqual(getter(), old)
                    self.assertGreater(thing.GetMTime(), time)
                    self.assertNotEqual(printed(thing), before)
                    count += 1
        self.assertGreater(count, 60)

    def test_algorithms_want_their_input(self):
        """Without it an error event, and no crash."""
        for name, kind in classes().items():
            thing = kind()
            if not isinstance(thing, vtkAlgorithm):
                continue
            with self.subTest(name):
                errors = self.events_of(thing, "ErrorEvent"), self.events_of(thing.GetExecutive(), "ErrorEvent")
                thing.Write() if name.endswith("Writer") else thing.Update()
                self.assertGreaterEqual(len(errors[0]) + len(errors[1]), 1)

    def test_pipeline_from_file_to_pictures(self):
        """Every class in one pipeline; what comes out is what the command line makes."""
        self.scene(60).save(self.folder / "a.toml")
        self.command("render", "a.toml", "--samples", 4, "-o", "a.exr")
        reader = vtk.vtkPlenoflameSceneReader()
        reader.SetFileName(str(self.folder / "a.toml"))
        source = vtk.vtkPlenoflameLightFieldSource()
        source.SetInputConnection(reader.GetOutputPort())
        source.SetSamples(4)
        source.StandardErrorOn()
        source.Update()
        file = vtk.vtkPlenoflameLightFieldReader()
        file.SetFileName(str(self.folder / "a.exr"))
        file.Update()
        flux = vtk_to_numpy(file.GetOutput().GetPointData().GetScalars())
        numpy.testing.assert_array_equal(vtk_to_numpy(source.GetOutput().GetPointData().GetScalars()), flux)
        writer = vtk.vtkPlenoflameLightFieldWriter()
        writer.SetInputConnection(source.GetOutputPort())
        writer.SetFileName(str(self.folder / "b.exr"))
        writer.Write()
        self.assertEqual(self.figures("compare", "b.exr", "a.exr")["relative_rmse"], 0)

        for kind, size in ((vtk.vtkPlenoflameViews, None), (vtk.vtkPlenoflameRefocus, 20)):
            picture = kind()
            picture.SetInputConnection(file.GetOutputPort())
            if size:
                picture.SetDepth(1.0)
                picture.SetWidth(size)
            picture.Update()
            self.assertGreater(picture.GetOutputDataObject(0).GetNumberOfElements(0), 0)

    def test_filters_of_vtk_get_the_whole_picture(self):
        """They ask for its size before there is one; and again when something has changed."""
        scene = self.scene(60)
        plenoflame.write_flame(self.folder / "a.vdb", scene.flame(16))
        reader = vtk.vtkPlenoflameFlameReader()
        reader.SetFileName(str(self.folder / "a.vdb"))
        flame = vtk.vtkPlenoflameFlameSource()
        flame.SetInputDataObject(scene.to_vtk())
        source = vtk.vtkPlenoflameLightFieldSource()
        source.SetInputDataObject(scene.to_vtk())
        source.SetSamples(2)
        part = vtk.vtkPlenoflameLightFieldSource()
        part.SetInputDataObject(scene.to_vtk())
        part.SetWindow(10, 12, 40, 30)
        scene.render(samples=2, window=(7, 9, 30, 20)).save(self.folder / "a.exr")
        file = vtk.vtkPlenoflameLightFieldReader()
        file.SetFileName(str(self.folder / "a.exr"))
        views, refocus = vtk.vtkPlenoflameViews(), vtk.vtkPlenoflameRefocus()
        for one in (views, refocus):
            one.SetInputConnection(source.GetOutputPort())
        for algorithm, port, changes in ((reader, 0, ()), (source, 0, ()), (part, 0, ()), (file, 0, ()),
                                         (flame, 0, [(flame.SetResolution, 9), (flame.SetResolution, 12)]),
                                         (views, 1, [(views.SetGrid, 3), (source.SetSamples, 4)]),
                                         (refocus, 0, [(refocus.SetWidth, 20), (source.SetSamples, 8)])):
            half = vtkImageShiftScale()
            half.SetInputConnection(algorithm.GetOutputPort(port))
            half.SetScale(0.5)
            before = numpy.empty(0)
            for change, value in (*changes, (half.SetScale, 0.25)):
                change(value)
                half.Update()
                whole, seen = algorithm.GetOutputDataObject(port), half.GetOutput()
                values = vtk_to_numpy(whole.GetPointData().GetScalars()).copy()
                self.assertEqual(numpy.array_equal(values, before), change == half.SetScale and before.size > 0)
                before = values
                self.assertGreater(whole.GetNumberOfPoints(), 20)
                self.assertEqual(seen.GetDimensions(), whole.GetDimensions())
                self.assertEqual((seen.GetOrigin(), seen.GetSpacing()), (whole.GetOrigin(), whole.GetSpacing()))
                numpy.testing.assert_array_equal(vtk_to_numpy(seen.GetPointData().GetScalars()),
                                                 half.GetScale() * values)

    def test_camera_is_where_the_scene_says(self):
        scene = self.scene(60)
        source = vtk.vtkPlenoflameCameraSource()
        source.SetInputDataObject(scene.to_vtk())
        source.SetLevelOfDetail(source.ALL_MICROLENSES)
        source.Update()
        blocks = source.GetOutput()
        side = 60 * scene["camera.sensor.pixel_pitch"]
        low, high = numpy.array(blocks.GetBlock(source.SENSOR).GetBounds()).reshape(3, 2).T
        numpy.testing.assert_allclose((high - low)[1:], side, rtol=1e-9)
        microlenses = blocks.GetBlock(source.MICROLENSES)
        self.assertGreater(microlenses.GetNumberOfCells(), 0)
        self.assertEqual(set(vtk_to_numpy(microlenses.GetCellData().GetArray("type"))) - {0, 1, 2}, set())
        source.SetLevelOfDetail(source.PLATE)
        source.Update()
        self.assertEqual(source.GetOutput().GetBlock(source.MICROLENSES).GetNumberOfCells(), 0)

    def test_rays_report_progress(self):
        source = vtk.vtkPlenoflameRayPathSource()
        source.SetInputDataObject(self.scene(60).to_vtk())
        source.SetNumberOfRandomPixels(200)
        source.SetRaysPerPixel(64)
        seen = self.events_of(source, "ProgressEvent")
        source.Update()
        self.assertGreaterEqual(len(seen), 2)
        self.assertEqual(seen, sorted(seen))
        self.assertEqual(seen[-1], 1)
        self.assertGreater(source.GetOutput().GetNumberOfLines(), 1000)

    def test_rays_can_be_aborted(self):
        source = vtk.vtkPlenoflameRayPathSource()
        source.SetInputDataObject(self.scene(60).to_vtk())
        source.SetNumberOfRandomPixels(3000)
        source.SetRaysPerPixel(16384)  # some hundred million rays
        source.SetNumberOfThreads(1)
        source.AddObserver("ProgressEvent", lambda caller, _: caller.SetAbortExecute(1))
        errors = self.events_of(source, "ErrorEvent")
        source.Update()
        self.assertEqual(source.GetOutput().GetNumberOfLines(), 0)
        self.assertEqual(errors, [])

    def test_vtk_opens_what_it_writes(self):
        """.vtp of rays, .vti of a light field, .vtm of the camera: by VTK's own readers, which ParaView has."""
        scene = self.scene(60)
        rays = scene.rays(random=20, rays=8).to_vtk()
        field = scene.render(samples=2).to_vtk()
        camera = vtk.vtkPlenoflameCameraSource()
        camera.SetInputDataObject(scene.to_vtk())
        camera.Update()
        for name, data, writer, reader in (("a.vtp", rays, vtkXMLPolyDataWriter(), vtkXMLPolyDataReader()),
                                           ("a.vti", field, vtkXMLImageDataWriter(), vtkXMLImageDataReader()),
                                           ("a.vtm", camera.GetOutput(), vtkXMLMultiBlockDataWriter(),
                                            vtkXMLMultiBlockDataReader())):
            writer.SetFileName(str(self.folder / name))
            writer.SetInputData(data)
            self.assertTrue(writer.Write())
            reader.SetFileName(str(self.folder / name))
            reader.Update()
            back = reader.GetOutputDataObject(0)
            self.assertEqual(back.GetNumberOfElements(0), data.GetNumberOfElements(0))
            if name == "a.vtm":
                self.assertEqual(back.GetNumberOfBlocks(), data.GetNumberOfBlocks())
                continue
            for attributes in (arrays_of(back, "Point"), arrays_of(back, "Cell")):
                for array, other in attributes(data):
                    numpy.testing.assert_array_equal(array, other)


def arrays_of(back, which):
    """Pairs of arrays of the same name."""
    def pairs(data):
        own, other = (getattr(d, f"Get{which}Data")() for d in (data, back))
        for i in range(own.GetNumberOfArrays()):
            yield (vtk_to_numpy(own.GetArray(i)), vtk_to_numpy(other.GetArray(own.GetArrayName(i))))
    return pairs


if __name__ == "__main__":
    main()
