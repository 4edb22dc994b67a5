#!/usr/bin/python3
"""Makes the drawing of docs/developer/architecture.md: docs/images/pipeline.png, the way of a ray from the scene to its consumers.

    tools/pipeline_drawing.py            needs matplotlib (Debian: python3-matplotlib)
    tools/pipeline_drawing.py --check    the files that it names are there, and the structs in one of them
"""

import pathlib
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
INK, STAGE, CONSUMER, GIVEN = "#222222", "#dbe9f6", "#e3f1df", "#f3ead7"

# name, what it does, files; what it hands to the next.
STAGES = [
    ("CompiledScene", "camera, pupil tables,\nmedium, surfaces, lights", ["scene/compile.h"], "BackwardPlan"),
    ("PixelSampler", "which pixels through which microlenses,\nhow many points of which sequence",
     ["pixel_sampler.h", "pixel_row_kernel.inl.h", "worth_levels.h"], "KernelPixel"),
    ("RayGenerator", "points of sensor and pupil,\naims at the stop's edge, etendue", ["ray_generator.h", "backward_kernel.inl.h",
                                                                              "aim_edges_kernel.inl.h"], "DrawnRays"),
    ("CameraTracer", "microlens, main lens, into the world", ["camera_tracer.h", "camera_kernel.inl.h"], "TracedRays"),
    ("WorldPaths", "straight stretches in air, windows\nbetween them, a surface at the end", ["world_paths.h"], "WorldPath"),
]
CONSUMERS = [
    ("PictureTracer", "RadianceIntegrator, FilmSums:\nthe picture", ["picture_tracer.h", "radiance_integrator.h", "film_sums.h"],
     "LightField"),
    ("PathSink", "exported paths", ["ray_paths.cpp"], "RayPaths"),
    ("BlockWriter", "the public stream", ["ray_stream.cpp"], "RayBlock"),
]


def check():
    """Lines that say what the drawing names and the sources do not have."""
    sources = [path for folder in ("core/src", "core/include") for path in (ROOT / folder).rglob("*") if path.is_file()]
    text = "\n".join(path.read_text(encoding="utf-8") for path in sources)
    wrong = []
    for name, _, files, handed in STAGES + CONSUMERS:
        wrong += [f"{name}: there is no {file}" for file in files
                  if not any(path.as_posix().endswith("/" + file) for path in sources)]
        wrong += [f"{name}: nothing in core is called {word}" for word in (handed,) if word not in text]
    return wrong


def box(axes, x, y, width, height, colour, name, about, files):
    import matplotlib.patches

    axes.add_patch(matplotlib.patches.FancyBboxPatch((x, y), width, height, boxstyle="round,pad=0,rounding_size=0.08",
                                                     facecolor=colour, edgecolor=INK, lw=0.8))
    axes.text(x + width / 2, y + height - 0.14, name, ha="center", va="top", fontsize=10, weight="bold")
    axes.text(x + width / 2, y + height - 0.44, about, ha="center", va="top", fontsize=8)
    axes.text(x + width / 2, y + 0.1, "\n".join(files), ha="center", va="bottom", fontsize=7, family="monospace", color="#555555")


def arrow(axes, a, b, text, offset, align):
    axes.annotate("", xy=b, xytext=a, arrowprops={"arrowstyle": "-|>", "color": INK, "lw": 1})
    axes.text((a[0] + b[0]) / 2 + offset[0], (a[1] + b[1]) / 2 + offset[1], text, ha=align, va="center", fontsize=8, style="italic")


def draw():
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    import matplotlib.patches

    figure, axes = plt.subplots(figsize=(10, 8.6))
    width, height, step = 4.4, 1.5, 2.05
    x, top = 0.5, 6.6
    axes.add_patch(matplotlib.patches.Rectangle((x - 0.25, top - 4 * step - 0.2), width + 0.5, 4 * step - 0.22, fill=False, ls="--",
                                                lw=0.8, edgecolor="#777777"))
    axes.text(x - 0.2, top - 4 * step - 0.28, "one worker, 64 x 64 pixels at a time", fontsize=8, va="top", color="#555555")
    for k, (name, about, files, handed) in enumerate(STAGES):
        y = top - k * step
        box(axes, x, y, width, height, STAGE if k else GIVEN, name, about, files)
        if k + 1 < len(STAGES):
            arrow(axes, (x + width / 2, y), (x + width / 2, y - step + height), handed, (0.1, 0), "left")
    rays, paths = [(x + width, top - row * step + height / 2) for row in (3, 4)]
    for k, (name, about, files, handed) in enumerate(CONSUMERS):
        y = top - 1 * step - k * step
        left = x + width + 2
        box(axes, left, y, width, height, CONSUMER, name, about, files)
        if k == 0:  # a medium alone lights whole lines
            arrow(axes, rays, (left, y + height / 2 + 0.15), "", (0, 0), "center")
        arrow(axes, paths, (left, y + height / 2 - 0.15), "WorldPath" if k == 2 else "", (0.25, -0.3), "left")
        arrow(axes, (left + width, y + height / 2), (left + width + 0.9, y + height / 2), "", (0, 0), "left")
        axes.text(left + width + 1, y + height / 2, handed, fontsize=9, style="italic", va="center")
    axes.text(x + width + 2, top - step + height + 0.18, "consumers of rays: blocks of up to 1024", fontsize=8, color="#555555")
    axes.set_xlim(0, 14.4)
    axes.set_ylim(-2.2, 8.3)
    axes.axis("off")
    figure.savefig(ROOT / "docs/images/pipeline.png", dpi=150, bbox_inches="tight")


if __name__ == "__main__":
    if sys.argv[1:] == ["--check"]:
        found = check()
        print("\n".join(found), end="\n" if found else "")
        sys.exit(1 if found else 0)
    if sys.argv[1:]:
        sys.exit(__doc__)
    draw()
