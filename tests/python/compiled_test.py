"""Compiled cameras from Python: the command's bits, files both ways, and what is refused."""

import numpy
from package import PackageTest, main

import plenoflame


class CompiledCameras(PackageTest):
    def setUp(self):
        super().setUp()
        self.small = self.scene(60)
        self.small.save(self.folder / "a.toml")

    def assert_same(self, field, path):
        read = plenoflame.read_light_field(self.folder / path)
        numpy.testing.assert_array_equal(read.flux, field.flux)
        numpy.testing.assert_array_equal(read.error, field.error)
        self.assertGreater(field.flux.max(), 0)
        self.assertEqual(read.window, field.window)

    def test_bits_of_the_command(self):
        self.command("compile", "a.toml", "--level", 2, "--samples", 32, "--seed", 5, "--margin", "2mm", "-o", "a.bundle")
        camera = self.small.compile(level=2, samples=32, seed=5, margin=2e-3, threads=2)
        camera.save(self.folder / "b.bundle")
        self.assertEqual((self.folder / "a.bundle").read_bytes(), (self.folder / "b.bundle").read_bytes())
        self.small["flames[0].layers[1].temperature"] = "1800 K"
        change = ("--set", "flames[0].layers[1].temperature=1800 K")
        self.command("render", "a.toml", *change, "--compiled", "a.bundle", "-o", "whole.exr")
        whole = self.small.render(compiled=camera)
        self.assert_same(whole, "whole.exr")
        self.assert_same(self.small.render(compiled=plenoflame.read_bundle(self.folder / "a.bundle")), "whole.exr")
        self.command("render", "a.toml", *change, "--compiled", "a.bundle", "--window", "10,20,30,25", "-o", "part.exr")
        self.assert_same(self.small.render(compiled=camera, window=(10, 20, 30, 25)), "part.exr")
        # Other than the picture whose rays are found anew.
        self.assertGreater(numpy.abs(self.small.render(samples=32, seed=5).flux - whole.flux).max(), 0)

    def test_what_it_is(self):
        region = ((0.97, -0.02, -0.04), (1.03, 0.02, 0.04))
        # The samples are so many that pixels between micro-images, which see a sliver of the pupil, have a ray too.
        camera = self.small.compile(level=1, samples=256, window=(5, 6, 40, 30), region=region)
        self.assertEqual((camera.window, camera.seed), ((5, 6, 40, 30), 1))
        numpy.testing.assert_array_equal(camera.region, region)
        self.assertEqual(camera.pixels, 40 * 30)
        # Level 1 keeps the sums of a constant and four coordinates, which takes five rays behind each microlens.
        self.assertGreaterEqual(camera.rays, 5 * camera.pixels)
        self.assertEqual(self.small.render(compiled=camera).flux.shape, (30, 40))

    def test_what_is_refused(self):
        camera = self.small.compile(level=1, samples=16, window=(5, 6, 40, 30))
        other = self.small.copy()
        other["camera.sensor.pixel_pitch"] = "90 um"
        for scene, arguments, message in (
                (other, {}, "belongs to another camera .*camera.sensor.pixel_pitch"),
                (self.small, {"samples": 4}, "samples: a compiled camera"),
                (self.small, {"seed": 0}, "seed: a compiled camera"),
                (self.small, {"window": (0, 0, 10, 10)}, "holds the window 5,6,40,30"),
                (self.small, {"compiled": "a.bundle"}, "compiled takes a CompiledCamera")):
            with self.assertRaisesRegex(plenoflame.Error, message):
                scene.render(**{"compiled": camera, **arguments})
        for arguments, message in (({"error": 0}, "error: a share"), ({"level": 8}, "level takes"), ({"margin": -1}, "margin takes"),
                                   ({"region": ((0, 0, 0), (1, 1, 0))}, "region: the second corner"),
                                   ({"window": (50, 0, 20, 10)}, "beyond the sensor")):
            with self.assertRaisesRegex(plenoflame.Error, message):
                self.small.compile(**arguments)
        camera.save(self.folder / "a.bundle")
        data = (self.folder / "a.bundle").read_bytes()
        (self.folder / "cut.bundle").write_bytes(data[:len(data) // 2])
        with self.assertRaisesRegex(plenoflame.Error, "cut.bundle.*cut off"):
            plenoflame.read_bundle(self.folder / "cut.bundle")
        with self.assertRaisesRegex(plenoflame.Error, "none.bundle"):
            plenoflame.read_bundle(self.folder / "none.bundle")
        with self.assertRaisesRegex(plenoflame.Error, "stopped before"):
            self.small.compile(samples=4096, progress=lambda _fraction: True)


if __name__ == "__main__":
    main()
