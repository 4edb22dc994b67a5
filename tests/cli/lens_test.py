"""plenoflame design of a lens alone: prescriptions, imports, figures, plots."""

from command import CommandTest, main

# 100 mm f/4 plano-convex, n = 1.5: R = 50 mm.
COLUMNS = "# plano-convex\n50 5 1.5 25\n0 1 1 25\n1e9 99 1 26\n"
ZMX = """MODE SEQ
NAME plano-convex
UNIT MM
SURF 0
  DISZ INFINITY
SURF 1
  STOP
  TYPE STANDARD
  CURV 0.02 0
  DISZ 5
  GLAS N-BK7 0 0
  DIAM 12.5
SURF 2
  TYPE STANDARD
  CURV 0
  DISZ 95
  DIAM 12.5
SURF 3
  DISZ 0
"""


class Lens(CommandTest):
    def near(self, actual, expected, tolerance):
        self.assertLess(abs(actual / expected - 1), tolerance)

    def test_shipped_prescriptions(self):
        for name, length in (("paper-singlet", 0.3040987), ("double-gauss-100mm", 0.1000038),
                             ("objective-50mm", 0.05), ("objective-100mm", 0.1004), ("achromat-100mm", 0.1)):
            self.write("a.toml", f'[camera.lens]\npreset = "{name}"\n')
            figures = self.json_of("design", "a.toml")
            self.near(figures["focal_length_m"], length, 5e-4)
            fields = figures["fields"]
            self.assertEqual(fields[0]["distortion"], 0)
            self.assertGreater(fields[0]["throughput"], 0.999)
            if figures["greatest_field_rad"] < 0.785:  # 45 degrees: as far as is looked
                self.assertLess(abs(fields[-1]["throughput"] - 0.1), 0.02)
            self.assertGreater(fields[-1]["image_height_m"], 0)

    def test_plano_convex(self):
        # f = R / (n - 1), BFL = f - t / n; third-order blur of a plano-convex lens, curved side first.
        self.write("a.dat", COLUMNS)
        figures = self.json_of("design", "a.dat", "--paraxial-focus", "--field", "2 deg")
        self.near(figures["focal_length_m"], 0.1, 1e-6)
        self.assertEqual(figures["title"], "plano-convex")
        self.assertEqual(figures["focus_shift_m"], 0)
        self.near(figures["fields"][-1]["field_rad"], 0.0349066, 1e-5)
        self.near(figures["fields"][-1]["image_height_m"], 0.1 * 0.0349208, 1e-3)

    def test_wavelength_and_import(self):
        self.write("a.zmx", ZMX)
        # n(BK7) at d, F and C from its maker's sheet.
        for wavelength, n in (("587.5618 nm", 1.5168000), ("486.1327 nm", 1.5223763), ("656.2725 nm", 1.5143223)):
            figures = self.json_of("design", "a.zmx", "--wavelength", wavelength)
            self.near(figures["focal_length_m"], 0.05 / (n - 1), 1e-6)
        self.run_command("design", "a.zmx", "-o", "b.toml")
        self.assertIn('glass = "N-BK7"', self.read("b.toml").decode())
        self.assertEqual(self.json_of("design", "b.toml")["fields"], self.json_of("design", "a.zmx")["fields"])

    def test_cylinder(self):
        # Zemax has the section along y in CURV; without PARM 1 the one along x is flat. First-order optics takes the
        # mean of both powers: n(BK7) at the d line from its maker's sheet.
        self.write("a.zmx", ZMX.replace("TYPE STANDARD", "TYPE BICONICX", 1))
        figures = self.json_of("design", "a.zmx", "-o", "b.toml", "--wavelength", "587.5618 nm")
        self.near(figures["focal_length_m"], 2 * 0.05 / 0.5168, 1e-6)
        lens = self.read("b.toml").decode()
        self.assertIn('radius_x = "inf"', lens)
        self.assertIn('radius_y = "50 mm"', lens)
        self.write("c.toml", lens.replace('radius_x = "inf"', 'radius_x = "0 m"'))
        self.fails(1, "design", "c.toml", mentions=["c.toml:", "radius_x", "inf"])

    def test_plots(self):
        self.write("a.toml", '[camera.lens]\npreset = "double-gauss-100mm"\n')
        self.succeeds("design", "a.toml", "--plots", "p")
        self.assertEqual(sorted(self.files()), ["a.toml", "p"])
        for name in ("lens-spots", "lens-fans", "lens-fields"):
            self.assertTrue(self.read(f"p/{name}.png").startswith(b"\x89PNG"))

    def test_messages(self):
        self.write("a.zmx", ZMX.replace("TYPE STANDARD", "TYPE TOROIDAL", 1))
        self.fails(1, "design", "a.zmx", mentions=["a.zmx:8", "TOROIDAL", "STANDARD, EVENASPH and BICONICX are"])
        self.write("a.zmx", ZMX.replace("N-BK7", "N-BK77"))
        self.fails(1, "design", "a.zmx", mentions=["a.zmx:11", "N-BK7"])
        self.write("a.dat", COLUMNS)
        self.fails(2, "design", "a.dat", "--field", "2", mentions="--field")
        self.fails(2, "design", "a.dat", "-o", "b.zmx", mentions=["b.zmx", ".toml"])
        self.fails(2, "design", "a.dat", "--solve", "index", mentions="--solve")
        for option, value in [("--field", "0 deg"), ("--field", "-5 deg"), ("--field", "90 deg"),
                              ("--wavelength", "0 nm"), ("--wavelength", "1 m"), ("--wavelength", "-400 nm")]:
            self.fails(2, "design", "a.dat", option + "=" + value, mentions=[option, value])
        self.fails(1, "design", "a.dat", "--distance", "10 mm", mentions="inside the front focal point")
        self.fails(1, "design", "a.dat", "--field", "80 deg", mentions="choose a smaller one")
        self.write("b.toml", '[camera.lens]\nfile = "a.dat"\npreset = "paper-singlet"\n')
        self.fails(1, "design", "b.toml", mentions=["b.toml:2", "both"])


if __name__ == "__main__":
    main()
