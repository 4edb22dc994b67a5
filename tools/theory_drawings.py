#!/usr/bin/python3
"""Makes the drawings of docs/theory: docs/images/theory-*.png. From the formulas of the chapters, not to scale.

    tools/theory_drawings.py            needs matplotlib and SciPy (Debian: python3-matplotlib, python3-scipy)
"""

import math
import pathlib
import random

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402  (the backend comes first)
import scipy.stats  # noqa: E402

IMAGES = pathlib.Path(__file__).resolve().parent.parent / "docs" / "images"
INK, OPEN, CUT = "#222222", "#2a6fb0", "#c0392b"


def plain(axes):
    axes.set_aspect("equal")
    axes.axis("off")


def arrow(axes, a, b, text, offset=(0, 0)):
    axes.annotate("", xy=b, xytext=a, arrowprops={"arrowstyle": "<->", "color": INK, "lw": 0.8})
    axes.text((a[0] + b[0]) / 2 + offset[0], (a[1] + b[1]) / 2 + offset[1], text, ha="center", va="bottom", fontsize=9)


def side_view(axes):
    """Sensor, microlens and exit pupil in the plane through both axes: the image s of the stop through a height u."""
    distance, pupil, focal, radius, height = 2.0, 7.0, 2.6, 1.7, 1.0
    half = 0.9
    axes.plot([-distance, -distance], [-1.8, 2.2], color=INK, lw=2)
    axes.text(-distance, 2.35, "sensor", ha="center", fontsize=9)
    edge = [half * k / 20 for k in range(-20, 21)]
    for side in (1, -1):
        axes.plot([side * 0.12 * (1 - (u / half) ** 2) for u in edge], edge, color=INK, lw=1.2)
    axes.text(0, 1.05, "microlens", ha="center", fontsize=9)
    axes.plot([pupil, pupil], [-height + radius, 2.2], color=INK, lw=3)
    axes.plot([pupil, pupil], [-3.2, -height - radius], color=INK, lw=3)
    axes.text(pupil, 2.35, "exit pupil, radius r", ha="center", fontsize=9)
    axes.plot([-distance - 0.4, pupil + 0.4], [0, 0], color=INK, lw=0.6, ls="-.")
    axes.plot([pupil - 0.3, pupil + 0.3], [-height, -height], color=INK, lw=0.6, ls="-.")
    axes.plot([pupil + 0.25, pupil + 0.25], [0, -height], color=INK, lw=0.8)
    axes.text(pupil + 0.35, -height / 2, "h", fontsize=9, va="center")
    k = distance / focal - 1 - distance / pupil
    for u, colour in ((0.55, OPEN), (-0.55, CUT)):
        for end in (-1, 1):
            # |s - (B h/z - k u)| = r B/z: the ray through u that meets the rim of the pupil
            s = distance * height / pupil - k * u + end * radius * distance / pupil
            there = u + pupil * ((u - s) / distance - u / focal)
            axes.plot([-distance, 0, pupil], [s, u, there], color=colour, lw=1)
        axes.text(0.2, u, "u", color=colour, fontsize=9)
        axes.text(-distance - 0.1, distance * height / pupil - k * u, "s", color=colour, fontsize=9, ha="right")
    arrow(axes, (-distance, -2.1), (0, -2.1), "B", (0, 0.03))
    arrow(axes, (0, -2.1), (pupil, -2.1), "z", (0, 0.03))
    axes.set_title("Through each u the stop is a disc on the sensor", fontsize=10)
    plain(axes)


