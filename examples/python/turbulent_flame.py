"""Makes a turbulent sooting flame of 280 mm from numpy. turbulent.toml has two cameras in front of it.

    turbulent_flame.py [VOXEL_SIZE_IN_MM] [FOLDER]      writes FOLDER/turbulent.vdb (1 mm, this folder)

Mixing follows kinematic simulation (Fung et al. 1992): a random velocity without divergence, with the spectrum k^-5/3
between 90 mm and 8 mm, wrinkles a steady plume. The eddies are 1.6 times as tall as wide, as buoyancy stretches them.
Each point takes the mixture fraction of the place from which the eddies carried its gas. The temperature is a function
of the mixture fraction: air at 0, the hottest gas at the stoichiometric value of ethylene, colder rich gas that has
radiated heat. Soot is a band of rich mixture, 4 ppm at most, and needs 70 mm of height to form.
"""

import pathlib
import sys
from typing import Any

import numpy
from scipy import fft, ndimage

import plenoflame

WIDTH, HEIGHT = 0.16, 0.28              # of the grid [m]
NOZZLE, SPREAD, TIP = 0.016, 0.085, 0.29  # 1/e radius [m], its growth per height, where the fuel ends [m]
LARGEST, SMALLEST = 0.09, 0.008         # eddies [m]
INTENSITY = 0.15                        # RMS velocity of the eddies over the velocity of the plume
STRETCH = 1.6                           # height of an eddy over its width
DIFFUSION = 0.5e-3                      # [m] standard deviation
AMBIENT, PEAK, COLDEST_RICH = 293.15, 2050.0, 0.25  # [K], [K], of the rise at mixture fraction 1
STOICHIOMETRIC = 0.064                  # of ethylene in air
SOOT_CENTRE, SOOT_WIDTH, SOOT = 0.13, 0.055, 4e-6   # mixture fractions, volume fraction
SOOT_HEIGHT = 0.07                      # [m]
SOOT_FUNCTION, WAVELENGTH = 0.26, 650e-9


def eddies(seed: int) -> tuple[Any, Any]:
    """Velocity of the eddies (3, 128, 128, 192) with RMS 1 per component, periodic, and samples per metre."""
    random = numpy.random.default_rng(seed)
    shape, box = (128, 128, 192), numpy.array([0.192, 0.192, 0.288])
    axes = [2 * numpy.pi * fft.fftfreq(n, length / n) for n, length in zip(shape[:2], box)]
    axes.append(2 * numpy.pi * fft.rfftfreq(shape[2], box[2] / shape[2]))
    wave = numpy.meshgrid(*axes, indexing="ij", sparse=True)
    square = sum(k * k for k in wave)
    inside = (square < (2 * numpy.pi / SMALLEST) ** 2) & (square >= 0.999 * (2 * numpy.pi / LARGEST) ** 2)
    square[0, 0, 0] = 1
    amplitude = numpy.where(inside, square ** (-11 / 12), 0)  # energy k^-5/3: |u|^2 ~ k^-11/3
    free = [amplitude * fft.rfftn(random.standard_normal(shape, dtype=numpy.float32)) for _ in range(3)]
    along = sum(k * u for k, u in zip(wave, free)) / square
    velocity = numpy.array([fft.irfftn(u - k * along, shape) for k, u in zip(wave, free)], dtype=numpy.float32)
    return velocity / numpy.sqrt((velocity ** 2).mean()), (shape / box).astype(numpy.float32)


def mixture_fraction(spacing: float, seed: int, steps: int = 24) -> tuple[Any, Any]:
    across, up = round(WIDTH / spacing), round(HEIGHT / spacing)
    side = (numpy.arange(across) - (across - 1) / 2) * spacing
    height = (numpy.arange(up) + 1) * spacing
    x, y, z = (numpy.asarray(a, numpy.float32) for a in numpy.meshgrid(side, side, height, indexing="ij"))
    near = numpy.hypot(x, y) < 2.2 * NOZZLE + 0.22 * z
    place = numpy.array([x[near], y[near], z[near]])
    # Gas that has risen by this distance was moved by eddies on its way; they are weak at the nozzle.
    risen = numpy.minimum(0.9 * place[2], 0.26) * (0.35 + 0.65 * numpy.minimum(place[2] / 0.15, 1))
    velocity, per_metre = eddies(seed)
    stretch = numpy.array([1, 1, STRETCH], numpy.float32)[:, None]
    for _ in range(steps):
        samples = place * per_metre[:, None] / stretch
        drift = numpy.array([ndimage.map_coordinates(u, samples, order=1, mode="grid-wrap") for u in velocity])
        place -= INTENSITY * stretch * drift * risen / steps
    rise = numpy.maximum(place[2], 1e-4)
    width = NOZZLE + SPREAD * rise
    fuel = (NOZZLE / width * numpy.clip(1 - rise / TIP, 0, 1)) ** 1.2
    mixture = numpy.zeros(x.shape, numpy.float32)
    mixture[near] = fuel * numpy.exp(-(place[0] ** 2 + place[1] ** 2) / width ** 2)
    return ndimage.gaussian_filter(mixture, DIFFUSION / spacing), height


def state(mixture: Any, height: Any) -> tuple[Any, Any]:
    """(temperature [K], absorption at 650 nm [1/m]) of a mixture fraction."""
    lean = mixture / STOICHIOMETRIC
    rich = COLDEST_RICH + (1 - COLDEST_RICH) * numpy.clip((1 - mixture) / (1 - STOICHIOMETRIC), 0, 1) ** 2.2
    temperature = AMBIENT + (PEAK - AMBIENT) * numpy.where(lean < 1, lean, rich)
    soot = SOOT * numpy.clip(1 - ((mixture - SOOT_CENTRE) / SOOT_WIDTH) ** 2, 0, None) ** 2
    soot *= 1 - numpy.exp(-(height / SOOT_HEIGHT) ** 2)
    return temperature, 6 * numpy.pi * SOOT_FUNCTION * soot / WAVELENGTH


here = pathlib.Path(__file__).resolve().parent
size = float(sys.argv[1]) / 1000 if len(sys.argv) > 1 else 1e-3
target = pathlib.Path(sys.argv[2] if len(sys.argv) > 2 else here) / "turbulent.vdb"
mixed, heights = mixture_fraction(size, seed=7)
hot, absorbing = state(mixed, heights)
corner = -(mixed.shape[0] - 1) / 2 * size
plenoflame.write_flame(target, plenoflame.flame_from_arrays(hot, absorbing, spacing=size, origin=(corner, corner, size)), half=True)
print(target)
