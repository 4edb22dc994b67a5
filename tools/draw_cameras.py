#!/usr/bin/python3
"""Draws docs/images/reconstruction-cameras.png: a turbulent flame and what one, three and six cameras find of it.

    tools/draw_cameras.py [FOLDER]     pictures and results stay in FOLDER (out/cameras) and are used again

The flame is that of examples/python/turbulent_flame.py, as small as the cameras' field of view, smoothed to their resolution, with
little soot, so that it hides nothing of itself. The cameras are those of examples/ring-of-six.toml with a sensor of 20000 electrons.
Needs what drawing.py says.
"""

import json
import re

from draw_reconstruction import emission_of
from drawing import ROOT, make, save, turbulent_flame, working_folder

import matplotlib.pyplot as plt
import numpy
import plenoflame
from scipy import ndimage
from scipy.interpolate import RegularGridInterpolator

CAMERAS = {1: ("at0",), 3: ("at0", "at60", "at120"), 6: ("at0", "at60", "at120", "at210", "at270", "at330")}
SMOOTHING, STEP = 0.008, 0.002          # [m] standard deviation and voxels of the flame, before it is made smaller
SCALE, FOOT, SOOT = 0.14, -0.02, 0.02   # of the flame in the scene: size, lower end [m], share of its soot
VOXELS = 32                             # of the reconstruction, along the height
HALF, TOP = 11, 20                      # width, depth and height shown, from the middle [mm]
HEIGHTS = (8, 0, -8)                    # of the slices [mm]
TURN = 45                               # [degrees] direction of the rendering, between those of two cameras


def flame(folder):
    """Writes the smoothed flame: soot, and the temperature of the soot."""
    if (folder / "smooth.vdb").exists():
        return
    fields, spacing, origin, _ = plenoflame.flame_arrays(plenoflame.read_flame(turbulent_flame(ROOT / "out/overview")))
    width, stride = SMOOTHING / spacing[0], round(STEP / spacing[0])
    soot = ndimage.gaussian_filter(fields["absorption"], width)
    hot = ndimage.gaussian_filter(fields["absorption"] * fields["temperature"], width) / numpy.maximum(soot, 1e-6)
    some = (slice(None, None, stride),) * 3
    lit = soot[some] > 0.01
    made = plenoflame.flame_from_arrays(numpy.where(lit, hot[some], 293), numpy.where(lit, SOOT * soot[some], 0), spacing=STEP, origin=origin)
    plenoflame.write_flame(folder / "smooth.vdb", made)


def field(path, grid):
    """An interpolator of one grid, at places in mm, which is 0 outside of it."""
    arrays, spacing, origin, _ = plenoflame.flame_arrays(plenoflame.read_flame(path, grid=grid))
    (values,) = arrays.values()
    axes = [1e3 * (origin[k] + spacing[k] * numpy.arange(values.shape[k])) for k in range(3)]
    return RegularGridInterpolator(axes, numpy.asarray(values, float), bounds_error=False, fill_value=0)


def computed(folder):
    """Renders and reconstructs; {cameras: relative error of the emission}."""
    flame(folder)
    text = (ROOT / "examples/ring-of-six.toml").read_text(encoding="utf-8")
    text = text.replace('pixel_pitch = "100 um"', 'pixel_pitch = "100 um"\nfull_well = 20000\nread_noise = 8')
    text = re.sub(r'preset = "paper-layered"\nposition = .*',
                  f'kind = "vdb"\nfile = "smooth.vdb"\nscale = {SCALE}\nposition = ["0 m", "0 m", "{FOOT} m"]', text)
    (folder / "six.toml").write_text(text, encoding="utf-8")
    make(folder, {"x-at0.exr": "render six.toml --samples 512 --seed 99 --quiet -o x.exr"} |
         {f"{name}.exr": f"develop x-{name}.exr --sensor -o {name}.exr" for name in CAMERAS[6]} |
         {f"{count}.vdb": "reconstruct six.toml " + "".join(f"--camera {name} " for name in names) + "--images " +
                          "".join(f"{name}.exr " for name in names) + f"--grid {VOXELS} --rays 32 --draws 8 --probes 0 --truth --quiet "
                          f"--report {count}.json -o {count}.vdb" for count, names in CAMERAS.items()})
    return {count: json.loads((folder / f"{count}.json").read_text())["truth_emission_error"] for count in CAMERAS}


def truth(folder):
    """The emission [W/(m^3 sr)] at places of the scene in mm."""
    temperature, absorption = (field(folder / "smooth.vdb", grid) for grid in ("temperature", "absorption"))

    def emission(places):
        here = (numpy.asarray(places) - (0, 0, 1e3 * FOOT)) / SCALE
        return emission_of(temperature(here), absorption(here))
    return emission


def rendering(emission):
    """Radiance [W/(m^2 sr)] of parallel rays through the flame, rows upwards, and its extent [mm]."""
    side, height = numpy.linspace(-HALF, HALF, 89), numpy.linspace(-TOP, TOP, 161)
    across, depth = numpy.meshgrid(side, side, indexing="ij")
    c, s = numpy.cos(numpy.radians(TURN)), numpy.sin(numpy.radians(TURN))
    x, y = numpy.broadcast_arrays((c * depth - s * across)[None], (s * depth + c * across)[None])
    z = numpy.broadcast_to(height[:, None, None], (len(height), *across.shape))
    x, y = (numpy.broadcast_to(a, z.shape) for a in (x, y))
    return emission(numpy.stack([x, y, z], -1)).sum(2) * 1e-3 * (side[1] - side[0]), (-HALF, HALF, -TOP, TOP)


