"""plenoflame design: figures of the paper's camera, and what it warns of."""

import json
import re

from command import CommandTest, main


class Design(CommandTest):
    def figures(self, scene):
        self.write("a.toml", scene)
        result = self.run_command("design", "a.toml", "--json")
        self.assertEqual(result.returncode, 0, result.stderr)
        figures = json.loads(result.stdout)
        self.assertEqual(result.stderr.splitlines(), ["plenoflame: warning: " + w for w in figures["warnings"]])
        return figures

    def near(self, actual, expected, tolerance):
        self.assertLess(abs(actual / expected - 1), tolerance)

    def test_the_papers_camera(self):
        figures = self.figures('[camera]\npreset = "paper-plenoptic2"\n')
        self.near(figures["focal_length_m"], 0.3040986, 1e-6)
        self.near(figures["back_focal_distance_m"], 0.2959014, 1e-6)
        self.assertEqual([t["name"] for t in figures["types"]], ["type1", "type2", "type3"])
        b, d, p = 0.2534e-3, 0.1e-3, 0.01e-3
        first = figures["types"][0]
        self.assertTrue(first["keplerian"])
        for sign, limit in zip((-1, 0, 1), first["array_m"]):
            self.near(limit, 1 / (1 / first["focal_length_m"] - (1 + sign * p / d) / b), 1e-9)
        self.assertLess(first["array_m"][2], 0)
        self.near(figures["types"][1]["object_m"][1], 1, 1e-9)
        self.assertTrue(any("cannot be seen" in w for w in figures["warnings"]), figures["warnings"])
        self.assertTrue(any("f-numbers do not match" in w for w in figures["warnings"]))
        text = self.run_command("design", "a.toml").stdout
        for words in ("focal length:", "304.1 mm", "Keplerian", "through infinity", "RMS radius"):
            self.assertIn(words, text)

    def test_galilean_ranges_do_not_pass_infinity(self):
        figures = self.figures('[camera]\npreset = "raytrix-r29"\n')
        for t in figures["types"]:
            self.assertFalse(t["keplerian"])
            self.assertTrue(max(t["array_m"]) < 0 < min(t["object_m"]))
            self.assertFalse(t["array_through_infinity"] or t["object_through_infinity"])
        self.assertNotIn("through infinity", self.run_command("design", "a.toml").stdout)
        self.assertNotIn("through infinity", self.run_command("design", "a.toml", "--solve", "radius").stdout)

    def test_lens_counts_views_and_table_2(self):
        figures = self.figures('[camera]\npreset = "paper-plenoptic2"\n')
        self.near(figures["hexagonal_over_square"], 2 / 3**0.5, 5e-3)
        self.assertEqual(figures["table_2"]["printed_ratio"], 1.955)
        # The union of the ranges over the first: read off the printed types.
        ranges = sorted(sorted((1 / t["array_m"][2], 1 / t["array_m"][0])) for t in figures["types"])
        length, end = 0, ranges[0][0]
        for low, high in ranges:
            length += max(0, high - max(low, end))
            end = max(end, high)
        self.near(figures["table_2"]["joint_1_m"], length, 1e-9)
        self.near(figures["table_2"]["ratio"], length / (ranges[0][1] - ranges[0][0]), 1e-9)
        view = figures["views"]
        self.near(view["count"], 3.14159265358979 / 4 * figures["types"][0]["image_diameter_pixels"] ** 2, 1e-9)
        for point in figures["resolution"]:
            best = max(value for value in point["traced"] if value is not None)
            self.near(point["traced_joint"], best, 1e-12)
        text = self.run_command("design", "a.toml").stdout
        self.assertIn("1.955, which does not follow", text)

    def test_windows(self):
        plate = ('[camera]\npreset = "paper-plenoptic2"\n[[windows]]\nname = "port"\nposition = ["0.5 m", "0 m", "0 m"]\n'
                 'rotation = ["0 deg", "90 deg", "0 deg"]\nthickness = "12 mm"\ndiameter = "0.3 m"\nindex = 1.5\n')
        (port,) = self.figures(plate)["windows"]
        self.near(port["shift_x_m"], 0.012 * (1 - 1 / 1.5), 1e-5)
        self.near(port["shift_y_m"], 0.012 * (1 - 1 / 1.5), 1e-5)
        self.assertEqual(port["loss"], 0)
        (port,) = self.figures(plate + "fresnel = true\n")["windows"]
        self.near(port["loss"], 1 - 3 / 3.25, 1e-6)  # 2 n / (n^2 + 1) pass
        text = self.run_command("design", "a.toml").stdout
        self.assertIn("moves the focus by 4 mm", text)
        self.write("bad.toml", plate.replace('"0.5 m"', '"-10 mm"'))
        result = self.run_command("design", "bad.toml")
        self.assertEqual(result.returncode, 1)
        self.assertIn("bad.toml:5:12: ", result.stderr)
        self.assertIn("reaches into the camera's main lens", result.stderr)

    def test_plots(self):
        self.figures('[camera]\npreset = "paper-plenoptic2"\n')
        for ending, start in (("png", b"\x89PNG"), ("svg", b"<?xml")):
            self.run_command("design", "a.toml", "--plots", "plots", "--format", ending)
            for name in ("resolution", "spots", "microlens"):
                self.assertTrue(self.read(f"plots/{name}.{ending}").startswith(start), name)
        # Drawn: lines of the colours of the three types.
        svg = self.read("plots/resolution.svg").decode()
        self.assertGreater(svg.count("<path"), 20)

    def test_legend_hides_no_curve(self):
        """The curve rises into the corner where legends stand by default."""
        self.write("a.toml", '[camera]\npreset = "paper-previous-60x60"\n')
        self.run_command("design", "a.toml", "--plots", "plots", "--format", "svg")
        svg = self.read("plots/resolution.svg").decode()
        numbers = r"[ML] ([0-9.]+) ([0-9.]+)"
        box = re.search(r'<path style="[^"]*stroke:rgb\(60%,60%,60%\)[^"]*" d="([^"]*)"', svg).group(1)
        corners = [(float(x), float(y)) for x, y in re.findall(numbers, box)]
        left, top = (min(c[i] for c in corners) for i in (0, 1))
        right, bottom = (max(c[i] for c in corners) for i in (0, 1))
        curves = re.findall(r'<path style="fill:none;stroke-width:2.2;[^"]*" d="([^"]*)"', svg)
        points = [(float(x), float(y)) for x, y in re.findall(numbers, " ".join(curves[:2]))]
        self.assertGreater(len(points), 40)
        for x, y in points:
            self.assertFalse(left < x < right and top < y < bottom, (x, y))

    def test_solving_for_the_array(self):
        """The scene that is written has the joined focal lengths when it is read again."""
        self.write("a.toml", '[camera]\npreset = "paper-plenoptic2"\n')
        b, d, p = 0.2534e-3, 0.1e-3, 0.01e-3
        for choice in ("index", "radius"):
            result = self.run_command("design", "a.toml", "--solve", choice, "-o", "b.toml", "--json")
            self.assertEqual(result.returncode, 0, result.stderr)
            solved = json.loads(result.stdout)["solved"]
            again = json.loads(self.run_command("design", "b.toml", "--json").stdout)["types"]
            for k in range(3):
                length = 1 / (1 / 0.2336538461538e-3 + k * 2 * p / (d * b))
                self.near(solved[k]["focal_length_m"], length, 1e-9)
                self.near(again[k]["focal_length_m"], length, 1e-9)
            self.assertTrue(all(0.05 < s["gap_share"] < 0.4 for s in solved[1:]))
        self.fails(2, "design", "a.toml", "-o", "b.toml", mentions="--solve")
        # The warnings stand before the error.
        for options, words in ((("index", "--greatest-index", "1.6"), "above the limit of 1.6"),
                               (("thickness",), "thickness"),
                               (("radius", "--least-radius", "0.2 mm"), "below the limit of 0.2 mm")):
            result = self.run_command("design", "a.toml", "--solve", *options)
            self.assertEqual(result.returncode, 1)
            self.assertIn(words, result.stderr.splitlines()[-1])

    def test_types_that_coincide(self):
        types = "".join(f'[[camera.array.types]]\nname = "{name}"\nradius_front = "0.225 mm"\n'
                        'radius_back = "0.225 mm"\nindex = 1.5\n' for name in ("one", "two"))
        self.write("a.toml", '[camera]\npreset = "paper-plenoptic2"\n' + types + '[camera.focus]\nconjugate = "one"\n')
        self.fails(1, "design", "a.toml", mentions=['"one" and "two" have the same focal length', "leave one out"])

    def test_messages(self):
        self.fails(2, "design", mentions="SCENE")
        self.fails(1, "design", "none.toml", mentions="none.toml")
        # A value that the scene states is not taken from the command line, and not ignored either.
        self.write("scene.toml", '[camera]\npreset = "paper-plenoptic2"\n')
        for option in (("--field", "14 deg"), ("--distance", "1 m"), ("--wavelength", "450 nm"), ("--paraxial-focus",)):
            self.fails(2, "design", "scene.toml", *option, mentions=[option[0], "only to a lens alone"])


if __name__ == "__main__":
    main()
