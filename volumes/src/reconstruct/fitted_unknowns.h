#pragma once
#include <optional>
#include <vector>

#include "plenoflame/inverse/axis_fit.h"
#include "plenoflame/volumes/reconstructor.h"

/// Block and axis of the unknowns by the pictures, before they are solved for.
namespace plenoflame {

/// Views of the pixels that were measured.
std::vector<CameraView> windowed(std::vector<CameraView> views,
                                 const std::vector<Measurement>& measurements);

/// The block by the pictures, where none is given. Empty where the scene's flames have one that
/// does not cut the flame. @throws InputError as block_of_light() @throws Cancelled
std::optional<Box> fitted_block(const UnknownsRequest& request, const ReconstructCameras& cameras,
                                const std::vector<Measurement>& measurements,
                                const Execution& execution);

/// A block that holds the flame, where that of the unknowns cuts it. Empty also where the pictures
/// do not tell it, and after a stop.
std::optional<Box> uncut_block(const Reconstruction& figures, const std::vector<CameraView>& views,
                               const std::vector<Measurement>& measurements, const Box& known,
                               int channel, const Execution& execution);

/// The rings' axis by the pictures. It begins with that of the request, or upright in the middle of
/// the block. @throws InputError as fit_axis() @throws Cancelled
FlameAxis fitted_axis(const UnknownsRequest& request, const ReconstructCameras& cameras,
                      const std::vector<Measurement>& measurements, const Execution& execution);

}  // namespace plenoflame
