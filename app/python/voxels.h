#pragma once
#include <pybind11/pybind11.h>

#include <array>
#include <stop_token>
#include <string>
#include <vector>

#include "plenoflame/volumes/flame_file.h"
#include "voxel_arrays.h"

namespace plenoflame::python {

/// A flame's fields on one lattice.
struct Voxels {
  VoxelPlace place;
  std::vector<VoxelArray> arrays;

  /// Null where there is none.
  const VoxelArray* find(const std::string& name) const;
};

/// Temperature, absorption, and the other arrays that are named after emission lines.
/// @param ambient temperature outside [K]
/// @throws InputError: no such array (lists those present); values that are not finite or negative;
/// Cancelled
FlameFields flame_of(const Voxels& voxels, const std::string& temperature,
                     const std::string& absorption, double ambient, const std::stop_token& stop);

}  // namespace plenoflame::python
