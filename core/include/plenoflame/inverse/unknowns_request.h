#pragma once
#include <cstddef>
#include <memory>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "plenoflame/base/setting_names.h"
#include "plenoflame/inverse/thermal_model.h"
#include "plenoflame/inverse/unknowns.h"
#include "plenoflame/scene/compile.h"

namespace plenoflame {

/// The shapes of unknowns: voxels; rings x heights around an axis; ellipsoidal layers.
enum class UnknownKind { voxels, rings, layers };
std::string_view name_of(UnknownKind kind);

/// The unknowns to solve for, and what is known of them.
struct UnknownsRequest {
  SettingNames names = {};  ///< as its caller writes them
  UnknownKind kind = UnknownKind::voxels;
  std::vector<int> grid;             ///< counts; empty: the usual ones
  std::optional<Vec3> centre, size;  ///< [m] nothing: by the scene or the pictures
  std::optional<Vec3> axis;          ///< direction of the rings' axis; nothing: upright
  bool fits_axis = false;            ///< it is found by the pictures
  VoxelInterpolation basis = VoxelInterpolation::trilinear;
  double absorption = 0;             ///< [1/m] known everywhere; 0: not known
  bool absorption_of_scene = false;  ///< that of the scene's flames is known
  /// The rings' axis where it was fitted: a point of it, and its direction.
  std::optional<std::pair<Vec3, Vec3>> fitted_axis = {};
  /// The block of space, where it was found by the pictures.
  std::optional<Box> fitted_block = {};

  bool fits_block() const { return !size; }
  bool knows_absorption() const { return absorption > 0 || absorption_of_scene; }
};

/// Axes that such unknowns have: 3 of voxels, 2 of rings, 1 of layers.
std::size_t unknown_axes(UnknownKind kind);

/// Refuses settings that do not go together, and values that cannot be. @throws UsageError
void check_unknowns(const UnknownsRequest& request);

/// The block that the request asks for, by default that of the scene's flames; empty where neither
/// tells it. @throws UsageError
Box block_of(const UnknownsRequest& request, const CompiledScene& scene);

/// The requested unknowns. @throws UsageError
std::unique_ptr<Unknowns> unknowns_of(const UnknownsRequest& request, const CompiledScene& scene);

/// A channel of the scene's flames at a place.
struct FlameAt {
  double absorption = 0, emission = 0, temperature = 0;
};
FlameAt flame_at(const CompiledScene& scene, std::size_t channel, Vec3 place);

/// Gives parts of the stop the absorption of the scene's flames, over that of the channel.
void take_absorption_of_scene(const CompiledScene& scene, std::size_t channel,
                              const Unknowns& unknowns, std::vector<ThermalPart>& parts);

/// The known absorption [1/m], one value for each unknown; empty: nothing is known.
/// @throws UsageError
std::vector<double> absorption_of(const UnknownsRequest& request, const CompiledScene& scene,
                                  std::size_t channel, const Unknowns& unknowns);

}  // namespace plenoflame
