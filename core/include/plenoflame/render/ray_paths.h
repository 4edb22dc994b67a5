#pragma once
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
  Vec3 position;        ///< [m] world
  int surface = 0;      ///< as Camera numbers them, from the scene; or kSensorVertex, kSceneVertex
  double index = 1;     ///< refractive index from here towards the scene
  double distance = 0;  ///< [m] geometric length from the sensor
};

inline constexpr int kSensorVertex = -1;  ///< where the ray starts
/// Where the ray enters and leaves the bounds of the flames; a ray that misses them ends beside
/// their middle.
inline constexpr int kSceneVertex = -2;

/// A ray from the sensor to the scene, or to where it ended.
struct RayPath {
  int column = 0, row = 0;  ///< pixel
  LensIndex lens;           ///< microlens; (0, 0) without array
  int type = -1;            ///< of the microlens; -1: no array
  TraceStatus status;
  double weight = 0;                 ///< [m^2 sr] share of the pixel's etendue; 0 for a chief ray
  double optical_thickness = 0;      ///< of the flames along the ray
  std::size_t first = 0, count = 0;  ///< of RayPaths::vertices
};

/// Rays with what they carry. Summed over all rays of a pixel, weight * radiance is its flux [W].
struct RayPaths {
  std::vector<std::string> channels;  ///< names
  std::vector<double> wavelengths;    ///< [m] per channel; 0: all wavelengths
  std::vector<std::string> surfaces;  ///< names, by number
  std::vector<RayPath> rays;
  std::vector<double> radiance;  ///< [W/(m^2 sr)] ray by ray, all channels of each
  std::vector<RayVertex> vertices;

  double radiance_of(std::size_t ray, std::size_t channel) const {
    return radiance[ray * channels.size() + channel];
  }
};

struct Pixel {
  int column = 0, row = 0;
};

/// Adds the rays of these pixels: those that the backward estimator draws for them with `settings`
/// (samples, replicates, seed; always in double precision; rays of microlenses whose beams miss the
/// flames are drawn, too). Rays that end in the camera are among them, with radiance 0.
/// @throws UsageError for a pixel outside of the sensor or settings that render() refuses
/// @throws Cancelled
void add_pixel_rays(const CompiledScene& scene, const RenderSettings& settings,
                    const std::vector<Pixel>& pixels, const Execution& execution, RayPaths& paths);

/// Adds one ray for each microlens whose micro-image has its centre on the sensor: through the
/// middle of the lens' rear aperture and of the stop's image. Weight 0.
/// @throws InputError without array
void add_chief_rays(const CompiledScene& scene, RayPaths& paths);

/// Pixels drawn at random from the whole sensor, each alike, with repetitions.
std::vector<Pixel> random_pixels(const SensorSpec& sensor, int count, std::uint64_t seed);

/// Paths without rays, for the scene's channels and surfaces.
RayPaths empty_ray_paths(const CompiledScene& scene);

/// Writes VTK PolyData (.vtp; one polyline a ray), CSV (.csv; one line a vertex) or JSON (.json),
/// as the name ends. Contents: docs/rays.md. @throws FileError; UsageError for another ending
void write_ray_paths(const std::string& path, const RayPaths& paths);

}  // namespace plenoflame
