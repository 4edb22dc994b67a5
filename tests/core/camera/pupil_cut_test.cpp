#include "plenoflame/camera/pupil_cut.h"

#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "support/approx.h"

namespace plenoflame::test {
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

PupilColumn random_column(Numbers& numbers, int kind) {
  PupilColumn column;
  column.opens = static_cast<float>(kind == 0 ? 0.0 : numbers(0, 1e-4));
  const double length = kind == 1 ? 0.0 : kind == 2 ? numbers(0, 1e-6) : numbers(0, 1e-4);
  column.closes = column.opens + static_cast<float>(length);
  for (PupilCut& cut : column.cuts)
    for (float& side : cut) side = static_cast<float>(numbers(-kLargest, kLargest));
  return column;
}

// All azimuths alike: every sector is that one column. Pixels end at its ends and at its steps,
// too.
TEST(PupilCut, PixelsHoldEveryCutWithin) {
  Numbers numbers;
  int cut_pixels = 0;
  for (int round = 0; round < 4000; ++round) {
    PupilCuts cuts;
    cuts.columns.fill(random_column(numbers, round % 4));
    const PupilColumn& column = cuts.columns.front();
    const PixelCuts pixels(cuts);
    const double half = std::pow(10, numbers(-7.5, -4)), turn = numbers(0, 7);
    double distance = numbers(0, 2e-4);
    if (round % 3 == 0)
      distance = static_cast<double>(column.distance_at(numbers.one_of(PupilColumn::kSteps + 1))) +
                 half * (numbers.one_of(3) - 1);
    const Vec2 centre =
        round % 2 == 0 ? Vec2{distance, 0} : distance * Vec2{std::cos(turn), std::sin(turn)};
    const PixelCut pixel = pixels.of_square(centre, half, {0.6, 0.8});
    const double x = std::fabs(centre.x), y = std::fabs(centre.y);
    const double near = std::hypot(std::max(x - half, 0.0), std::max(y - half, 0.0)),
                 far = std::hypot(x + half, y + half);
    const double closes = static_cast<double>(column.closes),
                 opens = static_cast<double>(column.opens);
    constexpr double kRounding = 1e-6;
    EXPECT_TRUE(!pixel.dark || near >= closes * (1 - kRounding));
    EXPECT_TRUE(!pixel.open || far <= opens * (1 + kRounding));
    if (pixel.dark || pixel.open) continue;
    ++cut_pixels;
    // Single precision rounds values, and places, where a column may be steep.
    const double steepest = PupilColumn::kSteps * 2 * kLargest / std::max(closes - opens, 1e-300);
    const double room = kRounding * (kLargest + (closes + far) * steepest);
    for (int i = 0; i <= 40 + PupilColumn::kSteps; ++i) {
      const double d = i <= 40 ? near + (std::min(far, closes) - near) * i / 40
                               : static_cast<double>(column.distance_at(i - 40));
      if (d < near || d > far || d > closes) continue;
      const auto middle = static_cast<double>(pixel.middle);
      const std::size_t part = d < middle ? 0 : 1;
      for (std::size_t side = 0; side < 4; ++side) {
        const double bound = static_cast<double>(pixel.value[part][side]) +
                             static_cast<double>(pixel.slope[part][side]) * (d - middle);
        EXPECT_GE(bound, value(column, side, d) - room)
            << "from " << near << " to " << far << " at " << d << ", opens " << opens << ", closes "
            << closes;
      }
    }
  }
  EXPECT_GT(cut_pixels, 1500);
}

// A straight column is not lifted: a pixel's cut is the column itself.
TEST(PupilCut, StraightColumnsAreTakenAsTheyAre) {
  PupilCuts cuts;
  PupilColumn& column = cuts.columns.front();
  column.opens = 1e-5F;
  column.closes = 9e-5F;
  for (std::size_t k = 0; k < column.cuts.size(); ++k)
    column.cuts[k].fill(5e-5F - 2e-6F * static_cast<float>(k));
  cuts.columns.fill(PupilColumn(column));
  const PixelCuts pixels(cuts);
  for (double distance = 2e-5; distance < 8e-5; distance += 3e-6) {
    const PixelCut pixel = pixels.of_square({0, distance}, 4e-6, {1, 0});
    for (std::size_t part = 0; part < 2; ++part) {
      // The step is 5e-6 m long.
      EXPECT_TRUE(relative(static_cast<double>(pixel.slope[part][0]), -0.4, 1e-4));
      EXPECT_TRUE(relative(static_cast<double>(pixel.value[part][0]),
                           value(column, 0, static_cast<double>(pixel.middle)), 1e-5));
    }
  }
}

}  // namespace
}  // namespace plenoflame::test
