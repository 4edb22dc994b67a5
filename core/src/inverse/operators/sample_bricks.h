#pragma once
#include <array>
#include <functional>
#include <string>

#include "plenoflame/media/voxel_medium.h"

namespace plenoflame {

/// A field of count[0] x count[1] x count[2] samples from index 0 on, in the bricks of VoxelField;
/// bricks of zeros are left out.
VoxelField sample_bricks(const std::array<int, 3>& count, const AffineTransform& index_to_world,
                         const std::string& name,
                         const std::function<double(int, int, int)>& sample);

}  // namespace plenoflame
