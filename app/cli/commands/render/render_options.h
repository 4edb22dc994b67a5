#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "commands/moment_options.h"
#include "plenoflame/base/part.h"
#include "plenoflame/image/image.h"
#include "plenoflame/image/light_field.h"
#include "plenoflame/render/render.h"
#include "plenoflame/scene/render_spec.h"
#include "plenoflame/scene/sensor_spec.h"

namespace CLI {
class App;
}

namespace plenoflame::cli {

/// The checked command line of `render`. The scene decides what it does not give.
struct RenderOptions {
  std::string scene;                   ///< path of the scene file; empty: that of `resume`
  std::vector<std::string> set;        ///< of --set
  std::string output;                  ///< .exr
  std::vector<std::string> cameras;    ///< which of the scene's; empty: all
  bool output_given = false;           ///< false: `output` is made of the scene's name
  std::optional<int> samples;          ///< rays per pixel and microlens; with a target or a time
                                       ///< limit: at most
  std::optional<double> target_error;  ///< relative RMSE over lit pixels, in (0, 1)
  std::optional<double> time_limit;    ///< [s] > 0
  std::optional<double> checkpoint;    ///< [s] > 0, between two states that are kept
  std::optional<Estimator> estimator;
  std::optional<std::uint64_t> seed;
  std::optional<PixelWindow> window;  ///< of the sensor; not yet checked against its size
  std::optional<Part> part;           ///< of --part
  std::optional<FrameRange> frames;   ///< of --frames
  std::optional<double> time;         ///< [s] of --time
  std::string all_frames;             ///< of one of several frames: the name of all, without number
  int threads = 0;                    ///< 0: one per processor
  std::string resume;                 ///< .exr to continue; empty: none
  std::string stats;                  ///< .json to write; empty: none
  bool quiet = false;
  bool skip = true;  ///< false: --no-skip
  bool control_variate = true;
  bool truth = false;  ///< ground truth as layers of the light field
  bool json = false;
  std::string compression;  ///< as in exr_compression(); empty: that of `resume`, else rle
  bool white = false;       ///< a uniform field in place of the flames
  /// With --white: f-numbers at which it is taken, each into a file of its own; empty: the lens as
  /// it is.
  std::vector<double> f_numbers;
};

/// The options as they stand on the command line.
struct RenderArguments {
  RenderOptions options;
  std::string target_error, time_limit, checkpoint, estimator, window, part;
  std::string seed, samples;
  std::string f_numbers, frames, time;
};

/// Adds render's options to its command.
void add_render_options(CLI::App& command, RenderArguments& arguments);

/// Checks what was given, before anything is read. @throws UsageError
RenderOptions checked_options(const RenderArguments& arguments);

/// The settings of these options; others are the scene's.
RenderSettings render_settings_of(const RenderOptions& options, const Scene& scene);

/// --compression by its name; that of none is rle.
ExrCompression exr_compression(const std::string& name);

/// The file of a stopped run's state, by the light field that the run writes.
std::string state_path(const std::string& light_field);

/// Finds out before any work whether the results can be written. @throws FileError
void check_files(const RenderOptions& options);

/// Checks the window against the sensor, now that the scene is known. @throws UsageError
void check_window(const RenderOptions& options, const SensorSpec& sensor);

}  // namespace plenoflame::cli