def outline(axes):
    """The aperture as a sensor point sees it: what low, high and the two circles bound."""
    aperture, stop, shift = 1.0, 1.15, 0.75
    turn = [2 * math.pi * i / 400 for i in range(401)]
    axes.plot([aperture * math.cos(t) for t in turn], [aperture * math.sin(t) for t in turn], color=INK, lw=1)
    axes.plot([shift + stop * math.cos(t) for t in turn], [stop * math.sin(t) for t in turn], color=CUT, lw=1)
    across = [[], [], []]
    low, high = shift - stop, aperture
    for i in range(301):
        p = low + (high - low) * i / 300
        q = min(math.sqrt(max(0, aperture ** 2 - p ** 2)), math.sqrt(max(0, stop ** 2 - (p - shift) ** 2)))
        across[0].append(p)
        across[1].append(q)
        across[2].append(-q)
    axes.fill_between(*across, color=OPEN, alpha=0.25, lw=0)
    axes.plot([-1.3, 2.1], [0, 0], color=INK, lw=0.6, ls="-.")
    for p, name, where in ((low, "low", "right"), (high, "high", "left")):
        axes.plot([p], [0], "o", color=INK, ms=3)
        axes.text(p + (0.05 if where == "left" else -0.05), 0.06, name, fontsize=9, ha=where)
    middle = (low + high) / 2
    axes.plot([middle], [0], "+", color=INK)
    axes.text(middle - 0.04, -0.18, "c", fontsize=9)
    phi = 0.9
    reach = next(r for r in (0.001 * i for i in range(3000))
                 if (middle + r * math.cos(phi)) ** 2 + (r * math.sin(phi)) ** 2 >= aperture ** 2
                 or (middle + r * math.cos(phi) - shift) ** 2 + (r * math.sin(phi)) ** 2 >= stop ** 2)
    edge = middle + reach * math.cos(phi), reach * math.sin(phi)
    axes.annotate("", xy=edge, xytext=(middle, 0), arrowprops={"arrowstyle": "->", "color": OPEN, "lw": 1.2})
    axes.text(edge[0] + 0.06, edge[1] + 0.02, r"$c+\rho v$", fontsize=9, color=OPEN)
    axes.text(-1.02, 0.75, "aperture", fontsize=9, ha="right", color=INK)
    axes.text(1.65, 0.95, "stop", fontsize=9, color=CUT)
    axes.text(2.1, -0.16, "p", fontsize=9, ha="right")
    axes.set_title("Open aim points (blue) of one sensor point", fontsize=10)
    plain(axes)


def pupil_drawing():
    figure, (left, right) = plt.subplots(1, 2, figsize=(11, 4), width_ratios=(1.5, 1))
    side_view(left)
    outline(right)
    figure.tight_layout()
    figure.savefig(IMAGES / "theory-pupil.png", dpi=150, metadata={"Software": None})
    plt.close(figure)


def interval_drawing():
    """A ray through cells of a grid: intervals between faces, two Gauss nodes in each."""
    figure, axes = plt.subplots(figsize=(7, 3.2))
    for i in range(6):
        axes.plot([i, i], [0, 2], color="#aaaaaa", lw=0.8)
    for j in range(3):
        axes.plot([0, 5], [j, j], color="#aaaaaa", lw=0.8)
    start, end = (-0.4, 0.25), (5.4, 1.85)
    at = lambda t: tuple(a + t * (b - a) for a, b in zip(start, end))  # noqa: E731
    axes.plot(*zip(at(0), at(1)), color=OPEN, lw=1.2)
    faces = sorted([(x - start[0]) / (end[0] - start[0]) for x in range(6)] +
                   [(y - start[1]) / (end[1] - start[1]) for y in (1,)])
    for a, b in zip(faces, faces[1:]):
        for sign in (-1, 1):
            axes.plot(*at((a + b) / 2 + sign * (b - a) / (2 * math.sqrt(3))), "o", color=CUT, ms=3.5)
    for t in faces:
        axes.plot(*at(t), "|", color=INK, ms=9)
    axes.text(-0.5, 0.2, "camera", fontsize=9, ha="right")
    axes.text(2.5, 2.1, "intervals end at faces of cells; two nodes (red) in each", fontsize=9, ha="center")
    plain(axes)
    figure.tight_layout()
    figure.savefig(IMAGES / "theory-interval.png", dpi=150, metadata={"Software": None})
    plt.close(figure)


def save(figure, name):
    figure.tight_layout()
    figure.savefig(IMAGES / f"theory-{name}.png", dpi=150, metadata={"Software": None})
    plt.close(figure)


