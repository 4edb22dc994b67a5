#pragma once
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "plenoflame/base/part.h"
#include "plenoflame/image/light_field.h"
#include "plenoflame/render/merge.h"

namespace plenoflame {

/// A picture to merge.
struct MergePiece {
  std::string path;
  const LightField* field = nullptr;  ///< nullptr: the file has it
  LightField header;                  ///< without pixels
  Part part;
};

/// Pieces of one picture, in an order that does not depend on the order of their names.
struct MergePlan {
  PixelWindow window;  ///< of the merged picture
  /// By seed, then by window (row, then column of its corner), then by part.
  std::map<std::uint64_t, std::vector<std::vector<MergePiece>>> seeds;

  const MergePiece& first() const { return seeds.begin()->second.front().front(); }
};

/// Reads the headers and checks that the pictures are complete. @throws as merge_light_fields()
MergePlan make_merge_plan(const std::vector<MergeInput>& pictures);

}  // namespace plenoflame
