#pragma once
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "plenoflame/base/part.h"
#include "plenoflame/image/light_field.h"

namespace plenoflame {

/// A file to merge, without its pixels.
struct MergePiece {
  std::string path;
  LightField header;
  Part part;
};

/// Pieces of one picture, in an order that does not depend on the order of their names.
struct MergePlan {
  PixelWindow window;  ///< of the merged picture
  /// By seed, then by window (row, then column of its corner), then by part.
  std::map<std::uint64_t, std::vector<std::vector<MergePiece>>> seeds;

  const MergePiece& first() const { return seeds.begin()->second.front().front(); }
};

/// Reads the headers and checks that the files are complete. @throws as merge_light_fields()
MergePlan make_merge_plan(const std::vector<std::string>& paths);

}  // namespace plenoflame
