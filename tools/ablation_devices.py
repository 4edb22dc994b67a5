"""The devices of the sampler that tools/ablation.py switches off, one at a time.

Each is switched off in a copy of the sources: `edits` are (file, text, replacement), where WITHOUT(name) asks whether the device of
that name is off. The text must occur once, so that a device that changes its form is noticed. `parts` say which lines are the device:
whole files, or (file, first line, last line) by what the lines begin with. `tests` name files, or (file, test).
"""

import dataclasses


@dataclasses.dataclass
class Device:
    name: str
    what: str
    edits: list
    parts: list = dataclasses.field(default_factory=list)
    tests: list = dataclasses.field(default_factory=list)


RENDER = "core/src/render/"
FRAME = RENDER + "sampling/microlens_frame.cpp"
SAMPLER = RENDER + "tracer/pixel_sampler.cpp"
AIM = RENDER + "sampling/aim_edges_kernel.inl.h"

# Wanted by every measurement: processor time, so that other programs disturb less.
COMMON = [
    (RENDER + "estimators/render.cpp", "  const auto start = std::chrono::steady_clock::now();\n", "  const std::clock_t start = std::clock();\n"),
    (RENDER + "estimators/render.cpp", "statistics.seconds = seconds_since(start);",
     "statistics.seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;"),
    (RENDER + "estimators/render.cpp", "#include <cmath>\n", "#include <cmath>\n#include <ctime>\n"),
]

DEVICES = [
    Device("bounds of the pupil", "Sensor points aim at the unvignetted part of the microlens' aperture only (`PupilCuts`).",
           [(SAMPLER, "made.cuts = rows_.far2[k] <= opens * opens ? &whole_ : &cuts;",
             "made.cuts = WITHOUT(bounds of the pupil) || rows_.far2[k] <= opens * opens ? &whole_ : &cuts;")],
           ["core/src/camera/pupil/pupil_cut.cpp", "core/src/camera/pupil/widen_cuts.cpp", "core/src/camera/pupil/pupil_outline.cpp"],
           ["tests/core/camera/pupil_cut_test.cpp"]),
    Device("steps to the stop's edge", "A Newton step and a parabola lead from these bounds to the edge of the stop (`find_stop`).",
           [(FRAME, "frame.finds_stop = node.stop.known();", "frame.finds_stop = node.stop.known() && !WITHOUT(steps to the stop's edge);")],
           [(AIM, "struct StopEdge {", "}"), (AIM, "PLENOFLAME_INLINE void find_stop(", "}"), "core/src/camera/pupil/stop_landing.cpp"],
           ["tests/core/camera/stop_landing_test.cpp"]),
    Device("step to the far rim", "A Newton step leads to the rim of the microlens' far face (`find_far_rim`).",
           [(FRAME, "frame.finds_far = node.far_reach > 0 && !ideal_array;",
             "frame.finds_far = node.far_reach > 0 && !ideal_array && !WITHOUT(step to the far rim);")],
           [(AIM, "PLENOFLAME_INLINE void find_far_rim(", "}")], []),
    Device("levels of worth", "Pixels that see little of a microlens get fewer points (`WorthLevels`).",
           [(SAMPLER, "plan_.levels[static_cast<std::size_t>(std::min(worth, last_level))];",
             "plan_.levels[static_cast<std::size_t>(WITHOUT(levels of worth) ? 0 : std::min(worth, last_level))];")],
           [RENDER + "sampling/worth_levels.cpp", RENDER + "sampling/worth_levels.h"], []),
    Device("skipping of microlenses", "Microlenses whose beams miss the flame are skipped (`BeamBounds`).",
           [(SAMPLER, "if (plan_.beams && !plan_.beams->lenses().may_meet(type, lens_place)) return;",
             "if (!WITHOUT(skipping of microlenses) && plan_.beams && !plan_.beams->lenses().may_meet(type, lens_place)) return;")],
           [RENDER + "visibility/beam_bounds.cpp", RENDER + "visibility/beam_bounds.h"], ["tests/core/render/skipping_test.cpp"]),
    Device("skipping of pixels", "Pixels whose beams miss the flame are skipped, behind microlenses whose beams meet it (`PixelBeams`).",
           [(RENDER + "estimators/backward.cpp", "if (plan->beams && tests_pixels(scene.paths()[p], settings, ranges[range].points))",
             "if (!WITHOUT(skipping of pixels) && plan->beams && tests_pixels(scene.paths()[p], settings, ranges[range].points))")],
           [RENDER + "visibility/pixel_beams.cpp", RENDER + "visibility/pixel_beams.h"], ["tests/core/render/pixel_beams_test.cpp"]),
    Device("control variate", "A table gives the radiance of grids; some rays correct it (`RadianceTable`).",
           [(RENDER + "estimators/backward.cpp", "if (!settings.control_variate || !in_single_precision(scene, settings)) return nullptr;",
             "if (WITHOUT(control variate) || !settings.control_variate || !in_single_precision(scene, settings)) return nullptr;")],
           [RENDER + "tracer/radiance_table.cpp", RENDER + "tracer/radiance_table.h", RENDER + "tracer/radiance_table_kernel.inl.h",
            RENDER + "tracer/radiance_table_kernel.h"],
           ["tests/core/render/radiance_table_test.cpp"]),
    Device("constant bricks", "Rays cross bricks of one value at once, in closed form.",
           [("core/src/media/voxels/voxel_lattice.cpp", "    if (constant) {", "    if (constant && !WITHOUT(constant bricks)) {")],
           [("core/src/media/voxels/voxel_kernel.inl.h", "  void add_constants(", "  }"), ("core/src/media/voxels/voxel_lattice.cpp", "    if (constant) {", "    }")],
           []),
    Device("empty bricks", "Rays cross empty and constant bricks, and blocks of 512 of them, at once.",
           [(RENDER + "tracer/radiance_integrator.cpp", "options.skip = plan_.settings->skip;",
             "options.skip = plan_.settings->skip && !WITHOUT(empty bricks);"),
            (RENDER + "estimators/backward.cpp", "options.skip = settings.skip;", "options.skip = settings.skip && !WITHOUT(empty bricks);")],
           [], []),
    Device("roulette of walks", "Scattered walks of small weight end at random.",
           [(RENDER + "transport/scatter_walk.cpp", "if (largest < kRoulette) {", "if (largest < kRoulette && !WITHOUT(roulette of walks)) {")],
           [], []),
]
