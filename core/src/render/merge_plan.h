#pragma once
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "plenoflame/base/part.h"
#include "plenoflame/image/light_field.h"

namespace plenoflame {

/// A file that is to be merged, without its pixels.
struct MergePiece {
  std::string path;
  LightField header;
  Part part;
};

/// Pieces that belong together, in an order that does not depend on that of their names.
struct MergePlan {
  PixelWindow window;  ///< of the merged picture
  /// By seed; of each seed by window (row, then column of its corner), of each window by part.
  std::map<std::uint64_t, std::vector<std::vector<MergePiece>>> seeds;

  const MergePiece& first() const { return seeds.begin()->second.front().front(); }
};

/// Reads the headers, and checks that the files are a whole. @throws as merge_light_fields()
MergePlan make_merge_plan(const std::vector<std::string>& paths);

}  // namespace plenoflame
