#pragma once
#include "plenoflame/base/execution.h"
#include "plenoflame/image/light_field.h"
#include "plenoflame/scene/compile.h"

namespace plenoflame {

/// Names of the layers that add_ground_truth adds to a light field.
namespace truth {
/// Optical depth of all flames together.
inline constexpr const char* kOpticalDepth = "truth.optical_depth";
/// [m] Mean distance of what glows in the flames: weighted by the light that reaches the camera
/// from each place, first channel. Where nothing glows, that of the surface; 0 where there is none.
inline constexpr const char* kDistance = "truth.distance";
/// [m] First and last place with absorption. 0 where there is none.
inline constexpr const char* kFirstHit = "truth.first_hit";
inline constexpr const char* kLastHit = "truth.last_hit";
/// [K] Mean temperature of what is seen, weighted as the distance. 0 where nothing glows.
inline constexpr const char* kTemperature = "truth.temperature";
/// The solid surface that is met first: its number in the scene, counted from 1; 0: none. Only in
/// scenes with surfaces.
inline constexpr const char* kSurface = "truth.surface";
/// [m] Its distance; 0 where there is none. Only in scenes with surfaces.
inline constexpr const char* kSurfaceDistance = "truth.surface_distance";
}  // namespace truth

/// The truth along a pixel's chief ray, the ray from the pixel's centre through the middle of the
/// microlens whose micro-image is nearest (without array: through the middle of the exit pupil). A
/// pixel gathers a bundle of rays; this is its middle one. It ends on the first solid surface: of
/// the flames only what stands in front counts. Distances are along the optical axis from the front
/// vertex of the main lens, as depths in refocusing are. Pixels whose ray does not leave the camera
/// have 0 everywhere. Of a picture that is a part of one (kPartOfPicture) only its tiles are looked
/// at.
///
/// Optical depth and distance are integrated by Gauss' rule of four points on steps that end where
/// the medium's fields have kinks and are at most 0.1 deep: relative error below 1e-6.
/// @throws Cancelled
void add_ground_truth(const CompiledScene& scene, LightField& light_field,
                      const Execution& execution = {});

}  // namespace plenoflame
