#include "plenoflame/camera/pupil_cut.h"

#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "plenoflame/base/constants.h"
#include "support/approx.h"

namespace plenoflame::test::pupil_cut_test {
namespace {

constexpr double kLargest = 1e-5;  ///< of the cuts [m]

class Numbers {
 public:
  double operator()(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(engine_);
  }
  int one_of(int count) { return std::uniform_int_distribution<int>(0, count - 1)(engine_); }

 private:
  std::mt19937 engine_{11};
};

/// A column in double precision, by its definition: flat up to where it opens, then straight
/// between equal steps.
double value(const PupilColumn& column, std::size_t side, double distance) {
  const double opens = static_cast<double>(column.opens),
               length = static_cast<double>(column.closes) - opens;
  const double step =
      length > 0 ? std::clamp((distance - opens) / length, 0.0, 1.0) * PupilColumn::kSteps : 0.0;
  const auto k = static_cast<std::size_t>(std::min(std::floor(step), PupilColumn::kSteps - 1.0));
  const double from = static_cast<double>(column.cuts[k][side]),
               to = static_cast<double>(column.cuts[k + 1][side]);
  return from + (step - static_cast<double>(k)) * (to - from);
}

/// @param kind 0: open nowhere 1: closes at once 2: soon
PupilColumn random_column(Numbers& numbers, int kind) {
  PupilColumn column;
  column.opens = static_cast<float>(kind == 0 ? 0.0 : numbers(0, 1e-4));
  const double length = kind == 1 ? 0.0 : kind == 2 ? numbers(0, 1e-6) : numbers(0, 1e-4);
  column.closes = column.opens + static_cast<float>(length);
  for (PupilCut& cut : column.cuts)
    for (float& side : cut) side = static_cast<float>(numbers(-kLargest, kLargest));
  return column;
}

// Columns of all azimuths open and close at the same distances, but are not alike otherwise. Points
// of a pixel: its corners, its middle, and others.
TEST(PupilCut, PixelsHoldEveryCutWithin) {
  Numbers numbers;
  const Vec2 field{0.6, 0.8};
  int looked_at = 0, narrow = 0;
  for (int round = 0; round < 4000; ++round) {
    PupilCuts cuts;
    cuts.columns.fill(random_column(numbers, round / 4 % 4));
    const PupilColumn& column = cuts.columns.front();
    for (PupilColumn& other : cuts.columns)
      for (PupilCut& cut : other.cuts)
        for (float& side : cut) side = static_cast<float>(numbers(-kLargest, kLargest));
    const PixelCuts pixels(cuts);
    const double half = std::pow(10, numbers(-7.5, -4)), turn = numbers(0, 7);
    // Some of them next to the size from which on pixels have a sector of their own.
    const double distance = round % 4 == 3 ? half * numbers(2.5, 4.5) : numbers(0, 2e-4);
    const Vec2 centre =
        round % 2 == 0 ? Vec2{distance, 0} : distance * Vec2{std::cos(turn), std::sin(turn)};
    const PixelView view = pixels.look(centre, half, field);
    const double closes = static_cast<double>(column.closes),
                 opens = static_cast<double>(column.opens);
    constexpr double kRounding = 1e-6;
    // Single precision rounds values, and places, where a column may be steep.
    const double steepest = PupilColumn::kSteps * 2 * kLargest / std::max(closes - opens, 1e-300);
    for (int i = 0; i < 40; ++i) {
      const auto part = [&](int bit) { return i < 4 ? (i >> bit & 1) * 2 - 1.0 : numbers(-1, 1); };
      const Vec2 v = i == 4 ? centre : centre + half * Vec2{part(0), part(1)};
      const double d = length(v);
      EXPECT_TRUE(!view.dark || d >= closes * (1 - kRounding));
      EXPECT_TRUE(!view.open || d <= opens * (1 + kRounding));
      if (view.dark || view.open || d > closes) continue;
      ++looked_at;
      const double way = 8 / constants::pi * std::acos(std::clamp(dot(v, field) / d, -1.0, 1.0));
      const auto j = static_cast<std::size_t>(std::min(way, 7.0));
      const double t = way - static_cast<double>(j);
      const double room = kRounding * (kLargest + (closes + d) * steepest);
      const PupilCut bound = cut_at(*view.column, static_cast<float>(d));
      for (std::size_t side = 0; side < 4; ++side) {
        const double a = value(cuts.columns[j], side, d), b = value(cuts.columns[j + 1], side, d);
        EXPECT_GE(static_cast<double>(bound[side]), a + t * (b - a) - room)
            << "at " << d << ", azimuth " << way << ", opens " << opens << ", closes " << closes;
        narrow += static_cast<double>(bound[side]) < 0.5 * kLargest ? 1 : 0;
      }
    }
  }
  EXPECT_GT(looked_at, 20000);
  EXPECT_GT(narrow, 1000);  // not just any wide bound
}

// If all azimuths are alike a pixel's cuts are that one column; between tables they are mixed.
TEST(PupilCut, LikeColumnsAreTakenAsTheyAre) {
  Numbers numbers;
  PixelCuts tables[2];
  PupilColumn columns[2];
  for (int k = 0; k < 2; ++k) {
    PupilColumn& column = columns[k] = random_column(numbers, 3);
    column.opens = 1e-5F;
    column.closes = 9e-5F;
    PupilCuts cuts;
    cuts.columns.fill(column);
    tables[k] = PixelCuts(cuts);
  }
  for (const float t : {0.0F, 0.25F, 1.0F}) {
    PixelCuts mixed;
    mixed.set_mix(tables[0], tables[1], t);
    const PixelView view = mixed.look({0, 4e-5}, 4e-6, {1, 0});
    EXPECT_FALSE(view.dark || view.open);
    for (double d = 5e-6; d < 9.5e-5; d += 3e-7)
      for (std::size_t side = 0; side < 4; ++side) {
        const double a = value(columns[0], side, d), b = value(columns[1], side, d);
        EXPECT_TRUE(within(static_cast<double>(cut_at(*view.column, static_cast<float>(d))[side]),
                           a + static_cast<double>(t) * (b - a), 1e-5, kLargest));
      }
  }
}

// Open farther out, and no narrower anywhere, though its steps lie elsewhere: nor much wider.
TEST(PupilCut, ReachesFartherWithoutBecomingNarrower) {
  Numbers numbers;
  int alike = 0, all = 0;
  for (int round = 0; round < 200; ++round) {
    PupilColumn column = random_column(numbers, 3);
    column.opens = 2e-5F;
    column.closes = 9e-5F;
    const float farther = column.closes * static_cast<float>(numbers(1, 1.01));
    const PupilColumn reaching = column.reaching(farther);
    EXPECT_EQ(reaching.opens, column.opens);
    EXPECT_EQ(reaching.closes, farther);
    for (double d = 1e-5; d < 9.2e-5; d += 3e-7)
      for (std::size_t side = 0; side < 4; ++side) {
        const double before = value(column, side, d), now = value(reaching, side, d);
        EXPECT_GE(now, before - 1e-5 * kLargest) << d;
        alike += now < before + 0.2 * kLargest ? 1 : 0;
        ++all;
      }
  }
  EXPECT_GT(alike, 0.8 * all);
}

}  // namespace
}  // namespace plenoflame::test::pupil_cut_test
