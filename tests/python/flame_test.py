"""Flames from Python."""

import numpy
from package import PackageTest, main

import plenoflame


class Flames(PackageTest):
    def test_numpy_flame_is_written(self):
        """A homogeneous block: the command line finds what was written."""
        hot = numpy.full((12, 12, 20), 1700.0)
        block = plenoflame.flame_from_arrays(hot, 0 * hot + 25, spacing=2e-3, origin=(-0.011, -0.011, 0))
        plenoflame.write_flame(self.folder / "block.vdb", block)
        grids = {grid["name"]: grid for grid in self.figures("info", "block.vdb")["grids"]}
        self.assertEqual(grids["temperature"]["maximum"], 1700)
        self.assertEqual(grids["absorption"]["maximum"], 25)
        read = plenoflame.read_flame(self.folder / "block.vdb")
        numpy.testing.assert_array_equal(read["absorption"], 25)
        numpy.testing.assert_allclose(read.origin, (-0.011, -0.011, 0), rtol=1e-12)

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

    def test_lines_are_written_and_the_rest_is_named(self):
        ones = numpy.ones((2, 2, 2))
        flame = plenoflame.flame_from_arrays(300 * ones, ones, spacing=1e-3, **{"CH*": 5 * ones, "ch": 6 * ones})
        with self.assertWarnsRegex(RuntimeWarning, r"not written: ch; .* CH\*, C2\*, OH\*, Na_D"):
            plenoflame.write_flame(self.folder / "lines.vdb", flame)
        grids = {grid["name"]: grid["maximum"] for grid in self.figures("info", "lines.vdb")["grids"]}
        self.assertEqual(grids, {"temperature": 300, "absorption": 1, "CH*": 5})

    def test_scene_is_sampled(self):
        flame = self.scene().flame(50)
        self.assertEqual(flame["temperature"].max(), 1900)
        self.assertEqual(max(flame["temperature"].shape), 50)

    def test_errors(self):
        with self.assertRaisesRegex(plenoflame.Error, "missing.vdb"):
            plenoflame.read_flame(self.folder / "missing.vdb")
        ones = numpy.ones((2, 2, 2))
        block = plenoflame.flame_from_arrays(ones, ones, spacing=1e-3)
        with self.assertRaisesRegex(plenoflame.Error, "the data has temperature, absorption"):
            plenoflame.write_flame(self.folder / "x.vdb", block, absorption="kappa")


if __name__ == "__main__":
    main()
