#include "plenoflame/camera/microlens_lattice.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <set>

#include "support/approx.h"

namespace plenoflame::test::microlens_lattice_test {
namespace {

ArraySpec array(Lattice lattice, int types, double rotation = 0, Vec2 offset = {}) {
  ArraySpec spec;
  spec.present = true;
  spec.lattice = lattice;
  spec.pitch = 1.5e-4;
  spec.types.resize(static_cast<std::size_t>(types));
  spec.rotation = rotation;
  spec.offset = offset;
  return spec;
}

TEST(MicrolensLattice, CentresAsDocumented) {
  const double p = 1.5e-4, cos30 = std::sqrt(3.0) / 2;
  const MicrolensLattice hex(array(Lattice::hexagonal, 3)), square(array(Lattice::square, 1));
  for (int q = -3; q <= 3; ++q)
    for (int r = -3; r <= 3; ++r) {
      const Vec2 h = hex.centre({q, r}), s = square.centre({q, r});
      EXPECT_TRUE(within(h.x, p * (q + 0.5 * r), 1e-15, 4 * p));
      EXPECT_TRUE(within(h.y, p * r * cos30, 1e-15, 4 * p));
      EXPECT_TRUE(within(s.x, p * q, 1e-15, 4 * p));
      EXPECT_TRUE(within(s.y, p * r, 1e-15, 4 * p));
    }
  // Rotation x towards y about the axis, then the offset.
  const double angle = 0.3;
  const Vec2 offset{2e-5, -7e-5};
  const MicrolensLattice turned(array(Lattice::hexagonal, 3, angle, offset));
  for (int q = -3; q <= 3; ++q)
    for (int r = -3; r <= 3; ++r) {
      const double x = p * (q + 0.5 * r), y = p * r * cos30;
      const Vec2 c = turned.centre({q, r});
      EXPECT_TRUE(within(c.x, offset.x + x * std::cos(angle) - y * std::sin(angle), 1e-15, 4 * p));
      EXPECT_TRUE(within(c.y, offset.y + x * std::sin(angle) + y * std::cos(angle), 1e-15, 4 * p));
    }
}

TEST(MicrolensLattice, ThreeTypesAlternateAroundEveryLens) {
  const MicrolensLattice hex(array(Lattice::hexagonal, 3, 0.1));
  EXPECT_EQ(hex.type({0, 0}), 0);
  std::array<int, 3> count{};
  for (int q = -10; q <= 10; ++q)
    for (int r = -10; r <= 10; ++r) {
      const LensIndex lens{q, r};
      ++count[static_cast<std::size_t>(hex.type(lens))];
      // The neighbours are the six lenses at the pitch, found by distance alone.
      std::array<int, 3> neighbours{};
      for (int dq = -2; dq <= 2; ++dq)
        for (int dr = -2; dr <= 2; ++dr) {
          const double d = length(hex.centre({q + dq, r + dr}) - hex.centre(lens));
          if (d > 1e-4 && d < 1.6e-4)
            ++neighbours[static_cast<std::size_t>(hex.type({q + dq, r + dr}))];
        }
      const int own = hex.type(lens);
      for (int t = 0; t < 3; ++t)
        EXPECT_EQ(neighbours[static_cast<std::size_t>(t)], t == own ? 0 : 3);
    }
  for (const int c : count) EXPECT_EQ(c, 147);
  // One type everywhere, two that alternate along q.
  const MicrolensLattice one(array(Lattice::square, 1)), two(array(Lattice::square, 2));
  for (int q = -5; q <= 5; ++q)
    for (int r = -5; r <= 5; ++r) {
      EXPECT_EQ(one.type({q, r}), 0);
      EXPECT_EQ(two.type({q, r}), (q - r) % 2 == 0 ? 0 : 1);
    }
}

TEST(MicrolensLattice, NearestAgainstBruteForce) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> u(-1, 1);
  for (const Lattice kind : {Lattice::square, Lattice::hexagonal})
    for (const double rotation : {0.0, 0.4, 2.0, -3.0}) {
      const MicrolensLattice lattice(array(kind, 3, rotation, {3e-5, 9e-5}));
      for (int trial = 0; trial < 500; ++trial) {
        const Vec2 point{1e-3 * u(random), 1e-3 * u(random)};
        double best = kInfinity;
        for (int q = -25; q <= 25; ++q)
          for (int r = -25; r <= 25; ++r)
            best = std::min(best, length(lattice.centre({q, r}) - point));
        EXPECT_TRUE(relative(length(lattice.centre(lattice.nearest(point)) - point), best, 1e-12));
      }
      for (int q = -3; q <= 3; ++q)
        for (int r = -3; r <= 3; ++r)
          EXPECT_EQ(lattice.nearest(lattice.centre({q, r})), (LensIndex{q, r}));
    }
}

TEST(MicrolensLattice, WithinAgainstBruteForce) {
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> u(-1, 1);
  for (const Lattice kind : {Lattice::square, Lattice::hexagonal})
    for (const double rotation : {0.0, 0.4, 2.0, -3.0}) {
      const MicrolensLattice lattice(array(kind, 3, rotation, {3e-5, 9e-5}));
      for (int trial = 0; trial < 200; ++trial) {
        const Vec2 a{1e-3 * u(random), 1e-3 * u(random)}, b{1e-3 * u(random), 1e-3 * u(random)};
        const Vec2 lower{std::min(a.x, b.x), std::min(a.y, b.y)};
        const Vec2 upper{std::max(a.x, b.x), std::max(a.y, b.y)};
        std::vector<LensIndex> expected;
        for (int r = -25; r <= 25; ++r)
          for (int q = -25; q <= 25; ++q) {
            const Vec2 c = lattice.centre({q, r});
            if (c.x >= lower.x && c.x <= upper.x && c.y >= lower.y && c.y <= upper.y)
              expected.push_back({q, r});
          }
        EXPECT_EQ(lattice.within(lower, upper), expected);
      }
      EXPECT_TRUE(lattice.within({1e-3, 1e-3}, {-1e-3, -1e-3}).empty());
      // The rectangle is closed.
      const Vec2 c = lattice.centre({2, -1});
      EXPECT_EQ(lattice.within(c, c).size(), 1u);
    }
}

TEST(MicrolensLattice, NothingLiesWithinAnEmptyBox) {
  const MicrolensLattice lattice(array(Lattice::hexagonal, 1));
  // Inside out: a loop over the places between its corners would take 10^10 steps.
  EXPECT_TRUE(lattice.within({1e5, 0}, {-1e5, 1e-3}).empty());
  EXPECT_TRUE(lattice.within({0, 1e5}, {1e-3, -1e5}).empty());
  EXPECT_EQ(lattice.within({-1e-6, -1e-6}, {1e-6, 1e-6}).size(), 1u);
}

}  // namespace
}  // namespace plenoflame::test::microlens_lattice_test
