"""The package on a machine without VTK: what it says where VTK is needed."""

import importlib
import sys

from package import PackageTest, main

import plenoflame


class Alone(PackageTest):
    def test_nothing_of_vtk_is_loaded(self):
        self.assertIsNone(sys.modules["vtkmodules"])
        self.assertEqual([name for name in sys.modules if name.startswith(("plenoflame.vtk", "plenoflame._vtk"))], [])
        with self.assertRaisesRegex(ImportError, "plenoflame.vtk needs VTK: .*python3-plenoflame-vtk"):
            importlib.import_module("plenoflame.vtk")
        with self.assertRaisesRegex(plenoflame.Error, "plenoflame.vtk needs VTK: .*python3-plenoflame-vtk"):
            plenoflame.vtk

    def test_what_needs_vtk_says_so(self):
        scene = self.scene(60)
        field, rays = scene.render(samples=2), scene.rays(pixels=[(30, 30)], rays=2)
        block = next(scene.ray_blocks(2))
        for name, action in (("Scene.to_vtk", scene.to_vtk), ("Scene.camera", scene.camera), ("picture", lambda: plenoflame.picture(scene)),
                             ("import_flame", lambda: plenoflame.import_flame("a.vtu", constant=1))):
            with self.assertRaisesRegex(plenoflame.Error, rf"^{name}\(\) needs VTK: .*python3-plenoflame-vtk"):
                action()
        for action in (field.to_vtk, rays.to_vtk, block.to_vtk, scene.flame(8).to_vtk, lambda: plenoflame.Flame.from_vtk(None),
                       lambda: plenoflame.LightField.from_vtk(None)):
            with self.assertRaisesRegex(plenoflame.Error, r"^to_vtk\(\) and from_vtk\(\) need VTK: .*python3-vtk9"):
                action()


if __name__ == "__main__":
    main()