def cardinal_drawing():
    """A lens of two surfaces: focal points, principal planes and the distances of first-order optics, from its matrix."""
    n, thickness, front, back, height = 1.5, 1.6, 3.2, -3.2, 1.1
    matrix = [[1.0, 0.0], [0.0, 1.0]]
    for step in ([[1, 0], [-(n - 1) / front, 1]], [[1, thickness / n], [0, 1]], [[1, 0], [-(1 - n) / back, 1]]):
        matrix = [[sum(step[i][k] * matrix[k][j] for k in range(2)) for j in range(2)] for i in range(2)]
    (a, _), (c, d) = matrix
    efl, bfl, ffl = -1 / c, -a / c, d / c
    first, second = (d - 1) / c, thickness + (1 - a) / c
    figure, axes = plt.subplots(figsize=(8.5, 3.4))
    heights = [-1.4 + 2.8 * k / 40 for k in range(41)]
    axes.plot([front - math.sqrt(front ** 2 - y ** 2) for y in heights], heights, color=INK, lw=1.2)
    axes.plot([thickness - (front - math.sqrt(front ** 2 - y ** 2)) for y in heights], heights, color=INK, lw=1.2)
    axes.plot([ffl - 0.6, thickness + bfl + 0.8], [0, 0], color=INK, lw=0.6, ls="-.")
    for x, name in ((first, "H"), (second, "H'")):
        axes.plot([x, x], [-1.5, 1.5], color="#888888", lw=0.8, ls="--")
        axes.text(x, 1.55, name, ha="center", fontsize=9)
    axes.plot([ffl - 0.4, second, thickness + bfl], [height, height, 0], color=OPEN, lw=1)
    axes.plot([ffl, first, thickness + bfl + 0.6], [0, -height, -height], color=CUT, lw=1)
    for x, name in ((ffl, "F"), (thickness + bfl, "F'")):
        axes.plot([x], [0], "o", color=INK, ms=3)
        axes.text(x, 0.12, name, ha="center", fontsize=9)
    arrow(axes, (second, -1.75), (thickness + bfl, -1.75), "EFL = -1/c", (0, 0.02))
    arrow(axes, (thickness, -2.3), (thickness + bfl, -2.3), "BFL = -a/c", (0, 0.02))
    arrow(axes, (ffl, -2.3), (0, -2.3), "-FFL = -d/c", (0, 0.02))
    axes.text(ffl - 0.4, height + 0.08, "from the scene", fontsize=8, color=OPEN)
    axes.set_ylim(-2.6, 1.9)
    plain(axes)
    save(figure, "cardinal")


def measurement_drawing():
    """A pixel and a parallel plane at the distance g: what the measurement equation integrates over."""
    figure, axes = plt.subplots(figsize=(6.5, 3))
    g, s, u = 5.0, -0.7, 0.9
    axes.plot([0, 0], [-1.6, 1.6], color=INK, lw=1.5)
    axes.plot([0, 0], [s - 0.15, s + 0.15], color=CUT, lw=4, solid_capstyle="butt")
    axes.plot([g, g], [-1.6, 1.6], color=INK, lw=0.8, ls="--")
    axes.plot([0, g + 1.6], [s, s + (u - s) * (g + 1.6) / g], color=OPEN, lw=1.2)
    axes.plot([0, 1.9], [s, s], color="#888888", lw=0.7)
    axes.text(1.35, s + 0.1, r"$\theta$", fontsize=9)
    axes.text(-0.15, s, "s", fontsize=10, ha="right", va="center", color=CUT)
    axes.text(g + 0.1, u - 0.22, "u", fontsize=10, color=OPEN)
    axes.text(g + 1.65, s + (u - s) * (g + 1.6) / g, "L(s, u)", fontsize=9, va="center", color=OPEN)
    axes.text(0, 1.7, "sensor", ha="center", fontsize=9)
    axes.text(g, 1.7, "aim plane", ha="center", fontsize=9)
    arrow(axes, (0, -1.5), (g, -1.5), "g", (0, 0.02))
    plain(axes)
    save(figure, "measurement")


