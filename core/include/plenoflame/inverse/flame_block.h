#pragma once
#include <vector>

#include "plenoflame/base/execution.h"
#include "plenoflame/inverse/camera_rays.h"
#include "plenoflame/inverse/measurement.h"

/// The block of space that the light of pictures comes from.
namespace plenoflame {

/// A smaller share of a camera's light beside a block is its blur, and no flame that is cut.
inline constexpr double kLightCut = 0.01;

/// Share of each view's light in pixels of no row, or 0 within five standard deviations of their
/// noise. Such light tells that the block of the rays cuts the flame. Empty where other things
/// shine. @param bin of the rays' settings
std::vector<double> light_outside(const std::vector<CameraView>& views,
                                  const std::vector<Measurement>& measurements,
                                  const CameraRays& rays, int bin);

/// The block along the world's axes that holds what all cameras see in common of their light. It
/// has a tenth of its sides more on each side. Less than kLightCut of the light is beside it.
/// Cameras that look the same way tell no depth. Then the flame is as deep as the known block, and
/// at least as deep as it is wide or high.
/// @param views with drawn rays, of scenes in which nothing but flames shines
/// @param known a block about the flame's middle; empty: the middle is where lines of sight meet,
/// or where a single camera is focused.
/// @param channel of the scenes that was measured
/// @throws InputError where no light is above noise, where the cameras see no light in common, and
/// where a camera is focused on infinity @throws Cancelled
Box block_of_light(const std::vector<CameraView>& views,
                   const std::vector<Measurement>& measurements, const Box& known,
                   const Execution& execution = {}, int channel = 0);

}  // namespace plenoflame
