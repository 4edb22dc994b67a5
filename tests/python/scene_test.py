"""Scenes from Python: values, messages, design."""

import copy
import os
import pickle
import tempfile

import numpy
from package import VTK, EXAMPLE, PackageTest, main

import plenoflame


class Scenes(PackageTest):
    def test_numbers_know_their_units(self):
        scene = self.scene()
        pitch = scene["camera.sensor.pixel_pitch"]
        self.assertEqual((pitch, pitch.unit, pitch.text), (1e-4, "m", "100 um"))
        scene["camera.sensor.pixel_pitch"] = "0.05 mm"
        self.assertEqual(scene.get_text("camera.sensor.pixel_pitch"), "50 um")
        scene["camera.sensor.pixel_pitch"] *= 3
        self.assertEqual(scene["camera.sensor.pixel_pitch"], 3 * 5e-5)
        scene["camera.sensor.pixel_pitch"] = (2 * pitch + pitch - pitch) / 4
        numpy.testing.assert_allclose(scene["camera.sensor.pixel_pitch"], 5e-5, rtol=1e-14)
        scene["flames[0].position"] = ["1.1 m", "0 m", "-29 mm"]
        self.assertEqual(scene["flames[0].position"], (1.1, 0, -0.029))
        scene["flames[0].position"] = scene["flames[0].position"]
        self.assertEqual(scene.get_text("flames[0].position"), "1.1 m, 0 m, -29 mm")
        self.assertEqual((scene["render.samples"], scene["render.estimator"]), (64, "backward"))
        scene["render.samples"] = numpy.int64(5)
        self.assertEqual(scene["render.samples"], 5)
        self.assertEqual((scene.columns, scene.rows, scene.channels), (80, 80, ["red_650nm"]))
        self.assertIn("camera.array.types[2].index", scene.keys())

    def test_moments_of_flames_that_change(self):
        with tempfile.TemporaryDirectory() as folder:
            for number in (3, 4, 5):
                with open(os.path.join(folder, f"run_{number:02d}.vdb"), "wb"):
                    pass
            text = ('[camera]\npreset = "paper-previous-60x60"\n[[flames]]\nkind = "vdb"\nfile = "run_##.vdb"\n'
                    'frame_rate = "1 kHz"\nposition = ["1 m", "0 m", "0 m"]\n')
            film = plenoflame.Scene(text=text, name=os.path.join(folder, "film.toml"))
            self.assertEqual(film.frames, range(3, 6))
            self.assertEqual(film.at_frame(4)["flames[0].file"], "run_04.vdb")
            self.assertEqual(film.at_time(0.0025)["flames[0].file"], "run_05.vdb")
            self.assertEqual(film.at_frame(4).frames, range(0))
            self.assertEqual(film["flames[0].file"], "run_##.vdb")
            with self.assertRaisesRegex(plenoflame.Error, "there is no frame 6"):
                film.at_frame(6)
            with self.assertRaisesRegex(plenoflame.Error, "no flame of the scene changes"):
                film.at_frame(4).at_time(0)

    def test_one_of_several_cameras(self):
        text = self.scene().text
        several = (text.replace("[camera]\n", "[[cameras]]\n").replace("[camera.", "[cameras.")
                   .replace('name = ""', 'name = "left"', 1))
        several += '\n[[cameras]]\nname = "right"\nlike = "left"\nposition = ["1 m", "-1 m", "0 m"]\n' \
                   'look_direction = [0, 1, 0]\n[cameras.sensor]\ncolumns = 40\n'
        scene = plenoflame.Scene(text=several, name="several.toml")
        self.assertEqual((scene.cameras, scene.camera_name), (["left", "right"], ""))
        self.assertIn("cameras left, right", repr(scene))
        self.assertEqual(scene["cameras[1].name"], "right")
        for ask in (lambda: scene.columns, scene.design, scene.render, lambda: scene.rays(chief=True),
                    *([scene.camera] if VTK else [])):
            with self.assertRaisesRegex(plenoflame.Error, r"left, right; choose one: scene.with_camera\('left'\)"):
                ask()
        with self.assertRaisesRegex(plenoflame.Error, 'did you mean "right"'):
            scene.camera_name = "rihgt"
        with self.assertRaisesRegex(KeyError, "cameras"):
            scene["camera.sensor.columns"]
        right = scene.with_camera("right")
        self.assertEqual((right.columns, scene.camera_name, right.camera_name), (40, "", "right"))
        alone = self.scene()
        alone["camera.position"], alone["camera.look_direction"] = "1 m, -1 m, 0 m", "0, 1, 0"
        alone["camera.sensor.columns"] = 40
        picture, reference = right.render(4), alone.render(4)
        numpy.testing.assert_array_equal(picture["red_650nm"], reference["red_650nm"])
        self.assertGreater(picture["red_650nm"].max(), 0)
        right.camera_name = "left"  # what both have in common is kept, and no more
        numpy.testing.assert_array_equal(right.render(4)["red_650nm"], self.scene().render(4)["red_650nm"])
        again = pickle.loads(pickle.dumps(scene.with_camera("right")))
        self.assertEqual((again.camera_name, again.columns), ("right", 40))

    def test_tables_are_lists_and_dicts(self):
        scene = self.scene()
        (flame,) = scene["flames"]
        self.assertEqual(flame["position"], scene["flames[0].position"])
        self.assertEqual(len(flame["layers"]), scene.list_size("flames[0].layers"))
        self.assertEqual(flame["layers"][2]["temperature"], scene["flames[0].layers[2].temperature"])
        self.assertEqual(scene["flames[0]"], flame)
        self.assertEqual(scene["camera.sensor"]["columns"], 80)
        self.assertEqual(scene["flames[0].lines"], [])
        with self.assertRaisesRegex(KeyError, "no key"):
            scene["camera.sens"]

    def test_pickle_and_copy(self):
        scene = self.scene()
        scene["render.samples"] = 7
        for other in (pickle.loads(pickle.dumps(scene)), copy.copy(scene), copy.deepcopy(scene)):
            self.assertEqual(other.text, scene.text)
            other["render.samples"] = 8
        self.assertEqual(scene["render.samples"], 7)
        pitch = pickle.loads(pickle.dumps(scene["camera.sensor.pixel_pitch"]))
        self.assertEqual((pitch, pitch.text), (1e-4, "100 um"))

    def test_lists(self):
        scene = self.scene()
        self.assertEqual(scene.list_size("camera.array.types"), 3)
        scene.remove("camera.array.types", 1)
        self.assertEqual(scene.list_size("camera.array.types"), 2)
        scene.insert("camera.array.types", 0)
        self.assertEqual(scene.list_size("camera.array.types"), 3)
        with self.assertRaises(plenoflame.Error):
            scene.remove("camera.array.types", -1)

    def test_copy_is_independent(self):
        scene = self.scene()
        copy = scene.copy()
        copy["render.samples"] = 5
        self.assertEqual((scene["render.samples"], copy["render.samples"]), (64, 5))

    def test_message_is_that_of_the_command_line(self):
        bad = self.folder / "bad.toml"
        bad.write_text('[camera]\npreset = "paper-plenoptic2"\nsensr = 3\n')
        with self.assertRaises(plenoflame.Error) as caught:
            plenoflame.Scene(bad)
        self.assertEqual(self.command("info", bad, status=1), f"plenoflame: error: {caught.exception}\n")

    def test_unknown_keys(self):
        scene = self.scene()
        with self.assertRaisesRegex(KeyError, "no key"):
            scene["camera.nothing"]
        with self.assertRaisesRegex(plenoflame.Error, "unit"):
            scene["camera.sensor.pixel_pitch"] = 3
        self.assertEqual(scene["camera.sensor.pixel_pitch"], 1e-4)

    def test_impossible_scene_is_refused_not_fatal(self):
        scene = self.scene()
        scene["camera.array.diameter"] = "5 mm"  # wider than the pitch
        with self.assertRaises(plenoflame.Error):
            scene.check()
        with self.assertRaises(plenoflame.Error):
            scene.render(samples=2)

    def test_saved_scene_is_the_scene(self):
        scene = self.scene()
        scene.save(self.folder / "a.toml")
        self.assertEqual(plenoflame.Scene(self.folder / "a.toml").text, scene.text)
        self.assertEqual(plenoflame.Scene(text=scene.text).text, scene.text)

    def test_design_is_that_of_the_command_line(self):
        self.assertEqual(plenoflame.Scene(EXAMPLE).design(), self.figures("design", EXAMPLE))


if __name__ == "__main__":
    main()
