#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <vector>

#include "library/flame_builder.h"
#include "plenoflame/base/constants.h"
#include "plenoflame/base/error.h"
#include "plenoflame/volumes/flame_library.h"

namespace plenoflame {
namespace {

constexpr int kLines = 8;  // per side: lines along which shares are exact

using Vector = std::array<double, 3>;
Vector array_of(Vec3 v) {
  return {v.x, v.y, v.z};
}

struct Layer {
  Vector centre, semi_axes;
  double smallest_axis;
  double temperature, absorption;
};

/// (distance from the centre) / (distance of the surface in the same direction).
double level(const Layer& layer, const Vector& p) {
  double sum = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    const double x = (p[a] - layer.centre[a]) / layer.semi_axes[a];
    sum += x * x;
  }
  return std::sqrt(sum);
}

struct Interval {
  double begin, end;
};

/// Part of the line p + t e_axis, |t| <= half, inside of an ellipsoid; begin > end: none.
Interval clip(const Layer& layer, const Vector& p, std::size_t axis, double half) {
  double rest = 1;
  for (std::size_t a = 0; a < 3; ++a) {
    if (a == axis) continue;
    const double x = (p[a] - layer.centre[a]) / layer.semi_axes[a];
    rest -= x * x;
  }
  if (rest <= 0) return {1, -1};
  const double reach = layer.semi_axes[axis] * std::sqrt(rest);
  const double middle = layer.centre[axis] - p[axis];
  return {std::max(middle - reach, -half), std::min(middle + reach, half)};
}

class LayeredFlame {
 public:
  LayeredFlame(const std::vector<EllipsoidSpec>& layers, double voxel_size) : reach_(voxel_size) {
    for (const EllipsoidSpec& spec : layers) {
      const Vector axes = array_of(spec.semi_axes);
      layers_.push_back({array_of(spec.centre), axes, std::min({axes[0], axes[1], axes[2]}),
                         spec.temperature, spec.absorption});
    }
  }

  double absorption(Vec3 place) const {
    double mean = 0;
    const std::vector<double> share = shares(array_of(place));
    for (std::size_t i = 0; i < share.size(); ++i) mean += share[i] * layers_[i].absorption;
    return mean;
  }

  double temperature(Vec3 place) const {
    const Vector p = array_of(place);
    const std::vector<double> share = shares(p);
    double absorbed = 0, emitted = 0, hottest = 0;
    std::size_t parts = 0, last = 0;
    for (std::size_t i = 0; i < share.size(); ++i) {
      if (share[i] <= 0) continue;
      ++parts;
      last = i;
      absorbed += share[i] * layers_[i].absorption;
      emitted += share[i] * layers_[i].absorption * std::pow(layers_[i].temperature, 4);
      hottest = std::max(hottest, layers_[i].temperature);
    }
    if (parts == 0) return nearest(p).temperature;
    if (parts == 1) return layers_[last].temperature;
    return absorbed > 0 ? std::pow(emitted / absorbed, 0.25) : hottest;
  }

 private:
  /// Mean over the tent function around p of what belongs to each layer. Their sum is at most 1.
  std::vector<double> shares(const Vector& p) const {
    std::vector<double> share(layers_.size(), 0.0);
    std::array<std::size_t, 64> crossing;
    std::size_t crossing_count = 0;
    std::size_t full = layers_.size();  // the first layer that covers all of the tent
    for (std::size_t i = 0; i < layers_.size() && full == layers_.size(); ++i) {
      const double at = level(layers_[i], p);
      const double reach = 1.7321 * reach_ / layers_[i].smallest_axis;  // of `level` in the tent
      if (at > 1 + reach) continue;
      if (at < 1 - reach) {
        full = i;
      } else {
        crossing[crossing_count++] = i;
      }
    }
    if (crossing_count == 0) {
      if (full < layers_.size()) share[full] = 1;
      return share;
    }
    const std::size_t axis = steepest(layers_[crossing[0]], p);
    const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
    for (int i = 0; i < kLines; ++i)
      for (int j = 0; j < kLines; ++j) {
        const double a = (2 * i + 1) / double{kLines} - 1, b = (2 * j + 1) / double{kLines} - 1;
        Vector line = p;
        line[u] += reach_ * a;
        line[v] += reach_ * b;
        const double weight = (1 - std::fabs(a)) * (1 - std::fabs(b)) / (0.25 * kLines * kLines);
        add_line(line, axis, {crossing.data(), crossing_count}, full, weight, share);
      }
    return share;
  }

  /// Share of the tent function (1 - |t| / h) / h below t, for |t| <= h = reach_.
  double tent_share(double t) const {
    const double x = t / reach_;
    return 0.5 + x - 0.5 * x * std::fabs(x);
  }

