#pragma once
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cstddef>
#include <string>

#include "media/field_reader.h"
#include "plenoflame/base/error.h"
#include "plenoflame/media/voxel_medium.h"

namespace plenoflame::voxel {

/// The share of the extinction that is not scattered, from a field of albedos.
/// @throws InputError for an albedo outside of [0, 1)
inline VoxelField unscattered_share(const VoxelField& albedo) {
  VoxelField share = albedo;
  const auto turn = [&](float& value, const std::string& where) {
    if (!(value >= 0 && value < 1))
      throw InputError(
          fmt::format("field '{}': the albedo {} is {:g}; it must be at least 0 and "
                      "below 1",
                      albedo.name, where, value));
    value = static_cast<float>(1 - static_cast<double>(value));
  };
  turn(share.background, "of the background");
  for (std::size_t v = 0; v < share.values.size(); ++v) {
    float& value = share.values[v];
    if (value >= 0 && value < 1)  // no text for every voxel
      turn(value, "");
    else
      turn(value, fmt::format("at index ({})", fmt::join(index_of(share, v), ", ")));
  }
  return share;
}

}  // namespace plenoflame::voxel
