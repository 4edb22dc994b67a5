#include "plenoflame/camera/microlens_aperture.h"

#include <cmath>
#include <random>

#include "plenoflame/camera/camera.h"
#include "support/approx.h"
#include "support/cameras.h"

namespace plenoflame::test::microlens_aperture_test {
namespace {

ArraySpec full_fill(Lattice lattice, double rotation) {
  ArraySpec array;
  array.present = true;
  array.lattice = lattice;
  array.aperture = lattice == Lattice::square ? ApertureShape::square : ApertureShape::hexagonal;
  array.pitch = array.diameter = 1e-4;
  if (lattice == Lattice::square) array.pitch_y = array.diameter_y = 0.7e-4;
  array.rotation = rotation;
  array.offset = {1e-5, -2e-5};
  array.types.resize(1);
  return array;
}

TEST(MicrolensAperture, AreasAndCircles) {
  const double s = 1e-4;
  const MicrolensAperture square(full_fill(Lattice::square, 0.3));
  EXPECT_TRUE(relative(square.area(), 0.7 * s * s, 1e-14));
  EXPECT_TRUE(relative(square.radius(), 0.5 * s * std::sqrt(1.49), 1e-14));
  const MicrolensAperture hexagon(full_fill(Lattice::hexagonal, 0.3));
  EXPECT_TRUE(relative(hexagon.area(), 0.5 * std::sqrt(3.0) * s * s, 1e-14));
  EXPECT_TRUE(relative(hexagon.radius(), s / std::sqrt(3.0), 1e-14));
  ArraySpec circle = full_fill(Lattice::square, 0);
  circle.aperture = ApertureShape::circular;
  EXPECT_TRUE(relative(MicrolensAperture(circle).area(), 0.25 * std::acos(-1.0) * s * s, 1e-14));
}

// Every point belongs to one lens: to the nearest one in these lattices.
TEST(MicrolensAperture, FullFillLeavesNoGap) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> place(-1e-3, 1e-3);
  for (const Lattice lattice : {Lattice::square, Lattice::hexagonal})
    for (const double rotation : {0.0, 0.3, -1.1}) {
      const ArraySpec array = full_fill(lattice, rotation);
      const MicrolensAperture aperture(array);
      const MicrolensLattice centres(array);
      for (int i = 0; i < 3000; ++i) {
        const Vec2 point{place(random), place(random)};
        int found = 0;
        const Vec2 reach{aperture.radius(), aperture.radius()};
        for (const LensIndex lens : centres.within(point - reach, point + reach))
          found += aperture.holds(point - centres.centre(lens)) ? 1 : 0;
        ASSERT_EQ(found, 1) << point.x << ' ' << point.y;
        EXPECT_TRUE(aperture.holds(point - centres.centre(centres.nearest(point))));
      }
    }
}

TEST(MicrolensLatticeWithAnEdge, HasAsManyLensesAsItSays) {
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> place(-2e-3, 2e-3);
  for (const Lattice lattice : {Lattice::square, Lattice::hexagonal})
    for (const auto& [columns, rows] : {std::pair{4, 5}, {7, 1}, {1, 6}, {3, 2}}) {
      ArraySpec array = full_fill(lattice, 0.2);
      array.columns = columns;
      array.rows = rows;
      const MicrolensLattice centres(array);
      const std::vector<LensIndex> all = centres.within({-1e-2, -1e-2}, {1e-2, 1e-2});
      EXPECT_EQ(all.size(), static_cast<std::size_t>(columns * rows));
      EXPECT_TRUE(centres.has({0, 0}));
      // The bounding box is as small as it can be: rows are straight.
      double least = kInfinity, most = -kInfinity;
      for (const LensIndex lens : all) {
        const Vec2 p = centres.centre(lens) - array.offset;
        const double x = p.x * std::cos(0.2) + p.y * std::sin(0.2);
        least = std::min(least, x);
        most = std::max(most, x);
      }
      EXPECT_LE(most - least, (columns - 0.49) * array.pitch);
      for (int i = 0; i < 500; ++i) {
        const Vec2 point{place(random), place(random)};
        double nearest = kInfinity;
        for (const LensIndex lens : all)
          nearest = std::min(nearest, length(centres.centre(lens) - point));
        EXPECT_TRUE(
            relative(length(centres.centre(centres.nearest(point)) - point), nearest, 1e-12));
      }
    }
}

// Both ways through a real lens with sides: what passes one way passes the other, and ends at the
// face outside of whose sides it is.
TEST(MicrolensAperture, SameBothWays) {
  CameraSpec spec = preset_camera("paper-plenoptic2");
  spec.array.aperture = ApertureShape::hexagonal;
  spec.array.rotation = 0.4;
  const Camera camera(spec);
  const Camera circles = camera.with_circles();
  const int front = camera.surface_count() - 2;
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> unit(-1, 1);
  int passed = 0, stopped = 0;
  for (int i = 0; i < 4000; ++i) {
    const Vec2 s{6e-5 * unit(random), 6e-5 * unit(random)};
    const Vec2 aim{6e-5 * unit(random), 6e-5 * unit(random)};
    const Camera::Path path = camera.trace(s, LensIndex{0, 0}, aim, true);
    const Camera::Path whole = circles.trace(s, LensIndex{0, 0}, aim, true);
    if (whole.status.status != RayStatus::reached) continue;
    const auto inside = [&](const Vec3& p) { return camera.aperture().holds({p.x, p.y}); };
    const bool back_inside = inside(whole.points[1]), front_inside = inside(whole.points[2]);
    if (back_inside && front_inside) {
      ++passed;
      EXPECT_EQ(path.status.status, RayStatus::reached);
      std::vector<Camera::Arrival> arrivals;
      camera.trace_from_scene({path.exit.origin, -path.exit.direction}, arrivals);
      ASSERT_EQ(arrivals.size(), 1u);
      EXPECT_TRUE(within(arrivals[0].sensor_point.x, s.x, 1e-9, 1e-4));
      EXPECT_EQ(arrivals[0].lens, (LensIndex{0, 0}));
    } else {
      ++stopped;
      EXPECT_EQ(path.status, (TraceStatus{RayStatus::vignetted, back_inside ? front : front + 1}));
      EXPECT_EQ(path.points.size(), back_inside ? 3u : 2u);
    }
  }
  EXPECT_GT(passed, 300);
  EXPECT_GT(stopped, 30);
}

}  // namespace
}  // namespace plenoflame::test::microlens_aperture_test
