#pragma once
#include "plenoflame/base/execution.h"
#include "plenoflame/image/light_field.h"
#include "plenoflame/scene/compile.h"

namespace plenoflame {

/// Names of the layers that add_ground_truth adds to a light field.
namespace truth {
/// Optical depth of all flames together.
inline constexpr const char* kOpticalDepth = "truth.optical_depth";
/// [m] Mean distance of the emitting gas, weighted by the light that reaches the camera from each
/// place, first channel. Without emission it is the distance of the surface; without a surface it
/// is 0.
inline constexpr const char* kDistance = "truth.distance";
/// [m] First and last place with absorption; 0 without absorption.
inline constexpr const char* kFirstHit = "truth.first_hit";
inline constexpr const char* kLastHit = "truth.last_hit";
/// [K] Mean temperature, weighted like the distance; 0 without emission.
inline constexpr const char* kTemperature = "truth.temperature";
/// Number of the first solid surface on the ray, counted from 1 in the scene; 0: none. Only in
/// scenes with surfaces.
inline constexpr const char* kSurface = "truth.surface";
/// [m] Distance of that surface; 0 without one. Only in scenes with surfaces.
inline constexpr const char* kSurfaceDistance = "truth.surface_distance";
}  // namespace truth

/// Adds the truth along each pixel's chief ray. The chief ray runs from the pixel's centre through
/// the middle of the microlens with the nearest micro-image. Without array it runs through the
/// middle of the exit pupil. A pixel gathers a bundle of rays, of which the chief ray is the middle
/// one. It ends on the first solid surface, so only the flames in front count. Distances are
/// measured along the optical axis from the front vertex of the main lens, like depths in
/// refocusing. A pixel whose ray does not leave the camera has 0 everywhere. If the light field is
/// a part of a picture (kPartOfPicture), only its tiles are filled.
///
/// Optical depth and distance are integrated by Gauss' rule of four points. Steps end where the
/// medium's fields have kinks and have an optical depth of at most 0.1. The relative error is below
/// 1e-6.
/// @throws Cancelled
void add_ground_truth(const CompiledScene& scene, LightField& light_field,
                      const Execution& execution = {});

}  // namespace plenoflame
