#pragma once
#include <openvdb/openvdb.h>

#include "plenoflame/media/voxel_medium.h"

/// The only public header with OpenVDB's types, for code that exchanges grids with OpenVDB itself.
/// Link to plenoflame::volumes_interop.
namespace plenoflame {

/// @throws InputError for a singular transform.
openvdb::FloatGrid::Ptr to_openvdb(const VoxelField& field);

/// See read_voxel_field for what becomes of tiles and inactive voxels. @throws InputError.
VoxelField from_openvdb(const openvdb::FloatGrid& grid);
VoxelField from_openvdb(const openvdb::DoubleGrid& grid);

}  // namespace plenoflame