def window_drawing():
    """A plate and a tube, refracted by Snell's law; the straight line on which the ray left the camera is dashed."""
    figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.2))
    n, thickness, slope = 1.5, 1.2, math.tan(0.6)
    inside = math.tan(math.asin(math.sin(0.6) / n))
    y = [0, 2 * slope, 2 * slope + thickness * inside, 2 * slope + thickness * inside + 2.2 * slope]
    x = [0, 2, 2 + thickness, 4.2 + thickness]
    left.axvspan(2, 2 + thickness, color="#cfe3f3", lw=0)
    left.plot(x, y, color=OPEN, lw=1.3)
    left.plot([0, x[-1]], [0, x[-1] * slope], color="#888888", lw=0.8, ls="--")
    left.text(0, -0.35, "camera", fontsize=9)
    left.text(2 + thickness / 2, -0.35, "t", fontsize=9, ha="center")
    left.set_title("A plate displaces", fontsize=10)
    left.set_ylim(-0.8, 4.6)
    plain(left)
    outer, inner, b = 2.0, 1.5, 0.9
    turn = [2 * math.pi * k / 200 for k in range(201)]
    right.fill([outer * math.cos(t) for t in turn], [outer * math.sin(t) for t in turn], color="#cfe3f3", lw=0)
    right.fill([inner * math.cos(t) for t in turn], [inner * math.sin(t) for t in turn], color="white", lw=0)
    # b, n b, b: the distance of the line from the axis, times the index, is the same along the ray.
    at, direction, points = [-3.4, b], [1.0, 0.0], []
    points.append(tuple(at))
    for radius, ratio, nearest in ((outer, 1 / n, True), (inner, n, True), (inner, 1 / n, False), (outer, n, False)):
        along = at[0] * direction[0] + at[1] * direction[1]
        root = math.sqrt(along ** 2 - (at[0] ** 2 + at[1] ** 2 - radius ** 2))
        t = -along - root if nearest else -along + root
        at = [at[0] + t * direction[0], at[1] + t * direction[1]]
        points.append(tuple(at))
        side = -1 if nearest else 1
        normal = [side * at[0] / radius, side * at[1] / radius]  # along the ray
        cosine = direction[0] * normal[0] + direction[1] * normal[1]
        if cosine < 0:
            normal, cosine = [-normal[0], -normal[1]], -cosine
        behind = math.sqrt(1 - ratio ** 2 * (1 - cosine ** 2))
        direction = [ratio * e + (behind - ratio * cosine) * m for e, m in zip(direction, normal)]
    points.append((at[0] + 1.6 * direction[0], at[1] + 1.6 * direction[1]))
    right.plot(*zip(*points), color=OPEN, lw=1.3)
    right.plot([-3.4, 3.4], [b, b], color="#888888", lw=0.8, ls="--")
    right.plot([0, 0], [0, b], color=INK, lw=0.8)
    right.plot([0], [0], "+", color=INK)
    right.text(0.08, b / 2, "b", fontsize=9)
    for radius, name, angle in ((inner, "r", -0.9), (outer, "R", -2.2)):
        end = (radius * math.cos(angle), radius * math.sin(angle))
        right.annotate("", xy=end, xytext=(0, 0), arrowprops={"arrowstyle": "->", "color": INK, "lw": 0.8})
        right.text(0.5 * end[0] + 0.2, 0.5 * end[1], name, fontsize=9)
    right.set_title("A tube turns", fontsize=10)
    plain(right)
    save(figure, "window")


def rings_drawing():
    """A ray through rings around an axis, seen along it; one row of the matrix."""
    figure, (left, right) = plt.subplots(1, 2, figsize=(8, 3), width_ratios=(1.2, 1))
    turn = [2 * math.pi * k / 200 for k in range(201)]
    b, count = 0.9, 5
    for k in range(1, count + 1):
        left.plot([k / 2 * math.cos(t) for t in turn], [k / 2 * math.sin(t) for t in turn], color="#aaaaaa", lw=0.8)
    left.plot([-5, 3], [b, b], color=OPEN, lw=1.2)
    lengths = []
    for k in range(1, count + 1):
        outer, inner = (math.sqrt(max(0, (j / 2) ** 2 - b * b)) for j in (k, k - 1))
        lengths.append(2 * (outer - inner))
        for x in ({-outer, outer} if outer else ()):
            left.plot([x], [b], "|", color=INK, ms=9)
    left.text(-5, b + 0.15, "ray r of pixel i", fontsize=9)
    left.set_title("Intervals of a ray in rings j", fontsize=10)
    plain(left)
    right.bar(range(1, count + 1), lengths, color=OPEN)
    right.set_xlabel("ring j", fontsize=9)
    right.set_ylabel("way in the ring", fontsize=9)
    right.set_yticks([])
    right.set_title("its part of row i of A, where nothing absorbs", fontsize=10)
    save(figure, "rings")


