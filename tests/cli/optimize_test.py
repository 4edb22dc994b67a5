"""plenoflame optimize: the paper's focal lengths, and a camera like the R29 for a flame."""

import json

from command import CommandTest, main


class Optimize(CommandTest):
    def figures(self, *arguments):
        result = self.run_command("optimize", *arguments, "--json")
        self.assertEqual(result.returncode, 0, result.stderr)
        return json.loads(result.stdout)

    def test_the_papers_focal_lengths(self):
        """From indices whose focal lengths are 30 % off; thin lenses, so that B is the same for all."""
        lengths = (0.233, 0.19681, 0.17035)
        types = "".join(f'[[camera.array.types]]\nname = "t{k}"\nfocal_length = "{f * factor} mm"\n'
                        for k, (f, factor) in enumerate(zip(lengths, (1.3, 0.7, 1.3))))
        self.write("a.toml", '[camera]\npreset = "paper-plenoptic2"\n[camera.lens]\nmodel = "ideal"\n'
                   '[camera.array]\nmodel = "ideal"\nthickness = "0 m"\n' + types +
                   '[camera.focus]\nconjugate = "array"\n')
        figures = self.figures("a.toml", "--merit", "depth", "--array-range", "0.43128 mm,-20.359 mm", "-o", "b.toml")
        found = sorted((f * 1e3 for f in figures["after"]["focal_lengths_m"]), reverse=True)
        for actual, expected in zip(found, lengths):
            self.assertLess(abs(actual / expected - 1), 1e-3, found)
        self.assertLess(figures["before"]["merit_paraxial"], -0.1)
        self.assertGreater(figures["after"]["merit_paraxial"], -1e-6)
        design = json.loads(self.run_command("design", "b.toml", "--json").stdout)
        self.assertLess(abs(design["joint_ratio"] / 3 - 1), 1e-2)

    def test_the_r29_for_a_flame(self):
        self.write("a.toml", '[camera]\npreset = "raytrix-r29"\n')
        figures = self.figures("a.toml", "--merit", "volume", "--height", "60 mm", "--depths", "0.99m,1.01m",
                               "--vary", "focal,spacing,focus", "--free", "radius", "--bound", "1.5",
                               "-o", "b.toml", "--time-limit", "20")
        before, after = figures["before"], figures["after"]
        self.assertGreater(after["merit_traced"], 1.05 * before["merit_traced"])
        self.assertLess(after["overlap_pixels"], 1e-6)
        # The scene renders.
        result = self.run_command("render", "b.toml", "--samples", "1", "--window", "3000,2000,32,32", "-o", "b.exr")
        self.assertEqual(result.returncode, 0, result.stderr)

    def test_micro_images_do_not_overlap(self):
        """More light, until the micro-images touch: there the f-numbers match, B/D = (B_L - B)/D_L."""
        self.write("a.toml", '[camera]\npreset = "paper-plenoptic2"\n')
        vary = ("a.toml", "--merit", "light", "--vary", "aperture", "--bound", "3")
        free = self.figures(*vary, "--overlap", "1000", "-o", "wide.toml")
        self.assertGreater(free["after"]["overlap_pixels"], 1)
        figures = self.figures(*vary, "-o", "b.toml")
        self.assertGreater(figures["after"]["merit_paraxial"], figures["before"]["merit_paraxial"])
        self.assertLess(abs(figures["after"]["overlap_pixels"]), 1e-3)
        # From a camera whose micro-images overlap: they must not any more, or it is said.
        narrow = self.figures("wide.toml", "--merit", "light", "--vary", "aperture", "--bound", "3", "-o", "c.toml")
        self.assertLess(abs(narrow["after"]["overlap_pixels"]), 1e-3)
        factor = narrow["before"]["entrance_pupil_m"] / narrow["after"]["entrance_pupil_m"]
        self.assertGreater(factor, 1.1)
        for bound in (1.01, factor ** 0.6):  # not far enough down
            result = self.run_command("optimize", "wide.toml", "--merit", "light", "--vary", "aperture", "--bound",
                                      str(bound), "-o", "d.toml")
            self.assertEqual(result.returncode, 1)
            for words in ("overlap by at most 0 pixels", "--bound", "--overlap"):
                self.assertIn(words, result.stderr.splitlines()[-1])
            self.assertNotIn("d.toml", self.files())

    def test_bounds_hold(self):
        """More aperture is more light, up to the bound."""
        self.write("a.toml", '[camera]\npreset = "paper-plenoptic2"\n')
        for bound in (1.1, 1.2):
            figures = self.figures("a.toml", "--merit", "light", "--vary", "aperture", "--bound", str(bound),
                                   "--overlap", "1000", "-o", "b.toml")
            grown = figures["after"]["entrance_pupil_m"] / figures["before"]["entrance_pupil_m"]
            self.assertLess(abs(grown / bound - 1), 1e-6)

    def test_messages(self):
        self.write("a.toml", '[camera]\npreset = "raytrix-r29"\n')
        for arguments, words in ((("--merit", "depth"), "--array-range"), (("--merit", "volume"), "--depths"),
                                 (("--merit", "resolution", "--depths", "1m"), "two lengths"),
                                 (("--merit", "light", "--vary", "types"), "no parameter to vary")):
            result = self.run_command("optimize", "a.toml", *arguments, "-o", "b.toml")
            self.assertIn(result.returncode, (1, 2))
            self.assertIn(words, result.stderr.splitlines()[-1])
        self.fails(2, "optimize", "a.toml", "--merit", "light", mentions="--output")
        self.fails(2, "optimize", "a.toml", "--merit", "depth", "--array-range", "0 mm,1 mm", "-o", "b.toml",
                   mentions=["--array-range", "array itself"])
        for option, value in [("--bound", "nan"), ("--bound", "1"), ("--time-limit", "inf"), ("--bound", "2x")]:
            self.fails(2, "optimize", "a.toml", "--merit", "light", "-o", "b.toml", option, value,
                       mentions=[option, value + " is not a number from"])


if __name__ == "__main__":
    main()
