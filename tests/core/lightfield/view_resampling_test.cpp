#include "lightfield/view_resampling.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/approx.h"

namespace plenoflame::view_resampling_test {
namespace {

using test::within;

ArraySpec array(Lattice lattice) {
  ArraySpec spec;
  spec.present = true;
  spec.lattice = lattice;
  spec.pitch = 2e-4;
  spec.rotation = 0.3;
  spec.offset = {3e-5, -7e-5};
  spec.types.resize(1);
  return spec;
}

template <class Function>
LensSamples samples(const ArraySpec& spec, const Function& function) {
  const MicrolensLattice lattice(spec);
  const auto lenses = lattice.within({-5e-3, -5e-3}, {5e-3, 5e-3});
  LensSamples result(spec, lenses);
  for (const LensIndex lens : lenses)
    result.at(lens) = static_cast<float>(function(lens, lattice.centre(lens)));
  return result;
}

constexpr Vec2 kPoints[] = {
    {0, 0}, {1.23e-3, -0.4e-3}, {-1.9e-3, 0.77e-3}, {0.051e-3, 1.31e-3}, {-0.6e-3, -1.7e-3}};

TEST(ViewResampling, LinearPicturesAreReproduced) {
  const auto plane = [](Vec2 p) { return 5 + 1e3 * p.x - 700 * p.y; };
  for (const Lattice lattice : {Lattice::square, Lattice::hexagonal}) {
    const auto values = samples(array(lattice), [&](LensIndex, Vec2 p) { return plane(p); });
    for (const Vec2 p : kPoints)
      EXPECT_TRUE(within(values.value(p, ViewResampling::barycentric), plane(p), 1e-6, 5));
  }
}

// The kernels look upwards by half a row (10) and by (1 - cos 30) of a row (9): on a linear picture
// that is all that they do. Up in the picture is +y of the array before its rotation.
TEST(ViewResampling, PaperKernelsShiftALinearPicture) {
  const ArraySpec spec = array(Lattice::hexagonal);
  const Vec2 row{-std::sin(spec.rotation) * spec.pitch * std::sqrt(0.75),
                 std::cos(spec.rotation) * spec.pitch * std::sqrt(0.75)};
  const auto plane = [](Vec2 p) { return 5 + 1e3 * p.x - 700 * p.y; };
  const auto values = samples(spec, [&](LensIndex, Vec2 p) { return plane(p); });
  for (const Vec2 p : kPoints) {
    EXPECT_TRUE(within(values.value(p, ViewResampling::paper10), plane(p + 0.5 * row), 1e-6, 5));
    EXPECT_TRUE(within(values.value(p, ViewResampling::paper9),
                       plane(p + (1 - std::sqrt(0.75)) * row), 1e-6, 5));
  }
}

// One bright lens: the weights themselves, from the formulas by hand.
TEST(ViewResampling, WeightsOfOneLens) {
  ArraySpec spec = array(Lattice::hexagonal);
  spec.rotation = 0;
  spec.offset = {};
  const auto values = samples(spec, [](LensIndex lens, Vec2) {
    return lens == LensIndex{0, 0} ? 1.0 : 0.0;
  });
  const double c = std::sqrt(0.75), row = c * spec.pitch;
  const auto at = [&](double x, double rows, ViewResampling how) {
    return values.value({x * spec.pitch, rows * row}, how);
  };
  // Eq. (9) at the lens: 2c - 1, and of its neighbours at distance c the share 1 - c each.
  EXPECT_TRUE(within(at(0, 0, ViewResampling::paper9), 2 * c - 1 + (1 - c) * (1 - c), 1e-6, 1));
  // The row below takes half of (1 - c) from each side; at x = c one side is exactly on the lens.
  EXPECT_TRUE(within(at(c, -1, ViewResampling::paper9), 0.5 * (1 - c), 1e-6, 1));
  EXPECT_TRUE(within(at(0.5, 0, ViewResampling::paper10), 0.25, 1e-6, 1));
  EXPECT_TRUE(within(at(0.5, -1, ViewResampling::paper10), 0.25, 1e-6, 1));
  EXPECT_TRUE(within(at(0.5, 1, ViewResampling::paper10), 0, 1e-6, 1));
  EXPECT_TRUE(within(at(0, 0, ViewResampling::barycentric), 1, 1e-6, 1));
  EXPECT_TRUE(within(at(0.25, 0.5, ViewResampling::barycentric), 0.5, 1e-6, 1));
  EXPECT_TRUE(within(at(0.5, 1.0 / 3, ViewResampling::barycentric), 1.0 / 3, 1e-6, 1));
  EXPECT_EQ(at(0.24, 0.3, ViewResampling::nearest), 1);
  EXPECT_EQ(at(0.51, 0, ViewResampling::nearest), 0);
}

// The kernels compared on a known scene: waves of one length in twelve directions, on the square
// grid of a view. RMS error over the wave's RMS in percent, by a program of its own in Python
// (numpy) that works from the kernels' formulas; docs/light-fields.md shows the table.
TEST(ViewResampling, ErrorsOnWavesOfKnownLength) {
  ArraySpec spec = array(Lattice::hexagonal);
  spec.rotation = 0;
  const double pi = std::acos(-1.0), step = std::pow(0.75, 0.25) * spec.pitch;
  struct Row {
    double length;  ///< in pitches
    double nearest, barycentric, paper9, paper10;
  };
  for (const Row& row : {Row{12, 13.72, 1.866, 5.686, 16.39}, Row{6, 27.44, 7.355, 16.39, 34.45},
                         Row{4, 40.74, 16.13, 30.82, 53.80}}) {
    double squares[4] = {};
    long count = 0;
    for (int k = 0; k < 12; ++k) {
      const double angle = pi * k / 12, wave = 2 * pi / (row.length * spec.pitch);
      const auto scene = [&](Vec2 p) {
        return std::sin(wave * (std::cos(angle) * p.x + std::sin(angle) * p.y) + 0.3 * k);
      };
      const auto values = samples(spec, [&](LensIndex, Vec2 p) { return scene(p); });
      for (int j = -20; j < 20; ++j)
        for (int i = -20; i < 20; ++i) {
          const Vec2 p{(i + 0.13) * step, (j + 0.29) * step};
          int kernel = 0;
          for (const auto how : {ViewResampling::nearest, ViewResampling::barycentric,
                                 ViewResampling::paper9, ViewResampling::paper10}) {
            const double error = values.value(p, how) - scene(p);
            squares[kernel++] += error * error;
          }
          ++count;
        }
    }
    const auto percent = [&](int kernel) {
      return 100 * std::sqrt(2 * squares[kernel] / static_cast<double>(count));
    };
    EXPECT_TRUE(test::relative(percent(0), row.nearest, 0.03)) << row.length;
    EXPECT_TRUE(test::relative(percent(1), row.barycentric, 0.03)) << row.length;
    EXPECT_TRUE(test::relative(percent(2), row.paper9, 0.03)) << row.length;
    EXPECT_TRUE(test::relative(percent(3), row.paper10, 0.03)) << row.length;
  }
}
TEST(ViewResampling, UnknownSamplesStayUnknown) {
  ArraySpec spec = array(Lattice::square);
  spec.rotation = 0;
  spec.offset = {};
  auto values = samples(spec, [](LensIndex, Vec2) { return 3.0; });
  values.at({1, 0}) = std::numeric_limits<float>::quiet_NaN();
  EXPECT_TRUE(std::isnan(values.value({spec.pitch, 0}, ViewResampling::nearest)));
  EXPECT_TRUE(std::isnan(values.value({0.9 * spec.pitch, 0}, ViewResampling::barycentric)));
  EXPECT_EQ(values.value({0.1 * spec.pitch, 0}, ViewResampling::barycentric), 3);
  EXPECT_TRUE(std::isnan(values.value({1, 0}, ViewResampling::nearest)));
}

}  // namespace
}  // namespace plenoflame::view_resampling_test