def way(axes, a, b, colour, style="-", lw=1.1):
    """A straight way of light from a to b, with its direction in the middle."""
    middle = (0.55 * b[0] + 0.45 * a[0], 0.55 * b[1] + 0.45 * a[1])
    axes.plot([a[0], b[0]], [a[1], b[1]], color=colour, lw=lw, ls=style)
    axes.annotate("", xy=middle, xytext=a, arrowprops={"arrowstyle": "-|>", "color": colour, "lw": 0, "mutation_scale": 11})


def flame_shape(axes, x, y, width, height):
    turn = [math.pi * k / 60 for k in range(121)]
    axes.fill([x + width * math.sin(t) * math.sin(t / 2) for t in turn], [y + height * math.cos(t) for t in turn],
              color="#f5b971", alpha=0.7, lw=0)


def circle(axes, x, y, radius, **style):
    turn = [2 * math.pi * k / 200 for k in range(201)]
    axes.plot([x + radius * math.cos(t) for t in turn], [y + radius * math.sin(t) for t in turn], **style)


def lit_point(axes):
    """The light that a point of a surface sends towards the camera, term by term."""
    p = (0.0, 0.0)
    axes.plot([-3.2, 3.4], [0, 0], color=INK, lw=2)
    axes.fill_between([-3.2, 3.4], -0.22, 0, color="#d9d9d9", lw=0)
    axes.annotate("", xy=(0, 1.3), xytext=p, arrowprops={"arrowstyle": "-|>", "color": INK, "lw": 0.9})
    axes.text(0.07, 1.32, "n", fontsize=9)
    camera, lamp = (-3.6, 2.3), (-1.5, 3.3)
    way(axes, p, camera, OPEN, lw=1.5)
    axes.text(camera[0] - 0.1, camera[1] + 0.08, "camera", fontsize=9, ha="right")
    axes.text(-2.5, 1.12, "$L_o$", fontsize=9, color=OPEN, ha="center")
    axes.plot(*lamp, "*", color=CUT, ms=10)
    axes.text(lamp[0], lamp[1] + 0.2, r"lamp: shadow ray, $I\cos\theta/d^2$", fontsize=8, ha="center")
    way(axes, lamp, p, CUT)
    flame_shape(axes, 1.0, 2.6, 0.5, 0.9)
    end = (1.0 * 1.75, 2.45 * 1.75)
    way(axes, end, p, "#d98324")
    axes.plot([0.84], [2.06], "o", color=INK, ms=3)
    axes.text(1.62, 2.75, "flame: a point gives the direction,\nthe whole line counts", fontsize=8, va="center")
    sky = (4.0, 1.35)
    way(axes, sky, p, "#3f8f4f", "--")
    axes.text(sky[0] + 0.1, sky[1], "next point or surroundings:\nby the cosine", fontsize=8, va="center")
    arc = [0.9 * k / 20 for k in range(21)]
    turn = math.atan2(sky[0], sky[1])
    axes.plot([0.75 * math.sin(turn * a / 0.9) for a in arc], [0.75 * math.cos(turn * a / 0.9) for a in arc], color=INK, lw=0.7)
    axes.text(0.42, 0.78, r"$\theta$", fontsize=8)
    axes.text(-0.05, -0.5, "p", fontsize=9)
    axes.set_title("Light that leaves a point of a surface", fontsize=10)
    plain(axes)


