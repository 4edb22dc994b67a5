"""plenoflame design: figures of the paper's camera, and what it warns of."""

import json

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
        self.assertTrue(any("hides them" in w for w in figures["warnings"]), figures["warnings"])
        self.assertTrue(any("f-numbers do not match" in w for w in figures["warnings"]))
        text = self.run_command("design", "a.toml").stdout
        for words in ("focal length:", "304.1 mm", "Keplerian", "through infinity", "RMS radius"):
            self.assertIn(words, text)

    def test_messages(self):
        self.fails(2, "design", mentions="SCENE")
        self.fails(1, "design", "none.toml", mentions="none.toml")


if __name__ == "__main__":
    main()
