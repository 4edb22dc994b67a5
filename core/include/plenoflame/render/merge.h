#pragma once
#include <cstddef>
#include <stop_token>
#include <string>
#include <vector>

#include "plenoflame/image/light_field.h"

namespace plenoflame {

/// Numbers of files that make up a picture, and in which ways.
struct MergeCounts {
  std::size_t parts = 1;    ///< of a window (`render --part`), at most
  std::size_t windows = 1;  ///< of the sensor
  std::size_t seeds = 1;    ///< of which the mean is taken
};

/// Puts together the raw pictures of one scene. Files of a seed that are parts make up their
/// window, bit by bit as though it had been rendered at one go; windows side by side make up a
/// rectangle. Pictures of different seeds are independent: the mean, weighted by samples, has the
/// standard error that follows from theirs. The order of the names does not matter. One picture at
/// a time is in memory besides the sums.
/// @param paths of light fields (.exr) @param counts may be nullptr
/// @throws InputError naming the file for one that is not complete, of another scene or other
/// settings than the first, given twice, and for parts or windows that are missing
/// @throws FileError, Cancelled as read_light_field()
LightField merge_light_fields(const std::vector<std::string>& paths,
                              const std::stop_token& stop = {}, MergeCounts* counts = nullptr);

}  // namespace plenoflame
