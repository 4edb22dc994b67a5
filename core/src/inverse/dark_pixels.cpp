#include "inverse/dark_pixels.h"

#include <algorithm>
#include <cmath>

#include "inverse/operators/vector_sums.h"

namespace plenoflame {
namespace {

/// The root of the sum of each row's squares, to a quarter: its product with random signs.
/// @param support 0 for columns that do not count; empty: all do
std::vector<double> lengths_of_rows(const LinearOperator& a, const std::vector<char>& support) {
  constexpr int kSigns = 8;
  SignSequence signs(3);
  std::vector<double> squares(a.rows(), 0.0), z(a.columns());
  for (int n = 0; n < kSigns; ++n) {
    for (double& value : z) value = signs.next();
    for (std::size_t j = 0; j < support.size(); ++j) z[j] *= support[j] != 0;
    const std::vector<double> product = a * z;
    for (std::size_t i = 0; i < squares.size(); ++i) squares[i] += product[i] * product[i] / kSigns;
  }
  for (double& square : squares) square = std::sqrt(square);
  return squares;
}

}  // namespace

RuledOut behind_dark(const LinearOperator& a, const CameraRays& rays, const MeasuredRows& measured,
                     std::size_t views, const std::vector<char>& support) {
  RuledOut ruled{std::vector<char>(a.columns(), 0), std::vector<double>(a.columns(), 0.0)};
  const std::vector<double> lengths = lengths_of_rows(a, support);
  std::vector<double> all(a.rows()), dark(a.rows()), noise(a.rows()), length(a.rows());
  for (std::size_t v = 0; v < views; ++v) {
    double largest = 0;
    for (std::size_t i = 0; i < a.rows(); ++i) {
      all[i] = static_cast<std::size_t>(rays.rows[i].view) == v && measured.deviation[i] > 0;
      if (all[i] > 0) largest = std::max(largest, measured.flux[i]);
    }
    for (std::size_t i = 0; i < a.rows(); ++i) {
      const double deviation = measured.deviation[i];
      // Five of six pixels without light are below one deviation, half of those that have as much.
      dark[i] = all[i] > 0 && measured.flux[i] <= std::max(deviation, 1e-4 * largest) &&
                deviation < 0.05 * largest;
      noise[i] = dark[i] * deviation;
      length[i] = dark[i] * lengths[i];
    }
    const std::vector<double> seen = transposed_times(a, all), in_dark = transposed_times(a, dark),
                              hiding = transposed_times(a, noise),
                              through = transposed_times(a, length);
    for (std::size_t j = 0; j < seen.size(); ++j) {
      if (!(in_dark[j] > 0.3 * seen[j])) continue;
      const double hidden = through[j] > 0 ? hiding[j] / through[j] : 0;
      ruled.hidden[j] = ruled.empty[j] ? std::min(ruled.hidden[j], hidden) : hidden;
      ruled.empty[j] = 1;
    }
  }
  return ruled;
}

}  // namespace plenoflame
