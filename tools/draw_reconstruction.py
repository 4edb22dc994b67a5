#!/usr/bin/python3
"""Draws docs/images/reconstruction-slices.png: the truth, what one camera finds of it, the error, and the stated deviation.

    tools/draw_reconstruction.py [FOLDER]     the light field and the result stay in FOLDER (out/reconstruction) and are used again

The case is the R29 of docs/reconstruct.md: a candle, one picture with the sensor's noise, rings around the axis. The true emission
is absorption times Planck's function over the channel. Needs what drawing.py says.
"""

from drawing import candle_case, save

import matplotlib.pyplot as plt
import numpy
import plenoflame
from scipy.interpolate import RegularGridInterpolator

FOOT = (1, 0, -0.016)             # of the flame in the scene [m]
BAND = (645e-9, 655e-9)           # of the channel [m]
X, Z = numpy.linspace(-5, 5, 101), numpy.linspace(-0.5, 32.5, 331)  # of the slice, from the foot [mm]


def slice_of(path, grid, foot=(0, 0, 0)):
    """A grid on the plane through the flame's axis, rows upwards."""
    (values,), spacing, origin, _ = (part if k else part.values()
                                     for k, part in enumerate(plenoflame.flame_arrays(plenoflame.read_flame(path, grid=grid))))
    axes = [origin[k] - foot[k] + spacing[k] * numpy.arange(values.shape[k]) for k in range(3)]
    sample = RegularGridInterpolator(axes, numpy.asarray(values, float), bounds_error=False, fill_value=0)
    z, y = numpy.meshgrid(Z / 1e3, X / 1e3, indexing="ij")
    return sample(numpy.stack([numpy.zeros_like(y), y, z], -1))


def emission_of(temperature, absorption):
    """Emission into the channel [W/(m^3 sr)]."""
    total = 0
    for wavelength in numpy.linspace(*BAND, 11):
        total = total + 1.191043e-16 / wavelength ** 5 / numpy.expm1(1.438777e-2 / wavelength / numpy.maximum(temperature, 290))
    return absorption * total / 11 * (BAND[1] - BAND[0])


def panel(figure, axes, values, title, unit, **options):
    axes.set_facecolor("#808080")
    shown = axes.imshow(values, extent=(X[0], X[-1], Z[0], Z[-1]), origin="lower", interpolation="nearest", **options)
    axes.set_title(title)
    axes.set_xlabel("y (mm)")
    axes.set_xticks((-4, 0, 4))
    bar = figure.colorbar(shown, ax=axes, location="bottom", pad=0.015, aspect=12, label=unit)
    bar.ax.locator_params(nbins=3)


def main():
    folder = candle_case("reconstruction", "candle-r29", {
        "r29.exr": "render examples/candle-r29.toml --samples 128 --quiet -o r29.exr",
        "r29-electrons.exr": "develop r29.exr --sensor -o r29-electrons.exr",
        "r29.vdb": "reconstruct examples/candle-r29.toml --images r29-electrons.exr --unknowns rings --bin 4 --rays 8 "
                   "--absorption scene --quiet -o r29.vdb"})
    truth, result = folder / "examples/candle.vdb", folder / "r29.vdb"
    temperature = slice_of(truth, "temperature")
    emission = emission_of(temperature, slice_of(truth, "absorption"))
    found = {name: slice_of(result, name, FOOT) for name in
             ("emission", "emission_deviation", "temperature", "temperature_deviation")}
    plt.rcParams.update({"font.family": "DejaVu Sans", "font.size": 11, "axes.titlesize": 12})
    figure, axes = plt.subplots(1, 8, figsize=(14, 6.9), layout="constrained", sharey=True)
    axes[0].set_ylabel("z (mm)")
    rows = ((emission, found["emission"], found["emission_deviation"], "emission", "W/(m$^3$ sr)", "inferno"),
            (temperature, found["temperature"], found["temperature_deviation"], "temperature", "K", "magma"))
    bright = emission > 0.1 * emission.max()
    for (true, back, deviation, name, unit, colours), line in zip(rows, (axes[:4], axes[4:])):
        mask = bright if name == "temperature" else numpy.ones_like(bright)
        mask = mask & (back > 0)
        true, back, deviation = (numpy.where(mask, a, numpy.nan) for a in (true, back, deviation))
        low = 0 if name == "emission" else 50 * numpy.floor(numpy.nanmin(true) / 50)
        scale = {"vmin": low, "vmax": numpy.nanmax(true), "cmap": colours}
        panel(figure, line[0], true, f"{name}:\ntrue", unit, **scale)
        panel(figure, line[1], back, "\nreconstructed", unit, **scale)
        reach = numpy.nanpercentile(numpy.abs(back - true), 99.5)
        panel(figure, line[2], back - true, "\ndifference", unit, cmap="RdBu_r", vmin=-reach, vmax=reach)
        panel(figure, line[3], deviation, "\nstated deviation", unit, cmap="viridis", vmin=0, vmax=numpy.nanpercentile(deviation, 99.5))
    save(figure, "reconstruction-slices.png", 122)


if __name__ == "__main__":
    main()
