#pragma once
#include <openvdb/openvdb.h>

#include "plenoflame/media/voxel_medium.h"

namespace plenoflame::detail {

/// Index to world as a column-vector map. The transform must be linear.
AffineTransform affine_of(const openvdb::math::Transform& transform);

/// @throws InputError for a singular transform.
openvdb::math::Transform::Ptr transform_of(const AffineTransform& affine);

}  // namespace plenoflame::detail
