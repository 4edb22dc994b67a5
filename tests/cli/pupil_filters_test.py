"""Filters over parts of the stop: their report, the temperature of one picture, what is refused."""

import json

from command import CommandTest, long, main

TEMPERATURE = 1600
CAMERA = """[camera.lens]
model = "ideal"
focal_length = "100 mm"
diameter = "25 mm"
[camera.array]
lattice = "square"
model = "ideal"
aperture = "square"
pitch = "0.25 mm"
diameter = "0.25 mm"
sensor_distance = "1 mm"
[[camera.array.types]]
name = "lens"
focal_length = "1 mm"
[camera.sensor]
columns = 100
rows = 100
pixel_pitch = "10 um"
[camera.focus]
object_distance = "0.75 m"
"""
CHANNEL = '[[channels]]\nname = "sensor"\nkind = "band"\nwavelength = "725 nm"\nwidth = "400 nm"\n'
FLAME = f"""[[flames]]
position = ["0.75 m", "0 m", "0 m"]
[[flames.layers]]
centre = ["0 m", "0 m", "0 m"]
semi_axes = ["50 mm", "50 mm", "50 mm"]
temperature = "{TEMPERATURE} K"
absorption = "2000 1/m"
"""


def sector(name, angle, extent, transmission):
    return (f'[[camera.pupil_filters]]\nname = "{name}"\nangle = "{angle} deg"\nextent = "{extent} deg"\n'
            f'transmission = "{transmission}"\n')


RED = sector("red", -90, 180, "640 nm 0, 650 nm 0.9, 660 nm 0")
INFRARED = sector("infrared", 90, 180, "840 nm 0, 850 nm 0.6, 860 nm 0")


