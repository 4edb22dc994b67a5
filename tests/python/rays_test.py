"""Rays from Python: numpy views, the pixel's flux, bundles."""

import pickle

import numpy
from package import PackageTest, main

import plenoflame


class RaysTest(PackageTest):
    def test_sum_over_a_pixel_is_its_flux(self):
        scene = self.scene()
        rays = scene.rays(pixels=[(40, 41)], rays=32)
        flux = scene.render(samples=32).flux[41, 40]
        self.assertGreater(flux, 0)
        # The image is rendered in single precision.
        numpy.testing.assert_allclose((rays.weight * rays.radiance[:, 0]).sum(), flux, rtol=1e-4)

    def test_arrays_belong_together(self):
        rays = self.scene().rays(pixels=[(40, 41)], rays=4)
        self.assertEqual(rays.points.dtype, numpy.float64)
        self.assertEqual(len(rays.offsets), len(rays) + 1)
        self.assertEqual(rays.offsets[-1], len(rays.points))
        self.assertEqual(rays.surfaces[0], "main lens surface 1")
        with self.assertRaises(AttributeError):
            rays.nothing

    def test_object_point_is_seen_where_its_light_arrives(self):
        """Forward rays end on pixels whose own rays pass near the point."""
        scene = self.scene(300)
        point = (1.0, 0.003, -0.002)
        rays = scene.rays(points=[point], rays=200, status="reached")
        self.assertGreater(len(rays), 20)
        numpy.testing.assert_array_equal(rays.points[rays.offsets[:-1]], numpy.tile(point, (len(rays), 1)))
        arrived = rays.pixel[rays.pixel[:, 0] >= 0]
        column, row = numpy.median(arrived, axis=0).astype(int)
        back = scene.rays(pixels=[(int(column), int(row))], rays=16, status="reached")
        ends = back.offsets[1:] - 1
        # The points at which they cross the plane of the point.
        a, b = back.points[ends - 1], back.points[ends]
        t = (point[0] - a[:, 0]) / (b[:, 0] - a[:, 0])
        crossing = a + t[:, None] * (b - a)
        self.assertLess(numpy.abs(crossing[:, 1:] - numpy.array(point[1:])).min(), 0.01)

    def test_microlens_bundle_is_that_of_its_pixels(self):
        scene = self.scene()
        lens = scene.rays(microlenses=[(0, 0)], rays=8)
        self.assertEqual({tuple(qr) for qr in lens.microlens}, {(0, 0)})
        pixels = sorted({tuple(map(int, pixel)) for pixel in lens.pixel})
        own = scene.rays(pixels=pixels, rays=8)
        through = (own.microlens == 0).all(axis=1)
        numpy.testing.assert_allclose((lens.weight * lens.radiance[:, 0]).sum(),
                                      (own.weight * own.radiance[:, 0])[through].sum(), rtol=1e-12)

    def test_flame_samples_lie_in_the_flame(self):
        rays = self.scene().rays(pixels=[(40, 41)], rays=8, flame_samples=50)
        inside = rays.surface == -3
        self.assertEqual(inside.sum() % 50, 0)
        self.assertGreater(rays.absorption[inside].max(), 0)
        self.assertEqual(rays.temperature[rays.surface >= -1].max(), 0)
        # The optical thickness is the absorption's integral: here by the trapezium rule.
        for i in numpy.flatnonzero(rays.optical_thickness > 0)[:5]:
            part = slice(*rays.offsets[i:i + 2])
            chosen = rays.surface[part] <= -2
            integral = numpy.trapz(rays.absorption[part][chosen], rays.distance[part][chosen])
            numpy.testing.assert_allclose(integral, rays.optical_thickness[i], rtol=0.25)

    def test_selection(self):
        scene = self.scene()
        everything = scene.rays(random=40, rays=8)
        self.assertEqual(len(scene.rays(random=40, rays=8, status="vignetted")), (everything.status == 1).sum())
        self.assertEqual(len(scene.rays(random=40, rays=8, lens_type=1)), (everything.type == 1).sum())
        self.assertEqual(len(scene.rays(random=40, rays=8, most=17)), 17)
        with self.assertRaisesRegex(plenoflame.Error, "'lost'"):
            scene.rays(random=4, status="lost")

    def test_saved_rays_are_those_of_the_command_line(self):
        scene = self.scene()
        scene.save(self.folder / "a.toml")
        rays = scene.rays(pixels=[(40, 41)], rays=8)
        rays.save(self.folder / "r.vtp")
        info = self.figures("info", "r.vtp")
        self.command("rays", "a.toml", "--pixel", "40,41", "--rays", 8, "-o", "s.vtp")
        self.assertEqual({k: v for k, v in info.items() if k in ("rays", "points", "status")},
                         {k: v for k, v in self.figures("info", "s.vtp").items() if k in ("rays", "points", "status")})

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


if __name__ == "__main__":
    main()
