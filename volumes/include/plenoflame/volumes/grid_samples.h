#pragma once
#include <span>
#include <string>
#include <vector>

#include "plenoflame/math/vector.h"
#include "plenoflame/media/voxel_medium.h"

namespace plenoflame {

/// Values of a field at places [m, world], linear between its samples; its background outside.
/// @throws InputError for a singular transform
std::vector<double> sample_field(const VoxelField& field, std::span<const Vec3> places);

/// The same of a grid of a file, as read_voxel_field() reads it. @throws FileError, InputError
std::vector<double> sample_grid(const std::string& path, const std::string& name,
                                std::span<const Vec3> places);

}  // namespace plenoflame
