#pragma once
#include "plenoflame/scene/compile.h"

namespace plenoflame::cli {

/// Loads every kind of flame that this build knows: OpenVDB files only when built with volumes.
MediumLoader medium_loader();

}  // namespace plenoflame::cli
