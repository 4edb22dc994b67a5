"""The package without VTK: what it has of its own, and what it says where VTK is needed."""

import importlib
import pickle
import sys
import unittest

import numpy
from package import VTK, PackageTest, main

import plenoflame


@unittest.skipIf(VTK, "the package was built with VTK")
class Alone(PackageTest):
    def test_nothing_of_vtk_is_loaded(self):
        self.assertIsNone(sys.modules["vtkmodules"])
        self.assertIsNone(plenoflame.vtk)
        self.assertRaises(ImportError, importlib.import_module, "vtkmodules.vtkCommonCore")

    def test_what_needs_vtk_says_so(self):
        scene = self.scene(60)
        field, rays = scene.render(samples=2), scene.rays(pixels=[(30, 30)], rays=2)
        block = next(scene.ray_blocks(2))
        for action in (lambda: scene.scene, lambda: field.image, lambda: rays.polydata, lambda: block.table, scene.camera,
                       lambda: plenoflame.picture(scene), lambda: plenoflame.import_flame("a.vtu", constant=1),
                       lambda: plenoflame.read_flame("a.vdb", local_frame=True)):
            with self.assertRaisesRegex(plenoflame.Error, "needs VTK: install the package with it"):
                action()

    def test_saved_rays_are_those_of_the_command(self):
        """Also those that were pickled between: nothing of them is lost."""
        scene = self.scene()
        scene.save(self.folder / "a.toml")
        self.command("rays", "a.toml", "--pixel", "40,41", "--rays", "8", "--flame-samples", "3", "-o", "c.vtp")
        rays = scene.rays(pixels=[(40, 41)], rays=8, flame_samples=3)
        rays.save(self.folder / "p.vtp")
        self.assertEqual((self.folder / "p.vtp").read_bytes(), (self.folder / "c.vtp").read_bytes())
        pickle.loads(pickle.dumps(rays)).save(self.folder / "q.vtp")
        self.assertEqual((self.folder / "q.vtp").read_bytes(), (self.folder / "c.vtp").read_bytes())

    def test_voxels_keep_their_place(self):
        """Through a file, turned: the directions are the rotation's columns."""
        values = numpy.arange(300.0, 300 + 4 * 5 * 6).reshape(4, 5, 6)
        flame = plenoflame.flame_from_arrays(values, values / 300, spacing=(1e-3, 2e-3, 3e-3), origin=(1, -2, 0.5))
        plenoflame.write_flame(self.folder / "a.vdb", flame, ambient=0)
        arrays, spacing, origin, directions = plenoflame.flame_arrays(plenoflame.read_flame(self.folder / "a.vdb"))
        numpy.testing.assert_array_equal(arrays["temperature"], values.astype(numpy.float32))
        numpy.testing.assert_allclose(spacing, (1e-3, 2e-3, 3e-3), rtol=1e-12)
        numpy.testing.assert_allclose(origin, (1, -2, 0.5), rtol=1e-12)
        numpy.testing.assert_array_equal(directions, numpy.eye(3))

    def test_a_light_field_outlives_pickle_and_file(self):
        field = self.scene(60).render(samples=2, truth=True)
        field.save(self.folder / "a.exr")
        pickle.loads(pickle.dumps(field)).save(self.folder / "b.exr")
        self.assertEqual((self.folder / "a.exr").read_bytes(), (self.folder / "b.exr").read_bytes())

    def test_arrays_outlive_their_light_field(self):
        flux = self.scene(60).render(samples=2).flux
        self.assertGreater(flux.sum(), 0)


if __name__ == "__main__":
    main()
