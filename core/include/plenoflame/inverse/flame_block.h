#pragma once
#include <vector>

#include "plenoflame/base/execution.h"
#include "plenoflame/inverse/camera_rays.h"
#include "plenoflame/inverse/measurement.h"

/// The block of space from which the light of the pictures comes.
namespace plenoflame {

/// A smaller share of a camera's light outside of a block is blur, and does not mean that the block
/// cuts the flame.
inline constexpr double kLightCut = 0.01;

/// Share of each view's light in pixels without row, or 0 within five standard deviations of their
/// noise. This light means that the block of the rays cuts the flame. Empty if other things emit
/// light. @param bin of the rays' settings
std::vector<double> light_outside(const std::vector<CameraView>& views,
                                  const std::vector<Measurement>& measurements,
                                  const CameraRays& rays, int bin);

/// The block along the world's axes that holds the light that all cameras see in common. It is
/// enlarged by a tenth of its sides on each side. Less than kLightCut of the light is outside.
/// Cameras of one direction do not measure depth. The flame is then as deep as the known block, and
/// at least as deep as it is wide or high.
/// @param known a block about the flame's middle; empty: the middle is where lines of sight meet,
/// or where a single camera is focused.
/// @param channel of the scenes that was measured
/// @throws InputError where no light is above noise, where the cameras see no light in common, and
/// where a camera is focused on infinity @throws Cancelled
Box block_of_light(const std::vector<CameraView>& views,
                   const std::vector<Measurement>& measurements, const Box& known,
                   const Execution& execution = {}, int channel = 0);

}  // namespace plenoflame
