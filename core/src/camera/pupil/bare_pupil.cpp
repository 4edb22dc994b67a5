#include "camera/pupil/bare_pupil.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "camera/pupil/passing_edge.h"
#include "camera/pupil/pupil_field.h"
#include "plenoflame/base/constants.h"

namespace plenoflame {
namespace {

/// Without array the edge is seen directly: 48 halvings locate it to this accuracy. Rays beside the
/// edge are rare. They matter because a pixel with an uncut pupil is otherwise nearly free of
/// noise.
constexpr double kBareSafety = 1e-11;
constexpr int kBareBisections = 48;
constexpr double kZones[] = {0.3, 0.5, 0.7, 0.85, 1};  ///< of the way to the edge

struct Outline {
  PupilNode node;
  std::vector<Vec2> edge;
  std::vector<Ray> rays;
};

/// @param turn the azimuth of the field, for a camera without rotational symmetry
Outline trace_bare_outline(const Camera& camera, double h, Vec2 turn = {1, 0}) {
  Outline outline{};  // no cuts: zeros
  const auto turned = [turn](Vec2 v) {
    return Vec2{turn.x * v.x - turn.y * v.y, turn.y * v.x + turn.x * v.y};
  };
  const double plane = camera.aim_plane(0);
  const FirstOrder& lens = camera.lens_first_order();
  const Passes passes = [&](Vec2 u) {
    return camera.trace(camera.foot() + turned({h, 0}), std::nullopt, camera.foot() + turned(u))
               .status.status == RayStatus::reached;
  };
  double centre = h, radius = 0.5 * lens.entrance_pupil_diameter;
  if (std::isfinite(camera.exit_pupil())) {
    const double to_pupil = camera.exit_pupil() - camera.sensor();
    const double part = (plane - camera.sensor()) / to_pupil;
    centre = h * (1 - part);
    radius = 0.5 * lens.exit_pupil_diameter * std::fabs(part);
  }
  Vec2 inside{centre, 0};
  if (!find_inside(passes, 1.5 * radius, inside)) return outline;
  std::vector<Vec2> edge = find_edge(passes, inside, 4 * radius, kBareBisections);
  outline.node.aim_centre = middle(edge).x;
  outline.node.image_radius = kInfinity;
  for (const Vec2 u : edge) {
    outline.node.aim_radius =
        std::max(outline.node.aim_radius, length(u - Vec2{outline.node.aim_centre, 0}));
    outline.edge.push_back(u);
    if (camera.misaligned() && camera.lens_is_round()) continue;  // needs only the edge
    // Zones of a lens focus at different distances, so rays of inner zones may be the outermost.
    for (const double share : kZones) {
      const Vec2 within = inside + share * (u - inside);
      const Camera::Path path = camera.trace(camera.foot() + turned({h, 0}), std::nullopt,
                                             camera.foot() + turned(within));
      if (path.status.status == RayStatus::reached) outline.rays.push_back(path.exit);
    }
  }
  return outline;
}

constexpr int kBareTurns = 12;

/// Samples the azimuths of a camera without rotational symmetry.
template <class Function>
void for_turns(double offset, const Function& function) {
  for (int k = 0; k < kBareTurns; ++k) {
    const double angle = 2 * constants::pi * (k + offset) / kBareTurns;
    function(Vec2{std::cos(angle), std::sin(angle)});
  }
}

/// One disc around the outlines at all azimuths.
Outline trace_all_around(const Camera& camera, double h) {
  Outline all{};
  for_turns(0, [&](Vec2 turn) {
    Outline outline = trace_bare_outline(camera, h, turn);
    if (outline.node.dark()) return;
    all.node.image_radius = kInfinity;
    all.edge.insert(all.edge.end(), outline.edge.begin(), outline.edge.end());
    all.rays.insert(all.rays.end(), outline.rays.begin(), outline.rays.end());
  });
  if (all.node.dark()) return all;
  all.node.aim_centre = middle(all.edge).x;
  for (const Vec2 u : all.edge)
    all.node.aim_radius = std::max(all.node.aim_radius, length(u - Vec2{all.node.aim_centre, 0}));
  return all;
}

}  // namespace

PupilTable bare_table(const Camera& given) {
  const Camera camera = given.misaligned() ? given.aligned() : given;
  PupilTable table;
  const Vec2 pixel = camera.spec().sensor.pixel();
  const double field = field_radius(camera) + std::max(pixel.x, pixel.y) + field_shift(given);
  const auto nodes = static_cast<int>(field_nodes(camera, field));
  table.field_step = field / (nodes - 1);
  for (int i = 0; i < nodes; ++i) {
    const double h = i * table.field_step;
    Outline outline =
        given.lens_is_round() ? trace_bare_outline(camera, h) : trace_all_around(given, h);
    table.nodes.push_back(outline.node);
    table.edges.push_back(std::move(outline.rays));
  }
  std::vector<PupilCuts> none(table.nodes.size());
  extend_into_shadow(table.nodes, none);
  double margin = 0;
  for (int i = 0; i + 1 < nodes; ++i) {
    const double h = (i + 0.5) * table.field_step;
    const PupilNode node = table.at(h);
    const auto hold = [&](const Outline& outline) {
      for (const Vec2 u : outline.edge)
        margin = std::max(margin, length(u - Vec2{node.aim_centre, 0}) - node.aim_radius);
    };
    if (given.lens_is_round()) hold(trace_bare_outline(camera, h));
    if (!given.misaligned()) continue;
    for_turns(0.5 * (i % 2), [&](Vec2 turn) { hold(trace_bare_outline(given, h, turn)); });
  }
  for (PupilNode& node : table.nodes)
    if (node.aim_radius > 0) node.aim_radius += 1.5 * margin + kBareSafety * node.aim_radius;
  return table;
}

}  // namespace plenoflame
