"""What the pictures of the examples show: the paper's flame in its layers, and micro-images of three kinds of sharpness."""

import math
import pathlib
import sys
import tomllib
import unittest

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
sys.path.insert(0, str(ROOT / "tests" / "cli"))

from command import CommandTest, main  # noqa: E402
from exr import read_exr  # noqa: E402

STEFAN_BOLTZMANN = 5.670374419e-8


def metres(text):
    value, unit = text.split()
    return float(value) * {"m": 1, "mm": 1e-3, "um": 1e-6}[unit]


def layers_of(scene):
    """[(centre in the world, semi-axes, source function, absorption)] of the first flame."""
    flame = scene["flames"][0]
    position = [metres(x) for x in flame["position"]]
    return [([p + metres(c) for p, c in zip(position, layer["centre"])], [metres(a) for a in layer["semi_axes"]],
             STEFAN_BOLTZMANN * float(layer["temperature"].split()[0]) ** 4 / math.pi, float(layer["absorption"].split()[0]))
            for layer in flame["layers"]]


def radiance(layers, origin, direction):
    """Closed form along a ray: the first listed layer wins where several overlap."""
    ends = []
    for centre, axes, _, _ in layers:
        o = [(o - c) / a for o, c, a in zip(origin, centre, axes)]
        d = [d / a for d, a in zip(direction, axes)]
        a, b, c = sum(x * x for x in d), sum(x * y for x, y in zip(o, d)), sum(x * x for x in o) - 1
        root = b * b - a * c
        ends.append(((-b - math.sqrt(root)) / a, (-b + math.sqrt(root)) / a) if root > 0 else None)
    cuts = sorted(t for pair in ends if pair for t in pair)
    light, transmittance = 0.0, 1.0
    for near, far in zip(cuts, cuts[1:]):
        for pair, (_, _, source, absorption) in zip(ends, layers):
            if pair and pair[0] <= 0.5 * (near + far) <= pair[1]:
                through = math.exp(-absorption * (far - near))
                light += transmittance * (1 - through) * source
                transmittance *= through
                break
    return light


class Pictures(CommandTest):
    def example(self, name, window, *options):
        """Flux of a window, rows of pixels, from the example as it is."""
        self.succeeds("render", str(ROOT / "examples" / (name + ".toml")), "-o", "a.exr", "--quiet", "--window",
                      ",".join(map(str, window)), *options)
        return read_exr(self.path("a.exr"))[1]["total"]

    def test_layers_of_the_paper_flame(self):
        scene = tomllib.loads(self.succeeds("info", str(ROOT / "examples" / "paper-flame-1m.toml"), "--scene"))
        layers = layers_of(scene)
        # Chief rays: the stop at the rear vertex of the lens (R 300 mm, t 24.26 mm, n 1.5) is seen from the scene in the
        # entrance pupil, t/n / (1 - (n - 1) t/(n R)) behind the front vertex, and behind it slopes grow by 1 + (n - 1)/R of that.
        pupil = 0.02426 / 1.5 / (1 - 0.5 * 0.02426 / (1.5 * 0.3))
        growth = 1 + 0.5 / 0.3 * pupil
        side, pitch = 104, 10e-6
        measured, expected = [], []
        for height in (0.050, 0.035, 0.014):  # in the mantle alone, in the luminous layer, in the core
            if not measured:
                self.example("paper-flame-1m", (1448, 1448, 8, 8), "--samples", "2")
            distance = self.json_of("info", "a.exr")["numbers"]["lens.distance"]  # rear vertex to array
            scale = growth * distance / (1 + pupil)  # array height per height at 1 m
            row = round(1500 - (height - 0.029) * scale / pitch)
            flux = self.example("paper-flame-1m", (1500 - side // 2, row - side // 2, side, side), "--samples", "16")
            measured.append(math.fsum(map(math.fsum, flux)))
            rays = [(x, y) for x in range(-48, 52, 12) for y in range(-48, 52, 12)]
            expected.append(math.fsum(
                radiance(layers, (-pupil, 0, 0),
                         (1, -x * pitch / (growth * distance), ((1500 - row) - y) * pitch / (growth * distance)))
                for x, y in rays) / len(rays))
        # The blur of the lens, 1 mm in the flame, and the micro-images that the window cuts are worth some percent; the layers
        # differ by far more.
        for a, b in ((0, 1), (2, 1)):
            self.assertLess(abs(measured[a] / measured[b] / (expected[a] / expected[b]) - 1), 0.03)
        self.assertLess(expected[0] / expected[1], 0.5)
        self.assertLess(expected[2] / expected[1], 0.8)

    def test_three_kinds_of_sharpness(self):
        self.succeeds("flame", "candle", "-o", "candle.vdb")
        self.write("candle.toml", (ROOT / "examples" / "candle.toml").read_text())
        x0, y0, width, height = 350, 350, 300, 300
        self.succeeds("render", "candle.toml", "-o", "a.exr", "--quiet", "--samples", "64", "--window",
                      f"{x0},{y0},{width},{height}")
        flux = read_exr(self.path("a.exr"))[1]["total"]
        # Micro-images stand where chief rays through the microlenses meet the sensor: a little farther out than these.
        numbers = self.json_of("info", "a.exr")["numbers"]
        spread = 1 + 253.4e-6 / numbers["lens.distance"]
        contrast = {0: [], 1: [], 2: []}
        for r in range(-20, 21):
            for q in range(-30, 31):
                column = 500 - spread * 10 * (q + 0.5 * r) - x0
                row = 500 - spread * 10 * math.sqrt(0.75) * r - y0
                i, j = math.floor(column), math.floor(row)
                if not (5 <= i < width - 5 and 5 <= j < height - 5):
                    continue
                # The candle's edges run downwards: steps across them, in units of the brightness.
                lines = [flux[j + b][i - 2:i + 3] for b in (-1, 0, 1)]
                mean = sum(map(sum, lines)) / 15
                if mean < 2e-8:
                    continue
                steps = [line[k + 1] - line[k] for line in lines for k in range(4)]
                contrast[(q - r) % 3].append(max(map(abs, steps)) / mean)
        mean = [sum(values) / len(values) for values in contrast.values()]
        self.assertGreater(min(map(len, contrast.values())), 50)
        self.assertGreater(mean[0], 1.3 * mean[1])
        self.assertGreater(mean[1], 1.3 * mean[2])


if __name__ == "__main__":
    main()
