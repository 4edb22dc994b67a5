// Rings and layers against closed forms: chords of a cone and Abel's pair of a parabola; axes of
// tilted flames.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "plenoflame/base/error.h"
#include "plenoflame/inverse/axis_fit.h"
#include "plenoflame/inverse/flame_estimate.h"
#include "plenoflame/inverse/unknowns.h"
#include "support/approx.h"

namespace plenoflame::test::ring_unknowns_test {
namespace {

constexpr double kRadius = 20e-3;

RingGrid upright(int rings, int heights) {
  RingGrid grid;
  grid.base = {1, 0, -10e-3};
  grid.radial_step = kRadius / rings;
  grid.height_step = 1e-3;
  grid.rings = rings;
  grid.heights = heights;
  return grid;
}

double chord(const Unknowns& unknowns, const Ray& ray, const std::vector<double>& samples) {
  RayIntervals intervals;
  unknowns.append(ray, 0, 10, intervals);
  IntervalTransfers weights;
  node_weights(intervals, {}, RowModel::emission, weights);
  double sum = 0;
  for (std::size_t i = 0; i < intervals.size(); ++i)
    sum += weights.near[i] * value_at(intervals[i], 0, samples) +
           weights.far[i] * value_at(intervals[i], 1, samples);
  return sum;
}

// 1 - r/R is linear between the rings, as the basis is: its chord at distance y is
// 2 (s - (s R + y^2 asinh(s/y)) / (2 R)), s^2 = R^2 - y^2. Fails when a corner of a ring is lost.
TEST(RingUnknowns, ConeInClosedForm) {
  const auto rings = make_ring_unknowns(upright(10, 21));
  std::vector<double> samples;
  for (std::size_t n = 0; n < rings->size(); ++n)
    samples.push_back(1 - std::hypot(rings->place(n).x - 1, rings->place(n).y) / kRadius);
  for (const double y : {0.1e-3, 3.7e-3, 8e-3, 19e-3}) {
    const double s = std::sqrt(kRadius * kRadius - y * y);
    const double expected = 2 * (s - (s * kRadius + y * y * std::asinh(s / y)) / (2 * kRadius));
    EXPECT_TRUE(relative(chord(*rings, {{0, y, 0.3e-3}, {1, 0, 0}}, samples), expected, 1e-4)) << y;
    // Rising by 1 in 10: longer by the secant.
    const double rise = std::sqrt(1.01);
    EXPECT_TRUE(relative(chord(*rings, {{0, y, -0.1}, normalize(Vec3{1, 0, 0.1})}, samples),
                         expected * rise, 1e-4))
        << y;
  }
  EXPECT_EQ(chord(*rings, {{0, 20.1e-3, 0}, {1, 0, 0}}, samples), 0);
}

// Abel's pair 1 - r^2/R^2 and (4/3) R (1 - y^2/R^2)^(3/2): to the square of the rings' width.
TEST(RingUnknowns, AbelPair) {
  double before = 0;
  for (const int count : {20, 40, 80}) {
    const auto rings = make_ring_unknowns(upright(count, 21));
    std::vector<double> samples;
    for (std::size_t n = 0; n < rings->size(); ++n) {
      const double r = std::hypot(rings->place(n).x - 1, rings->place(n).y) / kRadius;
      samples.push_back(1 - r * r);
    }
    double worst = 0;
    for (const double y : {0.3e-3, 4e-3, 11e-3}) {
      const double expected = 4.0 / 3 * kRadius * std::pow(1 - y * y / (kRadius * kRadius), 1.5);
      const double own = chord(*rings, {{0, y, 0}, {1, 0, 0}}, samples);
      worst = std::max(worst, std::fabs(own / expected - 1));
    }
    EXPECT_LT(worst, 0.5 / (count * count));
    if (before > 0) {
      EXPECT_LT(worst, before / 3.5);
    }
    before = worst;
  }
}

// A tilted axis sees what an upright one sees from the side; the field that is written is round.
TEST(RingUnknowns, TiltedAxisAndVoxels) {
  const RingGrid grid = upright(8, 12);
  const auto rings = make_ring_unknowns(grid);
  std::vector<double> samples;
  for (std::size_t n = 0; n < rings->size(); ++n) samples.push_back(1 + 0.1 * (n % 12) + n / 12);
  RingGrid turned = grid;  // z becomes y
  turned.base = {1, -10e-3, 0};
  turned.axis = {0, 1, 0};
  const auto other = make_ring_unknowns(turned);
  const double upright_chord = chord(*rings, {{0, 2e-3, -3e-3}, {1, 0, 0}}, samples);
  const double turned_chord = chord(*other, {{0, -3e-3, 2e-3}, {1, 0, 0}}, samples);
  EXPECT_TRUE(relative(turned_chord, upright_chord, 1e-12));
  const VoxelField field = rings->field(samples, "x");
  const Vec3 centre = field.index_to_world.point({7, 7, 0});
  EXPECT_TRUE(within(centre.x, 1, 1e-12, 1));
  EXPECT_TRUE(within(centre.y, 0, 1e-12, 1));
  const auto value = [&](int i, int j, int k) {
    for (std::size_t b = 0; b < field.brick_origins.size(); ++b)
      if (field.brick_origins[b] == std::array<int, 3>{i / 8 * 8, j / 8 * 8, k / 8 * 8})
        return static_cast<double>(
            field.values[b * 512 + static_cast<std::size_t>(i % 8 * 64 + j % 8 * 8 + k % 8)]);
    return 0.0;
  };
  EXPECT_TRUE(relative(value(7, 7, 5), samples[5], 1e-6));
  EXPECT_TRUE(relative(value(7 + 3, 7, 5), samples[3 * 12 + 5], 1e-6));
  EXPECT_TRUE(relative(value(7, 7 - 3, 5), samples[3 * 12 + 5], 1e-6));
}

// 1 - s, s the reduced radius, is linear between layers; scaled by the semi-axes its chords are
// those of the cone, and its integral is pi a b c / 3.
TEST(LayerUnknowns, ConeInClosedForm) {
  const LayerGrid grid{{1, 2e-3, -1e-3}, {8e-3, 12e-3, 25e-3}, 9};
  const auto layers = make_layer_unknowns(grid);
  std::vector<double> samples;
  double integral = 0;
  for (std::size_t n = 0; n < layers->size(); ++n) {
    samples.push_back(1 - static_cast<double>(n) / 9);
    integral += layers->volume(n) * samples.back();
  }
  EXPECT_TRUE(relative(integral, std::numbers::pi / 3 * 8e-3 * 12e-3 * 25e-3, 1e-12));
  for (const double y : {0.5e-3, 5e-3, 11e-3})
    for (const double z : {0.3e-3, 7e-3}) {
      const double p = std::hypot(y / 12e-3, z / 25e-3), s = std::sqrt(1 - p * p);
      const double expected = 2 * 8e-3 * (s - (s + p * p * std::asinh(s / p)) / 2);
      const Ray ray{{0, 2e-3 + y, -1e-3 + z}, {1, 0, 0}};
      EXPECT_TRUE(relative(chord(*layers, ray, samples), expected, 1e-4)) << y << " " << z;
    }
  EXPECT_EQ(chord(*layers, {{0, 14.1e-3, 0}, {1, 0, 0}}, samples), 0);
  const VoxelField field = layers->field(samples, "layers");
  EXPECT_FALSE(field.values.empty());
  EXPECT_THROW(make_layer_unknowns({{}, {1, 1, 0}, 3}), InputError);
  EXPECT_THROW(make_layer_unknowns({{}, {1, 1, 1}, 0}), InputError);
}

/// Rays of parallel views, and light that is 1 within 5 mm of an axis, along its middle part.
struct TiltedFlame {
  CameraRays rays;
  MeasuredRows measured;

