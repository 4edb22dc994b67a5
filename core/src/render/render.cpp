#include "plenoflame/render/render.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "plenoflame/base/error.h"
#include "plenoflame/base/version.h"
#include "render/backward.h"
#include "render/forward.h"
#include "render/rounds.h"
#include "render/scene_medium.h"

namespace plenoflame {
namespace {

PixelWindow whole_sensor(const SensorSpec& sensor) {
  return {0, 0, sensor.columns, sensor.rows};
}

void check(const RenderSettings& settings, const SensorSpec& sensor) {
  const PixelWindow& w = settings.window;
  if (w.width != 0 || w.height != 0) {
    if (w.width <= 0 || w.height <= 0 || w.x < 0 || w.y < 0 || w.width > sensor.columns - w.x ||
        w.height > sensor.rows - w.y)
      throw UsageError("the window must lie inside the sensor of " +
                       std::to_string(sensor.columns) + " x " + std::to_string(sensor.rows) +
                       " pixels");
  }
  if (settings.replicates < 1 || settings.replicates > 64)
    throw UsageError("the number of replicates must be 1 to 64");
  if (settings.samples < settings.replicates)
    throw UsageError("at least " + std::to_string(settings.replicates) + " samples are needed");
  if (settings.target_error > 0 && settings.replicates < 2)
    throw UsageError("a target error needs at least 2 replicates");
  if (!is_supported(settings.isa))
    throw UsageError("this processor does not support " + std::string(name(settings.isa)));
}

}  // namespace

RenderResult render(const CompiledScene& scene, const RenderSettings& settings,
                    const Execution& execution) {
  const auto start = std::chrono::steady_clock::now();
  const SensorSpec& sensor = scene.scene.camera.sensor;
  check(settings, sensor);
  const PixelWindow window = settings.window.width > 0 ? settings.window : whole_sensor(sensor);
  const int channels = static_cast<int>(scene.scene.channels.size());
  const bool forward = settings.estimator == Estimator::forward;

  RenderResult result;
  RenderStatistics& statistics = result.statistics;
  statistics.threads = execution.thread_count();
  statistics.isa = std::string(name(settings.isa));
  statistics.pixels = static_cast<double>(window.width) * window.height;
  result.film = Film(window, channels, settings.replicates);
  Film& film = result.film;
  if (settings.resume) {
    if (!(settings.resume->window() == window) || settings.resume->channels() != channels ||
        settings.resume->replicates() != settings.replicates)
      throw UsageError("the film to go on from has another window, channels or replicates");
    film = *settings.resume;
  }
  if (has_content(scene)) {
    statistics.medium_description = scene.medium ? scene.medium->description() : "none";
    if (scene.surfaces) statistics.surfaces_description = scene.surfaces->description();
    if (forward) {
      render_forward(scene, settings, execution, film, statistics);
    } else {
      count_lenses(scene, settings, window, statistics);
      render_rounds(scene, settings, execution, film, statistics);
    }
  } else {
    for (int t = 0; t < film.tile_count(); ++t) film.add_samples(t, 1);
  }

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
  if (!first.standard_error.empty()) {
    const StatedError error = stated_error(first.flux, first.standard_error, settings.replicates);
    statistics.relative_error = error.relative_rmse;
    statistics.relative_error_bound = error.bound;
  }
  for (const float f : first.flux.pixels) statistics.flux += static_cast<double>(f);
  field.estimator = forward ? "forward" : "backward";
  field.seed = settings.seed;
  double samples = 0;
  for (const double tile : film.all_tile_samples()) samples = std::max(samples, tile);
  field.samples = samples * settings.replicates;
  field.complete = statistics.complete;
  statistics.seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return result;
}

}  // namespace plenoflame
