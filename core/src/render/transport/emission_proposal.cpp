#include "render/transport/emission_proposal.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "plenoflame/base/error.h"
#include "plenoflame/sampling/philox.h"

namespace plenoflame {
namespace {

constexpr int kPointsPerCell = 8;         ///< one in each eighth
constexpr int kScoutPoints = 4096;        ///< for the relative scale of the channels
constexpr double kNeighbourShare = 0.25;  ///< smallest share of the brightest neighbour's weight
constexpr double kFloorShare = 0.02;      ///< smallest share of the mean weight

Vec3 place_in(const Box& box, double u, double v, double w) {
  return {box.lower.x + u * (box.upper.x - box.lower.x),
          box.lower.y + v * (box.upper.y - box.lower.y),
          box.lower.z + w * (box.upper.z - box.lower.z)};
}

/// Replaces each value by the largest of itself and its two neighbours along one axis.
void spread(std::vector<double>& values, std::size_t count, std::size_t stride) {
  const std::size_t slab = count * stride;
  std::vector<double> line(count);
  for (std::size_t first = 0; first < values.size(); first += slab)
    for (std::size_t offset = 0; offset < stride; ++offset) {
      double* const at = values.data() + first + offset;
      for (std::size_t i = 0; i < count; ++i) line[i] = at[i * stride];
      for (std::size_t i = 0; i < count; ++i)
        at[i * stride] =
            std::max({line[i], i > 0 ? line[i - 1] : 0, i + 1 < count ? line[i + 1] : 0});
    }
}

}  // namespace

EmissionProposal::EmissionProposal(const Medium& medium, std::uint64_t seed,
                                   const Execution& execution, int cells_along)
    : bounds_(medium.bounds()) {
  if (bounds_.empty()) return;
  const Vec3 size = bounds_.upper - bounds_.lower;
  if (!(size.x > 0 && size.y > 0 && size.z > 0)) return;  // no volume
  const double longest = std::max({size.x, size.y, size.z});
  const double cell = std::max(longest / cells_along, medium.feature_size() / 8);
  const auto cells = [&](double extent) {
    return std::clamp(static_cast<int>(std::ceil(extent / cell)), 1, cells_along);
  };
  nx_ = cells(size.x), ny_ = cells(size.y), nz_ = cells(size.z);
  cell_volume_ = size.x / nx_ * (size.y / ny_) * (size.z / nz_);
  set_weights(cell_emission(medium, seed, execution));
}

std::size_t EmissionProposal::cell_count() const {
  return static_cast<std::size_t>(nx_) * static_cast<std::size_t>(ny_) *
         static_cast<std::size_t>(nz_);
}

std::vector<double> EmissionProposal::cell_emission(const Medium& medium, std::uint64_t seed,
                                                    const Execution& execution) const {
  const auto channels = static_cast<std::size_t>(medium.channel_count());
  // Channels may differ by orders of magnitude, so each is divided by its own mean.
  std::vector<double> emission(channels), scale(channels);
  for (std::uint64_t i = 0; i < kScoutPoints; ++i) {
    const auto word = philox(seed, i, 0);
    medium.coefficients(
        place_in(bounds_, unit_uniform(word[0]), unit_uniform(word[1]), unit_uniform(word[2])),
        emission.data());
    for (std::size_t c = 0; c < channels; ++c) scale[c] += emission[c] / kScoutPoints;
  }
  // A channel whose mean is 0 is not scaled.
  for (double& s : scale) s = s > 0 ? 1 / s : 1;
  std::vector<double> weights(cell_count());
  const auto slab = static_cast<std::size_t>(ny_) * static_cast<std::size_t>(nx_);
  const bool complete =
      parallel_for(execution, static_cast<std::size_t>(nz_), [&](std::size_t k, int) {
        std::vector<double> j(channels);
        for (std::size_t in_slab = 0; in_slab < slab; ++in_slab) {
          const std::size_t index = k * slab + in_slab;
          const std::size_t column = in_slab % static_cast<std::size_t>(nx_);
          const std::size_t row = in_slab / static_cast<std::size_t>(nx_);
          const auto x = static_cast<double>(column), y = static_cast<double>(row);
          double squares = 0;
          for (int p = 0; p < kPointsPerCell; ++p) {
            const auto word = philox(seed, index, 1 + static_cast<std::uint64_t>(p));
            const auto inside = [](int half, std::uint32_t random) {
              return 0.5 * (half + unit_uniform(random));
            };
            medium.coefficients(place_in(bounds_, (x + inside(p & 1, word[0])) / nx_,
                                         (y + inside(p >> 1 & 1, word[1])) / ny_,
                                         (static_cast<double>(k) + inside(p >> 2, word[2])) / nz_),
                                j.data());
            double sum = 0;
            for (std::size_t c = 0; c < channels; ++c) sum += scale[c] * j[c];
            squares += sum * sum;
          }
          weights[index] = std::sqrt(squares / kPointsPerCell);
        }
      });
  if (!complete) throw Cancelled();
  return weights;
}

void EmissionProposal::set_weights(std::vector<double> weights) {
  const double mean =
      std::accumulate(weights.begin(), weights.end(), 0.0) / static_cast<double>(weights.size());
  // Emission too small for every point of the grid may exist, but it cannot be found.
  if (!(mean > 0)) return;
  std::vector<double> around = weights;
  spread(around, static_cast<std::size_t>(nx_), 1);
  spread(around, static_cast<std::size_t>(ny_), static_cast<std::size_t>(nx_));
  spread(around, static_cast<std::size_t>(nz_),
         static_cast<std::size_t>(nx_) * static_cast<std::size_t>(ny_));
  double total = 0;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    total += std::max({weights[i], kNeighbourShare * around[i], kFloorShare * mean});
    weights[i] = total;
  }
  for (double& w : weights) w /= total;
  weights.back() = 1;
  cumulative_ = std::move(weights);
  guide_.resize(cumulative_.size());
  std::uint32_t cell = 0;
  for (std::size_t k = 0; k < guide_.size(); ++k) {
    while (cumulative_[cell] <= static_cast<double>(k) / static_cast<double>(guide_.size())) ++cell;
    guide_[k] = cell;
  }
}