def slice_at(emission, height):
    side = numpy.linspace(-HALF, HALF, 89)
    x, y = numpy.meshgrid(side, side, indexing="xy")
    return emission(numpy.stack([x, y, numpy.full_like(x, height)], -1))


def named(count):
    return f"{count} camera" + ("s" if count > 1 else "")


def bar(figure, shown, axes, label):
    figure.colorbar(shown, ax=axes, location="bottom", label=label, aspect=30, shrink=0.9, pad=0.02)


def draw_renderings(figure, sources, errors):
    """The flame from a direction that no camera has, and the error against the number of cameras."""
    axes = figure.subplots(1, 5, width_ratios=(1, 1, 1, 1, 2.7))
    pictures = [rendering(source) for source in sources.values()]
    for place, name, (picture, extent) in zip(axes, sources, pictures):
        shown = place.imshow(picture, extent=extent, origin="lower", cmap="inferno", vmin=0, vmax=pictures[0][0].max())
        place.set_title(name)
        place.set_xlabel("across (mm)")
        place.set_xticks((-8, 0, 8))
        place.set_yticks((-16, -8, 0, 8, 16), labels=None if place is axes[0] else [])
    axes[0].set_ylabel("z (mm)")
    figure.colorbar(shown, ax=axes[3], location="right", aspect=25, shrink=0.8).ax.set_title("radiance\n(W/(m$^2$ sr))", fontsize=10)
    plot = axes[4]
    plot.plot(errors.keys(), [100 * error for error in errors.values()], "o-", color="#0072b2")
    for count, error in errors.items():
        plot.annotate(f"{100 * error:.0f} %", (count, 100 * error), xytext=(8, 6), textcoords="offset points")
    plot.set_title("error of the emission, 2-norm (%)")
    plot.set_xlabel("cameras")
    plot.set_xlim(0.5, 6.7)
    plot.set_ylim(0, 115 * max(errors.values()))
    plot.set_xticks(range(1, 7))
    plot.grid(color="#e0e0e0", linewidth=0.7)
    plot.spines[["top", "right"]].set_visible(False)


def draw_slices(figure, true, found, deviations):
    """Rows are heights; columns are the truth and, for each number of cameras, result, error and deviation."""
    axes = figure.subplots(len(HEIGHTS), 1 + 3 * len(CAMERAS), sharex=True, sharey=True)
    brightest = max(slice_at(true, height).max() for height in HEIGHTS)
    widest = max(slice_at(deviation, height).max() for deviation in deviations.values() for height in HEIGHTS)
    for row, height in zip(axes, HEIGHTS):
        real = slice_at(true, height)
        panels = [(real, "values")]
        for count in CAMERAS:
            value = slice_at(found[count], height)
            panels += [(value, "values"), (value - real, "errors"), (slice_at(deviations[count], height), "deviations")]
        looks = {"values": {"cmap": "inferno", "vmin": 0, "vmax": brightest},
                 "errors": {"cmap": "RdBu_r", "vmin": -brightest / 2, "vmax": brightest / 2},
                 "deviations": {"cmap": "viridis", "vmin": 0, "vmax": widest}}
        shown = {}
        for place, (values, look) in zip(row, panels):
            shown[look] = place.imshow(values, extent=(-HALF, HALF, -HALF, HALF), origin="lower", **looks[look])
            place.set_xticks((-8, 0, 8))
            place.set_yticks((-8, 0, 8))
        row[0].set_ylabel(f"z = {height} mm\ny (mm)")
    for place, title in zip(axes[0], ["true"] + [words for count in CAMERAS for words in (named(count), "error", "standard\ndeviation")]):
        place.set_title(title)
    for place in axes[-1]:
        place.set_xlabel("x (mm)")
    bar(figure, shown["values"], axes[:, :4], "emission (W/(m$^3$ sr))")
    bar(figure, shown["errors"], axes[:, 4:7], "error (W/(m$^3$ sr))")
    bar(figure, shown["deviations"], axes[:, 7:], "standard deviation (W/(m$^3$ sr))")


def main():
    folder = working_folder("cameras")
    errors = computed(folder)
    true = truth(folder)
    found = {count: field(folder / f"{count}.vdb", "emission") for count in CAMERAS}
    deviations = {count: field(folder / f"{count}.vdb", "emission_deviation") for count in CAMERAS}
    plt.rcParams.update({"font.family": "DejaVu Sans", "font.size": 11, "axes.titlesize": 12})
    figure = plt.figure(figsize=(15, 11), layout="constrained")
    upper, lower = figure.subfigures(2, 1, height_ratios=(1, 1.15))
    draw_renderings(upper, {"true": true} | {named(count): found[count] for count in CAMERAS}, errors)
    draw_slices(lower, true, found, deviations)
    save(figure, "reconstruction-cameras.png", 89)


if __name__ == "__main__":
    main()