class PupilFilters(CommandTest):
    def rendered(self, filters):
        self.write("a.toml", CAMERA + filters + CHANNEL + FLAME)
        self.succeeds("render", "a.toml", "-o", "a.exr", "--samples", "64", "--quiet")

    def json_of(self, *words):
        """Figures; a camera as small as this one is warned of."""
        result = self.run_command(*words, "--json")
        self.assertEqual(result.returncode, 0, result.stderr)
        return json.loads(result.stdout)

    def test_a_uniform_flame_has_its_temperature(self):
        self.rendered(RED + INFRARED)
        figures = self.json_of("pyrometry", "a.exr", "--filters", "red,infrared", "-o", "t.exr", "--picture", "t.png")
        for key in ("mean_K", "lowest_K", "highest_K"):
            self.assertLess(abs(figures[key] / TEMPERATURE - 1), 1e-3, figures)
        self.assertEqual(figures["filters"], ["red", "infrared"])
        self.assertGreaterEqual(figures["microlenses"], 9)
        self.assertGreater(min(figures["pixels_of_a_microlens"]), 30)
        self.assertIn("t.exr", self.files())
        self.assertIn("t.png", self.files())

    def test_opaque_masks_take_their_part_of_the_light(self):
        """Both blocked halves of the stop together are the open stop: the rays are the same."""
        flux = {}
        dark = "300 nm 0, 1200 nm 0"
        for name, filters in (("open", ""), ("left", sector("mask", -90, 180, dark)), ("right", sector("mask", 90, 180, dark))):
            self.write("a.toml", CAMERA + filters + CHANNEL + FLAME)
            self.succeeds("render", "a.toml", "-o", name + ".exr", "--samples", "16", "--quiet")
            flux[name] = self.json_of("info", name + ".exr")["channels"][0]["total_W"]
        self.assertLess(abs(flux["left"] / flux["right"] - 1), 0.05)
        self.assertLess(abs((flux["left"] + flux["right"]) / flux["open"] - 1), 1e-5)
        said = self.run_command("design", "a.toml").stdout
        self.assertIn("mask: 50", said)
        self.assertIn("opaque", said)

    def test_an_opaque_stop_gives_a_black_picture(self):
        self.write("a.toml", CAMERA + sector("lid", 0, 0, "300 nm 0, 1200 nm 0") + CHANNEL + FLAME)
        result = self.run_command("render", "a.toml", "-o", "a.exr", "--samples", "4", "--quiet")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn('no pupil filter transmits light of channel "sensor", so its picture is black', result.stderr)
        self.assertEqual(self.json_of("info", "a.exr")["channels"][0]["largest_W"], 0)
        figures = self.run_command("render", "a.toml", "-o", "a.exr", "--samples", "4")
        self.assertRegex(figures.stdout, "error: +none: no pixel is lit")
        # A channel that passes beside one that does not: a filter that was meant for another channel.
        self.write("a.toml", CAMERA + sector("red", 0, 0, "640 nm 0, 650 nm 0.9, 660 nm 0") + CHANNEL.replace("sensor", "blue").replace(
            "725", "450").replace("400", "20") + CHANNEL + FLAME)
        self.fails(1, "render", "a.toml", "-o", "b.exr", mentions='no pupil filter transmits light of channel "blue"')

    def test_electrons_give_the_temperature_too(self):
        # A uniform flame: what is left is noise of many pixels. The dark signal is 30 electrons of some thousand.
        camera = CAMERA.replace('pixel_pitch = "10 um"', 'pixel_pitch = "10 um"\nfull_well = 20000\n'
                                'read_noise = 5\ndark_current = 30000\nexposure_time = "1 ms"\nquantum_efficiency = 0.4')
        self.write("a.toml", camera + RED + INFRARED + CHANNEL + FLAME)
        self.succeeds("render", "a.toml", "-o", "a.exr", "--samples", "64", "--quiet")
        self.succeeds("develop", "a.exr", "--exposure", "auto", "-o", "e.exr")
        figures = self.json_of("pyrometry", "e.exr", "--filters", "red,infrared")
        self.assertGreater(figures["expected_deviation_K"], 0.1)
        self.assertLess(abs(figures["mean_K"] - TEMPERATURE),
                        3 * figures["expected_deviation_K"] / figures["microlenses"] ** 0.5 + 1e-3 * TEMPERATURE)

    def test_the_matrix_weighs_the_filters(self):
        # Two halves of 0.9 and 0.3 in all light of the channel, against the open stop: 0.6.
        total = []
        for filters in ("", sector("a", -90, 180, "300 nm 0.9, 1200 nm 0.9") +
                        sector("b", 90, 180, "300 nm 0.3, 1200 nm 0.3")):
            self.write("a.toml", CAMERA + filters + CHANNEL + FLAME)
            result = self.run_command("operator", "a.toml", "--grid", "4", "--rays", "16", "--quiet", "-o", "A.mtx")
            self.assertEqual(result.returncode, 0, result.stderr)
            with open(self.path("A.mtx"), encoding="ascii") as file:
                rows = [line.split() for line in file if not line.startswith("%")]
            total.append(sum(float(row[2]) for row in rows[1:]))
        self.assertLess(abs(total[1] / total[0] / 0.6 - 1), 0.02)

    @long
    def test_one_channel_behind_two_filters_tells_temperature_and_absorption(self):
        flame = (FLAME.replace("2000 1/m", "60 1/m").replace("50 mm", "4 mm") +
                 '[flames.spectrum]\nkind = "power"\nreference = "725 nm"\nexponent = 1\n')
        self.write("a.toml", CAMERA + RED + INFRARED + CHANNEL + flame)
        self.succeeds("render", "a.toml", "-o", "a.exr", "--samples", "64", "--quiet")
        common = ("reconstruct", "a.toml", "--images", "a.exr", "--unknowns", "layers", "--grid", "3", "--rays", "64",
                  "--seed", "5", "--truth", "--quiet")
        # Three layers make little of the sharp edge (chi^2 is 54): the strength is given, not chosen by a misfit that noise does not make.
        both = self.json_of(*common, "--find", "both", "--strength", "1", "-o", "both.vdb")
        self.assertLess(both["truth_temperature_error"], 0.05)  # 0.042; 0.11 with absorptions that do not fit
        # Layers make little of the flame's sharp edge: as little with filters as with an open stop.
        known = ("--find", "temperature", "--absorption", "scene", "--strength", "1", "-o", "known.vdb")
        errors = [self.json_of(*common, *known)["truth_temperature_error"]]
        self.write("a.toml", CAMERA + CHANNEL.replace("400", "30") + flame)
        self.succeeds("render", "a.toml", "-o", "a.exr", "--samples", "64", "--quiet")
        errors.append(self.json_of(*common, *known)["truth_temperature_error"])
        self.assertLess(abs(errors[0] - errors[1]), 0.02)
        # With one colour, nothing is known but the emission.
        self.write("one.toml", CAMERA + RED + CHANNEL.replace("725", "650").replace("400", "10") + flame)
        self.succeeds("render", "one.toml", "-o", "one.exr", "--samples", "16", "--quiet")
        self.fails(2, *[w.replace("a.toml", "one.toml").replace("a.exr", "one.exr") for w in common], "--find", "both",
                   "-o", "none.vdb", mentions="a second channel")

    def test_truth_behind_filters_is_the_flame_s_own_emission(self):
        """Grey filters weaken the picture to 0.6; what is found, and what it is compared with, is the flame as without."""
        flame = FLAME.replace("2000 1/m", "60 1/m").replace("50 mm", "4 mm")
        found = []
        for filters in ("", sector("a", -90, 180, "300 nm 0.9, 1200 nm 0.9") +
                        sector("b", 90, 180, "300 nm 0.3, 1200 nm 0.3")):
            self.write("a.toml", CAMERA + filters + CHANNEL.replace("400", "30") + flame)
            self.succeeds("render", "a.toml", "-o", "a.exr", "--samples", "1024", "--quiet")
            found.append(self.json_of("reconstruct", "a.toml", "--images", "a.exr", "--unknowns", "layers", "--grid", "3", "--rays",
                                      "64", "--seed", "5", "--strength", "1e-6", "--absorption", "scene", "--truth", "--draws", "0", "--probes", "0",
                                      "--quiet", "-o", "x.vdb"))
        self.assertLess(abs(found[1]["largest_emission"] / found[0]["largest_emission"] - 1), 0.05)
        # The same strength in both: what the noise lets choose differs. A truth seen through the filters would be 0.6 of what is found: an error of 0.67.
        self.assertLess(abs(found[1]["truth_emission_error"] - found[0]["truth_emission_error"]), 0.05)

    def test_design_says_which_views_see_which_filter(self):
        self.write("a.toml", CAMERA + RED + INFRARED + CHANNEL + FLAME)
        figures = self.json_of("design", "a.toml")
        parts = figures["pupil_parts"]
        self.assertEqual([part["name"] for part in parts], ["red", "infrared"])
        for part in parts:
            self.assertLess(abs(part["share"] - 0.5), 2e-3)
            # A pixel of 10 um behind a pupil of 25 mm at 115.38 mm.
            self.assertLess(abs(part["etendue_m2_sr"] / (0.5 * 1e-10 * 3.14159 / (4 * (115.38 / 25) ** 2 + 1)) - 1), 0.01)
        for row in figures["views_see"]:
            self.assertEqual((row[0], row[3], row[6]), ("infrared", None, "red"))
        self.assertIn("a of the stop", self.run_command("design", "a.toml").stdout)
        self.assertRegex(self.succeeds("info", "a.toml"), r"pupil filters: +red, infrared\n")
        self.assertEqual(self.json_of("info", "a.toml")["pupil_filters"], "red, infrared")

    def test_what_is_refused(self):
        self.rendered(RED + INFRARED)
        for words, status, mentions in (
                (("--filters", "red"), 2, "two names"),
                (("--filters", "red,green"), 2, ["no pupil filter 'green'", "it has: red, infrared"]),
                (("--filters", "red,infrared", "--channels", "a,b"), 2, "one channel")):
            self.fails(status, "pyrometry", "a.exr", *words, mentions=mentions)
        self.rendered("")
        self.fails(1, "pyrometry", "a.exr", "--filters", "red,infrared", mentions="no camera.pupil_filters")

    def test_mistakes_have_their_place(self):
        twice = sector("b", 80, 180, "400 nm 1, 900 nm 1")
        self.write("a.toml", CAMERA + RED + twice + CHANNEL + FLAME)
        line = (CAMERA + RED).count("\n") + 3
        self.fails(1, "render", "a.toml", mentions=[f"a.toml:{line}:", '"red" and pupil filter "b" overlap'])
        far = '[[camera.pupil_filters]]\nshape = "polygon"\ncorners = "1.1 0, 2 0, 2 1"\n'
        self.write("a.toml", CAMERA + far + CHANNEL + FLAME)
        line = CAMERA.count("\n") + 3
        self.fails(1, "render", "a.toml", mentions=[f"a.toml:{line}:", "outside of the stop"])
        self.write("a.toml", CAMERA + far.replace("1.1 0, 2 0, 2 1", "0 0, 1") + CHANNEL + FLAME)
        self.fails(1, "render", "a.toml", mentions=[f"a.toml:{line}:", "corners are pairs of numbers"])
        self.write("a.toml", CAMERA + RED + INFRARED.replace("infrared", "red") + CHANNEL + FLAME)
        line = (CAMERA + RED).count("\n") + 2
        self.fails(1, "render", "a.toml", mentions=[f"a.toml:{line}:", 'both named "red"; names must differ'])
        self.assertEqual(self.files(), ["a.toml"])


if __name__ == "__main__":
    main()
