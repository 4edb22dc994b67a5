"""--set of every command that reads a scene, messages about what was typed, and names that would act on a terminal."""

import re

from command import CommandTest, main
from exr import write_light_field

SCENE = """[camera.sensor]
columns = 30
rows = 30
pixel_pitch = "10 um"
[camera.lens]
model = "ideal"
focal_length = "50 mm"
diameter = "20 mm"
[camera.focus]
object_distance = "1 m"
[camera.array]
model = "ideal"
pitch = "0.1 mm"
diameter = "0.1 mm"
sensor_distance = "0.4 mm"
[[camera.array.types]]
name = "only"
focal_length = "0.4 mm"
[[flames]]
preset = "paper-layered"
position = ["1 m", "0 m", "-29 mm"]
"""
SET = ("--set", "camera.lens.f_number=5")


class Settings(CommandTest):
    def setUp(self):
        super().setUp()
        self.write("a.toml", SCENE)
        # The same scene with the value in the file.
        self.write("b.toml", SCENE.replace('diameter = "20 mm"', 'diameter = "10 mm"'))

    def test_a_set_value_is_as_one_in_the_file(self):
        for name, scene, more in (("a", "a.toml", SET), ("b", "b.toml", ())):
            self.succeeds("render", scene, "--samples", "4", "--quiet", "-o", name + ".exr", *more)
            self.succeeds("rays", scene, "--pixel", "15,15", "--rays", "8", "-o", name + ".csv", *more)
        self.assertEqual(self.read("a.csv"), self.read("b.csv"))
        a, b = self.json_of("info", "a.exr"), self.json_of("info", "b.exr")
        self.assertEqual(a["channels"], b["channels"])
        self.assertEqual(a["scene"], b["scene"])
        self.assertEqual(self.run_command("design", "a.toml", *SET).stdout, self.run_command("design", "b.toml").stdout)
        self.assertEqual(self.succeeds("info", "a.toml", "--scene", *SET), self.succeeds("info", "b.toml", "--scene"))

    def test_every_command_that_takes_a_scene_has_it(self):
        text = self.succeeds("--help").split("Subcommands:\n")[1]
        taking = []
        for name in re.findall(r"^  (\w+)", text, re.MULTILINE):
            usage = self.run_command(name, "--help").stdout  # submit has --options for those of render
            if re.search(r"^Usage: .*(SCENE|RAW)", usage, re.MULTILINE) and name not in ("compare", "picture", "submit"):
                taking.append(name)
                self.assertIn("--set KEY=VALUE", usage, name)
        for name in ("render", "rays", "corners", "bench", "design", "optimize", "operator", "develop", "truth", "views"):
            self.assertIn(name, taking)

    def test_of_the_scene_of_a_light_field(self):
        self.succeeds("render", "a.toml", "--samples", "4", "--quiet", "-o", "a.exr")
        spacing = [self.json_of("truth", "a.exr", "-o", "t.csv", *more)["spacing_pixels"]
                   for more in ((), ("--set", "camera.array.pitch=0.12 mm"))]
        self.assertLess(abs(spacing[1] / spacing[0] / 1.2 - 1), 1e-6)
        self.assertIn('pitch = "120 um"', self.succeeds("info", "a.exr", "--scene", "--set", "camera.array.pitch=0.12 mm"))
        self.fails(2, "views", "a.exr", "-o", "v", "--set", "camera.array.pitch=-1 mm",
                   mentions=["--set camera.array.pitch", "above 0 m"])
        self.fails(2, "info", "a.exr", "--set", "camera.array.pitch=1 mm", mentions="is not a scene")

    def test_what_is_wrong_with_it(self):
        for value, mentions in (("camera.focus.object_distnce=0.9 m", "did you mean camera.focus.object_distance?"),
                                ("object_distance=0.9 m", "did you mean camera.focus.object_distance?"),
                                ("camera.focus.object_distance=0.9", "its unit is missing"),
                                ("camera.focus.object_distance=1 mm", "inside the front focal point"),
                                ("camera.lens.f_number=1", "f/1 is wider than the lens, which is f/2.5"),
                                ("camera.array.types.other.index=2", "known are only"),
                                ("camera.array.sensor_distance=1 m", "overlap on every pixel"),
                                ("camera.array.types.only.focal_length=1e-50 mm", "at least 6.25 um")):
            self.fails(2, "render", "a.toml", "--quiet", "-o", "x.exr", "--set", value,
                       mentions=["--set " + value.split("=")[0] + ": ", mentions])
        self.fails(2, "render", "a.toml", "--set", "camera", mentions="is not of the form KEY=VALUE")
        self.assertEqual(self.files(), ["a.toml", "b.toml"])

    def test_a_hostile_camera_in_a_light_field(self):
        self.succeeds("render", "a.toml", "--samples", "1", "--quiet", "-o", "a.exr")
        scene = self.succeeds("info", "a.exr", "--scene")
        write_light_field(self.path("h.exr"), [[1.0] * 30] * 30, sensor=(30, 30),
                          scene=scene.replace('focal_length = "400 um"', 'focal_length = "1e-47 um"'))
        self.fails(1, "views", "h.exr", "-o", "v", mentions=["scene of h.exr:", "at least 6.25 um"])
        # It opens no file by itself.
        write_light_field(self.path("f.exr"), [[1.0] * 30] * 30, sensor=(30, 30),
                          scene=SCENE.replace('model = "ideal"', 'file = "/etc/passwd"', 1))
        for arguments in (("views", "f.exr", "-o", "v"), ("truth", "f.exr", "-o", "t.csv"), ("develop", "f.exr", "--sensor")):
            self.fails(1, *arguments, mentions=["scene of f.exr:", "opens no file"])

    def test_misspelt_options_and_words(self):
        self.fails(2, "render", "a.toml", "--smaples", "3", mentions="unknown option '--smaples'; did you mean '--samples'?")
        self.fails(2, "render", "--smaples=3", mentions="unknown option '--smaples'; did you mean '--samples'?")
        self.fails(2, "render", "a.toml", "one", "two", "three", mentions="unexpected arguments 'one', 'two', 'three'")
        self.fails(2, "export", "a.exr", "--format", "hcj", "-o", "e",
                   mentions=["'hcj' is not one of plenoptic-toolbox, ", "did you mean 'hci'?"])
        self.fails(2, "render", "a.toml", "--estimator", "foreward", mentions="did you mean 'forward'?")

    def test_another_kind_of_file_in_place_of_a_scene(self):
        self.succeeds("render", "a.toml", "--samples", "1", "--quiet", "-o", "a.exr")
        for command in ("render", "design", "bench"):
            self.fails(1, command, "a.exr", mentions=["'a.exr' is a light field", "plenoflame info a.exr --scene"])
        self.fails(1, "render", "none.exr", mentions="cannot read 'none.exr'")
        self.write("a.vdb", b" BDV\0\0\0\0abcdef")
        self.fails(1, "render", "a.vdb", mentions="is a flame (.vdb)")

    def test_names_do_not_act_on_the_terminal(self):
        evil = "a\x1b[31m\u009b2J\u202e"
        self.write("e.toml", SCENE.replace("[[flames]]\n", "[[flames]]\nname = \"a\\u001B[31m\\u009b2J\\u202e\"\n"))
        for text in (self.succeeds("info", "e.toml"), self.succeeds("info", "e.toml", "--json"),
                     self.succeeds("info", "e.toml", "--scene")):
            self.assertRegex(text.lower(), r"a\\u001b\[31m\\u009b2j\\u202e")
            for character in evil[1] + evil[6] + evil[-1]:
                self.assertNotIn(character, text)
        write_light_field(self.path("e.exr"), [[1.0]], name="x\x1b[2Jcomplete: yes", scene="# \x1b[2J\u009b\n",
                          **{"text.note": "\r\x1b[1A"})
        for text in (self.succeeds("info", "e.exr"), self.succeeds("info", "e.exr", "--json"),
                     self.succeeds("info", "e.exr", "--scene")):
            self.assertNotRegex(text, "[\x00-\x09\x0b-\x1f\x7f-\x9f]")
        name = "f\x1b[31m.toml"
        for command in ("info", "render", "design"):
            self.fails(1, command, name, mentions="f\\u001b[31m.toml")


if __name__ == "__main__":
    main()
