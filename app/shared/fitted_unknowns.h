#pragma once
#include <optional>
#include <vector>

#include "plenoflame/inverse/axis_fit.h"
#include "reconstructor.h"

/// What the pictures tell of the unknowns before they are solved for.
namespace plenoflame {

bool any_compiled(const ReconstructCameras& cameras);

/// Views of the pixels that were measured.
std::vector<CameraView> windowed(std::vector<CameraView> views,
                                 const std::vector<Measurement>& measurements);

/// The block by the pictures, where none is given and that of the scene's flames cuts the flame, or
/// there is none; empty otherwise. @throws InputError as block_of_light() @throws Cancelled
std::optional<Box> fitted_block(const UnknownsRequest& request, const ReconstructCameras& cameras,
                                const std::vector<Measurement>& measurements,
                                const Execution& execution);

/// The rings' axis by the pictures, begun with that of the request, or with an upright one through
/// the block that is solved for. @throws InputError as fit_axis() @throws Cancelled
FlameAxis fitted_axis(const UnknownsRequest& request, const ReconstructCameras& cameras,
                      const std::vector<Measurement>& measurements, const Execution& execution);

}  // namespace plenoflame
