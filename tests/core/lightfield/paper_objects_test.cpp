// The paper's Fig. 13 on the paper's own scene: refocused at 1.5 m the cylinder's edge is sharp and
// the cone's is not, at 1.30 m the other way round.
#include <gtest/gtest.h>

#include <cmath>

#include "plenoflame/lightfield/refocus.h"
#include "plenoflame/render/render.h"
#include "plenoflame/scene/scene_file.h"
#include "support/approx.h"
#include "support/cameras.h"
#include "support/source_folder.h"

namespace plenoflame::paper_objects_test {
namespace {

/// An edge of the scene as the picture shows it: where the floor ends and the lit side of an object
/// begins.
struct Edge {
  double floor = 0, side = 0;  ///< [W/(m^2 sr)] 1.5 mm to the left and to the right of it
  double width = 0;            ///< [m] of the rise from 10 to 90 %, on the plane of the picture
};

/// @param at [m] camera x, y of the edge on the plane of the picture
/// @param slant x per y of the edge
/// @param sharp the same edge in focus, whose levels count; null: measured here
Edge edge_at(const RefocusedImage& picture, Vec2 at, double slant, const Edge* sharp = nullptr) {
  // The mean along 4 mm of the edge, since samples lie unevenly.
  const auto value = [&](double x) {
    const int rows = static_cast<int>(2e-3 / picture.pixel);
    double sum = 0;
    for (int k = -rows; k <= rows; ++k) {
      const double y = at.y + k * picture.pixel;
      const int row = static_cast<int>(std::lround((y - picture.corner.y) / picture.pixel - 0.5));
      const double column = (x + slant * (y - at.y) - picture.corner.x) / picture.pixel - 0.5;
      const int first = static_cast<int>(std::floor(column));
      const double share = column - first;
      sum += (1 - share) * static_cast<double>(picture.image.at(first, row)) +
             share * static_cast<double>(picture.image.at(first + 1, row));
    }
    return sum / (2 * rows + 1);
  };
  Edge edge;
  edge.floor = sharp ? sharp->floor : value(at.x - 1.5e-3);
  edge.side = sharp ? sharp->side : value(at.x + 1.5e-3);
  const auto crossing = [&](double share) {
    const double level = edge.floor + share * (edge.side - edge.floor), step = 0.05e-3;
    double x = at.x - 6e-3;
    while (x < at.x + 6e-3 && value(x) < level) x += step;
    return x;
  };
  edge.width = crossing(0.9) - crossing(0.1);
  return edge;
}

TEST(PaperObjects, EdgesAreSharpAtTheirOwnDepth) {
  Scene scene = read_scene_file(PLENOFLAME_SOURCE_DIR "/examples/paper-objects-r29.toml").scene;
  const RigidTransform world_to_camera = Camera(scene.camera).to_world().inverse();
  const CompiledScene compiled = compile(scene, load_core_medium, test::threads(2));
  const MicroImages micro(compiled.camera, true, test::threads(2));
  struct Case {
    const char* name;
    Vec3 edge;  ///< [m] world: on the left side, towards the lamp
    double depth, other, slant;
  };
  // The cylinder: radius 8 mm at (1.5, 0) m. The cone: radius 12 mm, height 30 mm at (1.3, -0.02)
  // m, a quarter up. Silhouettes lie before the axis by r^2 / distance: less than 0.1 mm.
  for (const Case& c : {Case{"cylinder", {1.5, 0.008, 0.012}, 1.5, 1.3, 0},
                        Case{"cone", {1.3, -0.02 + 0.75 * 0.012, 0.0075}, 1.3, 1.5, -0.4}}) {
    const Vec3 edge = world_to_camera.point(c.edge);
    EXPECT_TRUE(test::relative(edge.z, c.depth, 0.005)) << c.name;
    const auto on_plane = [&](double depth) {
      return Vec2{edge.x * depth / edge.z, edge.y * depth / edge.z};
    };
    // The part of the sensor that sees it: the field is 83 mm wide at 1.5 m.
    const SensorSpec& sensor = scene.camera.sensor;
    const double scale = sensor.columns / 0.083 * 1.5 / edge.z;
    RenderSettings settings;
    settings.samples = 16;
    settings.standard_error = false;
    settings.window = {static_cast<int>(0.5 * sensor.columns + scale * edge.x) - 500,
                       static_cast<int>(0.5 * sensor.rows + scale * edge.y) - 250, 1000, 500};
    const LightField field = render(compiled, settings, test::threads(2)).light_field;
    RefocusSettings how;
    how.width = 160;
    how.depth = c.depth;
    const Edge sharp =
        edge_at(refocus(field, micro, how, test::threads(2)), on_plane(c.depth), c.slant);
    EXPECT_GT(sharp.side, 2 * sharp.floor) << c.name;
    how.depth = c.other;
    const Edge blurred =
        edge_at(refocus(field, micro, how, test::threads(2)), on_plane(c.other), c.slant, &sharp);
    // As angles, since planes farther away are magnified.
    EXPECT_GT(blurred.width / c.other, 2 * sharp.width / c.depth)
        << c.name << ": " << sharp.width << " m sharp, " << blurred.width << " m blurred";
    // Out of focus the edge is the shadow of the stop, 50 mm wide near the lens' front: from 10 to
    // 90 % of a disc's shadow is 0.687 of its diameter.
    const double disc = 0.05 * std::fabs(c.other / c.depth - 1);
    EXPECT_TRUE(test::relative(blurred.width, 0.687 * disc, 0.15)) << c.name;
    RecordProperty(c.name, std::to_string(sharp.width) + " " + std::to_string(blurred.width));
  }
}

}  // namespace
}  // namespace plenoflame::paper_objects_test
