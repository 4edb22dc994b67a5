#include <cmath>
#include <utility>
#include <vector>

#include "field.h"
#include "plenoflame/base/constants.h"
#include "plenoflame/base/error.h"
#include "plenoflame/scene/spectral.h"
#include "plenoflame/volumes/flame_file.h"

namespace plenoflame {
namespace {

void check_scale(const FlameSpec& spec) {
  if (!(spec.scale > 0) || !std::isfinite(spec.scale))
    throw InputError("flame \"" + spec.name + "\" has a scale that is not a positive number");
}

}  // namespace

std::unique_ptr<Medium> load_flame(const FlameSpec& spec, const std::string& scene_folder,
                                   std::vector<SourceFunction> channels,
                                   const Execution& execution) {
  check_scale(spec);
  return make_flame_medium(read_flame(spec, scene_folder, execution), spec, std::move(channels));
}

std::unique_ptr<Medium> make_flame_medium(FlameFields flame, const FlameSpec& spec,
                                          std::vector<SourceFunction> channels) {
  check_scale(spec);
  VoxelMediumOptions options;
  options.absorption_factors = absorption_factors(spec.spectrum, channels);
  options.placement = {spec.scale, {rotation_xyz(spec.rotation), spec.position}};
  VoxelExtras& extras = options.extras;
  extras.lines = std::move(flame.lines);
  extras.line_weights = line_weights(spec, channels);
  // From all directions to one.
  for (VoxelField& line : extras.lines)
    for (float& value : line.values)
      value = static_cast<float>(static_cast<double>(value) / (4 * constants::pi));
  extras.albedo = std::move(flame.albedo);
  return make_voxel_medium(std::move(flame.temperature), std::move(flame.absorption),
                           spec.interpolation == Interpolation::trilinear
                               ? VoxelInterpolation::trilinear
                               : VoxelInterpolation::constant,
                           std::move(channels), options);
}

}  // namespace plenoflame
