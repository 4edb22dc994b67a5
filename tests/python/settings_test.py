"""Every setting arrives where it is used: the package against the command's files, counts and closed forms."""

import pickle

import numpy
from package import PackageTest, main

import plenoflame


class Settings(PackageTest):
    def flame(self):
        hot = numpy.full((5, 6, 7), 1500.0)
        return plenoflame.flame_from_arrays(hot, hot / 100, spacing=2e-3)

    def test_written_flame_has_the_temperature_around_it(self):
        plenoflame.write_flame(self.folder / "a.vdb", self.flame(), ambient=400)
        self.assertIn("background 400 K", self.command("info", "a.vdb"))

    def test_half_precision_is_written(self):
        """A number that half precision rounds by 0.3: it has 11 digits in base 2."""
        values = numpy.full((3, 3, 3), 1500.3, numpy.float32)
        flame = plenoflame.flame_from_arrays(values, values / 100, spacing=2e-3)
        for half, kept in ((False, values), (True, values.astype(numpy.float16).astype(numpy.float32))):
            plenoflame.write_flame(self.folder / "a.vdb", flame, half=half)
            arrays, *_ = plenoflame.flame_arrays(plenoflame.read_flame(self.folder / "a.vdb"))
            numpy.testing.assert_array_equal(arrays["temperature"], kept)

    def test_time_limit_ends_a_run(self):
        self.scene(60).render(samples=4096, time_limit=0.05).save(self.folder / "a.exr")
        self.assertLess(self.figures("info", "a.exr")["samples"], 4096)

    def test_what_was_stopped_is_incomplete_after_pickling(self):
        field = self.scene().render(samples=1 << 20, progress=lambda fraction: True)
        self.assertFalse(field.complete)
        self.assertFalse(pickle.loads(pickle.dumps(field)).complete)

    def test_resolution_of_a_sampled_flame(self):
        arrays, *_ = plenoflame.flame_arrays(self.scene().flame(resolution=16))
        self.assertEqual(max(arrays["temperature"].shape), 16)

    def test_aperture_and_spread_are_those_of_the_command(self):
        field = self.scene().render(samples=4)
        field.save(self.folder / "a.exr")
        self.command("refocus", "a.exr", "--depth", "1 m", "--aperture", "0.4", "--exr", "-o", "r")
        self.command("views", "a.exr", "--grid", "3", "--spread", "0.4", "--exr", "-o", "v")
        expected = plenoflame.read_light_field(self.folder / "r" / "refocus_1.0000m.exr")
        numpy.testing.assert_array_equal(field.refocus(1, aperture=0.4).image, expected.flux)
        expected = plenoflame.read_light_field(self.folder / "v" / "view_00_02.exr")
        numpy.testing.assert_array_equal(field.views(3, spread=0.4)[0, 2], expected.flux)

    def test_volumes_of_voxels(self):
        operator = self.scene(20).operator(grid=(4, 3, 2), size=(0.04, 0.03, 0.02), center="1 m, 0 m, 0 m")
        numpy.testing.assert_allclose(operator.volumes, 1e-6, rtol=1e-12)

    def test_confidence_is_a_share_of_its_own(self):
        stack = self.scene().render(samples=4).focus_stack([0.9, 1.0, 1.1])
        self.assertGreater(stack.confidence.max(), 0)
        self.assertLessEqual(stack.confidence.max(), 1)


if __name__ == "__main__":
    main()
