#include "model/jobs/coarse_picture.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "plenoflame/base/error.h"
#include "plenoflame/render/describe.h"
#include "plenoflame/render/render_request.h"

namespace plenoflame::desktop {
namespace {

constexpr int kCoarseSide = 200;  ///< large pixels along the longer side, about

/// Takes flames over from the scene that renders now, so that nothing is read twice.
std::shared_ptr<const Medium> no_flame(const FlameSpec&, const std::string&,
                                       const std::vector<SourceFunction>&, const Execution&) {
  throw InputError("a flame of the coarse picture is not that of the scene");
}

}  // namespace

int coarse_pixel(int at, int whole, int coarse, int factor) {
  const double place = 0.5 * coarse + (at + 0.5 - 0.5 * whole) / factor;
  return std::clamp(static_cast<int>(std::floor(place)), 0, coarse - 1);
}

std::shared_ptr<LightField> empty_picture(const CompiledScene& scene) {
  const SensorSpec& sensor = scene.scene.camera.sensor;
  auto field = std::make_shared<LightField>();
  field->sensor_width = sensor.columns;
  field->sensor_height = sensor.rows;
  field->window = {0, 0, sensor.columns, sensor.rows};
  field->complete = false;
  const RenderSpec& settings = scene.scene.render;
  field->estimator = settings.estimator == Estimator::forward ? "forward" : "backward";
  field->seed = settings.seed;
  describe(scene, *field);
  return field;
}

std::shared_ptr<LightField> coarse_picture(const CompiledScene& scene, const Execution& execution,
                                           CoarseScene& kept) {
  if (scene.scene.render.estimator == Estimator::forward) return nullptr;
  const SensorSpec& fine = scene.scene.camera.sensor;
  const int factor = (std::max(fine.columns, fine.rows) + kCoarseSide - 1) / kCoarseSide;
  if (factor < 2) return nullptr;
  Scene large = scene.scene;
  SensorSpec& sensor = large.camera.sensor;
  sensor.columns = (fine.columns + factor - 1) / factor;
  sensor.rows = (fine.rows + factor - 1) / factor;
  sensor.pixel_pitch *= factor;
  sensor.pixel_pitch_y *= factor;  // 0 stays 0: as the other
  LightField small;
  try {
    Execution quiet = execution;
    quiet.message = nullptr;
    quiet.progress = nullptr;
    kept.compiled =
        compile(large, no_flame, quiet, {}, {&scene, kept.compiled ? &*kept.compiled : nullptr});
    const CompiledScene& compiled = *kept.compiled;
    RenderSettings settings = render_settings(compiled.scene);
    settings.samples = settings.replicates;
    RenderResult result = render(compiled, settings, quiet);
    if (!result.statistics.complete) throw Cancelled();
    small = std::move(result.light_field);
  } catch (const Cancelled&) {
    throw;
  } catch (const Error&) {  // pixels of this size make no scene: there are fine ones soon
    return nullptr;
  }
  auto field = empty_picture(scene);
  field->samples = render_settings(scene.scene).replicates;
  const auto share = static_cast<float>(1.0 / (factor * static_cast<double>(factor)));
  for (LightFieldChannel& from : small.channels) {
    LightFieldChannel channel;
    channel.name = from.name;
    channel.flux = Image(fine.columns, fine.rows);
    for (int row = 0; row < fine.rows; ++row) {
      const int y = coarse_pixel(row, fine.rows, sensor.rows, factor);
      for (int column = 0; column < fine.columns; ++column)
        channel.flux.at(column, row) =
            share * from.flux.at(coarse_pixel(column, fine.columns, sensor.columns, factor), y);
    }
    field->channels.push_back(std::move(channel));
  }
  return field;
}

}  // namespace plenoflame::desktop
