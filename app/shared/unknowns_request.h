#pragma once
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "plenoflame/inverse/thermal_model.h"
#include "plenoflame/inverse/unknowns.h"
#include "plenoflame/scene/compile.h"
#include "settings.h"

namespace plenoflame {

/// The unknowns to solve for, and what is known of them, as texts.
struct UnknownsRequest {
  SettingNames names = {};  ///< as its caller writes them
  std::string kind = "voxels", axis, basis, absorption;
  std::vector<int> grid;             ///< counts; empty: the usual ones
  std::optional<Vec3> centre, size;  ///< [m] nothing: by the scene or the pictures
  /// The rings' axis where it was fitted: a point of it, and its direction.
  std::optional<std::pair<Vec3, Vec3>> fitted_axis = {};

  /// The block of space, where it was found by the pictures.
  std::optional<Box> fitted_block = {};

  bool fits_axis() const { return kind == "rings" && axis == "fit"; }
  bool fits_block() const { return !size; }
};
template <>
std::span<const SettingRow<UnknownsRequest>> setting_rows();

/// Axes that such unknowns have: 3 of voxels, 2 of rings, 1 of layers.
std::size_t unknown_axes(const UnknownsRequest& request);

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
/// Behind one part of the stop. @param mix one of the scene's part_mixes
FlameAt flame_at(const CompiledScene& scene, const ChannelMix& mix, std::size_t channel,
                 Vec3 place);

/// Gives parts of the stop the absorption of the scene's flames, over that of the channel.
void take_absorption_of_scene(const CompiledScene& scene, std::size_t channel,
                              const Unknowns& unknowns, std::vector<ThermalPart>& parts);

/// The known absorption [1/m], one value for each unknown; empty: nothing is known.
/// @throws UsageError
std::vector<double> absorption_of(const UnknownsRequest& request, const CompiledScene& scene,
                                  std::size_t channel, const Unknowns& unknowns);

}  // namespace plenoflame
