#include "render/compiled/tile_bundles.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "plenoflame/film/film.h"
#include "plenoflame/sampling/sobol.h"
#include "render/compiled/compiled_frame.h"

namespace plenoflame {
namespace {

constexpr double kSteps = std::numeric_limits<std::uint16_t>::max();

}  // namespace

TileBundles::TileBundles(const CompiledCamera& camera, int paths, int parts, BundleReducer reducer)
    : camera_(camera),
      paths_(static_cast<std::uint32_t>(paths)),
      parts_(static_cast<std::uint32_t>(parts)),
      reducer_(std::move(reducer)) {}

void TileBundles::add(const RayBlock<float>& block) {
  traced_ += block.size;
  const RayBatch<float>& lines = block.rays;
  for (std::size_t i = 0; i < static_cast<std::size_t>(block.size); ++i) {
    if (!(block.etendue[i] > 0)) continue;
    const Vec3 direction{static_cast<double>(lines.dx[i]), static_cast<double>(lines.dy[i]),
                         static_cast<double>(lines.dz[i])};
    const Vec3 origin =
        lines.anchor + Vec3{static_cast<double>(lines.x[i]), static_cast<double>(lines.y[i]),
                            static_cast<double>(lines.z[i])};
    const double forward = dot(direction, camera_.along);
    if (!(forward > 0) || !line_meets(camera_.region, origin, direction)) continue;
    const Vec3 d = (1 / forward) * direction;
    const Vec3 from = origin - camera_.anchor;
    const Vec3 at = from - dot(from, camera_.along) * d;
    const auto column = static_cast<std::uint32_t>(block.columns[i] - tile_.x);
    const auto row = static_cast<std::uint32_t>(block.rows[i] - tile_.y);
    const auto part =
        static_cast<std::uint32_t>(block.pupil_parts.empty() ? 0 : block.pupil_parts[i]);
    const std::uint32_t pixel = row * Film::kTile + column;
    const auto path = static_cast<std::uint32_t>(block.path);
    keys_.push_back(2 * ((path * Film::kTile * Film::kTile + pixel) * parts_ + part) +
                    static_cast<std::uint32_t>(block.replicates[i]));
    rays_.push_back(
        {{static_cast<float>(dot(at, camera_.across)), static_cast<float>(dot(at, camera_.down)),
          static_cast<float>(dot(d, camera_.across)), static_cast<float>(dot(d, camera_.down))},
         2 * block.etendue[i]});  // each set alone gives the picture
  }
}

CompiledContent TileBundles::finish() {
  // Sorts by key; rays with equal keys keep their order.
  std::vector<std::size_t> begin(2 * std::size_t{paths_} * parts_ * Film::kTile * Film::kTile + 1);
  for (const std::uint32_t key : keys_) ++begin[key + 1];
  for (std::size_t k = 1; k < begin.size(); ++k) begin[k] += begin[k - 1];
  sorted_.resize(rays_.size());
  std::vector<std::size_t> next(begin.begin(), begin.end() - 1);
  for (std::size_t i = 0; i < rays_.size(); ++i) sorted_[next[keys_[i]]++] = rays_[i];
  CompiledContent tile;
  for (std::size_t k = 0; k + 1 < begin.size(); k += 2) {
    if (begin[k] == begin[k + 2]) continue;
    const std::span<const BundleRay> all(sorted_);
    add_group(static_cast<std::uint32_t>(k), all.subspan(begin[k], begin[k + 1] - begin[k]),
              all.subspan(begin[k + 1], begin[k + 2] - begin[k + 1]), tile);
  }
  keys_.clear(), rays_.clear();
  return tile;
}

void TileBundles::add_group(std::uint32_t key, std::span<const BundleRay> first,
                            std::span<const BundleRay> second, CompiledContent& tile) {
  CompiledGroup group;
  const std::uint32_t part = key / 2 % parts_, rest = key / 2 / parts_;
  const std::uint32_t pixel = rest % (Film::kTile * Film::kTile);
  group.pixel = static_cast<std::uint16_t>(pixel);
  group.path = static_cast<std::uint8_t>(rest / (Film::kTile * Film::kTile));
  group.part = static_cast<std::uint8_t>(part);
  // Coordinates on the sensor, so that a pixel has the same seed in any window.
  const auto column = static_cast<std::uint64_t>(tile_.x) + pixel % Film::kTile;
  const auto row = static_cast<std::uint64_t>(tile_.y) + pixel / Film::kTile;
  const std::uint64_t seed =
      mix64(mix64(camera_.seed ^ mix64(row << 32 | column)) + 256 * group.path + group.part);
  std::array<std::vector<BundleRay>, 2> rules{reducer_.reduce(first, mix64(seed)),
                                              reducer_.reduce(second, mix64(seed + 1))};
  std::array<float, 4> upper{};
  bool any = false;
  for (const std::vector<BundleRay>& rule : rules)
    for (const BundleRay& ray : rule) {
      for (std::size_t k = 0; k < 4; ++k) {
        group.lower[k] = any ? std::min(group.lower[k], ray.place[k]) : ray.place[k];
        upper[k] = any ? std::max(upper[k], ray.place[k]) : ray.place[k];
      }
      any = true;
    }
  for (std::size_t k = 0; k < 4; ++k)
    group.step[k] = static_cast<float>(
        (static_cast<double>(upper[k]) - static_cast<double>(group.lower[k])) / kSteps);
  for (std::size_t set = 0; set < 2; ++set) {
    group.count[set] = static_cast<std::uint16_t>(rules[set].size());
    for (const BundleRay& ray : rules[set]) {
      CompiledNode node;
      for (std::size_t k = 0; k < 4; ++k) {
        const double above =
            static_cast<double>(ray.place[k]) - static_cast<double>(group.lower[k]);
        const double step = static_cast<double>(group.step[k]);
        if (step > 0)
          node.place[k] = static_cast<std::uint16_t>(std::min(kSteps, std::round(above / step)));
      }
      node.weight = ray.weight;
      tile.nodes.push_back(node);
    }
  }
  tile.groups.push_back(group);
}

}  // namespace plenoflame
