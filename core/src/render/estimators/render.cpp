#include "plenoflame/render/render.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "film/image_sums.h"
#include "plenoflame/base/error.h"
#include "plenoflame/base/version.h"
#include "plenoflame/film/reopened.h"
#include "render/estimators/backward.h"
#include "render/estimators/rounds.h"
#include "render/forward/forward.h"
#include "render/run/check_settings.h"
#include "render/run/run_control.h"
#include "render/transport/scene_medium.h"

namespace plenoflame {
namespace {

constexpr double kTellingRays = 1e4;  ///< fewer rays without light prove little

/// Lists the effects that a rendering omits, in addition to the counters.
std::vector<std::string> left_out(const CompiledScene& scene, const RenderSettings& settings) {
  std::vector<std::string> list;
  const CameraSpec& camera = scene.scene.camera;
  const std::size_t types = camera.array.types.size(), channels = scene.scene.channels.size();
  if (!camera.array.present)
    list.emplace_back("the array: the camera has none");
  else if (settings.estimator == Estimator::backward)
    list.emplace_back("directions that the stop or a microlens blocks");
  if (camera.array.present && types < 3)
    list.push_back(fmt::format("lens types beyond the array's {}", types));
  if (camera.lens.model == LensModel::ideal)
    list.emplace_back("surfaces of the main lens: it is ideal");
  if (!scene.medium) list.emplace_back("flames: the scene has none");
  if (!scene.surfaces) list.emplace_back("solid surfaces: the scene has none");
  if (channels > 1)
    list.push_back(
        fmt::format("rays of their own for {} channels: all share one path", channels - 1));
  if (!settings.standard_error || settings.replicates < 2)
    list.emplace_back("standard errors: not asked for");
  return list;
}

/// Statistics before any work is done.
void begin_statistics(const CompiledScene& scene, const RenderSettings& settings,
                      const Execution& execution, RenderStatistics& statistics) {
  const PixelWindow window = window_of(settings, scene.scene.camera.sensor);
  statistics.threads = execution.thread_count();
  statistics.isa = std::string(name(settings.isa));
  statistics.pixels = static_cast<double>(window.width) * window.height;
  statistics.left_out = left_out(scene, settings);
  if (!has_content(scene)) return;
  statistics.medium_description = scene.medium ? scene.medium->description() : "none";
  statistics.wavelengths = scene.mix.nodes();
  statistics.spectral_error = scene.spectral_error;
  statistics.paths = static_cast<int>(scene.paths().size());
  if (scene.surfaces) statistics.surfaces_description = scene.surfaces->description();
}

/// Makes the light field of a film, with its statistics and warnings.
void finish_picture(const CompiledScene& scene, const RenderSettings& settings,
                    const Execution& execution, RenderResult& result) {
  const SensorSpec& sensor = scene.scene.camera.sensor;
  const PixelWindow window = window_of(settings, sensor);
  const int channels = static_cast<int>(scene.scene.channels.size());
  const bool forward = settings.estimator == Estimator::forward;
  RenderStatistics& statistics = result.statistics;
  const Film& film = result.film;
  LightField& field = result.light_field;
  field.sensor_width = sensor.columns;
  field.sensor_height = sensor.rows;
  field.window = window;
  for (int c = 0; c < channels; ++c) {
    LightFieldChannel channel;
    channel.name = scene.scene.channels[static_cast<std::size_t>(c)].name;
    FilmImages images = film.images(c, execution);
    channel.flux = std::move(images.flux);
    if (settings.standard_error) channel.standard_error = std::move(images.standard_error);
    field.channels.push_back(std::move(channel));
  }
  const LightFieldChannel& first = field.channels.front();
  const ImageParts parts = film.lit_parts();
  if (!first.standard_error.empty()) {
    const StatedError error =
        stated_error(first.flux, first.standard_error, settings.replicates, parts, execution);
    statistics.relative_error = error.relative_rmse;
    statistics.relative_error_bound = error.bound;
  }
  statistics.flux = sum_of(first.flux, parts, execution);
  // A part of a picture may miss the flame.
  if (statistics.complete && !(statistics.flux > 0) && has_content(scene) &&
      settings.part.is_whole()) {
    if (statistics.rays >= kTellingRays)
      execution.warn(
          fmt::format("the picture is black: none of {:.3g} rays found light; what is small beside "
                      "the beams of "
                      "pixels takes more samples, or the other estimator",
                      statistics.rays));
    else if (!(statistics.rays > 0) && window == window_of({}, sensor))
      execution.warn("the picture is black: nothing of the scene is in view");
  }
  field.estimator = forward ? "forward" : "backward";
  field.seed = settings.seed;
  double samples = 0;
  for (const double tile : film.all_tile_samples()) samples = std::max(samples, tile);
  field.samples = samples * settings.replicates;
  field.numbers["render.replicates"] = settings.replicates;
  // A picture to be continued must hold the samples of its tiles.
  if (const std::string tiles = tile_samples_text(film); !tiles.empty())
    field.texts[kTileSamples] = tiles;
  if (!settings.part.is_whole()) field.texts[kPartOfPicture] = to_string(settings.part);
  field.complete = statistics.complete;
}

}  // namespace

bool has_fixed_samples(const RenderSettings& settings) {
  return settings.estimator == Estimator::backward && settings.target_error <= 0 &&
         settings.time_limit <= 0;
}

RenderResult render(const CompiledScene& scene, const RenderSettings& settings,
                    const Execution& execution) {
  const auto start = std::chrono::steady_clock::now();
  const SensorSpec& sensor = scene.scene.camera.sensor;
  check_settings(settings, sensor);
  const PixelWindow window = window_of(settings, sensor);
  check_part(settings.part, window);
  const int channels = static_cast<int>(scene.scene.channels.size());
  const bool forward = settings.estimator == Estimator::forward;

  RenderResult result;
  RenderStatistics& statistics = result.statistics;
  begin_statistics(scene, settings, execution, statistics);
  result.film = Film(window, channels, settings.replicates);
  Film& film = result.film;
  if (settings.resume) {
    if (!(settings.resume->window() == window) || settings.resume->channels() != channels ||
        settings.resume->replicates() != settings.replicates)
      throw UsageError("the film to go on from has another window, channels or replicates");
    film = *settings.resume;
  }
  if (has_content(scene)) {
    if (forward) {
      render_forward(scene, settings, execution, film, statistics);
    } else {
      render_rounds(scene, settings, execution, film, statistics);
    }
  } else {
    for (int t = 0; t < film.tile_count(); ++t)
      if (part_of_tile(t, film.tiles_across(), settings.part.count) == settings.part.number - 1)
        film.add_samples(t, 1);
  }

  finish_picture(scene, settings, execution, result);
  statistics.seconds = seconds_since(start);
  return result;
}

}  // namespace plenoflame
