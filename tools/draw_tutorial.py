#!/usr/bin/python3
"""Draws docs/images/tutorial-found.png: the temperatures that step 8 of docs/user/tutorial.md finds, beside the true ones.

    tools/draw_tutorial.py [FOLDER]     light field and result stay in FOLDER (out/tutorial) and are used again

Needs what drawing.py says.
"""

from drawing import candle_case, save

import matplotlib.pyplot as plt
import numpy
from draw_reconstruction import emission_of, panel, slice_of

FOOT = (0.3, 0, -0.016)  # of the flame in the scene [m]


def main():
    folder = candle_case("tutorial", "tutorial", {
        "flame.exr": "render examples/tutorial.toml --samples 128 --truth --quiet -o flame.exr",
        "measured.exr": "develop flame.exr --sensor -o measured.exr",
        "found.vdb": "reconstruct examples/tutorial.toml --images measured.exr --unknowns rings --grid 12,24 --absorption scene "
                     "--quiet -o found.vdb"})
    truth = folder / "examples/candle.vdb"
    true = slice_of(truth, "temperature")
    emission = emission_of(true, slice_of(truth, "absorption"))
    found, deviation = (slice_of(folder / "found.vdb", name, FOOT) for name in ("temperature", "temperature_deviation"))
    lit = (emission > 0.1 * emission.max()) & (found > 0)
    true, found, deviation = (numpy.where(lit, values, numpy.nan) for values in (true, found, deviation))
    low, high = 50 * numpy.floor(numpy.nanmin(true) / 50), numpy.nanmax(true)
    reach = numpy.nanquantile(numpy.abs(found - true), 0.99)
    plt.rcParams.update({"font.family": "DejaVu Sans", "font.size": 11, "axes.titlesize": 12})
    figure, axes = plt.subplots(1, 4, figsize=(7.5, 6.4), layout="constrained", sharey=True)
    axes[0].set_ylabel("z (mm)")
    panel(figure, axes[0], true, "true", "temperature (K)", cmap="magma", vmin=low, vmax=high)
    panel(figure, axes[1], found, "found", "temperature (K)", cmap="magma", vmin=low, vmax=high)
    panel(figure, axes[2], found - true, "found - true", "difference (K)", cmap="RdBu_r", vmin=-reach, vmax=reach)
    panel(figure, axes[3], deviation, "stated", "deviation (K)", cmap="viridis", vmin=0, vmax=reach)
    save(figure, "tutorial-found.png", 150)


if __name__ == "__main__":
    main()
