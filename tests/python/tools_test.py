"""What the command line's other tools do, from Python: generated flames, flames of arrays, ground truth, focus stacks,
epipolar slices, exports, comparison, pickling. References are the command's files and closed forms."""

import copy
import pickle

import numpy
from package import PackageTest, main

import plenoflame


class Tools(PackageTest):
    def test_generated_flame_is_that_of_the_command(self):
        self.command("flame", "candle", "--voxel-size", "1 mm", "--set", "height=40 mm", "--line", "ch", "-o", "a.vdb")
        image = plenoflame.make_flame("candle", voxel_size="1 mm", height="40 mm", lines="ch")
        plenoflame.write_flame(self.folder / "b.vdb", image)
        for grid in ("temperature", "absorption", "CH*"):
            a, b = [plenoflame.read_flame(self.folder / name, grid=grid) for name in ("a.vdb", "b.vdb")]
            (_, first), (_, second) = [next(iter(plenoflame.flame_arrays(f)[0].items())) for f in (a, b)]
            self.assertEqual(first.shape, second.shape)
            numpy.testing.assert_array_equal(first, second)

    def test_table_of_generators(self):
        table = {flame["name"]: flame for flame in plenoflame.flame_generators()}
        self.assertEqual(list(table), ["layered", "candle", "diffusion", "cylinder", "turbulent"])
        (seed,) = [p for p in table["turbulent"]["parameters"] if p["name"] == "seed"]
        self.assertEqual(seed["value"], "1")
        (height,) = [p for p in table["cylinder"]["parameters"] if p["name"] == "height"]
        self.assertEqual((height["value"], height["unit"]), ("300 mm", "m"))

    def block(self, scene, shape=(9, 7, 5)):
        """A flame of arrays that is different along each axis."""
        i, j, k = numpy.indices(shape)
        return plenoflame.flame_from_arrays(1500.0 + 50 * i + 20 * j, 3.0 + i + 2 * j + 3 * k, spacing=(4e-3, 5e-3, 6e-3),
                                            origin=(-0.016, -0.015, 0))

    def with_block(self):
        scene = self.scene(60)
        scene.remove("flames", 0)
        scene.add_flame(self.block(scene), position="1 m, 0 m, -20 mm", name="block")
        return scene

    def test_flame_of_arrays_is_that_of_a_file(self):
        scene = self.with_block()
        plenoflame.write_flame(self.folder / "block.vdb", self.block(scene))
        other = scene.copy()
        other["flames[0].file"] = str(self.folder / "block.vdb")
        a, b = scene.render(samples=4, seed=1), other.render(samples=4, seed=1)
        self.assertGreater(a.flux.sum(), 0)
        numpy.testing.assert_array_equal(a.flux, b.flux)

    def test_flame_of_arrays_has_the_transmission_of_beer(self):
        """Optical depth of a homogeneous block, straight through."""
        scene = self.scene(40)
        scene.remove("flames", 0)
        image = plenoflame.flame_from_arrays(numpy.full((21, 21, 21), 1500.0), numpy.full((21, 21, 21), 5.0), spacing=1e-2,
                                             origin=(-0.1, -0.1, -0.1))
        scene.add_flame(image, position="1 m, 0 m, 0 m", ambient=1500)
        field = scene.render(samples=2, truth=True)
        depth = field["truth.optical_depth"]
        # Within the block 5 1/m over 0.2 m; a voxel on each side where it fades to nothing, half of it in the mean.
        seen = depth[depth > 0]
        self.assertGreater(len(seen), 100)
        numpy.testing.assert_allclose(seen, 5 * 0.21, rtol=2e-3)

    def test_flames_in_memory_go_with_copies_and_pickles(self):
        scene = self.with_block()
        expected = scene.render(samples=2, seed=1).flux
        for other in (scene.copy(), copy.deepcopy(scene), pickle.loads(pickle.dumps(scene))):
            numpy.testing.assert_array_equal(other.render(samples=2, seed=1).flux, expected)
        with self.assertRaisesRegex(plenoflame.Error, r"flames\[0\] is in memory: write it with write_flame\(\)"):
            scene.save(self.folder / "no.toml")
        self.assertFalse((self.folder / "no.toml").exists())

    def test_truth_layers(self):
        scene = self.scene(40)
        scene.save(self.folder / "a.toml")
        self.command("render", "a.toml", "--samples", 2, "--truth", "-o", "a.exr")
        expected = plenoflame.read_light_field(self.folder / "a.exr")
        field = scene.render(samples=2, truth=True)
        self.assertEqual(field.layers, expected.layers)
        self.assertIn("truth.distance", field.layers)
        for name in field.layers:
            numpy.testing.assert_array_equal(field[name], expected[name])
        self.assertEqual(scene.render(samples=2).layers, [])

    def test_light_fields_and_rays_are_pickled_and_copied(self):
        scene = self.scene(40)
        field = scene.render(samples=2, truth=True, window=(4, 6, 30, 20))
        for other in (pickle.loads(pickle.dumps(field)), copy.copy(field), copy.deepcopy(field), field.copy()):
            numpy.testing.assert_array_equal(other.flux, field.flux)
            numpy.testing.assert_array_equal(other.error, field.error)
            self.assertEqual((other.window, other.scene_text, other.layers, other.relative_error),
                             (field.window, field.scene_text, field.layers, field.relative_error))
            numpy.testing.assert_array_equal(other.refocus(1.0).image, field.refocus(1.0).image)
            other.save(self.folder / "copy.exr")
            other.flux[:] = 0
        self.assertGreater(field.flux.sum(), 0)
        numpy.testing.assert_array_equal(plenoflame.read_light_field(self.folder / "copy.exr").flux, field.flux)
        rays = scene.rays(pixels=[(20, 20)], rays=4, flame_samples=3)
        for other in (pickle.loads(pickle.dumps(rays)), copy.deepcopy(rays)):
            self.assertEqual((len(other), other.surfaces), (len(rays), rays.surfaces))
            numpy.testing.assert_array_equal(other.points, rays.points)
            numpy.testing.assert_array_equal(other.offsets, rays.offsets)
            numpy.testing.assert_array_equal(other.radiance, rays.radiance)
            numpy.testing.assert_array_equal(other.temperature, rays.temperature)

    def test_focus_stack_is_that_of_the_command(self):
        field = self.scene().render(samples=4)
        field.save(self.folder / "a.exr")
        self.command("refocus", "a.exr", "-o", "r", "--depths", "0.9 m:1.1 m:5", "--all-in-focus", "--exr")
        stack = field.focus_stack([0.9, 0.95, 1.0, 1.05, 1.1])
        expected = plenoflame.read_light_field(self.folder / "r" / "all_in_focus.exr")
        numpy.testing.assert_array_equal(stack.all_in_focus, expected.flux)
        self.assertEqual((len(stack.planes), stack.depth.shape), (5, stack.all_in_focus.shape))
        with self.assertRaisesRegex(plenoflame.Error, "ascend"):
            field.focus_stack([1.0, 0.9, 1.1])

    def test_coordinates_of_refocused_pictures(self):
        """A small hot body is found where it stands: 5 mm to the right of the axis and 8 mm above it."""
        scene = self.scene(120)
        scene.remove("flames", 0)
        i, j, k = numpy.indices((9, 9, 9)) - 4
        ball = (i ** 2 + j ** 2 + k ** 2 <= 4) * 100.0
        image = plenoflame.flame_from_arrays(numpy.full(ball.shape, 1800.0), ball, spacing=1e-3, origin=(-4e-3,) * 3)
        scene.add_flame(image, position="1 m, -5 mm, 8 mm", ambient=1800)
        camera = scene["camera"]["position"] if "position" in scene["camera"] else (0, 0, 0)
        picture = scene.render(samples=16).refocus(1.0 - camera[0])
        light = picture.image.sum(dtype=float)
        x = (picture.image * picture.x[None, :]).sum() / light
        y = (picture.image * picture.y[:, None]).sum() / light
        numpy.testing.assert_allclose([x, y], [5e-3, -8e-3], rtol=0.15)

    def test_epipolar_slices_are_those_of_the_command(self):
        field = self.scene().render(samples=4)
        field.save(self.folder / "a.exr")
        views = field.views(4)
        for line in (0, 5):
            folder = f"v{line}"
            self.command("views", "a.exr", "-o", folder, "--grid", 4, "--exr", "--epipolar-row", line, "--epipolar-column",
                         line)
            for name, found in (("row", views.epipolar(row=line)), ("column", views.epipolar(column=line))):
                expected = plenoflame.read_light_field(self.folder / folder / f"epipolar_{name}.exr")
                numpy.testing.assert_array_equal(found, expected.flux)

    def test_exports_are_those_of_the_command(self):
        field = self.scene(60).render(samples=2)
        field.save(self.folder / "lightfield.exr")
        for format in ("npz", "hci"):
            self.command("export", "lightfield.exr", "--format", format, "-o", "a-" + format, "--name", "flame")
            export = field.export(self.folder / ("b-" + format), format, name="flame")
            for folder in ("a-", "b-"):
                self.assertEqual(sorted(str(path.relative_to(self.folder / (folder + format)))
                                        for path in (self.folder / (folder + format)).rglob("*") if path.is_file()),
                                 sorted(export.files))
            with self.assertRaisesRegex(plenoflame.Error, "has files in it"):
                field.export(self.folder / ("b-" + format), format)
        self.assertIn("libpleno", plenoflame.export_formats())
        a, b = [numpy.load(self.folder / folder / "flame.npz") for folder in ("a-npz", "b-npz")]
        self.assertEqual(a.files, b.files)
        for name in a.files:
            numpy.testing.assert_array_equal(a[name], b[name])

    def test_exports_of_colour_channels_are_in_colour(self):
        """As the command's files, whose colours are tested against the fluxes (cli.export_colour)."""
        bands = "".join(f'[[channels]]\nname = "{name}"\nkind = "band"\nwavelength = "{nm} nm"\nwidth = "10 nm"\n'
                        for name, nm in (("ir", 850), ("red", 650), ("green", 600), ("blue", 560)))
        scene = self.scene(60)
        field = plenoflame.Scene(text=scene.text + bands).render(samples=1)
        field.save(self.folder / "lightfield.exr")

        def contents(folder):
            folder = self.folder / folder
            return {path.relative_to(folder): path.read_bytes() for path in folder.rglob("*") if path.is_file()}

        def exported(number, format, options, **arguments):
            self.command("export", "lightfield.exr", "--format", format, "-o", f"a{number}", *options)
            field.export(self.folder / f"b{number}", format, **arguments)
            found = contents(f"b{number}")
            self.assertEqual(found, contents(f"a{number}"))
            return {path: data for path, data in found.items() if path.suffix == ".png" and "white" not in path.name}

        colour = exported(0, "libpleno", [])
        grey = exported(1, "libpleno", ["--channel", "ir"], channel="ir")
        other = exported(2, "libpleno", ["--channels", "blue,green,red"], channels=("blue", "green", "red"))
        self.assertTrue(colour and colour.keys() == grey.keys() == other.keys())
        for path in colour:
            self.assertEqual(len({colour[path], grey[path], other[path]}), 3)
        for path, data in exported(3, "hci", ["--grid", "3"], grid=3).items():
            if path.name.startswith("input_"):
                self.assertEqual(data[25], 2)           # PNG's type of colour: red, green, blue
        for message, arguments in (("three names", {"channels": "red,green"}), ("pink", {"channels": "red,green,pink"}),
                                   ("give one of them", {"channels": "red,green,blue", "channel": "ir"}),
                                   ("channels", {"channels": 3})):
            with self.assertRaisesRegex(plenoflame.Error, message):
                field.export(self.folder / "c", "libpleno", **arguments)
        with self.assertRaisesRegex(plenoflame.Error, "holds one channel"):
            field.export(self.folder / "c", "npz", channels="red,green,blue")
        self.assertFalse((self.folder / "c").exists())

    def test_scene_within_a_light_field_opens_no_file(self):
        self.scene(20).render(samples=1).save(self.folder / "a.exr")
        (self.folder / "lens.toml").write_text("[camera.lens]\n")
        # A text of the same length, so that the file stays what it is.
        data = (self.folder / "a.exr").read_bytes()
        begin = data.index(b"[camera")
        end = data.index(b"\n[", data.index(b"[camera.lens]")) if b"[camera.lens]" in data else begin + 60
        text = f'[camera.lens]\nfile = "{self.folder}/lens.toml"\n#'.encode()
        self.assertLess(len(text), end - begin)
        (self.folder / "b.exr").write_bytes(data[:begin] + text.ljust(end - begin, b" ") + data[end:])
        field = plenoflame.read_light_field(self.folder / "b.exr")
        for action in (lambda: field.views(3), lambda: field.refocus(1.0), lambda: field.export(self.folder / "c", "npz")):
            with self.assertRaisesRegex(plenoflame.Error, "opens no file"):
                action()

    def test_comparison_is_that_of_the_command(self):
        scene = self.scene(60)
        a, b = scene.render(samples=2, seed=1), scene.render(samples=8, seed=2)
        a.save(self.folder / "a.exr")
        b.save(self.folder / "b.exr")
        expected = self.figures("compare", "a.exr", "b.exr")
        found = a.compare(b)
        for name in found:
            self.assertEqual(found[name], expected[name], name)
        self.assertGreater(found["relative_rmse"], 0)
        self.assertEqual(a.compare(a)["relative_rmse"], 0)


if __name__ == "__main__":
    main()
