#pragma once
#include <span>
#include <string_view>

#include "plenoflame/scene/presets.h"

namespace plenoflame {

struct PresetRow {
  PresetKind kind;
  std::string_view name;
  std::string_view text;
};

/// The files of core/presets, compiled in; sorted by kind, then name.
std::span<const PresetRow> preset_table();

}  // namespace plenoflame