EmissionProposal::Point EmissionProposal::draw(double choice, double u, double v, double w) const {
  const double place = choice * static_cast<double>(guide_.size());
  std::size_t cell = guide_[std::min(static_cast<std::size_t>(place), guide_.size() - 1)];
  while (cell + 1 < cumulative_.size() && cumulative_[cell] <= choice) ++cell;
  const double share = cumulative_[cell] - (cell > 0 ? cumulative_[cell - 1] : 0);
  const auto nx = static_cast<std::size_t>(nx_), ny = static_cast<std::size_t>(ny_);
  const std::size_t i = cell % nx, j = cell / nx % ny, k = cell / (nx * ny);
  Point point;
  point.position = place_in(bounds_, (static_cast<double>(i) + u) / nx_,
                            (static_cast<double>(j) + v) / ny_, (static_cast<double>(k) + w) / nz_);
  point.density = share / cell_volume_;
  return point;
}

double EmissionProposal::direction_density(const Ray& ray) const {
  const double o[3] = {ray.origin.x - bounds_.lower.x, ray.origin.y - bounds_.lower.y,
                       ray.origin.z - bounds_.lower.z};
  const double d[3] = {ray.direction.x, ray.direction.y, ray.direction.z};
  const double cell[3] = {(bounds_.upper.x - bounds_.lower.x) / nx_,
                          (bounds_.upper.y - bounds_.lower.y) / ny_,
                          (bounds_.upper.z - bounds_.lower.z) / nz_};
  const int cells[3] = {nx_, ny_, nz_};
  double near = 0, far = std::numeric_limits<double>::infinity();
  for (int k = 0; k < 3; ++k) {
    if (d[k] == 0) {
      if (o[k] < 0 || o[k] > cells[k] * cell[k]) return 0;
      continue;
    }
    const double a = -o[k] / d[k], b = (cells[k] * cell[k] - o[k]) / d[k];
    near = std::max(near, std::min(a, b));
    far = std::min(far, std::max(a, b));
  }
  if (!(near < far)) return 0;
  // From cell to cell: Amanatides and Woo, Eurographics (1987) 3.
  std::size_t index = 0, stride = 1;
  double next[3], step[3];
  int at[3];
  std::ptrdiff_t move[3];
  for (int k = 0; k < 3; ++k) {
    at[k] =
        std::clamp(static_cast<int>(std::floor((o[k] + near * d[k]) / cell[k])), 0, cells[k] - 1);
    index += static_cast<std::size_t>(at[k]) * stride;
    move[k] = (d[k] < 0 ? -1 : 1) * static_cast<std::ptrdiff_t>(stride);
    stride *= static_cast<std::size_t>(cells[k]);
    step[k] = d[k] == 0 ? std::numeric_limits<double>::infinity() : cell[k] / std::fabs(d[k]);
    next[k] = d[k] == 0 ? std::numeric_limits<double>::infinity()
                        : ((at[k] + (d[k] > 0 ? 1 : 0)) * cell[k] - o[k]) / d[k];
  }
  double sum = 0, t = near;
  for (;;) {
    const int k = next[0] < next[1] ? (next[0] < next[2] ? 0 : 2) : (next[1] < next[2] ? 1 : 2);
    const double end = std::clamp(next[k], t, far);
    const double share = cumulative_[index] - (index > 0 ? cumulative_[index - 1] : 0);
    sum += share * (end - t) * (end * end + end * t + t * t);
    t = end;
    at[k] += d[k] < 0 ? -1 : 1;
    if (t >= far || at[k] < 0 || at[k] >= cells[k]) break;
    index = static_cast<std::size_t>(static_cast<std::ptrdiff_t>(index) + move[k]);
    next[k] += step[k];
  }
  return sum / (3 * cell_volume_);
}

}  // namespace plenoflame