def own_root(axes):
    """A ray that starts on a curved part: the root nearer to 0 is its start."""
    radius, start, direction = 1.3, math.radians(200), math.radians(35)
    circle(axes, 0, 0, radius, color=INK, lw=1.2)
    o = (radius * math.cos(start), radius * math.sin(start))
    d = (math.cos(direction), math.sin(direction))
    far = -2 * (o[0] * d[0] + o[1] * d[1])  # o lies on the circle: t (t + 2 o.d) = 0
    at = lambda t: (o[0] + t * d[0], o[1] + t * d[1])  # noqa: E731
    axes.plot(*zip(at(-0.9), at(0)), color="#888888", lw=0.8, ls="--")
    way(axes, o, at(far), OPEN)
    axes.plot(*zip(at(far), at(far + 0.9)), color="#888888", lw=0.8, ls="--")
    axes.plot(*o, "o", color=CUT, ms=5)
    axes.plot(*at(far), "o", color=OPEN, ms=5)
    axes.text(o[0] - 0.2, o[1] + 0.2, "start: the root nearer to 0\nis ignored", fontsize=8, color=CUT, ha="right", va="bottom")
    axes.text(at(far)[0] + 0.62, at(far)[1] - 0.02, "the other root counts,\neven if it is near", fontsize=8, color=OPEN, va="top")
    foot = (at(far / 2)[0], at(far / 2)[1])
    axes.plot([0, foot[0]], [0, foot[1]], color=INK, lw=0.8)
    axes.plot([0], [0], "+", color=INK)
    axes.text(foot[0] / 2 + 0.08, foot[1] / 2, r"$|o-(o\cdot d)d|$", fontsize=8, va="center")
    axes.set_title("A ray from a curved part", fontsize=10)
    plain(axes)


def surfaces_drawing():
    figure, (left, right) = plt.subplots(1, 2, figsize=(11, 4), width_ratios=(1.35, 1))
    lit_point(left)
    own_root(right)
    save(figure, "surfaces")


def forward_drawing():
    """One energy bundle: its place from a grid of cells, its direction from the cone around the front surface, its end on the sensor."""
    figure, axes = plt.subplots(figsize=(10, 3.4))
    cell, columns, rows, left, low = 0.42, 4, 7, -1.0, -1.35
    for i in range(columns):
        for j in range(rows):
            x, y = left + (i + 0.5) * cell, low + (j + 0.5) * cell
            share = math.exp(-((x + 0.16) / 0.42) ** 2 - ((y - 0.1) / 0.85) ** 2)
            axes.fill([x - cell / 2, x + cell / 2, x + cell / 2, x - cell / 2], [y - cell / 2, y - cell / 2, y + cell / 2, y + cell / 2],
                      color="#f5a742", alpha=0.08 + 0.8 * share, lw=0.4, ec="#bbbbbb")
    axes.text(left + columns * cell / 2, low + rows * cell + 0.12, "cells: share of the emission", fontsize=9, ha="center")
    x, lens, radius, sensor, image = (-0.05, 0.35), 6.0, 1.15, 9.0, -0.22
    half = [radius * k / 20 for k in range(-20, 21)]
    for side in (-1, 1):
        axes.plot([lens + side * 0.16 * (1 - (u / radius) ** 2) for u in half], half, color=INK, lw=1.2)
    middle = lens - 0.16
    circle(axes, lens, 0, radius, color="#888888", lw=0.8, ls="--")
    distance = math.hypot(lens - x[0], x[1])
    axis, opening = math.atan2(-x[1], lens - x[0]), math.asin(radius / distance)
    for side in (-1, 1):
        turn, reach = axis + side * opening, distance * math.cos(opening)
        axes.plot([x[0], x[0] + reach * math.cos(turn)], [x[1], x[1] + reach * math.sin(turn)], color="#888888", lw=0.8)
    hit = (middle, 0.45)
    way(axes, x, hit, OPEN, lw=1.4)
    way(axes, hit, (sensor, image), OPEN, lw=1.4)
    missed = axis + 0.93 * opening
    end = (x[0] + 5.6 * math.cos(missed), x[1] + 5.6 * math.sin(missed))
    axes.plot([x[0], end[0]], [x[1], end[1]], color=CUT, lw=1)
    axes.text(end[0] - 0.1, end[1] + 0.14, "h = 0", fontsize=9, color=CUT, ha="right")
    axes.plot(*x, "o", color=INK, ms=4)
    axes.text(x[0] + 0.02, x[1] - 0.3, "x", fontsize=10, ha="center")
    axes.text(2.5, 0.08, r"$e^{-\tau(x,\mathrm{camera})}$", fontsize=9, color=OPEN)
    axes.text(2.6, -0.75, "cone around the sphere:\nits solid angle is the weight", fontsize=8, ha="center", va="top", color="#555555")
    axes.plot([sensor, sensor], [-1.35, 1.35], color=INK, lw=2)
    axes.plot([sensor, sensor], [image - 0.12, image + 0.12], color=CUT, lw=4, solid_capstyle="butt")
    axes.text(sensor + 0.15, image, "pixel: h = 1", fontsize=9, va="center")
    axes.text(sensor, 1.5, "sensor", fontsize=9, ha="center")
    axes.text(lens, 1.35, "front surface", fontsize=9, ha="center")
    axes.set_xlim(-1.3, 10.6)
    axes.set_ylim(-1.7, 2.0)
    plain(axes)
    save(figure, "forward")


