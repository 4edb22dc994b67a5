#include "render/sampling/worth_levels.h"

#include <algorithm>

namespace plenoflame {
namespace {

/// kWorthOfFew * 2^(-3 (k + 1) / 2).
constexpr double kRootHalf = 0.70710678118654752;
constexpr double limit_after(int k) {
  double limit = WorthLevels::kWorthOfFew;
  for (int i = 0; i <= k; ++i) limit *= 0.5 * kRootHalf;
  return limit;
}
constexpr std::array<double, WorthLevels::kCount> kLimits{
    limit_after(0), limit_after(1), limit_after(2), limit_after(3), limit_after(4), limit_after(5)};
constexpr int kSteps = 64;  ///< over a micro-image, for the search of levels

}  // namespace

double WorthLevels::limit(std::size_t k) {
  return kLimits[k];
}

int WorthLevels::of(double worth) {
  int level = 0;
  for (const double limit : kLimits) level += worth <= limit ? 1 : 0;
  return level;
}

WorthLevels::WorthLevels(const PupilTable& table, double half) : per_step_(1 / table.field_step) {
  for (const PupilNode& node : table.nodes) {
    Rings& rings = nodes_.emplace_back();
    if (node.dark()) continue;
    const OpenShare open(node, half);
    const double outer = node.outer_radius + half, step = outer / kSteps;
    // From outside inwards, so that a ring contains all pixels with a higher worth.
    double distance = outer, worth = open.mean(distance);
    for (std::size_t k = kCount; k-- > 0;) {
      while (worth <= kLimits[k] && distance > 0) {
        distance = std::max(distance - step, 0.0);
        worth = open.mean(distance);
      }
      rings.squares[k] = distance * distance;
    }
  }
}

WorthLevels::Rings WorthLevels::at(double h) const {
  const double place = h * per_step_;
  const auto last = nodes_.size() - 1;
  if (!(place < static_cast<double>(last))) return nodes_[last];
  const auto i = static_cast<std::size_t>(place);
  const double t = place - static_cast<double>(i);
  Rings rings;
  for (std::size_t k = 0; k < kCount; ++k)
    rings.squares[k] = nodes_[i].squares[k] + t * (nodes_[i + 1].squares[k] - nodes_[i].squares[k]);
  return rings;
}

}  // namespace plenoflame
