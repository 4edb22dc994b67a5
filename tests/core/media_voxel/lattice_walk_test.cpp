// The walk against the voxel medium's kernel and closed forms: weights times samples are the
// radiance.
#include "plenoflame/media/lattice_walk.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "plenoflame/base/error.h"
#include "voxel_fixture.h"

namespace plenoflame::test::lattice_walk_test {
namespace {

constexpr std::array<int, 3> kCount{13, 11, 17};

AffineTransform oblique() {
  AffineTransform t;
  t.linear = {{{{1e-3, 2e-4, 0}, {-1e-4, 1.2e-3, 1e-4}, {0, 1e-4, 0.9e-3}}}};
  t.translation = {0.9, -5e-3, 2e-3};
  return t;
}

std::vector<Ray> random_rays(int count) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> spread(-1, 1);
  std::vector<Ray> rays;
  for (int i = 0; i < count; ++i) {
    const Vec3 towards{0.907 + 5e-3 * spread(random), 5e-3 * spread(random),
                       9e-3 + 5e-3 * spread(random)};
    const Vec3 d = normalize(Vec3{spread(random), spread(random), spread(random)});
    rays.push_back({towards - 0.1 * d, d});
  }
  rays.push_back({{0.5, 1e-3, 9e-3}, {1, 0, 0}});
  rays.push_back({{0.907, -1, 8e-3}, {0, 1, 0}});
  return rays;
}

struct Fields {
  std::vector<double> emission, absorption, temperature;
  VoxelField emission_field, absorption_field, temperature_field;
};

/// Samples that single precision holds exactly, so that grids and the walk see the same.
Fields random_fields(const AffineTransform& transform, double thickest) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> share(0, 1);
  Fields f;
  for (int n = 0; n < kCount[0] * kCount[1] * kCount[2]; ++n) {
    f.emission.push_back(static_cast<double>(10 * share(random)));
    f.absorption.push_back(
        static_cast<double>(static_cast<float>(thickest) * (0.05f + share(random))));
    f.temperature.push_back(1500);
  }
  const auto field = [&](const std::vector<double>& samples, float background) {
    return make_field(
        {0, 0, 0}, kCount,
        [&](int i, int j, int k) {
          return static_cast<float>(
              samples[static_cast<std::size_t>((i * kCount[1] + j) * kCount[2] + k)]);
        },
        transform, background);
  };
  f.emission_field = field(f.emission, 0);
  f.absorption_field = field(f.absorption, 0);
  f.temperature_field = field(f.temperature, 1500);
  return f;
}

double radiance_of(const LatticeWalk& walk, const Ray& ray, const std::vector<double>& absorption,
                   RowModel model, const std::vector<double>& samples,
                   const RaySpan& span = {-1e30, 1e30}) {
  RayIntervals intervals;
  walk.append(ray, span.near, span.far, intervals);
  IntervalTransfers weights;
  node_weights(intervals, absorption, model, weights);
  double sum = 0;
  for (std::size_t i = 0; i < intervals.size(); ++i)
    sum += weights.near[i] * value_at(intervals[i], 0, samples) +
           weights.far[i] * value_at(intervals[i], 1, samples);
  return sum;
}

// Emission grids, clear and absorbing, through the medium's kernel in double precision: the same
// sums, in another order. Fails when the weights of the two nodes are exchanged.
TEST(LatticeWalk, EmissionGridsAsTheKernelIntegratesThem) {
  const std::vector<Ray> rays = random_rays(200);
  for (const auto mode : {VoxelInterpolation::trilinear, VoxelInterpolation::constant})
    for (const double thickest : {0.0, 3.0, 300.0}) {
      Fields f = random_fields(oblique(), thickest);
      const auto medium = make_voxel_medium(f.temperature_field, f.absorption_field, mode,
                                            {SourceFunction::of_lines(430e-9, {})},
                                            {.extras = {{f.emission_field}, {1}}});
      const Seen seen = see<double>(*medium, rays, with(Isa::baseline, false));
      const LatticeWalk walk({kCount, oblique(), mode});
      int met = 0;
      for (std::size_t r = 0; r < rays.size(); ++r) {
        const double own = radiance_of(walk, rays[r], f.absorption, RowModel::emission, f.emission);
        met += own > 0;
        EXPECT_TRUE(relative(own, seen.radiance[0][r], 1e-12)) << thickest << " ray " << r;
      }
      EXPECT_GT(met, 150);
    }
}

