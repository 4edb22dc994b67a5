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

/// A camera whose rays have been found once: of each pixel a few rays with positive weights stand
/// for its whole bundle, as the moments of place and slope agree. Pictures of many flames are made
/// of them without tracing the camera again.
namespace plenoflame {

/// A ray in the frame of its group, and the share of the pixel's etendue that it stands for.
struct CompiledNode {
  std::array<std::uint16_t, 4> place{};  ///< u, v, slope of u, slope of v, in steps of the group
  float weight = 0;                      ///< [m^2 sr] of the flux by this set alone
};

/// The rays of a pixel that go the same way through the camera, and through the same part of its
/// stop, in two sets that are independent of each other.
struct CompiledGroup {
  std::array<float, 4> lower{}, step{};  ///< of the nodes' places: [m, m, 1, 1]
  std::uint16_t pixel = 0;               ///< within its tile: row * Film::kTile + column
  std::uint8_t path = 0;                 ///< number of the spectral path
  std::uint8_t part = 0;                 ///< of the stop (PupilFilters::part_at())
  std::array<std::uint16_t, 2> count{};  ///< nodes of either set, one set after the other
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

/// The accuracy to which a camera is to be compiled.
struct CompileSettings {
  PixelWindow window;  ///< width 0: the whole sensor
  /// World box outside of which later flames have no light. Empty: the flames of the scene.
  Box region;
  double margin = 0;  ///< [m] by which the region grows on all sides
  /// Relative RMSE over lit pixels that pictures of a flame in layers are to have; of smoother ones
  /// it is less.
  double error = 0.005;
  std::uint64_t seed = 1;
  // Figures that `error` chooses if they are 0.
  int samples = 0;  ///< rays per pixel and microlens of the bundles, both sets together
  int level = 0;    ///< 1 to kCompileLevels: how many rays are kept
  bool skip = true;
};
inline constexpr int kCompileLevels = 7;

struct CompiledCamera {
  std::string version;  ///< of the program that made it
  std::string key;      ///< of all of the camera that matters, in words (compiled_key())
  PixelWindow window;
  int sensor_width = 0, sensor_height = 0;
  Box region;  ///< outside of which nothing is seen
  /// Rays run through anchor + u * across + v * down with the direction
  /// along + slope_u * across + slope_v * down.
  Vec3 anchor, across, down, along;
  double error = 0;  ///< that was asked for
  int samples = 0, level = 0;
  std::uint64_t seed = 0;

  std::vector<CompiledTile> tiles;      ///< as of a Film of this window
  std::uint64_t groups = 0, nodes = 0;  ///< of all tiles
  /// A copy of what a tile keeps, from memory or from the bundle's file; several threads may ask.
  /// @throws FileError for a file that is damaged or was changed
  std::function<CompiledContent(std::size_t tile)> content;

  double lit_pixels() const;  ///< @throws FileError
};

/// The part of a scene that a compiled camera belongs to: camera, paths, wavelengths where they
/// matter. Two scenes with the same key see the same rays.
std::string compiled_key(const CompiledScene& scene);

/// Finds the rays. @throws InputError for scenes with what has no place in a compiled camera:
/// windows, solid surfaces, lights, scattering; UsageError for settings; Cancelled
CompiledCamera compile_camera(const CompiledScene& scene, const CompileSettings& settings,
                              const Execution& execution = {});

/// @throws FileError
void write_bundle(const std::string& path, const CompiledCamera& camera);

/// Keeps the file open, and reads each tile when it is asked for: it is checked then.
/// @throws FileError (cannot be read, cut off, damaged, another version), InputError (no bundle)
CompiledCamera read_bundle(const std::string& path);

/// Says in one line why a camera does not belong to a scene. @param name of the bundle, for
/// messages @throws InputError
void check_compiled(const CompiledScene& scene, const CompiledCamera& camera,
                    const std::string& name);

/// That a box lies in the region that a camera was compiled for. @param what lies in the box
/// @throws InputError
void check_region(const CompiledCamera& camera, const Box& box, const std::string& what,
                  const std::string& name);

/// That a camera holds the pixels of a window. @throws UsageError
void check_compiled_window(const CompiledCamera& camera, const PixelWindow& window,
                           const std::string& name);

/// A ray that a compiled camera keeps, in the world.
struct CompiledRay {
  int column = 0, row = 0;  ///< of its pixel, on the whole sensor
  int path = 0;             ///< number of the spectral path
  int part = 0;             ///< of the stop
  int set = 0;              ///< 0 or 1
  Vec3 place;               ///< [m] where it passes the plane through the middle of the region
  Vec3 direction;           ///< unit vector, away from the camera
  double weight = 0;        ///< [m^2 sr] of the flux by both sets together
};
/// The rays of one of its tiles. @throws FileError for a damaged one
std::vector<CompiledRay> rays_of_tile(const CompiledScene& scene, const CompiledCamera& camera,
                                      std::size_t tile, const std::string& name);

/// Renders the flames of a scene by a compiled camera: the picture, and its standard error from
/// the two sets. Of the settings window, skip, precision and instruction set hold. The result does
/// not depend on threads.
/// @throws InputError as check_compiled(), FileError for a damaged tile, UsageError for a window
/// that the compiled one does not hold
RenderResult render_compiled(const CompiledScene& scene, const CompiledCamera& camera,
                             const RenderSettings& settings, const Execution& execution = {},
                             const std::string& name = "the compiled camera");

}  // namespace plenoflame
