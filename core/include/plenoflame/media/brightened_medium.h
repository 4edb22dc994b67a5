#pragma once
#include <memory>

#include "plenoflame/media/medium.h"

namespace plenoflame {

/// A medium that absorbs as another one does and emits `brightness` (at least 0) times its light.
/// @return that other one for a brightness of 1, nullptr for nullptr
std::shared_ptr<const Medium> brightened(std::shared_ptr<const Medium> medium, double brightness);

}  // namespace plenoflame
