#pragma once
#include "plenoflame/inverse/reconstruction.h"

namespace plenoflame {

/// Checks that rows which were made before belong to the pictures and unknowns of a reconstruction.
/// @throws InputError
void check_built(const ReconstructionInput& input, const ReconstructionSettings& settings);

}  // namespace plenoflame
