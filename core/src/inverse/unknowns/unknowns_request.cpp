#include "plenoflame/inverse/unknowns_request.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <sstream>

#include "plenoflame/base/error.h"
#include "plenoflame/base/mended_by.h"

namespace plenoflame {
namespace {

/// A matrix counts its columns with 32 bits. @throws UsageError
void check_number_of_unknowns(const UnknownsRequest& request, const std::vector<int>& counts) {
  double unknowns = 1;
  for (const int count : counts) unknowns *= count;
  constexpr double kMost = std::numeric_limits<std::int32_t>::max();
  if (unknowns <= kMost) return;
  std::ostringstream text;
  text << request.names("grid") << ": " << unknowns << " unknowns are more than " << kMost
       << "; a vector of this length takes " << unknowns * sizeof(double) / 1e9
       << " GB; use a coarser grid";
  throw UsageError(text.str());
}

/// Very thin unknowns resolve nothing, and a line meets all of them.
void check_shape(const UnknownsRequest& request, const std::string& what,
                 std::initializer_list<double> sides) {
  constexpr double kMost = 1000;
  const auto [least, most] = std::minmax_element(sides.begin(), sides.end());
  if (*most <= kMost * *least) return;
  std::ostringstream text;
  text << request.names("grid") << ": " << what << " would be " << *most / *least
       << " times as long as wide, and at most 1000 times is allowed: use numbers in proportion to "
          "the sides of the box";
  throw UsageError(text.str());
}

std::unique_ptr<Unknowns> voxels_of(const UnknownsRequest& request, const Box& box) {
  const Vec3 size = box.upper - box.lower;
  const double longest = std::max({size.x, size.y, size.z});
  std::vector<int> counts = request.grid.empty() ? std::vector<int>{32} : request.grid;
  if (counts.size() == 1) {
    const double step = longest / counts[0];
    const auto along = [&](double side) {
      return std::max(1, static_cast<int>(std::lround(side / step)));
    };
    counts = {along(size.x), along(size.y), along(size.z)};
  }
  if (counts.size() != 3)
    throw UsageError(request.names("grid") +
                     " must be the voxels along the longest side, or along all three, NX,NY,NZ");
  check_number_of_unknowns(request, counts);
  const Vec3 step{size.x / counts[0], size.y / counts[1], size.z / counts[2]};
  check_shape(request, "voxels", {step.x, step.y, step.z});
  RegularLattice lattice =
      regular_lattice(0.5 * (box.lower + box.upper), size, {counts[0], counts[1], counts[2]});
  lattice.interpolation = request.basis;
  return make_voxel_unknowns(lattice);
}

std::unique_ptr<Unknowns> rings_of(const UnknownsRequest& request, const Box& box) {
  std::vector<int> counts = request.grid.empty() ? std::vector<int>{40, 80} : request.grid;
  if (counts.size() != 2)
    throw UsageError(request.names("grid") + " must be the rings and heights, N,M");
  check_number_of_unknowns(request, counts);
  const Vec3 size = box.upper - box.lower;
  RingGrid grid;
  Vec3 middle = 0.5 * (box.lower + box.upper);
  if (request.fitted_axis) {
    const auto& [point, direction] = *request.fitted_axis;
    grid.axis = direction;
    middle = point + dot(middle - point, direction) * direction;
  } else if (request.axis) {
    grid.axis = *request.axis;
  }
  if (!(length(grid.axis) > 0))
    throw UsageError(request.names("axis") + " must be a direction, e.g. \"0 m, 0 m, 1 m\"");
  grid.axis = normalize(grid.axis);
  const Vec3 a{std::fabs(grid.axis.x), std::fabs(grid.axis.y), std::fabs(grid.axis.z)};
  const double height = dot(a, size);
  // The longest side across the axis is the diameter.
  const double radius =
      0.5 * std::max({size.x * (1 - a.x), size.y * (1 - a.y), size.z * (1 - a.z)});
  grid.rings = counts[0];
  grid.heights = counts[1];
  grid.radial_step = radius / grid.rings;
  grid.height_step = height / grid.heights;
  check_shape(request, "rings", {grid.radial_step, grid.height_step});
  grid.base = middle - (0.5 * (height - grid.height_step)) * grid.axis;
  return make_ring_unknowns(grid);
}

std::unique_ptr<Unknowns> layers_of(const UnknownsRequest& request, const Box& box) {
  const std::vector<int> counts = request.grid.empty() ? std::vector<int>{10} : request.grid;
  if (counts.size() != 1)
    throw UsageError(request.names("grid") + " must be the number of layers, N");
  return make_layer_unknowns(
      {0.5 * (box.lower + box.upper), 0.5 * (box.upper - box.lower), counts[0]});
}

}  // namespace

Box block_of(const UnknownsRequest& request, const CompiledScene& scene) {
  if (request.fitted_block) return *request.fitted_block;
  Box box;
  if (scene.medium) box = scene.medium->bounds();
  if (box.empty() && (!request.centre || request.fits_block())) return box;
  const Vec3 centre = request.centre.value_or(0.5 * (box.lower + box.upper));
  const Vec3 size = request.size.value_or(box.upper - box.lower);
  if (!(size.x > 0) || !(size.y > 0) || !(size.z > 0))
    throw UsageError(request.names("size") + " needs three lengths above 0");
  return {centre - 0.5 * size, centre + 0.5 * size};
}

std::unique_ptr<Unknowns> unknowns_of(const UnknownsRequest& request, const CompiledScene& scene) {
  const Box box = block_of(request, scene);
  if (box.empty())
    throw mended_by(UsageError("the scene has no flame that gives the box; give it"),
                    {"center", "size"});
  switch (request.kind) {
    case UnknownKind::layers:
      return layers_of(request, box);
    case UnknownKind::rings:
      return rings_of(request, box);
    default:
      return voxels_of(request, box);
  }
}

std::string_view name_of(UnknownKind kind) {
  return kind == UnknownKind::voxels ? "voxels" : kind == UnknownKind::rings ? "rings" : "layers";
}

void check_unknowns(const UnknownsRequest& request) {
  const SettingNames& names = request.names;
  const std::string kind(name_of(request.kind));
  if (request.basis != VoxelInterpolation::trilinear && request.kind != UnknownKind::voxels)
    throw UsageError(names("basis") + " is for voxels: " + kind + " have one of their own");
  if ((request.axis || request.fits_axis) && request.kind != UnknownKind::rings)
    throw UsageError(names("axis") + " is for rings, not for " + kind);
  // Dense soot has some 1e3 1/m. Beyond this bound a flame is black within a micrometre.
  constexpr double kMost = 1e6;
  for (const int count : request.grid)
    if (count < 1) throw UsageError(names("grid") + " has counts from 1 on");
  if (!(request.absorption >= 0)) throw UsageError(names("absorption") + " is not below 0");
  if (request.absorption > kMost)
    throw UsageError(
        fmt::format("{}: '{} 1/m' is beyond every flame, which would be black within "
                    "a micrometre; at most 1e6 1/m",
                    names("absorption"), request.absorption));
}

std::size_t unknown_axes(UnknownKind kind) {
  return kind == UnknownKind::rings ? 2 : kind == UnknownKind::layers ? 1 : 3;
}

namespace {

/// Behind one part of the stop. @param mix one of the scene's part_mixes
FlameAt flame_behind(const CompiledScene& scene, const ChannelMix& mix, std::size_t channel,
                     Vec3 place) {
  FlameAt result;
  const auto nodes = static_cast<std::size_t>(scene.medium->channel_count());
  std::vector<double> emission(nodes), absorption(nodes);
  scene.medium->coefficients(place, emission.data());
  scene.medium->absorptions(place, absorption.data());
  double weights = 0;
  for (std::size_t n = 0; n < nodes; ++n) {
    const double weight = mix.empty() ? (n == channel ? 1 : 0)
                                      : mix.weight(static_cast<int>(channel), static_cast<int>(n));
    result.emission += weight * emission[n];
    result.absorption += weight * absorption[n];
    weights += weight;
  }
  if (weights > 0) result.absorption /= weights;
  result.temperature = scene.medium->sample(place).temperature;
  return result;
}

}  // namespace

FlameAt flame_at(const CompiledScene& scene, std::size_t channel, Vec3 place) {
  return flame_behind(scene, scene.mix, channel, place);
}

void take_absorption_of_scene(const CompiledScene& scene, std::size_t channel,
                              const Unknowns& unknowns, std::vector<ThermalPart>& parts) {
  if (parts.size() != scene.part_mixes.size()) return;
  std::vector<double> sums(parts.size(), 0.0);
  double whole = 0;
  for (std::size_t j = 0; j < unknowns.size(); ++j) {
    const Vec3 place = unknowns.place(j);
    whole += flame_at(scene, channel, place).absorption;
    for (std::size_t p = 0; p < parts.size(); ++p)
      sums[p] += flame_behind(scene, scene.part_mixes[p], channel, place).absorption;
  }
  for (std::size_t p = 0; p < parts.size(); ++p)
    if (whole > 0 && sums[p] > 0) parts[p].absorption_ratio = sums[p] / whole;
}

std::vector<double> absorption_of(const UnknownsRequest& request, const CompiledScene& scene,
                                  std::size_t channel, const Unknowns& unknowns) {
  std::vector<double> absorption;
  if (request.absorption_of_scene) {
    const std::string name = request.names("absorption", "scene");
    if (!scene.medium) throw UsageError(name + ": the scene has no flame");
    for (std::size_t j = 0; j < unknowns.size(); ++j)
      absorption.push_back(flame_at(scene, channel, unknowns.place(j)).absorption);
    if (*std::max_element(absorption.begin(), absorption.end()) > 0) return absorption;
    throw UsageError(name + ": the scene's flames absorb nothing within the grid");
  }
  if (request.absorption > 0) absorption.assign(unknowns.size(), request.absorption);
  return absorption;
}

}  // namespace plenoflame
