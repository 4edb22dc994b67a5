#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "plenoflame/image/image.h"
#include "plenoflame/scene/scene.h"

namespace CLI {
class App;
}

namespace plenoflame::cli {

/// What the command line of `render` asks for, checked. What is not given stays as the scene says.
struct RenderOptions {
  std::string scene;                   ///< path of the scene file
  std::string output;                  ///< .exr
  std::optional<int> samples;          ///< rays per pixel and microlens; with a target or a time
                                       ///< limit: at most
  std::optional<double> target_error;  ///< relative RMSE over lit pixels, in (0, 1)
  std::optional<double> time_limit;    ///< [s] > 0
  std::optional<Estimator> estimator;
  std::optional<std::uint64_t> seed;
  std::optional<PixelWindow> window;  ///< of the sensor; not yet checked against its size
  int threads = 0;                    ///< 0: one per processor
  std::string resume;                 ///< .exr to go on from; empty: none
  std::string stats;                  ///< .json to write; empty: none
  bool quiet = false;
  bool skip = true;  ///< false: --no-skip
  bool control_variate = true;
  bool truth = false;  ///< ground truth as layers of the light field
  bool json = false;
  bool white = false;  ///< a uniform field in place of the flames
  /// With it: f-numbers at which it is taken, each into a file of its own; empty: the lens as it
  /// is.
  std::vector<double> f_numbers;
};

/// The options as they stand on the command line.
struct RenderArguments {
  RenderOptions options;
  std::string target_error, time_limit, estimator, window;
  std::string seed, samples;
  std::string f_numbers;
};

/// Adds render's options to its command.
void add_render_options(CLI::App& command, RenderArguments& arguments);

/// Checks what was given, before anything is read. @throws UsageError
RenderOptions checked_options(const RenderArguments& arguments);

/// Where the state of a stopped run is kept, for the light field that it was to write.
std::string state_path(const std::string& light_field);

/// Finds out before any work whether the results can be written, and whether the file to go on
/// from is there. @throws FileError
void check_files(const RenderOptions& options);

/// Checks the window against the sensor, now that the scene is known. @throws UsageError
void check_window(const RenderOptions& options, const SensorSpec& sensor);

}  // namespace plenoflame::cli
