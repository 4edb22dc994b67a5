#pragma once
#include <compare>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "plenoflame/camera/camera.h"
#include "plenoflame/image/image.h"
#include "plenoflame/render/render.h"

namespace plenoflame {

/// A vertex of a ray path.
struct RayVertex {
  Vec3 position;           ///< [m] world
  int surface = 0;         ///< as Camera numbers them, from the scene; or a constant below
  double index = 1;        ///< refractive index from here to the next vertex
  double distance = 0;     ///< [m] geometric length from the first vertex
  double temperature = 0;  ///< [K] of the flames here; 0 outside of their bounds
  double absorption = 0;   ///< [1/m] of the flames here
};

inline constexpr int kSensorVertex = -1;  ///< where the ray starts
/// A place where the ray enters or leaves the bounds of the flames. A ray that misses the bounds
/// ends beside their middle.
inline constexpr int kSceneVertex = -2;
inline constexpr int kFlameVertex = -3;   ///< a sample between entry and exit
inline constexpr int kObjectVertex = -4;  ///< the object point that a ray starts from
inline constexpr int kSolidVertex = -5;   ///< on a solid surface of the scene, where the ray ends
/// A place where the ray enters or leaves a window, or ends at its rim or by total reflection.
inline constexpr int kWindowVertex = -6;

/// A ray from the sensor to the first solid surface of the scene, through the scene, or to its end
/// in the camera. A ray from an object point runs the other way.
struct RayPath {
  int column = 0, row = 0;  ///< pixel; -1, -1: it does not arrive on the sensor
  LensIndex lens;           ///< microlens; (0, 0) without array, or when it reaches none
  int type = -1;            ///< of the microlens; -1: none
  TraceStatus status;
  int pupil_part = 0;  ///< part of the stop that it crosses (PupilFilters::part_at())
  int solid = -1;      ///< number of the scene's surface that the ray ends at; -1: none
  double weight = 0;   ///< [m^2 sr] share of the pixel's etendue; 0: not drawn for an image
  double optical_thickness = 0;      ///< of the flames along the ray
  std::size_t first = 0, count = 0;  ///< of RayPaths::vertices
};

/// Rays with the light that they carry from flames, solid surfaces and surroundings. The sum of
/// weight * radiance over all rays of a pixel is its flux [W].
struct RayPaths {
  std::vector<std::string> channels;  ///< names
  std::vector<double> wavelengths;    ///< [m] per channel; 0: all wavelengths
  std::vector<std::string> surfaces;  ///< names, by number
  std::vector<RayPath> rays;
  std::vector<double> radiance;  ///< [W/(m^2 sr)] ray by ray, all channels of each
  std::vector<RayVertex> vertices;
  /// Number of vertices between entry and exit of the flames' bounds, for rays that are added from
  /// now on. They have equal distances and hold temperature and absorption.
  int flame_samples = 0;

  double radiance_of(std::size_t ray, std::size_t channel) const {
    return radiance[ray * channels.size() + channel];
  }
};

struct Pixel {
  int column = 0, row = 0;
  friend auto operator<=>(const Pixel&, const Pixel&) = default;
};

/// Adds the rays that the backward estimator draws for these pixels with `settings` (samples,
/// replicates, seed), always in double precision. Rays of microlenses whose beams miss the flames
/// are included, and so are rays that end in the camera, with radiance 0. A pixel that is given
/// twice has its rays once, so that sums over them stay fluxes.
/// @throws UsageError for a pixel outside of the sensor or settings that render() refuses
/// @throws Cancelled
void add_pixel_rays(const CompiledScene& scene, const RenderSettings& settings,
                    const std::vector<Pixel>& pixels, const Execution& execution, RayPaths& paths);

/// Adds the rays of add_pixel_rays() that pass one microlens, for all pixels that it lights. The
/// sum of weight * radiance over them is the flux through that microlens [W].
/// @param except pixels that are left out because their rays exist already
/// @throws as add_pixel_rays(); InputError without array; UsageError for a microlens that lights no
/// pixel
void add_microlens_rays(const CompiledScene& scene, const RenderSettings& settings, LensIndex lens,
                        const Execution& execution, RayPaths& paths,
                        const std::vector<Pixel>& except = {});

/// Adds `count` rays from a point of the scene towards the camera, in the direction of light. They
/// are spread evenly over the entrance pupil. They arrive at the pixel (column, row), or end inside
/// of the camera. Their weight is 0; radiance and optical thickness are those of the flames between
/// point and camera. A ray that a solid surface blocks in front of the camera ends there, with the
/// status "missed".
/// @param point [m] world, in front of the camera
/// @throws InputError for a point that is not in front of the camera; UsageError for count < 1
void add_object_rays(const CompiledScene& scene, Vec3 point, int count, RayPaths& paths);

/// Adds one ray for each microlens whose micro-image has its centre on the sensor. The ray passes
/// the middle of the lens' rear aperture and of the stop's image. Its weight is 0; its radiance is
/// that of the flames, up to the first solid surface.
/// @throws InputError without array
void add_chief_rays(const CompiledScene& scene, RayPaths& paths);

/// Draws different pixels at random from the whole sensor, each with the same probability.
/// @throws UsageError when the sensor has fewer pixels
std::vector<Pixel> random_pixels(const SensorSpec& sensor, int count, std::uint64_t seed);

/// The rays to keep.
struct RaySelection {
  std::vector<RayStatus> statuses;  ///< empty: any
  std::vector<int> types;           ///< of the microlens, -1: none; empty: any
  /// Largest number of these rays, drawn evenly from all of them; 0: all. Their weights stay as
  /// they are, so that their sum is no longer a flux.
  std::size_t most = 0;
  std::uint64_t seed = 1;
};

/// Removes all other rays, with their vertices; the order stays.
void select_rays(const RaySelection& selection, RayPaths& paths);

/// Paths without rays, for the scene's channels and surfaces.
RayPaths empty_ray_paths(const CompiledScene& scene);

/// Writes a file whose format follows from the ending of its name. VTK PolyData (.vtp) has one
/// polyline a ray, CSV (.csv) one line a vertex. JSON (.json) is possible, too. Numpy arrays (.npz)
/// hold the end points in single precision, with 58 bytes a ray and 4 for each channel. Contents:
/// docs/rays.md. @throws FileError; UsageError for another ending
void write_ray_paths(const std::string& path, const RayPaths& paths);

}  // namespace plenoflame
