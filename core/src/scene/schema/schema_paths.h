#pragma once
#include <limits>

#include "plenoflame/scene/scene_schema.h"

/// Parts that the rows of the schema table share: ranges of values, and the chains of members that
/// lead to each table of a scene.
namespace plenoflame::schema {

inline constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr ValueRange above_zero(double upper) {
  return {0, upper, true, false};
}
constexpr ValueRange from_zero(double upper) {
  return {0, upper, false, false};
}
constexpr ValueRange within(double size) {
  return {-size, size, false, false};
}
inline constexpr ValueRange kNonzero{-kInf, kInf, false, true};
inline constexpr ValueRange kIndex{1, 5, false, false};
inline constexpr double kFar = 1e6;          // [m] positions
inline constexpr double kLargestLens = 100;  // [m]
inline constexpr Dimension kLength = Dimension::length;
inline constexpr Dimension kAngle = Dimension::angle;
inline constexpr Dimension kPure = Dimension::none;

}  // namespace plenoflame::schema

#define CAMERA &Scene::camera
#define LENS CAMERA, &CameraSpec::lens
#define DISTORTION LENS, &MainLensSpec::distortion
#define SURFACE LENS, &MainLensSpec::surfaces
#define ARRAY CAMERA, &CameraSpec::array
#define TYPE ARRAY, &ArraySpec::types
#define SENSOR CAMERA, &CameraSpec::sensor
#define FOCUS CAMERA, &CameraSpec::focus
#define TRANSMISSION CAMERA, &CameraSpec::transmission
#define FILTER CAMERA, &CameraSpec::pupil_filters
#define FLAME &Scene::flames
#define LAYER FLAME, &FlameSpec::layers
#define TEMPERATURE FLAME, &FlameSpec::temperature
#define ABSORPTION FLAME, &FlameSpec::absorption
#define LINE FLAME, &FlameSpec::lines
#define EMISSION LINE, &LineSpec::emission
#define SPECTRUM FLAME, &FlameSpec::spectrum
#define SCATTERING FLAME, &FlameSpec::scattering
#define SOLID &Scene::surfaces
#define MATERIAL SOLID, &SolidSurfaceSpec::material
#define TEXTURE MATERIAL, &MaterialSpec::texture
#define LIGHT &Scene::lights
#define CHANNEL &Scene::channels
#define RENDER &Scene::render
#define DEVELOP &Scene::develop