def sobol_points(count, bits=16):
    """The first points of the Sobol' sequence in two dimensions (Joe and Kuo's direction numbers), as whole numbers of `bits` bits."""
    first = [1 << (bits - 1 - k) for k in range(bits)]
    second = [1 << (bits - 1)]
    for k in range(1, bits):
        second.append(second[-1] ^ second[-1] >> 1)
    points = []
    for n in range(count):
        x = y = 0
        for k in range(bits):
            if n >> k & 1:
                x, y = x ^ first[k], y ^ second[k]
        points.append((x, y))
    return points


def scrambled(points, seed, bits=16):
    """Owen's nested uniform scrambling: each bit is flipped or not by chance, anew for each value of those before it."""
    flips = random.Random(seed)
    drawn = {}
    scramble = []
    for point in points:
        new = []
        for d, value in enumerate(point):
            mixed = 0
            for k in range(bits):
                above = (d, k, value >> (bits - k))
                if above not in drawn:
                    drawn[above] = flips.getrandbits(1)
                mixed |= (value >> (bits - 1 - k) & 1 ^ drawn[above]) << (bits - 1 - k)
            new.append((mixed + 0.5) / 2 ** bits)
        scramble.append(tuple(new))
    return scramble


def errors_drawing():
    """Scrambled points of two randomisations in their elementary intervals; the limit over the stated error."""
    figure, (one, other, right) = plt.subplots(1, 3, figsize=(11, 3.5), width_ratios=(1, 1, 1.45))
    points = sobol_points(16)
    for axes, seed, across, down in ((one, 3, 4, 4), (other, 8, 16, 1)):
        for k in range(across + 1):
            axes.plot([k / across, k / across], [0, 1], color="#bbbbbb", lw=0.7)
        for k in range(down + 1):
            axes.plot([0, 1], [k / down, k / down], color="#bbbbbb", lw=0.7)
        axes.plot(*zip(*scrambled(points, seed)), "o", color=OPEN if axes is one else CUT, ms=4)
        plain(axes)
    one.set_title("A replicate: 16 points,\none in each elementary interval", fontsize=9)
    other.set_title("Another replicate, in\nintervals of another shape", fontsize=9)
    pixels = [10 ** (3.0 * k / 60) for k in range(61)]
    for randomisations, colour in ((2, CUT), (4, OPEN), (16, "#3f8f4f")):
        right.loglog(pixels, [math.sqrt(scipy.stats.f.ppf(0.95, n, n * (randomisations - 1))) for n in pixels], color=colour,
                     label=f"R = {randomisations}")
    right.set_ylim(0.9, 20)
    right.set_yticks([1, 2, 5, 10], ["1", "2", "5", "10"])
    right.minorticks_off()
    right.grid(True, color="#dddddd", lw=0.6)
    right.set_xlabel("n: pixels that make the error", fontsize=9)
    right.set_ylabel("limit / stated error", fontsize=9)
    right.legend(fontsize=8, frameon=False)
    right.set_title(r"$\sqrt{F_{0.95}(n, n(R-1))}$", fontsize=10)
    save(figure, "errors")


pupil_drawing()
interval_drawing()
cardinal_drawing()
measurement_drawing()
window_drawing()
rings_drawing()
surfaces_drawing()
forward_drawing()
errors_drawing()
