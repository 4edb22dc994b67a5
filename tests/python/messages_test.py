"""What goes wrong is said in the same words by the command line, by VTK's error events and by Python."""

import re

from package import EXAMPLE, PackageTest, main, needs_vtk

import plenoflame


class Messages(PackageTest):
    def setUp(self):
        super().setUp()
        self.scene(60).save(self.folder / "a.toml")
        (self.folder / "bad.toml").write_text(EXAMPLE.read_text().replace("[camera]", "[camera]\nlens_count = 3", 1))
        (self.folder / "no.exr").write_text("not an image")
        self.scene(60).render(samples=2).save(self.folder / "a.exr")

    def of_command(self, *arguments):
        for status in (1, 2):
            try:
                text = self.command(*arguments, status=status)
                break
            except AssertionError:
                if status == 2:
                    raise
        found = re.fullmatch(r"plenoflame: error: ([^\n]+)\n", text)
        self.assertTrue(found, text)
        return found[1].replace(str(self.folder) + "/", "")

    def same(self, action, *arguments):
        with self.assertRaises(plenoflame.Error) as caught:
            action()
        text = str(caught.exception)
        self.assertNotIn("\n", text)
        self.assertEqual(text.replace(str(self.folder) + "/", ""), self.of_command(*arguments))

    def test_scenes(self):
        self.same(lambda: plenoflame.Scene(self.folder / "bad.toml"), "info", "bad.toml")
        self.same(lambda: plenoflame.Scene(self.folder / "none.toml"), "info", "none.toml")

    def test_light_fields(self):
        self.same(lambda: plenoflame.read_light_field(self.folder / "no.exr"), "develop", "no.exr")
        field = plenoflame.read_light_field(self.folder / "a.exr")
        self.same(lambda: field.refocus(-1), "refocus", "a.exr", "-o", "o", "--depth=-1 m")
        self.same(lambda: field.refocus(0.01), "refocus", "a.exr", "-o", "o", "--depth", "10 mm")
        self.same(lambda: field.develop(channel="blue"), "develop", "a.exr", "--channel", "blue")
        self.same(lambda: field.views(channel="blue"), "views", "a.exr", "-o", "o", "--channel", "blue")

    def test_rays(self):
        scene = plenoflame.Scene(self.folder / "a.toml")
        self.same(lambda: scene.rays(pixels=[(60, 3)]), "rays", "a.toml", "--pixel", "60,3", "-o", "r.vtp")
        self.same(lambda: scene.rays(points=[(-1, 0, 0)]), "rays", "a.toml", "--point=-1 m,0 m,0 m", "-o", "r.vtp")
        self.same(lambda: scene.rays(microlenses=[(500, 500)]), "rays", "a.toml", "--microlens", "500,500", "-o", "r.vtp")

    def write_mesh(self):
        from fields import mesh
        from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridWriter
        writer = vtkXMLUnstructuredGridWriter()
        writer.SetFileName(str(self.folder / "m.vtu"))
        writer.SetInputData(mesh(2))
        writer.Write()

    @needs_vtk
    def test_imports(self):
        self.write_mesh()

        def imported(name, *options, **settings):
            self.same(lambda: plenoflame.import_flame(self.folder / name, **settings), "flame", "import", name,
                      *options, "-o", "f.vdb")
        imported("m.vtu", "--temperature", "hot", "--constant", "1 1/m", temperature="hot", constant=1)
        imported("m.vtu", "--soot", "s", soot="s")
        imported("none.vtu", "--constant", "1 1/m", constant=1)
        imported("a.toml", "--constant", "1 1/m", constant=1)

    @needs_vtk
    def test_events_carry_the_same_text(self):
        """The class itself, as a script of VTK uses it: an event, an empty output, and the program goes on."""
        from vtkmodules.util.vtkConstants import VTK_STRING
        from vtkmodules.vtkCommonCore import vtkCommand
        self.write_mesh()
        source = plenoflame.vtk.vtkPlenoflameFlameImport()
        source.SetFileName(str(self.folder / "m.vtu"))
        source.SetTemperatureArray("hot")
        source.SetConstantAbsorption(1)
        texts = []

        def note(_caller, _event, text):
            texts.append(text)
        note.CallDataType = VTK_STRING
        source.AddObserver(vtkCommand.ErrorEvent, note)
        source.GetExecutive().AddObserver(vtkCommand.ErrorEvent, lambda *_: None)
        source.Update()
        self.assertEqual(source.GetOutput().GetNumberOfPoints(), 0)
        self.assertEqual(len(texts), 1)
        self.assertIn(self.of_command("flame", "import", "m.vtu", "--temperature", "hot", "--constant", "1 1/m", "-o",
                                      "f.vdb"), texts[0].replace(str(self.folder) + "/", ""))
        source.SetTemperatureArray("T")
        source.Update()
        self.assertGreater(source.GetOutput().GetNumberOfPoints(), 100)


if __name__ == "__main__":
    main()
