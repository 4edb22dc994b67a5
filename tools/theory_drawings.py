#!/usr/bin/python3
"""Makes the drawings of docs/theory: docs/images/theory-*.png. From the formulas of the chapters, not to scale.

    tools/theory_drawings.py            needs matplotlib (Debian: python3-matplotlib)
"""

import math
import pathlib

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402  (the backend comes first)

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
    axes.text(edge[0] + 0.06, edge[1] + 0.02, "c + r v", fontsize=9, color=OPEN)
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
    figure.savefig(IMAGES / "theory-pupil.png", dpi=90, metadata={"Software": None})
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
    figure.savefig(IMAGES / "theory-interval.png", dpi=90, metadata={"Software": None})
    plt.close(figure)


pupil_drawing()
interval_drawing()
