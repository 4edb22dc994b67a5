"""What the command does, Python does: the page's table against the command's help and the package; results against the command's
files."""

import csv
import inspect
import json
import re
import sys

import numpy
from package import ROOT, PackageTest, main

import plenoflame


def rows_of(path):
    with open(path, newline="") as file:
        return list(csv.DictReader(file))


def column(rows, *names):
    return numpy.squeeze(numpy.array([[float(row[name]) for name in names] for row in rows]))


class Commands(PackageTest):
    def commands_of(self, *command):
        """Names of the commands below one, by its help."""
        text = self.command(*command, "--help")
        found = []
        for name in re.findall(r"(?m)^  ([a-z]+)(?:  |$)", text.partition("Subcommands:")[2].partition("\n\n")[0]):
            below = self.commands_of(*command, name) if command == () else []
            found += ([] if name in ("calibrate", "camera") else [" ".join((*command, name))]) + below
        return found

    def test_table_has_all_commands_and_right_functions(self):
        page = (ROOT / "docs" / "scripting.md").read_text()
        table = re.findall(r"(?m)^\| `([a-z ]+)` \| (.+) \|$", page)
        self.assertEqual(sorted(command for command, _ in table), sorted(self.commands_of()))
        for command, functions in table:
            if functions.startswith("none"):
                continue
            for name in re.findall(r"`([A-Za-z_.]+)`", functions):
                thing = plenoflame
                for part in name.split("."):
                    thing = getattr(thing, part, None)
                self.assertTrue(callable(thing), f"{command}: {name}")

    def test_sweep_is_that_of_files(self):
        """The same values, choice and pictures, of drawn runs and of flames that are generated."""
        (self.folder / "a.toml").write_text('[camera]\npreset = "paper-plenoptic2"\n[[flames]]\nkind = "vdb"\nfile = "a.vdb"\n'
                                            'position = ["1 m", "0 m", "-29 mm"]\n')
        (self.folder / "rules.toml").write_text('runs = 3\n[[random]]\nkey = "flames[0].brightness"\nuniform = [0.5, 2]\n'
                                                '[[random]]\nkey = "flames[0].generator"\nvalue = "candle"\n'
                                                '[[random]]\nkey = "flames[0].generator.voxel_size"\nvalue = "1 mm"\n'
                                                '[[random]]\nkey = "flames[0].generator.height"\nuniform = ["30 mm", "50 mm"]\n')
        self.command("sweep", "a.toml", "--random", "rules.toml", "--test-share", "34%", "--seed", "7", "-o", "set", "--samples", "4",
                     "--window", "1500,1500,32,32")
        runs = plenoflame.Scene(self.folder / "a.toml").sweep(random=self.folder / "rules.toml", test_share=0.34, seed=7)
        self.assertEqual(len(runs), 3)
        self.assertEqual([run.number for run in runs[1:]], [1, 2])
        for run in runs:
            record = json.loads((self.folder / f"set/runs/{run.number:06}.json").read_text())
            self.assertEqual((run.values, run.seed, "test" if run.test else "train"), (record["values"], record["seed"], record["split"]))
            light = run.scene.render(samples=4, seed=run.seed, window=(1500, 1500, 32, 32))
            expected = plenoflame.read_light_field(self.folder / f"set/runs/{run.number:06}.exr")
            self.assertGreater(numpy.asarray(light).max(), 0)
            numpy.testing.assert_array_equal(light.flux, expected.flux)

    def test_sweep_refuses_with_the_place(self):
        scene = self.scene(48)
        (self.folder / "bad.csv").write_text("flames[0].brightness\n1\nloud\n")
        runs = scene.sweep(table=self.folder / "bad.csv")
        self.assertEqual(runs[0].scene["flames[0].brightness"], 1)
        with self.assertRaisesRegex(plenoflame.Error, r"bad\.csv:3:1: .*loud"):
            runs[-1]
        with self.assertRaisesRegex(plenoflame.Error, "give table='RUNS.csv' or random='RULES.toml'"):
            scene.sweep()
        with self.assertRaisesRegex(plenoflame.Error, "test_share must be a share .* not '2'"):
            scene.sweep(table=self.folder / "bad.csv", test_share=2)
        with self.assertRaises(IndexError):
            runs[2]

    def test_merge_is_that_of_files(self):
        scene = self.scene(48)
        fields = [scene.render(samples=4, seed=seed) for seed in (1, 2)]
        for number, field in enumerate(fields):
            field.save(self.folder / f"{number}.exr")
        self.command("merge", "0.exr", "1.exr", "-o", "all.exr")
        expected = plenoflame.read_light_field(self.folder / "all.exr")
        for merged in (plenoflame.merge(fields), plenoflame.merge([fields[1], self.folder / "0.exr"])):
            numpy.testing.assert_array_equal(merged.flux, expected.flux)
            numpy.testing.assert_array_equal(merged.error, expected.error)

    def test_merge_refuses_the_same_rays(self):
        field = self.scene(40).render(samples=2)
        with self.assertRaisesRegex(plenoflame.Error, "picture 1 and picture 2 are both the whole window"):
            plenoflame.merge([field, field])
        with self.assertRaisesRegex(plenoflame.Error, "pictures takes LightFields"):
            plenoflame.merge([3])

    def test_corners_are_those_of_the_file(self):
        plate = ROOT / "examples" / "calibration-plate.toml"
        self.command("corners", plate, "--rays", "256", "-o", "c.csv")
        rows = rows_of(self.folder / "c.csv")
        found = plenoflame.Scene(plate).corners(256)
        self.assertGreater(len(rows), 10)
        for values, names in ((found.surface, ["surface"]), (found.column, ["column"]), (found.row, ["row"]),
                              (found.point, ["x_m", "y_m", "z_m"]), (found.in_camera, ["camera_x_m", "camera_y_m", "camera_z_m"]),
                              (found.lens, ["lens_q", "lens_r"]), (found.type, ["type"]),
                              (found.image, ["image_column", "image_row"]), (found.spread, ["spread_pixels"]),
                              (found.share, ["share"])):
            numpy.testing.assert_allclose(values, column(rows, *names), rtol=1e-6, atol=1e-9, err_msg=names[0])

    def test_truth_is_that_of_the_files(self):
        field = self.scene(48).render(samples=2)
        field.save(self.folder / "a.exr")
        points = [(1, 0, 0), (0.9, 0.001, -0.002)]
        (self.folder / "p.csv").write_text("".join(f"{x},{y},{z}\n" for x, y, z in points))
        self.command("truth", "a.exr", "-o", "m.csv", "--points", "p.csv", "--projections", "q.csv", "--rays", "128",
                     "--chief-rays", "r.exr")
        truth = field.truth(points, rays=128, chief_rays=True)
        rows = rows_of(self.folder / "m.csv")
        numpy.testing.assert_array_equal(truth.micro_images.lens, column(rows, "q", "r"))
        numpy.testing.assert_allclose(truth.micro_images.centre, column(rows, "column", "row"), atol=1e-3)
        numpy.testing.assert_allclose(truth.micro_images.radius, column(rows, "radius"), atol=1e-3)
        rows = rows_of(self.folder / "q.csv")
        self.assertGreater(len(rows), 2)
        numpy.testing.assert_array_equal(truth.projections.point, column(rows, "point"))
        numpy.testing.assert_allclose(truth.projections.chief, column(rows, "column", "row"), atol=1e-6)
        numpy.testing.assert_allclose(truth.projections.light, column(rows, "centroid_column", "centroid_row"), atol=1e-6)
        expected = plenoflame.read_light_field(self.folder / "r.exr")
        numpy.testing.assert_array_equal(truth.chief_rays["chief.dx"], expected["chief.dx"])
        self.assertIsNone(field.truth().chief_rays)
        with self.assertRaisesRegex(plenoflame.Error, "point 0 .* is not in front of the camera"):
            field.truth([(-1, 0, 0)])

    def two_colours(self):
        scene = plenoflame.Scene(ROOT / "examples" / "candle-colours.toml")
        scene["camera.sensor.columns"] = scene["camera.sensor.rows"] = 60
        scene.remove("flames", 0)
        scene.add_flame(plenoflame.make_flame("candle", voxel_size="2 mm"), position="1 m, 0 m, -16 mm")
        return scene

    def test_frames_of_the_sensor_are_those_of_the_command(self):
        field = self.scene(48).render(samples=8)
        field.save(self.folder / "a.exr")
        self.command("develop", "a.exr", "--exposure", "2 ms", "--frames", "2", "--noise-seed", "7", "-o", "f.tif")
        frames = field.expose("2 ms", frames=2, noise_seed=7)
        self.assertEqual((frames.exposure_time, frames.numbers.shape), (2e-3, (2, 48, 48)))
        for number, values in enumerate(frames.numbers, 1):
            numpy.testing.assert_array_equal(values, self.pixels(self.folder / f"f-{number}.tif"))
        self.assertTrue((frames.numbers[0] != frames.numbers[1]).any())
        dark = field.expose(2e-3, dark=True)
        self.assertLess(dark.numbers.max(), frames.numbers.max())
        self.command("develop", "a.exr", "--exposure", "auto", "--noise", "read", "-o", "e.exr")
        electrons = field.electrons("auto", noise="read")
        expected = plenoflame.read_light_field(self.folder / "e.exr")
        self.assertEqual(electrons.unit, "e-")
        numpy.testing.assert_array_equal(electrons.flux, expected.flux)
        numpy.testing.assert_array_equal(electrons.error, expected.error)

    def test_automatic_exposure_knows_the_bits(self):
        scene = self.scene(48)
        field = scene.render(samples=8)
        scene["camera.sensor.bits"] = 8
        scene["camera.sensor.gain"] = 1
        few = scene.render(samples=8).expose("auto", noise=())
        self.assertEqual(few.saturated, (0,))
        self.assertLess(few.exposure_time, field.expose("auto").exposure_time)

    def pixels(self, path):
        """Of a picture's file, by another reader."""
        from PIL import Image
        return numpy.array(Image.open(path))

    def test_exposures_are_checked(self):
        field = self.scene(40).render(samples=2)
        for sentence, arguments in (("exposure takes a time above 0 s, or 'auto'", {"exposure": 0}),
                                    ("exposure: ", {"exposure": "2 mm"}), ("there is no kind of noise 'hiss'", {"noise": "hiss"}),
                                    ("frames takes a whole number", {"frames": 0})):
            with self.assertRaisesRegex(plenoflame.Error, re.escape(sentence)):
                field.expose(**arguments)
        with self.assertRaisesRegex(plenoflame.Error, "exclude each other"):
            field.electrons(1e-3, channel_exposure={"red_650nm": 1e-3})
        with self.assertRaisesRegex(plenoflame.Error, "holds electrons already"):
            field.electrons("auto").expose()

    def test_temperatures_are_those_of_the_command(self):
        scene = self.scene(48)
        scene.insert("channels", 1)
        for key, value in (("name", "infrared"), ("kind", "line"), ("wavelength", "850 nm"), ("width", "10 nm")):
            scene[f"channels[1].{key}"] = value
        field = scene.render(samples=8)
        field.save(self.folder / "a.exr")
        for options, settings in (((), {}), (("--bin", "4"), {"bin": 4}),
                                  (("--bin", "micro-image", "--law", "soot"), {"bin": "micro-image", "law": "soot"}),
                                  (("--bin", "view", "--cells", "2"), {"bin": "view", "cells": 2})):
            figures = self.figures("pyrometry", "a.exr", *options, "-o", "t.exr")
            found = field.pyrometry(**settings)
            expected = plenoflame.read_light_field(self.folder / "t.exr")
            numpy.testing.assert_array_equal(found.temperature, expected["temperature"])
            numpy.testing.assert_array_equal(found.error, expected["temperature.error"])
            self.assertEqual((found.figures["mean"], found.figures["law"], found.figures["pixels"]),
                             (figures["mean_K"], figures["law"], figures["pixels"]))
            numpy.testing.assert_array_equal(numpy.asarray(found), found.temperature)
        with self.assertRaisesRegex(plenoflame.Error, "there is no law 'pink'"):
            field.pyrometry(law="pink")
        with self.assertRaisesRegex(plenoflame.Error, r"a ratio takes two channels \(channels\)"):
            field.pyrometry(channels="650nm")

    def test_colour_picture_is_that_of_the_command(self):
        field = self.two_colours().render(samples=2)
        field.save(self.folder / "a.exr")
        self.command("develop", "a.exr", "--colour", "-o", "c.png")
        picture = field.develop(colour=True)
        self.assertEqual((picture.shape, picture.dtype), ((60, 60, 3), numpy.uint8))
        numpy.testing.assert_array_equal(picture, self.pixels(self.folder / "c.png"))
        with self.assertRaisesRegex(plenoflame.Error, "a colour picture needs channels"):
            self.scene(40).render(samples=2).develop(colour=True)

    def test_imported_camera_is_that_of_the_command(self):
        source = ROOT / "examples" / "lab" / "intrinsics.js"
        self.command("camera", "import", source, "--set", "camera.lens.f_number=4", "-o", "c.toml")
        found = plenoflame.import_camera(source, values={"camera.lens.f_number": 4})
        expected = plenoflame.Scene(self.folder / "c.toml")
        self.assertEqual([found.scene[key] for key in expected.keys()], [expected[key] for key in expected.keys()])
        self.assertEqual(len(found.formats), 1)
        with self.assertRaisesRegex(plenoflame.Error, "values camera.lens.f_number: a number above 0"):
            plenoflame.import_camera(source, values={"camera.lens.f_number": "wide"})

    def test_arguments_are_the_options(self):
        """Names and defaults in the help, which the package does not read."""
        files = {"set", "camera", "images", "output", "refined", "residual", "report", "pixels", "places", "part", "quiet", "json",
                 "help", "which", "picture", "poses", "residuals", "plot", "interval"}  # a series is a loop
        for command, function, own in (("reconstruct", plenoflame.reconstruct, {"operator"}),
                                       ("operator", plenoflame.Scene.operator, set()),
                                       ("import", plenoflame.import_raw, set()), ("optimize", plenoflame.Scene.optimize, set()),
                                       ("calibrate corners", plenoflame.calibrate_corners, set()),
                                       ("calibrate geometry", plenoflame.calibrate_geometry, set()),
                                       ("calibrate rig", plenoflame.calibrate_rig, set())):
            text = self.command(*command.split(), "--help")
            options = dict(re.findall(r"(?ms)^  (?:-\w, )?--([a-z-]+)(.*?)(?=^  -|^\S|^$)", text))
            named = {name: parameter for name, parameter in inspect.signature(function).parameters.items()
                     if parameter.kind is parameter.KEYWORD_ONLY and name not in own | {"progress"}}
            self.assertEqual(set(named), {name.replace("-", "_") for name in options} - files)
            for name, parameter in named.items():
                about = " ".join(options[name.replace("_", "-")].split())
                if parameter.default not in (None, False, (), parameter.empty):
                    self.assertRegex(about, rf"\({re.escape(str(parameter.default))}\)$", f"{command}: {name}")
                self.assertIn(name + ": ", function.__doc__)

    def test_imported_pictures_are_those_of_the_command(self):
        scene = self.scene(48)
        scene["camera.sensor.exposure_time"] = "1 ms"
        scene.save(self.folder / "camera.toml")
        scene.render(samples=8).save(self.folder / "a.exr")
        for words in (("--frames", "2", "-o", "f.tif"), ("--dark", "-o", "dark.tif")):
            self.command("develop", "a.exr", "--exposure", "0.002 ms", *words)
        names = [self.folder / name for name in ("f-1.tif", "f-2.tif")]
        figures = self.figures("import", *names, "--camera", "camera.toml", "--dark", "dark.tif", "--exposure-time", "0.002 ms",
                               "--gain", "1.5", "-o", "b.exr")
        expected = plenoflame.read_light_field(self.folder / "b.exr")
        camera = plenoflame.Scene(self.folder / "camera.toml")
        for time in (2e-6, {"red_650nm": 2e-6}, "0.002 ms"):
            pictures = {"red_650nm": names} if isinstance(time, dict) else names
            found = plenoflame.import_raw(pictures, camera, dark=self.folder / "dark.tif", exposure_time=time, gain=1.5)
            numpy.testing.assert_array_equal(found.light_field.flux, expected.flux)
            numpy.testing.assert_array_equal(found.light_field.error, expected.error)
        self.assertEqual({**found.figures, "light_field": "b.exr"}, figures)
        with self.assertRaisesRegex(plenoflame.Error, r"^noise='series': takes several frames"):
            plenoflame.import_raw(names[0], camera, noise="series")
        with self.assertRaisesRegex(plenoflame.Error, r"^gain: .* is not a number from 0 to 1e\+09"):
            plenoflame.import_raw(names, camera, gain=1e12)
        with self.assertRaisesRegex(TypeError, r"import_raw\(\) has no argument 'darks'; did you mean 'dark'\?"):
            plenoflame.import_raw(names, camera, darks="dark.tif")

    CAMERA = """
[camera.lens]
model = "ideal"
focal_length = "50 mm"
diameter = "11 mm"
[camera.array]
lattice = "hexagonal"
model = "ideal"
pitch = "{}"
diameter = "110 um"
sensor_distance = "0.45 mm"
types = [{{name = "one", focal_length = "0.5 mm"}}]
[camera.sensor]
columns = 160
rows = 140
pixel_pitch = "5.5 um"
bits = 12
gain = 2.3
black_level = 60
read_noise = 6
full_well = 9000
exposure_time = "1 ms"
[camera.focus]
object_distance = "0.5 m"
[[channels]]
name = "red"
kind = "line"
wavelength = "650 nm"
width = "10 nm"
"""

    def test_calibrations_are_those_of_the_command(self):
        (self.folder / "real.toml").write_text(self.CAMERA.format("127.4 um"))
        nominal = self.folder / "nominal.toml"
        nominal.write_text(self.CAMERA.format("127 um"))
        self.command("render", "real.toml", "--white", "--samples", "16", "-o", "white.exr", "--quiet")
        self.command("develop", "white.exr", "--exposure", "auto", "-o", "white.tif")
        camera = plenoflame.Scene(nominal)
        figures = self.figures("calibrate", "white", "white.tif", "--camera", nominal, "-o", "found.toml", "--centres", "c.csv")
        found = plenoflame.calibrate_white(self.folder / "white.tif", camera)
        self.assertEqual({**found.figures, "output": "found.toml"}, figures)
        self.assertEqual(found.scene.get_text("camera.array.pitch"),
                         plenoflame.Scene(self.folder / "found.toml").get_text("camera.array.pitch"))
        numpy.testing.assert_array_equal(found.centres["column"], column(rows_of(self.folder / "c.csv"), "column"))
        self.assertIsNone(found.radii)
        self.assertIsNone(plenoflame.calibrate_white(self.folder / "white.tif").scene)
        with self.assertRaisesRegex(plenoflame.Error, "^pixel_pitch: above 0, at most 1 cm"):
            plenoflame.calibrate_white(self.folder / "white.tif", pixel_pitch=1)
        # The white picture stands for a source of 1700 K: only both results are compared.
        self.command("develop", "white.exr", "--exposure", "auto", "--dark", "-o", "dark.tif")
        figures = self.figures("calibrate", "radiometry", "1700 K@2 ms=white.tif", "--dark", "dark.tif", "--camera", nominal,
                               "--temperature-error", "2 K", "--emissivity", "0.9", "-o", "scale.toml")
        scale = plenoflame.calibrate_radiometry({(1700, 2e-3): self.folder / "white.tif"}, camera, dark=self.folder / "dark.tif",
                                                temperature_error=2, emissivity=0.9)
        self.assertEqual({**scale.figures, "output": "scale.toml"}, figures)
        self.assertEqual(scale.text, (self.folder / "scale.toml").read_text())
        with self.assertRaisesRegex(plenoflame.Error, "sources takes a dict"):
            plenoflame.calibrate_radiometry("white.tif", camera)
        with self.assertRaisesRegex(plenoflame.Error, "^emissivity: 2 is not a number from 0.01 to 1"):
            plenoflame.calibrate_radiometry({1700: self.folder / "white.tif"}, camera, emissivity=2)

    def test_board_and_rig_are_those_of_the_command(self):
        sys.path.append(str(ROOT / "tests" / "cli"))
        from geometry_test import BOARD, POSES, camera
        small = camera().replace("columns = 560", "columns = 400").replace("rows = 440", "rows = 320")
        (self.folder / "real.toml").write_text(small)
        (self.folder / "nominal.toml").write_text(small.replace("57.5 mm", "57.6 mm"))
        names = ["b-0.tif"]
        (self.folder / "board.toml").write_text(small + BOARD.format(**dict(zip("xyzabc", POSES[0]))))
        self.command("render", "board.toml", "--samples", "4", "-o", "b.exr", "--quiet")
        self.command("develop", "b.exr", "--exposure", "auto", "-o", names[0])
        figures = self.figures("calibrate", "corners", *names, "--camera", "real.toml", "--board", "5x4", "--cell", "2.5 mm", "-o", "c.csv")
        real = plenoflame.Scene(self.folder / "real.toml")
        pictures = [self.folder / name for name in names]
        boards = plenoflame.calibrate_corners(pictures, real, board=(5, 4), cell=2.5e-3)
        boards.figures["pictures"][0]["file"] = names[0]
        self.assertEqual(boards.figures, figures)
        table = rows_of(self.folder / "c.csv")
        for name in ("pose", "x", "y", "column", "row", "q", "r"):
            numpy.testing.assert_array_equal(boards.corners[name], column(table, name))
        free = "camera.focus.lens_distance"
        figures = self.figures("calibrate", "geometry", "c.csv", "--camera", "nominal.toml", "--free", free, "-o", "found.toml",
                               "--poses", "poses.csv", "--residuals", "left.csv")
        nominal = plenoflame.Scene(self.folder / "nominal.toml")
        plain = numpy.stack([boards.corners[name] for name in boards.corners.dtype.names], 1)
        for corners in (boards.corners, plain, self.folder / "c.csv"):
            found = plenoflame.calibrate_geometry(corners, nominal, free=[free])
            self.assertEqual({**found.figures, "camera": "found.toml"}, figures)
        self.assertEqual(found.scene.get_text(free), plenoflame.Scene(self.folder / "found.toml").get_text(free))
        for values, file, names in ((found.poses, "poses.csv", ("rms_pixel", "x", "r02")),
                                    (found.residuals, "left.csv", ("pose", "residual_column", "residual_row"))):
            for name in names:
                numpy.testing.assert_array_equal(values[name], column(rows_of(self.folder / file), name))
        moved = found.poses.copy()
        moved["x"] -= 0.03
        numpy.savetxt(self.folder / "right.csv", moved, "%.17g", ",")
        figures = self.figures("calibrate", "rig", "found.toml=poses.csv", "found.toml=right.csv", "--size", "10 mm", "-o", "rig.toml")
        expected = plenoflame.Scene(self.folder / "rig.toml")
        for right in ((found.scene, moved), (found.scene, self.folder / "right.csv")):
            rig = plenoflame.calibrate_rig([found, right], size=0.01)
            rig.figures["cameras"][0]["camera"] = "found.toml"
            self.assertEqual({**rig.figures, "output": "rig.toml"}, figures)
            self.assertEqual([rig.scene[f"cameras[1].{key}"] for key in ("position", "up")],
                             [expected[f"cameras[1].{key}"] for key in ("position", "up")])
        self.assertEqual(sorted(path.name for path in self.folder.glob("*.toml")),
                         ["board.toml", "found.toml", "nominal.toml", "real.toml", "rig.toml"])  # nothing is written
        for sentence, function, arguments in (
                ("^board takes two whole numbers, not 5", plenoflame.calibrate_corners, {"board": 5, "cell": 1}),
                ("^board: from 2x2", plenoflame.calibrate_corners, {"board": (1, 4), "cell": 1}),
                ("^cell: above 0", plenoflame.calibrate_corners, {"board": (5, 4), "cell": "0 mm"})):
            with self.assertRaisesRegex(plenoflame.Error, sentence):
                function(pictures, real, **arguments)
        with self.assertRaisesRegex(TypeError, "missing a required argument: 'board'"):
            plenoflame.calibrate_corners(pictures, real, cell=1)
        for function, none, name in ((plenoflame.calibrate_white, [], "pictures"), (plenoflame.import_raw, [], "pictures"),
                                     (plenoflame.calibrate_radiometry, {}, "sources")):
            with self.assertRaisesRegex(plenoflame.Error, f"^{name} names no picture"):
                function(none, real)
        with self.assertRaisesRegex(plenoflame.Error, "^pictures names no picture"):
            plenoflame.calibrate_corners([], real, board=(5, 4), cell=1)
        with self.assertRaisesRegex(plenoflame.Error, "^a picture is the name of a file, not ndarray"):
            plenoflame.import_raw(numpy.zeros((2, 2)), real)
        for sentence, corners, arguments in (
                (r"^corners takes an array of the shape \(n, 10\) or \(n, 7\) or \(n, 5\), not \(3, 4\)", numpy.zeros((3, 4)), {}),
                ("^corners takes the columns pose, x, y, column, row, not pose, rms_pixel,", found.poses, {}),
                (r"^corners\[1\]: 0.5 is not a whole number", plain[:2] + 0.5 * numpy.eye(2, plain.shape[1], -1), {}),
                (r"^radii\[0\]: type 7: the camera's types are 0 to 0", plain, {"radii": [[7, 4, 9, 0.1]]}),
                ("^centres takes finite numbers", plain, {"centres": [[0, 0, float("nan"), 1]]}),
                ("^pupil: 2 is not a number from 0 to 1", plain, {"pupil": 2}),
                (r"^camera takes a Scene, not 3", plain, None)):
            with self.assertRaisesRegex(plenoflame.Error, sentence):
                plenoflame.calibrate_geometry(corners, *([3] if arguments is None else [nominal]), **(arguments or {}))
        with self.assertWarnsRegex(RuntimeWarning, r"fewer values \(free\)"):
            plenoflame.calibrate_geometry(plain, nominal, free="camera.array.sensor_distance,camera.lens.distortion.k1")
        with self.assertRaisesRegex(plenoflame.Error, "'cameras.0.' and 'cameras.1.' have no pose in common"):
            moved["pose"] += 5
            plenoflame.calibrate_rig([found, (found.scene, moved)])
        with self.assertRaisesRegex(plenoflame.Error, r"^cameras\[1\] takes what calibrate_geometry\(\) returned"):
            plenoflame.calibrate_rig([found, 3])

    def test_better_camera_is_that_of_the_command(self):
        text = '[camera]\npreset = "paper-plenoptic2"\n'
        (self.folder / "a.toml").write_text(text)
        figures = self.figures("optimize", "a.toml", "--merit", "depth", "--array-range", "0.43 mm,-20 mm", "--vary", "spacing,pitch",
                               "--bound", "1.2", "-o", "b.toml")
        scene = plenoflame.Scene(self.folder / "a.toml")
        found = scene.optimize(merit="depth", array_range=(0.43e-3, "-20 mm"), vary=("spacing", "pitch"), bound=1.2)
        self.assertEqual({**found.figures, "scene": "b.toml"}, figures)
        expected = plenoflame.Scene(self.folder / "b.toml")
        self.assertEqual(found.scene["camera.array.pitch"], expected["camera.array.pitch"])
        self.assertNotEqual(scene["camera.array.pitch"], expected["camera.array.pitch"])
        for sentence, arguments in ((r"^merit='depth' needs array_range$", {"merit": "depth"}),
                                    (r"^vary: 'pich' is not one of .* did you mean 'pitch'", {"merit": "light", "vary": "pich"}),
                                    (r"there is no parameter to vary; give some \(vary\)", {"merit": "light", "vary": "types"}),
                                    (r"^greatest_index: 9 is not a number from 1 to 5", {"greatest_index": 9})):
            with self.assertRaisesRegex(plenoflame.Error, sentence):
                scene.optimize(**arguments)
        with self.assertRaisesRegex(TypeError, "Scene.optimize.. has no argument 'merits'; did you mean 'merit'"):
            scene.optimize(merits="light")

    def test_a_wrong_key_of_a_flame(self):
        scene = self.scene(40)
        hot = numpy.full((4, 4, 4), 1500.0)
        flame = plenoflame.flame_from_arrays(hot, hot / 100, spacing=1e-3)
        text = scene.text
        with self.assertRaisesRegex(TypeError, r"Scene.add_flame\(\) has no argument 'positon'; did you mean 'position'\?"):
            scene.add_flame(flame, positon="1 m, 0 m, 0 m")
        self.assertEqual(scene.text, text)


if __name__ == "__main__":
    main()
