#include <utility>

#include "field.h"
#include "plenoflame/volumes/flame_file.h"

namespace plenoflame {

std::unique_ptr<Medium> load_flame(const FlameSpec& spec, const std::string& scene_folder,
                                   std::vector<SourceFunction> channels,
                                   const Execution& execution) {
  FlameFields flame = read_flame(spec, scene_folder, execution);
  const RigidTransform placement{rotation_xyz(spec.rotation), spec.position};
  for (VoxelField* field : {&flame.temperature, &flame.absorption})
    field->index_to_world = detail::compose(placement, field->index_to_world);
  return make_voxel_medium(std::move(flame.temperature), std::move(flame.absorption),
                           spec.interpolation == Interpolation::trilinear
                               ? VoxelInterpolation::trilinear
                               : VoxelInterpolation::constant,
                           std::move(channels));
}

}  // namespace plenoflame
