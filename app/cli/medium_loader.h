#pragma once
#include <cstddef>
#include <functional>
#include <string>

#include "plenoflame/scene/compile.h"

namespace plenoflame::cli {

/// Loads every kind of flame that this build knows: OpenVDB files only when built with volumes.
MediumLoader medium_loader();

/// Looks whether files of a series have one lattice (volumes/series_lattice.h): which of the
/// scene's flames, the flame with its file, the scene's folder. One for each run.
using SeriesCheck = std::function<void(std::size_t, const FlameSpec&, const std::string&)>;
SeriesCheck series_check();

}  // namespace plenoflame::cli