  void add_line(const Vector& line, std::size_t axis, std::span<const std::size_t> crossing,
                std::size_t full, double weight, std::vector<double>& share) const {
    std::array<Interval, 64> inside;
    std::array<double, 130> edges;
    std::size_t edge_count = 0;
    edges[edge_count++] = -reach_;
    edges[edge_count++] = reach_;
    for (std::size_t c = 0; c < crossing.size(); ++c) {
      inside[c] = clip(layers_[crossing[c]], line, axis, reach_);
      if (inside[c].begin >= inside[c].end) continue;
      edges[edge_count++] = inside[c].begin;
      edges[edge_count++] = inside[c].end;
    }
    std::sort(edges.begin(), edges.begin() + static_cast<std::ptrdiff_t>(edge_count));
    for (std::size_t e = 0; e + 1 < edge_count; ++e) {
      const double middle = 0.5 * (edges[e] + edges[e + 1]);
      std::size_t owner = full;
      for (std::size_t c = 0; c < crossing.size(); ++c)
        if (middle > inside[c].begin && middle < inside[c].end) {
          owner = crossing[c];
          break;
        }
      if (owner < layers_.size())
        share[owner] += weight * (tent_share(edges[e + 1]) - tent_share(edges[e]));
    }
  }

  static std::size_t steepest(const Layer& layer, const Vector& p) {
    Vector slope;
    for (std::size_t a = 0; a < 3; ++a)
      slope[a] = std::fabs(p[a] - layer.centre[a]) / (layer.semi_axes[a] * layer.semi_axes[a]);
    return static_cast<std::size_t>(std::max_element(slope.begin(), slope.end()) - slope.begin());
  }

  const Layer& nearest(const Vector& p) const {
    const Layer* best = &layers_.front();
    double best_distance = kInfinity;
    for (const Layer& layer : layers_) {
      const double at = level(layer, p);
      const double from_centre =
          std::hypot(p[0] - layer.centre[0], p[1] - layer.centre[1], p[2] - layer.centre[2]);
      const double distance = from_centre * (1 - 1 / at);
      if (distance < best_distance) {
        best_distance = distance;
        best = &layer;
      }
    }
    return *best;
  }

  std::vector<Layer> layers_;
  double reach_;  // [m] of the tent function: the voxel size
};

void check(const std::vector<EllipsoidSpec>& layers) {
  if (layers.size() > 64) throw InputError("a layered flame can have at most 64 layers");
  for (std::size_t i = 0; i < layers.size(); ++i) {
    const EllipsoidSpec& layer = layers[i];
    const std::string name = layer.name.empty() ? fmt::format("layer {}", i + 1)
                                                : fmt::format("layer \"{}\"", layer.name);
    const auto require = [&](bool good, const char* what) {
      if (!good) throw InputError(fmt::format("{}: {}", name, what));
    };
    for (const double axis : array_of(layer.semi_axes))
      require(std::isfinite(axis) && axis > 0, "every semi-axis must be a positive length");
    for (const double centre : array_of(layer.centre))
      require(std::isfinite(centre), "the centre must be finite");
    require(std::isfinite(layer.temperature) && layer.temperature > 0,
            "the temperature must be above 0 K");
    require(std::isfinite(layer.absorption) && layer.absorption >= 0,
            "the absorption must be at least 0");
  }
}

}  // namespace

std::vector<EllipsoidSpec> default_layers() {
  return {{"core", {0, 0, 14e-3}, {4e-3, 4e-3, 12e-3}, 1200, 1.0},
          {"luminous", {0, 0, 22e-3}, {7e-3, 7e-3, 22e-3}, 1650, 30},
          {"outer", {0, 0, 29e-3}, {10e-3, 10e-3, 30e-3}, 1900, 1.5}};
}

FlameFields make_layered_flame(const LayeredFlameOptions& options, const Execution& execution) {
  const std::vector<EllipsoidSpec> layers =
      options.layers.empty() ? default_layers() : options.layers;
  check(layers);
  Box bounds{{kInfinity, kInfinity, kInfinity}, {-kInfinity, -kInfinity, -kInfinity}};
  for (const EllipsoidSpec& layer : layers) {
    const Vec3 low = layer.centre - layer.semi_axes, high = layer.centre + layer.semi_axes;
    bounds.lower = {std::min(bounds.lower.x, low.x), std::min(bounds.lower.y, low.y),
                    std::min(bounds.lower.z, low.z)};
    bounds.upper = {std::max(bounds.upper.x, high.x), std::max(bounds.upper.y, high.y),
                    std::max(bounds.upper.z, high.z)};
  }
  const LayeredFlame flame(layers, options.voxel_size);
  return detail::sample_flame(
      {[&](Vec3 p) { return flame.absorption(p); }, [&](Vec3 p) { return flame.temperature(p); }},
      bounds, options.voxel_size, execution);
}

}  // namespace plenoflame
