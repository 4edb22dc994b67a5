"""Light fields from Python: shared memory, the command line's numbers, progress and interruption."""

import os
import pickle
import signal
import threading
import time

import numpy
from package import PackageTest, main

import plenoflame


class LightFields(PackageTest):
    def test_array_outlives_the_light_field(self):
        flux = self.scene().render(samples=2).flux
        total = float(flux.sum())
        trash = [numpy.ones((80, 80), numpy.float32) for _ in range(100)]
        self.assertEqual(float(flux.sum()), total)
        self.assertEqual(len(trash), 100)

    def test_flux_is_that_of_the_command_line(self):
        scene = self.scene()
        scene.save(self.folder / "a.toml")
        figures = self.figures("render", "a.toml", "--samples", 4, "--seed", 3, "-o", "a.exr")
        field = scene.render(samples=4, seed=3)
        read = plenoflame.read_light_field(self.folder / "a.exr")
        numpy.testing.assert_array_equal(read.flux, field.flux)
        numpy.testing.assert_array_equal(read.error, field.error)
        numpy.testing.assert_allclose(field.flux.sum(dtype=float), figures["flux"], rtol=1e-12)
        self.assertEqual(field.relative_error, figures["relative_error"])
        self.assertEqual((read.window, read.complete), ((0, 0, 80, 80), True))
        self.assertEqual(plenoflame.Scene(text=read.scene_text)["camera.sensor.rows"], 80)

    def test_saved_file_is_the_light_field(self):
        field = self.scene().render(samples=2, window=(30, 20, 25, 11))
        field.flux[2, 3] = 0.25
        field.save(self.folder / "b.exr")
        read = plenoflame.read_light_field(self.folder / "b.exr")
        numpy.testing.assert_array_equal(read.flux, field.flux)
        self.assertEqual(read.window, (30, 20, 25, 11))

    def test_a_light_field_outlives_pickle_and_file(self):
        field = self.scene(60).render(samples=2, truth=True)
        field.save(self.folder / "a.exr")
        pickle.loads(pickle.dumps(field)).save(self.folder / "b.exr")
        self.assertEqual((self.folder / "a.exr").read_bytes(), (self.folder / "b.exr").read_bytes())

    def test_pictures_of_two_units_are_not_compared_in_silence(self):
        field = self.scene(40).render(samples=2)
        with self.assertWarnsRegex(RuntimeWarning, "the first image is in e-, the reference in W"):
            field.electrons("auto").compare(field)

    def test_errors_are_set_where_there_were_none(self):
        field = self.scene(40).render(samples=2)
        for one in (field, plenoflame.read_light_field(self.without_errors(field))):
            one.error = 2 * field.flux
            numpy.testing.assert_array_equal(one.error, 2 * field.flux)
            with self.assertRaisesRegex(plenoflame.Error, "error"):
                one.error = [1, 2]

    def without_errors(self, field):
        """A file of its flux alone."""
        state = field._data.state
        state["images"] = {name: image for name, image in state["images"].items() if not name.endswith(".error")}
        path = self.folder / "bare.exr"
        plenoflame.LightField(type(field._data).from_state(state)).save(path)
        return path

    def test_white_pictures_are_those_of_the_command(self):
        scene = self.scene(40)
        scene.save(self.folder / "a.toml")
        self.command("render", "a.toml", "--white", "--samples", 2, "-o", "white.exr")
        white = scene.render(samples=2, white=True)
        numpy.testing.assert_array_equal(white.flux, plenoflame.read_light_field(self.folder / "white.exr").flux)
        for more in ({"truth": True}, {"estimator": "forward"}):
            with self.assertRaisesRegex(plenoflame.Error, "white has no flames"):
                scene.render(samples=2, white=True, **more)

    def test_image_is_upright(self):
        """The flame's foot is at the bottom of the picture, its tip at the top."""
        scene = self.scene()
        scene["flames[0].position"] = ["1 m", "0 m", "0 m"]  # starts 1 mm below the axis and rises
        flux = scene.render(samples=4).flux
        self.assertGreater(flux[:40].sum(), 3 * flux[40:].sum())
        scene["flames[0].position"] = ["1 m", "-20 mm", "-29 mm"]  # the world's -y is the right
        flux = scene.render(samples=4).flux
        self.assertGreater(flux[:, 40:].sum(), 3 * flux[:, :40].sum())

    def test_planes_lie_behind_windows(self):
        """A thick plate moves what is in focus and where things stand: as the command has it, and not as without."""
        scene = self.scene()
        clear = scene.render(samples=2)
        scene.save(self.folder / "s.toml")
        plate = (self.folder / "s.toml").read_text().replace("windows = []", "") + """
[[windows]]
name = "plate"
shape = "plate"
position = ["0.4 m", "0 m", "0 m"]
rotation = ["0 deg", "90 deg", "0 deg"]
diameter = "400 mm"
thickness = "100 mm"
index = 1.5
"""
        field = plenoflame.Scene(text=plate).render(samples=2)
        field.save(self.folder / "p.exr")
        self.command("refocus", "p.exr", "-o", "p", "--depth", "1 m", "--exr")
        picture = field.refocus(1.0)
        expected = plenoflame.read_light_field(self.folder / "p" / "refocus_1.0000m.exr")
        numpy.testing.assert_array_equal(picture.image, expected.flux)
        self.assertLess(abs(picture.pixel / clear.refocus(1.0).pixel - 1 + 0.1 / 3), 0.01)

    def test_views_and_refocus(self):
        scene = self.scene()
        field = scene.render(samples=8)
        field.save(self.folder / "c.exr")
        views = field.views(3)
        self.assertEqual((len(views), views.unit), (9, "W/(m^2 sr)"))
        self.command("views", "c.exr", "-o", "v", "--grid", 3, "--exr")
        self.command("refocus", "c.exr", "-o", "r", "--depth", "0.9 m", "--exr")
        for row in range(3):
            for column in range(3):
                expected = plenoflame.read_light_field(self.folder / "v" / f"view_{row:02}_{column:02}.exr")
                numpy.testing.assert_array_equal(views[row, column], expected.flux)
        picture = field.refocus(0.9)
        expected = plenoflame.read_light_field(self.folder / "r" / "refocus_0.9000m.exr")
        numpy.testing.assert_array_equal(picture.image, expected.flux)
        self.assertGreater(picture.pixel, 0)
        with self.assertRaisesRegex(plenoflame.Error, "depth above 0 m"):
            field.refocus(-1)

    def test_filters_see_values_changed_in_numpy(self):
        field = self.scene().render(samples=2)
        first = field.develop(saturation=1e-8, curve="linear", bits=16)
        field.flux[:] *= 0.5
        second = field.develop(saturation=1e-8, curve="linear", bits=16)
        below = first < 65535
        self.assertTrue(below.any() and first.any())
        numpy.testing.assert_allclose(second[below], first[below] / 2, atol=0.51)

    def test_unknown_names_list_what_there_is(self):
        field = self.scene().render(samples=2)
        with self.assertRaisesRegex(plenoflame.Error, "it has red_650nm, red_650nm.error"):
            field["blue"]
        with self.assertRaisesRegex(plenoflame.Error, "red_650nm"):
            field.develop(channel="blue")
        with self.assertRaisesRegex(plenoflame.Error, "bicubic"):
            field.views(resampling="bicubic")

    def test_progress_can_stop(self):
        seen = []

        def progress(fraction):
            seen.append(fraction)
            return len(seen) > 3

        start = time.monotonic()
        field = self.scene().render(samples=1 << 30, time_limit=1e6, progress=progress)
        self.assertFalse(field.complete)
        self.assertLess(time.monotonic() - start, 60)

    def test_interrupt_comes_through(self):
        timer = threading.Timer(0.5, os.kill, (os.getpid(), signal.SIGINT))
        timer.start()
        with self.assertRaises(KeyboardInterrupt):
            self.scene().render(samples=1 << 30, time_limit=1e6)

    def test_exception_of_progress_comes_through(self):
        def progress(_fraction):
            raise ZeroDivisionError

        with self.assertRaises(ZeroDivisionError):
            self.scene().render(samples=1 << 30, time_limit=1e6, progress=progress)

    def test_unreadable_files(self):
        (self.folder / "no.exr").write_text("not an image")
        for name in ("no.exr", "missing.exr"):
            with self.assertRaises(plenoflame.Error) as caught:
                plenoflame.read_light_field(self.folder / name)
            self.assertIn(name, str(caught.exception))


if __name__ == "__main__":
    main()
