#include <algorithm>
#include <cmath>
#include <utility>

#include "plenoflame/inverse/unknowns.h"

namespace plenoflame {
namespace {

constexpr std::size_t kNone = static_cast<std::size_t>(-1);

/// Calls use(unknown, the one before, the one behind) along an axis; kNone is beyond the lattice.
template <class Use>
void along(const Unknowns& unknowns, std::size_t axis, const Use& use) {
  const std::array<int, 3> shape = unknowns.shape();
  std::size_t stride = 1;
  for (std::size_t a = axis + 1; a < 3; ++a) stride *= static_cast<std::size_t>(shape[a]);
  const auto count = static_cast<std::size_t>(shape[axis]);
  if (count < 2) return;
  const bool even = axis == 0 && unknowns.begins_at_centre();
  for (std::size_t j = 0; j < unknowns.size(); ++j) {
    const std::size_t at = j / stride % count;
    const std::size_t behind = at + 1 < count ? j + stride : kNone;
    use(j, at > 0 ? j - stride : even ? behind : kNone, behind);
  }
}

}  // namespace

std::vector<double> values_at_places(const Unknowns& unknowns, std::span<const double> samples,
                                     const std::vector<char>& solved) {
  std::vector<double> values(samples.begin(), samples.end());
  if (!unknowns.is_linear()) return values;
  for (std::size_t axis = 3; axis-- > 0;) {
    const std::vector<double> before = values;
    along(unknowns, axis, [&](std::size_t j, std::size_t lower, std::size_t upper) {
      // A line that ends at the grid's rim may extend beyond it.
      if (lower != kNone && upper != kNone)
        values[j] += (before[lower] - 2 * before[j] + before[upper]) / 12;
    });
  }
  for (std::size_t j = 0; j < solved.size(); ++j)
    if (solved[j] == 0) values[j] = samples[j];
  return values;
}

std::vector<double> samples_of_places(const Unknowns& unknowns, std::span<const double> values) {
  // Each brings the fastest change of three axes nearer by a factor 0.7, and slow ones by far more.
  constexpr int kIterations = 40;
  std::vector<char> solved;
  for (const double value : values) solved.push_back(value > 0);
  std::vector<double> samples(values.begin(), values.end());
  for (int k = 0; k < kIterations; ++k) {
    const std::vector<double> reached = values_at_places(unknowns, samples, solved);
    for (std::size_t j = 0; j < samples.size(); ++j) samples[j] += values[j] - reached[j];
  }
  for (double& sample : samples) sample = std::max(sample, 0.0);
  return samples;
}

std::vector<double> refined_values(const Unknowns& unknowns, std::span<const double> values) {
  std::vector<double> fine(values.begin(), values.end());
  std::size_t behind = fine.size();
  std::size_t before = 1;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto count = static_cast<std::size_t>(unknowns.shape()[axis]);
    behind /= count;
    if (count < 2) continue;
    const bool even = axis == 0 && unknowns.begins_at_centre();
    const std::size_t finer = even ? 2 * count : 2 * count + 1;
    const std::vector<double> own =
        std::exchange(fine, std::vector<double>(before * finer * behind));
    for (std::size_t line = 0; line < before * behind; ++line) {
      const std::size_t b = line / behind, e = line % behind;
      const auto at = [&](std::ptrdiff_t j) {
        if (j < 0 && even) j = -j;
        return j < 0 || j >= static_cast<std::ptrdiff_t>(count)
                   ? 0
                   : own[(b * count + static_cast<std::size_t>(j)) * behind + e];
      };
      for (std::size_t i = 0; i < finer; ++i) {
        const std::size_t k = even ? i : i + 1;
        const auto j = static_cast<std::ptrdiff_t>(k / 2) - (even ? 0 : 1);
        fine[(b * finer + i) * behind + e] =
            k % 2 == 0 ? at(j)
                       : std::max(0.0, (9 * (at(j) + at(j + 1)) - at(j - 1) - at(j + 2)) / 16);
      }
    }
    before *= finer;
  }
  return fine;
}

std::vector<double> averaged_with_neighbours(const Unknowns& unknowns, std::vector<double> values) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::vector<double> own = values;
    along(unknowns, axis, [&](std::size_t j, std::size_t lower, std::size_t upper) {
      const auto at = [&](std::size_t k) { return own[k == kNone ? j : k]; };
      values[j] = 0.5 * own[j] + 0.25 * (at(lower) + at(upper));
    });
  }
  return values;
}

std::vector<double> errors_of_chords(const Unknowns& unknowns, std::span<const double> values,
                                     std::span<const double> absorption) {
  std::vector<double> squares(values.size(), 0.0);
  for (std::size_t axis = 0; axis < 3; ++axis)
    along(unknowns, axis, [&](std::size_t j, std::size_t lower, std::size_t upper) {
      const auto value = [&](std::size_t k) {
        return k == kNone ? 0 : absorption.empty() ? values[k] : absorption[k] * values[k];
      };
      squares[j] += std::pow((value(lower) - 2 * value(j) + value(upper)) / 8, 2);
    });
  squares = averaged_with_neighbours(unknowns, std::move(squares));
  for (std::size_t j = 0; j < squares.size(); ++j) {
    squares[j] = std::sqrt(squares[j]);
    if (!absorption.empty()) squares[j] = absorption[j] > 0 ? squares[j] / absorption[j] : 0;
  }
  return squares;
}

}  // namespace plenoflame
