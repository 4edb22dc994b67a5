// Places of extinction drawn through a grid of majorants: bounds against the medium's own values,
// places against the law of extinction.
#include "media/voxels/majorant_grid.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "plenoflame/media/layered_medium.h"
#include "voxel_fixture.h"

namespace plenoflame::test::majorant_grid_test {
namespace {

const std::vector<double> kFactors{0.7, 1.9};

std::vector<SourceFunction> two_channels() {
  return {SourceFunction::total(), SourceFunction::band(650e-9, 1e-12)};
}

/// Voxels of three sizes, turned: thin gas with a few dense wisps, holes, and a brick of one value.
std::shared_ptr<const Medium> wisps(VoxelInterpolation mode) {
  const double c = std::cos(0.5), s = std::sin(0.5);
  AffineTransform turned;
  turned.linear.rows = {{{c * 1e-3, -s * 2e-3, 0}, {s * 1e-3, c * 2e-3, 0}, {0, 0, 0.7e-3}}};
  turned.translation = {0.3, -0.2, 0.1};
  std::mt19937 random(11);
  const auto value = [&](int i, int j, int k) {
    if (i < 8 && j < 8 && k < 8) return 40.0f;
    if (i >= 40 && j < 16) return 0.0f;
    const bool dense = (i / 5 + j / 7 + k / 6) % 9 == 0;
    return std::uniform_real_distribution<float>(0, dense ? 4000.0f : 10.0f)(random);
  };
  const std::array<int, 3> size{61, 40, 50};
  const VoxelField absorption = make_field({-3, 5, 2}, size, value, turned, 0);
  const VoxelField temperature = make_field(
      {-3, 5, 2}, size, [](int, int, int) { return 1500.0f; }, turned, 300);
  return make_voxel_medium(temperature, absorption, mode, two_channels(),
                           {.absorption_factors = kFactors});
}

std::shared_ptr<const Medium> layers() {
  RigidTransform placed;
  const double c = std::cos(0.3), s = std::sin(0.3);
  placed.rotation.rows = {{{c, 0, s}, {0, 1, 0}, {-s, 0, c}}};
  placed.translation = {0.3, -0.15, 0.12};
  return make_layered_medium({{{0, 0, 0}, {0.004, 0.002, 0.003}, 1900, 3000},
                              {{0.05, 0.01, 0}, {0.002, 0.006, 0.002}, 1500, 900},
                              {{0, 0, 0}, {0.09, 0.05, 0.04}, 1200, 5}},
                             placed, two_channels(), kFactors);
}

std::vector<std::shared_ptr<const Medium>> media() {
  const auto voxels = wisps(VoxelInterpolation::trilinear);
  return {voxels, wisps(VoxelInterpolation::constant), layers(),
          make_composite_medium({voxels, layers()})};
}

Vec3 random_place(const Box& box, std::mt19937& random) {
  std::uniform_real_distribution<double> u(0, 1);
  const Vec3 side = box.upper - box.lower;
  return box.lower + Vec3{u(random) * side.x, u(random) * side.y, u(random) * side.z};
}

TEST(MajorantGrid, NothingIsAboveIt) {
  for (const auto& medium : media()) {
    const MajorantGrid grid(*medium);
    std::mt19937 random(5);
    double closest = 0;
    for (int i = 0; i < 200000; ++i) {
      const Vec3 place = random_place(medium->bounds(), random);
      double each[2];
      medium->absorptions(place, each);
      for (std::size_t c = 0; c < 2; ++c) {
        const double most = grid.share_at(place) * grid.majorant(c);
        ASSERT_LE(each[c], most * (1 + 1e-12)) << medium->description();
        if (most > 0) closest = std::max(closest, each[c] / most);
      }
    }
    EXPECT_GT(closest, 0.9);            // nor is it far above
    EXPECT_LT(grid.mean_share(), 0.6);  // and in most places far below the largest
  }
}

// A dense ball: the share of the cells that it reaches into, counted by their corners and middles.
TEST(MajorantGrid, MeanShareOfABall) {
  const double radius = 0.1;
  const auto ball =
      make_layered_medium({{{}, {radius, radius, radius}, 1500, 1e4}}, {}, two_channels());
  const MajorantGrid grid(*ball);
  ASSERT_EQ(grid.cells(), 32768u);
  double inside = 0, near = 0;
  for (int i = 0; i < 32; ++i)
    for (int j = 0; j < 32; ++j)
      for (int k = 0; k < 32; ++k) {
        const auto place = [](int n) { return (n - 15.5) / 16; };
        const double r = length(Vec3{place(i), place(j), place(k)});
        const double half_diagonal = std::sqrt(3.0) / 32;
        inside += r < 1 - half_diagonal;
        near += r < 1 + 1.001 * half_diagonal;
      }
  EXPECT_GT(grid.mean_share() * 32768, inside);
  EXPECT_LT(grid.mean_share() * 32768, near * 1.0001);
}

TEST(MajorantGrid, ThinMediaHaveOneCell) {
  const auto thin = make_layered_medium({{{}, {0.1, 0.1, 0.1}, 1500, 3}}, {}, two_channels());
  EXPECT_EQ(MajorantGrid(*thin).cells(), 1u);
}

/// Places along a ray, and how many were proposed for each.
struct Drawn {
  std::vector<double> places;
  double passed = 0, proposed = 0;
};

Drawn draw(const Medium& medium, const MajorantGrid& grid, const Ray& ray, const RaySpan& within,
           std::size_t node, int count) {
  Drawn drawn;
  for (int i = 0; i < count; ++i) {
    NoiseStream noise(77, static_cast<std::uint64_t>(i));
    double t = 0, before = within.near;
    const bool taken = grid.draw(ray, within, node, noise, t, [&](double at, double majorant) {
      EXPECT_GE(at, before);
      before = at;
      drawn.proposed += 1;
      double each[2];
      medium.absorptions(ray.at(at), each);
      return noise.uniform() * majorant < each[node];
    });
    if (taken)
      drawn.places.push_back(t);
    else
      drawn.passed += 1;
  }
  std::sort(drawn.places.begin(), drawn.places.end());
  return drawn;
}

// The first place lies beyond t with the probability e^-tau(t): Kolmogorov's test, at 1e-4.
TEST(MajorantGrid, PlacesFollowTheLawOfExtinction) {
  constexpr int kCount = 20000;
  for (const auto& medium : media()) {
    const MajorantGrid grid(*medium);
    std::mt19937 random(9);
    const Box box = medium->bounds();
    const Vec3 middle = 0.5 * (box.lower + box.upper);
    std::vector<Ray> rays{{{middle.x, middle.y, box.upper.z + 0.1}, {0, 0, -1}},
                          {{box.lower.x - 0.05, middle.y, middle.z}, {1, 0, 0}},
                          {middle, normalize(Vec3{-1, 0.3, 0.2})}};  // from inside
    for (int i = 0; i < 3; ++i) {
      const Vec3 a = random_place(box, random), b = random_place(box, random);
      rays.push_back({a - 0.3 * normalize(b - a), normalize(b - a)});
    }
    for (std::size_t r = 0; r < rays.size(); ++r) {
      const std::size_t node = r % 2;
      const double near = r == 4 ? 0.31 : 0, far = r == 5 ? 0.33 : 10;
      const Drawn drawn = draw(*medium, grid, rays[r], {near, far}, node, kCount);
      double worst = 0;
      const auto compare = [&](double t, double share) {
        MediumOptions options;
        const double tau = [&] {  // of the node: by steps far below a voxel
          double sum = 0;
          constexpr int kSteps = 20000;
          const RaySpan span = clip_to_box(box, rays[r], near, t);
          if (span.empty()) return 0.0;
          const double step = (span.far - span.near) / kSteps;
          for (int k = 0; k < kSteps; ++k) {
            double each[2];
            medium->absorptions(rays[r].at(span.near + (k + 0.5) * step), each);
            sum += step * each[node];
          }
          return sum;
        }();
        worst = std::max(worst, std::fabs(share - -std::expm1(-tau)));
      };
      for (std::size_t i = 0; i < drawn.places.size(); i += 1 + drawn.places.size() / 6)
        compare(drawn.places[i], static_cast<double>(i) / kCount);
      compare(far, 1 - drawn.passed / kCount);
      EXPECT_LT(worst * std::sqrt(kCount), 2.23) << medium->description() << ", ray " << r;
    }
  }
}

TEST(MajorantGrid, ProposesLittleWhereThereIsLittle) {
  const auto medium = layers();
  const MajorantGrid grid(*medium);
  // Beside both dense layers.
  const Vec3 place = medium->bounds().lower + Vec3{0, 0.02, 0.04};
  const Drawn drawn = draw(*medium, grid, {place, {1, 0, 0}}, {0, 1}, 1, 2000);
  const double length = medium->bounds().upper.x - medium->bounds().lower.x;
  EXPECT_LT(drawn.proposed, 0.02 * 2000 * grid.majorant(1) * length);
  EXPECT_GT(drawn.proposed, 0);
}

}  // namespace
}  // namespace plenoflame::test::majorant_grid_test
