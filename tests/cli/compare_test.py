"""plenoflame compare: figures against the definitions, computed here; messages."""

import math
import random
import struct

from command import CommandTest, main
from exr import write_light_field


def single(value):
    return struct.unpack("<f", struct.pack("<f", value))[0]


class Compare(CommandTest):
    def test_figures(self):
        source = random.Random(5)
        b = [[single(2e-9 * source.random()) if x != 3 else 0.0 for x in range(20)] for _ in range(9)]
        a = [[single(v * (1 + 0.1 * source.gauss(0, 1)) + 1e-11) for v in row] for row in b]
        errors = [[single(1e-10 * (1 + source.random())) for _ in row] for row in b]
        write_light_field(self.path("a.exr"), a, errors)
        write_light_field(self.path("b.exr"), b)
        figures = self.json_of("compare", "a.exr", "b.exr")
        pairs = [(u, v, s) for ru, rv, rs in zip(a, b, errors) for u, v, s in zip(ru, rv, rs)]
        threshold = 0.01 * max(v for _, v, _ in pairs)
        # Errors are known of the first image alone, and so the other one counts as exact.
        lit = [(u, v, s) for u, v, s in pairs if v > threshold]
        self.assertTrue(0 < min(v for _, v, _ in pairs if v > 0) < threshold)  # so that it matters
        mean = math.fsum(v for _, v, _ in lit) / len(lit)
        rmse = math.sqrt(math.fsum((u - v) ** 2 for u, v, _ in lit) / len(lit)) / mean
        bias = math.fsum(u - v for u, v, _ in lit) / len(lit) / mean

        def close(key, expected, tolerance=1e-9):
            self.assertLessEqual(abs(figures[key] - expected), tolerance * abs(expected), key)
        self.assertEqual(figures["lit_pixels"], len(lit))
        close("reference_mean_W", mean)
        close("relative_rmse", rmse)
        close("relative_bias", bias)
        close("stray_share", math.fsum(u for u, v, _ in pairs if v <= threshold) / math.fsum(u for u, _, _ in pairs))
        close("largest_difference_W", max((u - v for u, v, _ in pairs), key=abs))
        close("relative_bias_error", math.sqrt(math.fsum(s * s for _, _, s in lit)) / len(lit) / mean, 1e-6)
        close("expected_rmse", math.sqrt(math.fsum(s * s for _, _, s in lit) / len(lit)) / mean, 1e-6)
        close("chi_square", math.fsum(((u - v) / s) ** 2 for u, v, s in pairs) / len(pairs), 1e-6)
        close("largest_z", max(((u - v) / s for u, v, s in pairs), key=abs), 1e-6)
        self.assertEqual(figures["blocks"], 2)
        text = self.succeeds("compare", "a.exr", "b.exr")
        self.assertRegex(text, r"relative RMSE: +%.4g %%\n" % (100 * rmse))

    def test_says_it_in_words(self):
        """Two images of the same light: no digits of nothing, and a verdict."""
        source = random.Random(7)
        light = [[1e-9 * (1 + x / 40) for x in range(40)] for _ in range(40)]
        errors = [[5e-11] * 40 for _ in light]
        for name in "ab":
            noisy = [[v + 5e-11 * source.gauss(0, 1) for v in row] for row in light]
            write_light_field(self.path(name + ".exr"), noisy, errors)
        text = self.succeeds("compare", "a.exr", "b.exr")
        self.assertRegex(text, r"verdict: +nothing more than noise is seen\n")
        self.assertRegex(text, r"bias: +[+-][0-3]\.\d\d standard errors\n")
        self.assertRegex(text, r"single pixels: +\S+ times the expected mean square\n")
        write_light_field(self.path("bright.exr"), [[10 * v for v in row] for row in light], errors)
        self.assertRegex(self.succeeds("compare", "bright.exr", "b.exr"), r"bias: +\+\d{3,} standard errors\n")
        self.assertRegex(text, r"largest: +-?[2-5]\.\d of its errors at pixel \d+,\d+, as is usual")
        self.assertNotIn("probability", text)
        self.assertIs(self.json_of("compare", "a.exr", "b.exr")["more_than_noise"], False)
        write_light_field(self.path("b.exr"), [[1.02 * v for v in row] for row in light], errors)
        self.assertIn("the images differ by more than noise", self.succeeds("compare", "a.exr", "b.exr"))
        self.assertIs(self.json_of("compare", "a.exr", "b.exr")["more_than_noise"], True)

    def test_without_standard_errors(self):
        write_light_field(self.path("a.exr"), [[1.0, 2.0]])
        figures = self.json_of("compare", "a.exr", "a.exr")
        self.assertEqual((figures["relative_rmse"], figures["has_standard_errors"]), (0, False))
        self.assertNotIn("chi_square", figures)
        self.assertIn("neither image", self.succeeds("compare", "a.exr", "a.exr"))

    def test_two_units_are_warned_of(self):
        write_light_field(self.path("a.exr"), [[1.0, 2.0]], unit="e-")
        write_light_field(self.path("b.exr"), [[1.0, 2.0]])
        result = self.run_command("compare", "a.exr", "b.exr")
        self.assertEqual(result.returncode, 0)
        self.assertIn("warning: the first image is in e-, the reference in W: their difference means nothing", result.stderr)
        self.assertEqual(self.run_command("compare", "b.exr", "b.exr").stderr, "")

    def test_limit(self):
        write_light_field(self.path("a.exr"), [[1.02, 2.0]])
        write_light_field(self.path("b.exr"), [[1.0, 2.0]])
        self.succeeds("compare", "a.exr", "b.exr", "--limit", "1%")  # 0.94 %
        result = self.run_command("compare", "a.exr", "b.exr", "--limit", "0.9 %")
        self.assertEqual(result.returncode, 1)
        self.assertIn("relative RMSE", result.stdout)
        self.assertRegex(result.stderr, r"\Aplenoflame: error: [^\n]*exceeds the limit of 0\.9 %\n\Z")
        for wrong in ("much", "-1%", "1 m", "nan"):
            self.fails(2, "compare", "a.exr", "b.exr", "--limit=" + wrong, mentions="--limit")

    def test_what_cannot_be_compared(self):
        write_light_field(self.path("a.exr"), [[1.0, 2.0]], sensor=(20, 10))
        write_light_field(self.path("elsewhere.exr"), [[1.0, 2.0]], sensor=(20, 10), origin=(7, 7))
        write_light_field(self.path("other.exr"), [[1.0, 2.0]], sensor=(30, 10))
        write_light_field(self.path("band.exr"), [[1.0, 2.0]], sensor=(20, 10), name="650nm")
        write_light_field(self.path("dark.exr"), [[0.0, 0.0]], sensor=(20, 10))
        write_light_field(self.path("nan.exr"), [[0.0, float("inf")]], sensor=(20, 10))
        for name, message in (("elsewhere", "don't overlap"), ("other", "20 x 10 and 30 x 10"),
                              ("band", "no channel '650nm'; it has: total"), ("dark", "the reference is dark"),
                              ("nan", "column 1, row 0"), ("none", "No such file")):
            self.fails(1, "compare", "a.exr", name + ".exr", mentions=message)
        self.fails(2, "compare", "a.exr", mentions="REFERENCE")


if __name__ == "__main__":
    main()
