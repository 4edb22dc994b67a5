// Depth from refocusing, against the depth resolution that the design promises.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/lightfield/rendered.h"
#include "plenoflame/camera/design.h"
#include "plenoflame/lightfield/refocus.h"
#include "support/approx.h"
#include "support/cameras.h"
#include "support/plane_medium.h"

namespace plenoflame::depth_from_focus_test {
namespace {

// The design's depth resolution: the change of distance that moves the views from opposite sides of
// the pupil by one of their pixels against each other, 1 / |disparity_rate| at the distance in
// focus. Disparity goes as 1 / z: elsewhere it is coarser by the square of the distance.
TEST(DepthFromFocus, LiesWithinTheDesignsDepthResolution) {
  const CameraSpec spec = test::preset_camera("paper-previous-60x60");
  const Camera camera(spec);
  const CameraDesign design = first_order_design(camera);
  const double in_focus = design.object_distance;
  const double resolution = 1 / std::fabs(design.views.disparity_rate);
  ASSERT_GT(resolution, 1e-3);
  ASSERT_LT(resolution, 0.1);
  const MicroImages micro(camera, true, test::threads(2));
  for (const double depth : {0.87, 1.0, 1.12}) {
    const double step = resolution * depth * depth / (in_focus * in_focus);
    // Waves of six pixels of a view.
    const double k = 2 * std::acos(-1.0) / (6 * design.views.object_pixel);
    const test::PlaneMedium plane(depth, 1, [k](double y, double z) {
      return 1 + 0.4 * std::cos(k * y) + 0.4 * std::cos(k * z + 1);
    });
    const CompiledScene scene = test::scene_of(spec, std::make_unique<test::PlaneMedium>(plane));
    const LightField field = test::rendered(scene, {150, 150, 300, 300}, 64);
    // Planes that do not include the true one.
    std::vector<double> depths;
    for (int i = -3; i <= 3; ++i) depths.push_back(depth + (i + 0.3) * 2 * step);
    const FocusStack stack = focus_stack(field, micro, depths, {}, test::threads(2));
    std::vector<double> found;
    for (int row = 4; row + 4 < stack.depth.height; ++row)
      for (int column = 4; column + 4 < stack.depth.width; ++column)
        found.push_back(static_cast<double>(stack.depth.at(column, row)));
    ASSERT_GT(found.size(), 200U);
    std::sort(found.begin(), found.end());
    const double median = found[found.size() / 2];
    EXPECT_LT(std::fabs(median - depth), step)
        << depth << " m: " << median << ", resolution " << step;
    // Nine of ten pixels, too, each by itself.
    const auto within = std::count_if(found.begin(), found.end(),
                                      [&](double z) { return std::fabs(z - depth) < step; });
    EXPECT_GT(static_cast<double>(within), 0.9 * static_cast<double>(found.size())) << depth;
    RecordProperty("median_" + std::to_string(depth), std::to_string(median));
  }
}

}  // namespace
}  // namespace plenoflame::depth_from_focus_test
