"""Writes flame.vti, a VTK image with the arrays T [K] and soot (volume fraction), for docs/user/temperatures.md."""

import math
n, size = 41, 40e-3                                  # points along each side, metres
points = [(x, y, z) for z in range(n) for y in range(n) for x in range(n)]   # x runs fastest
def fields(x, y, z):
    r = size * math.hypot(x - 20, y - 20) / (n - 1)
    soot = 2e-6 * math.exp(-((r - 5e-3) / 2e-3) ** 2) * math.exp(-((z - 20) / 12) ** 2)
    return 300 + 1400 * math.exp(-(r / 9e-3) ** 2), soot
T, f = zip(*(fields(*p) for p in points))
array = '<DataArray type="Float64" Name="%s" format="ascii">%s</DataArray>'
with open("flame.vti", "w") as file:
    file.write('<VTKFile type="ImageData" version="0.1"><ImageData WholeExtent="0 40 0 40 0 40" Origin="-0.02 -0.02 0" '
               'Spacing="1e-3 1e-3 1e-3"><Piece Extent="0 40 0 40 0 40"><PointData>')
    for name, values in (("T", T), ("soot", f)):
        file.write(array % (name, " ".join(map(str, values))))
    file.write("</PointData></Piece></ImageData></VTKFile>")
