#include <algorithm>
#include <cmath>

#include "plenoflame/render/ray_paths.h"
#include "plenoflame/sampling/sobol.h"

namespace plenoflame {
namespace {

template <class Item>
bool wanted(const std::vector<Item>& items, Item item) {
  return items.empty() || std::find(items.begin(), items.end(), item) != items.end();
}

/// Divides the list into `most` stretches of equal length and takes one random entry of each. The
/// selection is even without being periodic.
std::vector<std::size_t> thinned(const std::vector<std::size_t>& all, std::size_t most,
                                 std::uint64_t seed) {
  std::vector<std::size_t> kept;
  const double stretch = static_cast<double>(all.size()) / static_cast<double>(most);
  for (std::size_t i = 0; i < most; ++i) {
    const double place = static_cast<double>(mix64(mix64(seed) + i) >> 11) * std::ldexp(1.0, -53);
    // Stretches do not overlap: each begins where the one before ends.
    const auto first = static_cast<std::size_t>(static_cast<double>(i) * stretch);
    const auto end = static_cast<std::size_t>(static_cast<double>(i + 1) * stretch);
    const std::size_t count = std::max<std::size_t>(1, end - first);
    kept.push_back(all[std::min(
        all.size() - 1, first + static_cast<std::size_t>(place * static_cast<double>(count)))]);
  }
  return kept;
}

}  // namespace

void select_rays(const RaySelection& selection, RayPaths& paths) {
  std::vector<std::size_t> kept;
  for (std::size_t i = 0; i < paths.rays.size(); ++i)
    if (wanted(selection.statuses, paths.rays[i].status.status) &&
        wanted(selection.types, paths.rays[i].type))
      kept.push_back(i);
  if (selection.most > 0 && kept.size() > selection.most)
    kept = thinned(kept, selection.most, selection.seed);
  // Entries move only towards the front, so that none is overwritten before it is moved.
  std::size_t vertex = 0;
  const std::size_t channels = paths.channels.size();
  for (std::size_t to = 0; to < kept.size(); ++to) {
    RayPath ray = paths.rays[kept[to]];
    for (std::size_t k = 0; k < ray.count; ++k)
      paths.vertices[vertex + k] = paths.vertices[ray.first + k];
    ray.first = vertex;
    vertex += ray.count;
    paths.rays[to] = ray;
    for (std::size_t c = 0; c < channels; ++c)
      paths.radiance[to * channels + c] = paths.radiance[kept[to] * channels + c];
  }
  paths.rays.resize(kept.size());
  paths.radiance.resize(kept.size() * channels);
  paths.vertices.resize(vertex);
}

}  // namespace plenoflame
