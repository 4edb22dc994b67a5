#include "unknowns_request.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <sstream>

#include "options.h"
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
  if (request.basis == "constant") lattice.interpolation = VoxelInterpolation::constant;
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
  } else if (!request.axis.empty() && !request.fits_axis()) {
    const auto [x, y, z] = point_option(request.names("axis"), request.axis);
    grid.axis = {x, y, z};
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

bool is_value(const std::string& absorption) {
  return !absorption.empty() && absorption != "none" && absorption != "scene";
}

/// The known value everywhere [1/m]; 0: none is given. @throws UsageError
double value_of_absorption(const UnknownsRequest& request) {
  if (!is_value(request.absorption)) return 0;
  // Dense soot has some 1e3 1/m. Beyond this bound a flame is black within a micrometre.
  constexpr double kMost = 1e6;
  const std::string name = request.names("absorption");
  const double value = quantity_option(name, request.absorption, Dimension::absorption);
  if (!(value > 0)) throw UsageError(name + " must be above 0, or none");
  if (value > kMost)
    throw UsageError(name + ": '" + request.absorption +
                     "' is beyond every flame, which would be black within a micrometre; at most "
                     "1e6 1/m");
  return value;
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
  if (request.kind == "layers") return layers_of(request, box);
  return request.kind == "rings" ? rings_of(request, box) : voxels_of(request, box);
}

template <>
std::span<const SettingRow<UnknownsRequest>> setting_rows() {
  using R = UnknownsRequest;
  using enum SettingKind;
  static const std::vector<SettingRow<R>> rows{
      {"unknowns",
       "KIND",
       "voxels; rings x heights around an axis; ellipsoidal layers that fill the block",
       &R::kind,
       word,
       {"voxels", "rings", "layers"}},
      {"grid",
       "N[,N,N]",
       "Voxels along the longest side or along all three, NX,NY,NZ (32); rings and heights, N,M "
       "(40,80); layers (10)",
       &R::grid,
       text,
       {},
       1,
       100000},
      {"center", "X,Y,Z",
       "Middle of the block, \"1 m, 0 m, 5 mm\"; without it, that of the scene's flames",
       &R::centre, lengths},
      {"size",
       "X,Y,Z",
       "Its sides, \"40 mm, 40 mm, 60 mm\", or auto: those of the scene's flames, or by the "
       "pictures (auto)",
       &R::size,
       lengths,
       {"auto"}},
      {"axis", "X,Y,Z",
       "Direction of the rings' axis through the block's middle (\"0 m, 0 m, 1 m\"), or fit: place "
       "and direction by the pictures",
       &R::axis, lengths},
      {"basis",
       "KIND",
       "Of voxels: trilinear or constant (trilinear)",
       &R::basis,
       word,
       {"trilinear", "constant"}},
      {"absorption", "WHICH",
       "Known absorption: none (no temperature is found), a value like \"8 1/m\" everywhere, or "
       "scene: that of the scene's flames (none)",
       &R::absorption}};
  return rows;
}

void check_unknowns(const UnknownsRequest& request) {
  const SettingNames& names = request.names;
  if (!request.basis.empty() && request.kind != "voxels")
    throw UsageError(names("basis") + " is for voxels: " + request.kind + " have one of their own");
  if (!request.axis.empty() && request.kind != "rings")
    throw UsageError(names("axis") + " is for rings, not for " + request.kind);
  value_of_absorption(request);
}

std::size_t unknown_axes(const UnknownsRequest& request) {
  return request.kind == "rings" ? 2 : request.kind == "layers" ? 1 : 3;
}

FlameAt flame_at(const CompiledScene& scene, std::size_t channel, Vec3 place) {
  return flame_at(scene, scene.mix, channel, place);
}

FlameAt flame_at(const CompiledScene& scene, const ChannelMix& mix, std::size_t channel,
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

void take_absorption_of_scene(const CompiledScene& scene, std::size_t channel,
                              const Unknowns& unknowns, std::vector<ThermalPart>& parts) {
  if (parts.size() != scene.part_mixes.size()) return;
  std::vector<double> sums(parts.size(), 0.0);
  double whole = 0;
  for (std::size_t j = 0; j < unknowns.size(); ++j) {
    const Vec3 place = unknowns.place(j);
    whole += flame_at(scene, channel, place).absorption;
    for (std::size_t p = 0; p < parts.size(); ++p)
      sums[p] += flame_at(scene, scene.part_mixes[p], channel, place).absorption;
  }
  for (std::size_t p = 0; p < parts.size(); ++p)
    if (whole > 0 && sums[p] > 0) parts[p].absorption_ratio = sums[p] / whole;
}

std::vector<double> absorption_of(const UnknownsRequest& request, const CompiledScene& scene,
                                  std::size_t channel, const Unknowns& unknowns) {
  std::vector<double> absorption;
  if (request.absorption.empty() || request.absorption == "none") return absorption;
  if (request.absorption == "scene") {
    const std::string name = request.names("absorption", "scene");
    if (!scene.medium) throw UsageError(name + ": the scene has no flame");
    for (std::size_t j = 0; j < unknowns.size(); ++j)
      absorption.push_back(flame_at(scene, channel, unknowns.place(j)).absorption);
    if (*std::max_element(absorption.begin(), absorption.end()) > 0) return absorption;
    throw UsageError(name + ": the scene's flames absorb nothing within the grid");
  }
  absorption.assign(unknowns.size(), value_of_absorption(request));
  return absorption;
}

}  // namespace plenoflame
