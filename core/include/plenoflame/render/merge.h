#pragma once
#include <cstddef>
#include <stop_token>
#include <string>
#include <vector>

#include "plenoflame/image/light_field.h"

namespace plenoflame {

/// Numbers of files that were merged into a picture.
struct MergeCounts {
  std::size_t parts = 1;    ///< largest number of parts of a window (`render --part`)
  std::size_t windows = 1;  ///< largest number of windows with one seed
  std::size_t seeds = 1;    ///< number of seeds, over which the mean is taken
};

/// A picture to merge.
struct MergeInput {
  std::string name;                   ///< of its file, or for messages
  const LightField* field = nullptr;  ///< the picture; nullptr: read the file
};

/// Merges the raw pictures of one scene. Parts with the same seed form their window, bit by bit as
/// in one uninterrupted run. Windows side by side form a rectangle. Pictures with different seeds
/// are independent. Their mean is weighted by samples, and its standard error follows from theirs.
/// The order of the pictures does not matter. The function reads one file at a time.
/// @param counts may be nullptr
/// @throws InputError with the name of a file that is incomplete, given twice, or has another scene
/// or other settings than the first.
/// @throws InputError for missing parts or windows
/// @throws FileError, Cancelled as read_light_field()
LightField merge_light_fields(const std::vector<MergeInput>& pictures,
                              const std::stop_token& stop = {}, MergeCounts* counts = nullptr);
/// @param paths of light fields (.exr)
LightField merge_light_fields(const std::vector<std::string>& paths,
                              const std::stop_token& stop = {}, MergeCounts* counts = nullptr);

}  // namespace plenoflame
