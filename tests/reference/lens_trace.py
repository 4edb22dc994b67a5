#!/usr/bin/env python3
"""Writes lens_trace.h: skew rays through lenses in 50-digit arithmetic (mpmath).

The method is the textbook one and shares nothing with the library: the quadratic of ray and sphere,
then Snell's law with the normal split off. Every input is a double, taken exactly.
    python3 lens_trace.py > lens_trace.h
"""
from mpmath import mp, mpf, sqrt

mp.dps = 50
INF = float("inf")

# (radius, thickness, index behind, diameter), from the scene to the sensor; lengths in metres.
SYSTEMS = {
    "singlet": [(0.3, 0.02426, 1.5, 0.12), (-0.3, 0, 1, 0.12)],
    "double_gauss": [
        (0.05620238, 0.00875, 1.622292, 0.06), (0.15228580, 0.0005, 1, 0.06),
        (0.03768262, 0.0125, 1.607379, 0.05), (INF, 0.0038, 1.603417, 0.05),
        (0.02423130, 0.016369445, 1, 0.04), (INF, 0.013747957, 1, 0.04),
        (-0.02837731, 0.0038, 1.603417, 0.04), (INF, 0.011, 1.620408, 0.05),
        (-0.03792546, 0.0005, 1, 0.05), (0.17741176, 0.007, 1.620408, 0.06),
        (-0.07941143, 0, 1, 0.06)],
    "microlens": [(2.25e-4, 5e-5, 1.59, 1e-4), (-2.25e-4, 0, 1, 1e-4)],
    "hemisphere": [(0.01, 0.01, 1.5, 0.02), (INF, 0, 1, 0.02)],
    "ball_10um": [(1e-5, 2e-5, 1.33, 1.9e-5), (-1e-5, 0, 1, 1.9e-5)],
    "radius_1km": [(1000.0, 0.01, 1.5, 0.2), (-1000.0, 0, 1, 0.2)],
    "index_step": [(0.05, 0.01, 1 + 1e-9, 0.04), (-0.05, 0, 1, 0.04)],
    "window": [(INF, 0.01, 1.7, 0.1), (INF, 0, 1, 0.1)],
}

# Origin and direction towards the sensor (-z) in units of the first clear radius; the z of the
# origin in units of the clear radius in front of the first vertex.
RAYS = [((0.1, 0.0, 3.0), (0.0, 0.0, -1.0)), ((0.3, -0.2, 2.0), (-0.02, 0.05, -1.0)),
        ((-0.5, 0.35, 1.0), (0.1, -0.15, -1.0)), ((0.0, 0.62, 5.0), (0.03, -0.01, -1.0))]


def exact(value):
    return None if value in (INF, -INF) else mpf(value)


def trace(surfaces, origin, direction):
    p = [mpf(v) for v in origin]
    d = [mpf(v) for v in direction]
    norm = sqrt(sum(v * v for v in d))
    d = [v / norm for v in d]
    vertex, before = mpf(0), mpf(1)
    for radius, thickness, index, diameter in surfaces:
        index = mpf(index)
        radius = exact(radius)
        if radius is None:
            t = (vertex - p[2]) / d[2]
            p = [p[k] + t * d[k] for k in range(3)]
            normal = [mpf(0), mpf(0), mpf(1)]
        else:
            # radius > 0: the centre lies on the sensor's side, at lower z.
            centre = [mpf(0), mpf(0), vertex - radius]
            o = [p[k] - centre[k] for k in range(3)]
            b = sum(o[k] * d[k] for k in range(3))
            c = sum(v * v for v in o) - radius * radius
            root = sqrt(b * b - c)
            hits = [-b - root, -b + root]
            points = [[p[k] + t * d[k] for k in range(3)] for t in hits]
            p = min(points, key=lambda q: abs(q[2] - vertex))  # the cap at the vertex
            normal = [(p[k] - centre[k]) / radius for k in range(3)]  # towards the scene
        assert p[0] ** 2 + p[1] ** 2 < (mpf(diameter) / 2) ** 2, "ray outside the clear diameter"
        cosine = -sum(d[k] * normal[k] for k in range(3))
        ratio = before / index
        across = [ratio * (d[k] + cosine * normal[k]) for k in range(3)]
        rest = 1 - sum(v * v for v in across)
        assert rest > 0, "total internal reflection"
        d = [across[k] - sqrt(rest) * normal[k] for k in range(3)]
        vertex -= mpf(thickness)
        before = index
    return p, d


def number(value):
    return "kInfinity" if value == INF else "-kInfinity" if value == -INF else repr(float(value))


def main():
    print("// Skew rays through lenses in 50-digit arithmetic, rounded to double.")
    print("// Made by lens_trace.py; do not edit.")
    print("#pragma once\n#include <vector>\n\n#include \"plenoflame/scene/scene.h\"\n")
    print("namespace plenoflame::test {\n")
    print("/// A ray towards the sensor, before the first and behind the last surface.")
    print("struct TracedRay {\n  Vec3 origin, direction;  ///< not normalised\n"
          "  Vec3 exit_point, exit_direction;\n};\n")
    print("struct TracedSystem {\n  const char* name;\n  std::vector<SurfaceSpec> surfaces;\n"
          "  std::vector<TracedRay> rays;\n};\n")
    print("inline std::vector<TracedSystem> traced_systems() {\n  return {")
    for name, surfaces in SYSTEMS.items():
        print(f"      {{\"{name}\",\n       {{")
        for radius, thickness, index, diameter in surfaces:
            print(f"           {{{number(radius)}, {number(thickness)}, {number(index)}, "
                  f"{number(diameter)}, false}},")
        print("       },\n       {")
        scale = min(s[3] for s in surfaces) / 2
        for origin, direction in RAYS:
            start = [float(scale * v) for v in origin]
            p, d = trace(surfaces, start, direction)
            rows = [start, direction, [float(v) for v in p], [float(v) for v in d]]
            print("           {" + ",\n            ".join(
                "{" + ", ".join(number(v) for v in row) + "}" for row in rows) + "},")
        print("       }},")
    print("  };\n}\n\n}  // namespace plenoflame::test")


if __name__ == "__main__":
    main()
