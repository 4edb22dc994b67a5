#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "plenoflame/base/execution.h"
#include "plenoflame/image/image.h"
#include "plenoflame/math/vector.h"
#include "plenoflame/render/render.h"
#include "plenoflame/scene/compile.h"

/// A compiled camera keeps rays that were found once, so that many flames are rendered without
/// tracing the camera again. A few rays with positive weights represent the whole bundle of a
/// pixel. They have the same moments of position and slope as the bundle.
namespace plenoflame {

/// A ray in the frame of its group, and the share of the pixel's etendue that it represents.
struct CompiledNode {
  std::array<std::uint16_t, 4> place{};  ///< u, v, slope of u, slope of v, in steps of the group
  float weight = 0;                      ///< [m^2 sr] for the flux from this set alone
};

/// Rays of a pixel with the same spectral path and the same part of the stop. They form two sets
/// that are independent of each other.
struct CompiledGroup {
  std::array<float, 4> lower{}, step{};  ///< scale of the nodes' places: [m, m, 1, 1]
  std::uint16_t pixel = 0;               ///< index within its tile: row * Film::kTile + column
  std::uint8_t path = 0;                 ///< number of the spectral path
  std::uint8_t part = 0;                 ///< part of the stop (PupilFilters::part_at())
  std::array<std::uint16_t, 2> count{};  ///< nodes of each set, one set after the other
};

struct CompiledTile {
  std::uint64_t first_group = 0, groups = 0;
  std::uint64_t first_node = 0, nodes = 0;
  std::uint32_t checksum = 0;  ///< CRC-32 of its groups and nodes
  std::uint32_t reserved = 0;
};

/// Content of one tile of a compiled camera.
struct CompiledContent {
  std::vector<CompiledGroup> groups;
  std::vector<CompiledNode> nodes;  ///< of one group after the other
};

/// The accuracy and the region for which a camera is compiled.
struct CompileSettings {
  PixelWindow window;  ///< width 0: the whole sensor
  /// World box that contains all light of later flames. Empty: the flames of the scene.
  Box region;
  double margin = 0;  ///< [m] by which the region grows on all sides
  /// Target for the relative RMSE over lit pixels of a flame in layers. Smoother flames have
  /// smaller errors.
  double error = 0.005;
  std::uint64_t seed = 1;
  // Values that follow from `error` if they are 0.
  int samples = 0;  ///< rays per pixel and microlens of the bundles, both sets together
  int level = 0;    ///< 1 to kCompileLevels; it decides how many rays are kept
  bool skip = true;
};
inline constexpr int kCompileLevels = 7;

struct CompiledCamera {
  std::string version;  ///< version of the program that compiled it
  std::string key;      ///< relevant properties of the camera as text (compiled_key())
  PixelWindow window;
  int sensor_width = 0, sensor_height = 0;
  Box region;  ///< its rays see only this box
  /// Rays run through anchor + u * across + v * down with the direction
  /// along + slope_u * across + slope_v * down.
  Vec3 anchor, across, down, along;
  double error = 0;  ///< CompileSettings::error
  int samples = 0, level = 0;
  std::uint64_t seed = 0;

  std::vector<CompiledTile> tiles;      ///< tiles of a Film of this window
  std::uint64_t groups = 0, nodes = 0;  ///< of all tiles
  /// Returns a copy of the content of a tile, from memory or from the bundle's file. Several
  /// threads may call it. @throws FileError for a file that is damaged or was changed
  std::function<CompiledContent(std::size_t tile)> content;

  double lit_pixels() const;  ///< @throws FileError
};

/// The properties of a scene on which a compiled camera depends: camera, paths, and wavelengths
/// where they matter. Two scenes with the same key see the same rays.
std::string compiled_key(const CompiledScene& scene);

/// Finds the rays. @throws InputError for scenes with windows, solid surfaces, lights or
/// scattering, which a compiled camera cannot hold; UsageError for settings; Cancelled
CompiledCamera compile_camera(const CompiledScene& scene, const CompileSettings& settings,
                              const Execution& execution = {});

/// @throws FileError
void write_bundle(const std::string& path, const CompiledCamera& camera);

/// Keeps the file open. Each tile is read and checked when it is needed.
/// @throws FileError (cannot be read, cut off, damaged, another version), InputError (no bundle)
CompiledCamera read_bundle(const std::string& path);

/// Checks that a camera belongs to a scene; the error gives the reason in one line. @param name of
/// the bundle, for messages @throws InputError
void check_compiled(const CompiledScene& scene, const CompiledCamera& camera,
                    const std::string& name);

/// Checks that a box lies in the region for which a camera was compiled. @param what name of the
/// content of the box, for messages
/// @throws InputError
void check_region(const CompiledCamera& camera, const Box& box, const std::string& what,
                  const std::string& name);

/// Checks that a camera holds all pixels of a window. @throws UsageError
void check_compiled_window(const CompiledCamera& camera, const PixelWindow& window,
                           const std::string& name);

/// A ray of a compiled camera, in world coordinates.
struct CompiledRay {
  int column = 0, row = 0;  ///< pixel, counted on the whole sensor
  int path = 0;             ///< number of the spectral path
  int part = 0;             ///< part of the stop
  int set = 0;              ///< 0 or 1
  Vec3 place;               ///< [m] where it crosses the plane through the middle of the region
  Vec3 direction;           ///< unit vector, away from the camera
  double weight = 0;        ///< [m^2 sr] for the flux from both sets together
};
/// The rays of one tile. @throws FileError for a damaged tile
std::vector<CompiledRay> rays_of_tile(const CompiledScene& scene, const CompiledCamera& camera,
                                      std::size_t tile, const std::string& name);

/// Renders the flames of a scene with a compiled camera. The standard error comes from the two
/// sets. The function uses window, skip, precision and instruction set of the settings. The result
/// does not depend on the number of threads.
/// @throws InputError as check_compiled(), FileError for a damaged tile, UsageError for a window
/// that the compiled camera does not hold
RenderResult render_compiled(const CompiledScene& scene, const CompiledCamera& camera,
                             const RenderSettings& settings, const Execution& execution = {},
                             const std::string& name = "the compiled camera");

}  // namespace plenoflame
