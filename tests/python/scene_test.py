"""Scenes from Python: values, messages, design."""

from package import EXAMPLE, PackageTest, main

import plenoflame


class Scenes(PackageTest):
    def test_values_are_text_with_units(self):
        scene = self.scene()
        self.assertEqual(scene["camera.sensor.pixel_pitch"], "100 um")
        scene["camera.sensor.pixel_pitch"] = "0.05 mm"
        self.assertEqual(scene["camera.sensor.pixel_pitch"], "50 um")
        scene["flames[0].position"] = ["1.1 m", "0 m", "-29 mm"]
        self.assertEqual(scene["flames[0].position"], "1.1 m, 0 m, -29 mm")
        self.assertEqual((scene.columns, scene.rows, scene.channels), (80, 80, ["red_650nm"]))
        self.assertIn("camera.array.types[2].index", scene.keys())

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
        self.assertEqual((scene["render.samples"], copy["render.samples"]), ("64", "5"))

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
        self.assertEqual(scene["camera.sensor.pixel_pitch"], "100 um")

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
