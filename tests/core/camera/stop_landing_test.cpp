// The series that say where rays cross a microlens' far face and the stop, against the camera's
// exact trace of single rays.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "plenoflame/camera/pupil_sampling.h"
#include "support/approx.h"
#include "support/cameras.h"

namespace plenoflame::test::stop_landing_test {
namespace {

/// Points of the unit cube that fill it evenly.
class Cube {
 public:
  const std::array<double, 4>& next() {
    constexpr std::array<double, 4> kStep{0.7320508075688772, 0.23606797749978958,
                                          0.6457513110645907, 0.3166247903554};
    for (std::size_t k = 0; k < 4; ++k) point_[k] = std::fmod(point_[k] + kStep[k], 1.0);
    return point_;
  }

 private:
  std::array<double, 4> point_{};
};

Vec2 of_disc(double share, double turn) {
  const double angle = 2 * std::numbers::pi * turn;
  return std::sqrt(share) * Vec2{std::cos(angle), std::sin(angle)};
}

struct Worst {
  double stop = 0, far_face = 0;  ///< difference of the distance from the middle, in radii
  int rays = 0;                   ///< that come close to the stop's edge
};

/// Rays of microlenses on the x axis at `h` [m] that cross close to the rims. A camera whose array
/// is moved there has a microlens there.
Worst worst_at(CameraSpec spec, const PupilTable& table, double h) {
  spec.array.offset = {h, 0};
  const Camera camera(spec);
  const PupilNode node = table.at(h);
  Worst worst;
  Cube cube;
  const double own = 0.5 * spec.array.diameter;
  const bool ideal = camera.ideal_lens();
  const auto stop = static_cast<std::size_t>(camera.lens_first_order().stop);
  const double radius =
      ideal ? camera.ideal().stop_radius : 0.5 * camera.lens().surfaces()[stop].diameter;
  for (int i = 0; i < 20000; ++i) {
    const auto& x = cube.next();
    const Vec2 s = Vec2{node.centre, 0} + node.outer_radius * of_disc(x[0], x[1]),
               u = own * of_disc(x[2], x[3]);
    const Vec2 place{h, 0};
    const auto at_stop = camera.at_stop(place + s, LensIndex{}, place + u);
    if (!at_stop) continue;
    const double height = length(*at_stop) / radius;
    if (height > 0.9 && height < 1.05) {
      ++worst.rays;
      const double found = length(node.stop.at(table.at_pupil.at(s, u)));
      worst.stop = std::max(worst.stop, std::fabs(found - height));
    }
    if (camera.ideal_array()) continue;
    const auto points = camera.trace(place + s, LensIndex{}, place + u, true).points;
    const Vec2 there{points[2].x - h, points[2].y};
    const double from_middle = length(there) / own;
    if (from_middle < 0.9 || height > 1.05) continue;
    const double found = length(table.at_far_face.at(s, u));
    worst.far_face = std::max(worst.far_face, std::fabs(found - from_middle));
  }
  return worst;
}

void expect_close(CameraSpec spec, double tolerance) {
  spec.array.types.resize(1);
  spec.focus.conjugate = "array";
  spec.array.rotation = 0;
  const Camera camera(spec);
  const PupilTable table = PupilSampling(camera, one_thread()).tables().front();
  ASSERT_TRUE(table.nodes.front().stop.known());
  const double last = static_cast<double>(table.nodes.size() - 2) * table.field_step;
  for (const double share : {0.0, 0.13, 0.5, 0.97}) {  // at nodes and between
    const Worst worst = worst_at(spec, table, share * last);
    EXPECT_GT(worst.rays, 100) << share;
    EXPECT_LT(worst.stop, tolerance) << share;
    EXPECT_LT(worst.far_face, tolerance) << share;
    // The reach that rays are held to leaves room for what was found.
    EXPECT_GT(table.at(share * last).stop.reach, 1) << share;
  }
}

TEST(StopLanding, SeriesFindRimsOfThePresets) {
  for (const char* name : {"paper-plenoptic2", "paper-plenoptic1", "raytrix-r29", "r12"}) {
    SCOPED_TRACE(name);
    expect_close(preset_camera(name), 5e-4);
  }
}

TEST(StopLanding, SeriesFindAStopBetweenLenses) {
  expect_close(double_gauss_camera(), 2e-3);
}

TEST(StopLanding, SeriesFindTheStopOfIdealLenses) {
  CameraSpec spec = preset_camera("paper-plenoptic2");
  spec.lens.model = LensModel::ideal;
  expect_close(spec, 5e-4);
  // Through ideal microlenses nothing is left of fifth order.
  spec.array.model = LensModel::ideal;
  expect_close(spec, 1e-12);
}

// Misaligned microlenses differ from one another: no series holds for all.
TEST(StopLanding, NothingIsKnownOfMisalignedCameras) {
  CameraSpec spec = preset_camera("paper-plenoptic2");
  spec.array.focal_jitter = 0.01;
  const PupilSampling pupils{Camera(spec), one_thread()};
  for (const PupilTable& table : pupils.tables())
    for (const PupilNode& node : table.nodes) {
      EXPECT_FALSE(node.stop.known());
      EXPECT_EQ(node.far_reach, 0);
    }
}

}  // namespace
}  // namespace plenoflame::test::stop_landing_test
