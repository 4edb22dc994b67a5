"""The stream of rays from Python: numpy views that make the picture."""

import itertools
import os
import re
import threading
import time

import numpy
from package import ROOT, PackageTest, main

import plenoflame


def picture_of(blocks, scene, channel=0):
    """[W] of every pixel, from rays with their radiance."""
    flux = numpy.zeros((scene.rows, scene.columns))
    for block in blocks:
        index = numpy.flatnonzero(block.channels == channel)
        for i in index:
            numpy.add.at(flux, (block.pixel[:, 1], block.pixel[:, 0]), block.etendue * block.radiance[:, i])
    return flux


class RayBlocksTest(PackageTest):
    def test_rays_make_the_picture(self):
        scene = self.scene()
        expected = scene.render(samples=16).flux
        self.assertGreater(expected.max(), 0)
        # The picture is rendered in single precision: at the rim of the flame a ray may see a little more or less.
        for precision, dtype, tolerance in (("single", numpy.float32, {"rtol": 1e-5}),
                                            ("double", numpy.float64, {"rtol": 1e-5, "atol": 1e-5 * expected.max()})):
            blocks = list(scene.ray_blocks(16, radiance=True, precision=precision))
            self.assertEqual(blocks[0].etendue.dtype, dtype)
            numpy.testing.assert_allclose(picture_of(blocks, scene), expected, **tolerance)

    def test_paths_of_dispersed_light(self):
        scene = self.scene()
        scene["camera.lens.surfaces[0].glass"] = "N-SF11"
        scene.insert("channels", 0)
        scene.insert("channels", 1)
        for i, wavelength in enumerate(("700 nm", "450 nm")):
            scene[f"channels[{i}].name"] = wavelength[:3]
            scene[f"channels[{i}].kind"] = "band"
            scene[f"channels[{i}].wavelength"] = wavelength
            scene[f"channels[{i}].width"] = "10 nm"
        while scene.list_size("channels") > 2:
            scene.remove("channels", 2)
        blocks = list(scene.ray_blocks(4, radiance=True, precision="single"))
        self.assertEqual({block.path for block in blocks}, {0, 1})
        light_field = scene.render(samples=4)
        for channel in range(2):
            expected = light_field[scene.channels[channel]]
            self.assertGreater(expected.max(), 0)
            numpy.testing.assert_allclose(picture_of(blocks, scene, channel), expected, rtol=1e-5)

    def test_arrays_have_a_row_for_each_ray(self):
        block = next(self.scene().ray_blocks(4))
        for name, width in (("pixel", 2), ("microlens", 2), ("origin", 3), ("direction", 3), ("etendue", None)):
            array = getattr(block, name)
            self.assertEqual(array.shape, (len(block), width) if width else (len(block),))
        numpy.testing.assert_allclose(numpy.linalg.norm(block.direction, axis=1), 1, rtol=1e-12)
        self.assertTrue(numpy.all(numpy.isinf(block.t_far)))
        with self.assertRaisesRegex(AttributeError, "radiance=True"):
            block.radiance

    def test_rays_are_those_of_the_exported_paths(self):
        """One pixel, ray by ray: how each ended, its weight, and that the lines are the same."""
        scene = self.scene()
        paths = scene.rays(pixels=[(40, 41)], rays=32)
        block, = scene.ray_blocks(32, window=(40, 41, 1, 1), skip=False)
        for name in ("pixel", "microlens", "type", "status", "ended_at"):
            numpy.testing.assert_array_equal(getattr(block, name), getattr(paths, name), name)
        reached = block.status == 0
        numpy.testing.assert_allclose(block.etendue[reached], paths.weight[reached], rtol=1e-10)
        self.assertFalse(block.etendue[~reached].any())
        ends = paths.points[paths.offsets[1:] - 1][reached]
        origin, direction = (block.anchor + block.origin)[reached], block.direction[reached]
        self.assertLess(numpy.linalg.norm(numpy.cross(ends - origin, direction), axis=1).max(), 1e-11)

    def test_order_does_not_depend_on_threads(self):
        scene = self.scene(150)

        def per_pixel(**options):
            tiles = {}
            for block in scene.ray_blocks(2, precision="single", **options):
                tiles.setdefault(block.tile, []).append(block)
            self.assertEqual(sorted(tiles), list(range(9)))
            return [numpy.concatenate([getattr(block, name) for tile in sorted(tiles) for block in tiles[tile]])
                    for name in ("pixel", "origin", "etendue")]

        alone = per_pixel(threads=1)
        for options in ({"threads": 3}, {"threads": 2, "rays_per_block": 1}):
            for expected, found in zip(alone, per_pixel(**options)):
                numpy.testing.assert_array_equal(expected, found)
        tiles = [block.tile for block in scene.ray_blocks(2, threads=1)]
        self.assertEqual(tiles, sorted(tiles))

    def test_an_iteration_that_ends_early_leaves_no_threads(self):
        before = len(os.listdir("/proc/self/task"))
        for _ in range(20):
            blocks = self.scene(300).ray_blocks(64, rays_per_block=1000, threads=2)
            self.assertEqual(len(list(itertools.islice(blocks, 2))), 2)
            blocks.close()
        self.assertEqual(len(os.listdir("/proc/self/task")), before)

    def test_other_threads_work_meanwhile(self):
        """While the iteration waits for its one block, which takes long."""
        blocks = self.scene(150).ray_blocks(256, radiance=True, rays_per_block=1 << 23, threads=1)
        counted, done = [0], threading.Event()

        def count():
            while not done.is_set():
                counted[0] += 1
                time.sleep(1e-4)

        counter = threading.Thread(target=count)
        counter.start()
        try:
            before = counted[0]
            next(blocks)
            self.assertGreater(counted[0] - before, 5)
        finally:
            done.set()
            counter.join()
            blocks.close()

    def test_documented_example(self):
        page = (ROOT / "docs" / "ray-stream.md").read_text()
        code = re.search(r"```python\n(.*?)```", page, re.DOTALL)[1]
        self.scene().save(self.folder / "small.toml")
        names = {}
        exec(code.replace("examples/lenslets-30.toml", str(self.folder / "small.toml")), names)
        expected = names["light_field"].flux
        self.assertGreater(expected.max(), 0)
        numpy.testing.assert_allclose(names["flux"], expected, rtol=1e-5, atol=1e-3 * expected.max())
        self.assertGreater(names["vignetted"], 0)

    def test_errors_are_those_of_the_command(self):
        scene = self.scene()
        with self.assertRaisesRegex(plenoflame.Error, "window must lie inside the sensor of 80 x 80"):
            list(scene.ray_blocks(window=(70, 0, 20, 20)))
        with self.assertRaisesRegex(plenoflame.Error, "no precision 'half'"):
            scene.ray_blocks(precision="half")
        scene["camera.lens.surfaces[0].diameter"] = "1 m"
        with self.assertRaises(plenoflame.Error):
            scene.ray_blocks()


if __name__ == "__main__":
    main()
