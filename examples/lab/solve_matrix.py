"""Solves A.npz of `plenoflame operator` for the emissions and writes them as a narrow line of found.vdb (docs/user/operators.md)."""

import numpy, plenoflame, scipy.sparse, scipy.sparse.linalg

A = scipy.sparse.load_npz("A.npz").astype(float)
rows = numpy.genfromtxt("rows.csv", delimiter=",", names=True, dtype=None, encoding="utf-8")
places = numpy.loadtxt("columns.csv", delimiter=",", skiprows=1)[:, 1:4]
y = plenoflame.read_light_field("front.exr").flux[rows["line"], rows["column"]]
unit = abs(A).sum() / A.shape[1]                          # fluxes are 1e-12 W: solvers want numbers about 1
x = scipy.sparse.linalg.lsqr(A / unit, y / y.max(), damp=0.05)[0] * y.max() / unit

steps = [numpy.unique(places[:, axis].round(9)) for axis in range(3)]
glow = 4 * numpy.pi * numpy.maximum(x, 0).reshape([len(s) for s in steps])   # W/m^3
flame = plenoflame.flame_from_arrays(300 + 0 * glow, 0 * glow, spacing=[s[1] - s[0] for s in steps], origin=places[0], **{"CH*": glow})
plenoflame.write_flame("found.vdb", flame)                # a channel about 431 nm, with lines = ["ch"], sees it