// An isothermal medium: the source function has one value, and so have its samples.
TEST(LatticeWalk, SourceFunctionsAsTheKernelIntegratesThem) {
  const std::vector<Ray> rays = random_rays(200);
  const SourceFunction source = SourceFunction::band(650e-9, 1e-9);
  for (const auto mode : {VoxelInterpolation::trilinear, VoxelInterpolation::constant}) {
    Fields f = random_fields(oblique(), 100);
    VoxelMediumOptions whole_cells;
    whole_cells.tolerance = 0;
    const auto medium =
        make_voxel_medium(f.temperature_field, f.absorption_field, mode, {source}, whole_cells);
    const Seen seen = see<double>(*medium, rays, with(Isa::baseline, false));
    // The field of the source function has no edge: it is the same behind the last samples.
    const LatticeWalk walk({kCount, oblique(), mode});
    for (std::size_t r = 0; r < rays.size(); ++r) {
      RayIntervals intervals;
      walk.append(rays[r], -1e30, 1e30, intervals);
      IntervalTransfers weights;
      const double passed = node_weights(intervals, f.absorption, RowModel::source, weights);
      double sum = 0;
      for (std::size_t i = 0; i < intervals.size(); ++i) sum += weights.near[i] + weights.far[i];
      EXPECT_TRUE(relative(sum * source(1500), seen.radiance[0][r], 1e-10)) << r;
      EXPECT_TRUE(relative(passed, seen.transmittance[r], 1e-12)) << r;
    }
  }
}

struct TwoWeights {
  double near, far;
};

/// Weights on source functions of an interval whose halves have these optical depths.
TwoWeights weights_of(const std::array<double, 2>& depths) {
  RayIntervals one;
  RayInterval& interval = one.add_empty(2);
  interval.count = 2;
  interval.sample[1] = 1;
  interval.weight[0][0] = interval.weight[1][1] = 1;
  IntervalTransfers transfers;
  transfers.set(one, depths, 1, RowModel::source);
  return {transfers.near[0], transfers.far[0]};
}

// Against differences of the weights themselves, from thin to thick, even and uneven. Fails when
// the share of the far node is taken for constant.
TEST(LatticeWalk, SlopesOfTheWeights) {
  for (const double tau : {1e-4, 0.01, 0.3, 0.99, 1.01, 4.0, 15.0})
    for (const double share : {0.05, 0.4, 0.5, 0.6, 0.95}) {
      const std::array<double, 2> at{tau * (1 - share), tau * share};
      const TransferSlopes slopes = transfer_slopes(at[0], at[1]);
      for (std::size_t n = 0; n < 2; ++n) {
        const double h = 1e-3 * at[n];
        const auto moved = [&](double step) {
          std::array<double, 2> there = at;
          there[n] += step;
          return weights_of(there);
        };
        const auto a = moved(h), b = moved(-h), c = moved(2 * h), d = moved(-2 * h);
        const double near = (8 * (a.near - b.near) - (c.near - d.near)) / (12 * h);
        const double far = (8 * (a.far - b.far) - (c.far - d.far)) / (12 * h);
        // If the weights hardly change with tau, differences of their values' last places count.
        const double size = std::max(std::fabs(near) + std::fabs(far), 1e-5 * a.near / at[n]);
        EXPECT_TRUE(within(slopes.near[n], near, 1e-7, size)) << tau << " " << share << " " << n;
        EXPECT_TRUE(within(slopes.far[n], far, 1e-7, size)) << tau << " " << share << " " << n;
      }
    }
  // A node without absorption emits nothing, and begins to where there is some.
  EXPECT_EQ(transfer_slopes(0, 0).near[0], 1);
  EXPECT_EQ(transfer_slopes(0, 0).far[1], 1);
}

// A ray that begins and ends inside of a homogeneous box, in closed form.
TEST(LatticeWalk, HomogeneousStretchInClosedForm) {
  const LatticeWalk walk({{20, 20, 20}, scaled(1e-3), VoxelInterpolation::constant});
  const Ray ray{{-1, 9.7e-3, 10.2e-3}, {1, 0, 0}};
  const double from = 1 + 3.3e-3, to = 1 + 15.9e-3;
  const std::vector<double> emission(8000, 7);
  for (const double kappa : {0.0, 1e-3, 20.0, 900.0}) {
    const std::vector<double> absorption(8000, kappa);
    const double expected =
        kappa > 0 ? -7 / kappa * std::expm1(-kappa * (to - from)) : 7 * (to - from);
    EXPECT_TRUE(
        relative(radiance_of(walk, ray, absorption, RowModel::emission, emission, {from, to}),
                 expected, 1e-11))
        << kappa;
    EXPECT_TRUE(relative(radiance_of(walk, ray, absorption, RowModel::source, emission, {from, to}),
                         expected * kappa, 1e-11))
        << kappa;
  }
}

TEST(LatticeWalk, RefusesWhatIsNoLattice) {
  AffineTransform flat = scaled(1e-3);
  flat.linear.rows[2] = {0, 0, 0};
  EXPECT_THROW(LatticeWalk({{2, 2, 2}, flat, VoxelInterpolation::constant}), InputError);
  EXPECT_THROW(LatticeWalk({{2, 0, 2}, scaled(1e-3), VoxelInterpolation::constant}), InputError);
}

}  // namespace
}  // namespace plenoflame::test::lattice_walk_test
