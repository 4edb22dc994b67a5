"""Sweeps the diameter of the main lens' stop: light against aperture.

    aperture_sweep.py [SCENE.toml] [FOLDER]      writes FOLDER/aperture.png
"""

import pathlib
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
import numpy  # noqa: E402

import plenoflame  # noqa: E402

here = pathlib.Path(__file__).resolve().parent
scene = plenoflame.Scene(sys.argv[1] if len(sys.argv) > 1 else here.parent / "lenslets-30.toml")
folder = pathlib.Path(sys.argv[2] if len(sys.argv) > 2 else ".")

count = scene.list_size("camera.lens.surfaces")
stop = next(i for i in range(count) if scene[f"camera.lens.surfaces[{i}].stop"])
full = 1e3 * float(scene[f"camera.lens.surfaces[{stop}].diameter"])  # mm
diameters = full * numpy.linspace(0.2, 1, 9)
sums = []
for diameter in diameters:
    changed = scene.copy()
    changed[f"camera.lens.surfaces[{stop}].diameter"] = f"{diameter} mm"
    sums.append(changed.render(samples=4).flux.sum(dtype=float))
fluxes = numpy.array(sums)

figure, axis = plt.subplots(figsize=(6, 4.2), layout="constrained")
axis.plot(diameters, fluxes * 1e6, "o-", label="rendered")
axis.plot(diameters, fluxes[0] * (diameters / diameters[0])**2 * 1e6, "--", label="proportional to the stop's area")
axis.set_xlabel("diameter of the stop (mm)")
axis.set_ylabel("flux on the sensor (uW)")
axis.legend()
figure.savefig(folder / "aperture.png", dpi=110)
print(folder / "aperture.png")