  TiltedFlame(Vec3 base, Vec3 axis, bool both) {
    for (int view = 0; view < (both ? 2 : 1); ++view)
      for (int i = -40; i <= 40; ++i)
        for (int j = -40; j <= 40; ++j) {
          const double across = 0.4e-3 * i, up = 0.4e-3 * j;
          const Vec3 d = view == 0 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
          const Vec3 o = view == 0 ? Vec3{-1, across, up} : Vec3{across, -1, up};
          const Vec3 normal = cross(d, axis);
          const double away = dot(base - o, normal) / length(normal);
          // As high as 8 mm along the axis, as it is seen.
          const Vec3 along = normalize(axis - dot(axis, d) * d);
          const double height = dot(o - base, along);
          const bool lit = std::fabs(away) < 5e-3 && std::fabs(height) < 8e-3;
          rays.rows.push_back({view, 0, 0, rays.rays.size()});
          rays.rays.push_back({o, d, 1, 10, 0});
          measured.flux.push_back(lit ? std::sqrt(25e-6 - away * away) : 0);
          measured.deviation.push_back(1e-5);
        }
  }
};

// Two views tell place and tilt, to a part of the pixels of 0.4 mm; one tells what it sees of them,
// and leaves the depth.
TEST(AxisFit, FindsATiltedAxis) {
  const Vec3 base{1.3e-3, -0.9e-3, 0}, axis = normalize(Vec3{0.08, -0.05, 1});
  const TiltedFlame two(base, axis, true);
  const FlameAxis found = fit_axis(two.rays, two.measured, {{0, 0, 0}, {0, 0, 1}});
  EXPECT_LT(length(cross(found.direction, axis)), 0.01);
  const Vec3 away = base - found.base;
  EXPECT_LT(length(away - dot(away, axis) * axis), 0.1e-3);
  EXPECT_TRUE(relative(found.spread, 2.5e-3, 0.05));  // of a round body: half its radius

  const TiltedFlame one(base, axis, false);
  const FlameAxis seen = fit_axis(one.rays, one.measured, {{0, 0, 0}, {0, 0, 1}});
  EXPECT_TRUE(within(seen.base.y, base.y, 0.25, 0.4e-3));  // a quarter of a pixel
  EXPECT_LT(std::fabs(seen.base.x), 1e-6);                 // depth is not told
  EXPECT_LT(std::fabs(seen.direction.y / seen.direction.z + 0.05), 0.01);
  EXPECT_LT(std::fabs(seen.direction.x), 1e-6);
  MeasuredRows dark = one.measured;
  for (double& flux : dark.flux) flux = 0;
  EXPECT_THROW(fit_axis(one.rays, dark, {{0, 0, 0}, {0, 0, 1}}), InputError);
}

TEST(RingUnknowns, RefusesWhatAreNoRings) {
  RingGrid grid = upright(3, 3);
  grid.radial_step = 0;
  EXPECT_THROW(make_ring_unknowns(grid), InputError);
  grid = upright(3, 3);
  grid.axis = {0, 0, 0};
  EXPECT_THROW(make_ring_unknowns(grid), InputError);
  grid = upright(3, 0);
  EXPECT_THROW(make_ring_unknowns(grid), InputError);
}

// The total of all wavelengths falls as the fourth power of the temperature only: a ten-thousandth
// of a flame's would be 200 K.
TEST(FlameEstimate, NothingIsColderThanTheSurroundings) {
  const auto rings = make_ring_unknowns(upright(5, 13));
  const SourceFunction source = SourceFunction::total();
  Reconstruction found;
  found.model = RowModel::source;
  found.at_places.assign(rings->size(), 0.0);
  found.at_places[40] = source(2000);
  found.at_places[41] = 3e-4 * source(2000);  // 263 K
  found.at_places[60] = 1e-3 * source(2000);  // 356 K
  const FlameEstimate estimate =
      estimate_flame(found, *rings, std::vector<double>(rings->size(), 30.0), source);
  EXPECT_TRUE(relative(estimate.temperature[40], 2000, 1e-9));
  EXPECT_FALSE(estimate.decided[41]);
  EXPECT_TRUE(relative(estimate.temperature[41], 2000, 1e-9));  // its neighbour's
  EXPECT_TRUE(relative(estimate.temperature[60], 2000 * std::pow(1e-3, 0.25), 1e-6));
  for (const double t : estimate.temperature) EXPECT_TRUE(t == 0 || t > 293);
}

}  // namespace
}  // namespace plenoflame::test::ring_unknowns_test
