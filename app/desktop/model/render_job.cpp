#include "model/render_job.h"

#include <algorithm>
#include <chrono>
#include <optional>
#include <utility>

#include "plenoflame/base/error.h"
#include "plenoflame/render/describe.h"

namespace plenoflame::desktop {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kGrowth = 8;                ///< of samples from pass to pass
constexpr double kFirstPicture = 0.15;    ///< [s] before the first one, at least
constexpr double kPictureInterval = 0.4;  ///< [s] between pictures, at least
constexpr double kPictureShare = 6;       ///< making pictures costs at most 1 / (1 + this)
constexpr double kProgressInterval = 0.1;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

}  // namespace

RenderSettings render_settings(const Scene& scene) {
  RenderSettings settings;
  settings.estimator = scene.render.estimator;
  settings.samples = scene.render.samples;
  settings.seed = scene.render.seed;
  if (settings.estimator == Estimator::forward) {
    if (settings.samples == RenderSpec{}.samples) settings.samples = kForwardSamples;
    settings.replicates = std::min(kForwardReplicates, settings.samples);
  }
  settings.replicates = std::clamp(settings.samples, 1, settings.replicates);
  return settings;
}

std::vector<int> pass_samples(int samples, int replicates) {
  std::vector<int> passes{samples};
  while (passes.back() / kGrowth >= replicates)
    passes.push_back(passes.back() / kGrowth / replicates * replicates);
  std::reverse(passes.begin(), passes.end());
  return passes;
}

/// What the worker keeps from pause to resume.
struct RenderJob::Run {
  std::shared_ptr<const CompiledScene> scene;
  int threads = 0;
  std::vector<int> passes;
  std::size_t pass = 0;
  std::optional<Film> paused;           ///< film of a pass that was paused
  std::shared_ptr<LightField> earlier;  ///< picture of the passes that are complete
  double seconds = 0;                   ///< spent before this launch
  // Since when, and how costly pictures are.
  Clock::time_point launched, last_picture, last_progress;
  double picture_seconds = 0;
  double pass_fraction = 0;

  double elapsed() const { return seconds + seconds_since(launched); }
  bool picture_due() const {
    const double since = seconds_since(last_picture);
    if (picture_seconds == 0 && !earlier) return since > kFirstPicture;
    return since > kPictureInterval && since > kPictureShare * picture_seconds;
  }
  /// The film over the picture of the passes before.
  std::shared_ptr<LightField> merged(const Film& film) const;
};

std::shared_ptr<LightField> RenderJob::Run::merged(const Film& film) const {
  const SensorSpec& sensor = scene->scene.camera.sensor;
  auto field = std::make_shared<LightField>();
  field->sensor_width = sensor.columns;
  field->sensor_height = sensor.rows;
  field->window = film.window();
  field->complete = false;
  for (int c = 0; c < film.channels(); ++c) {
    LightFieldChannel channel;
    channel.name = scene->scene.channels[static_cast<std::size_t>(c)].name;
    FilmImages images = film.images(c);
    channel.flux = std::move(images.flux);
    channel.standard_error = std::move(images.standard_error);
    if (earlier) {
      const LightFieldChannel& old = earlier->channels[static_cast<std::size_t>(c)];
      for (int t = 0; t < film.tile_count(); ++t) {
        if (film.tile_samples(t) > 0) continue;
        const PixelWindow tile = film.tile(t);
        for (int row = tile.y; row < tile.y + tile.height; ++row)
          for (int column = tile.x; column < tile.x + tile.width; ++column) {
            channel.flux.at(column, row) = old.flux.at(column, row);
            if (!channel.standard_error.empty() && !old.standard_error.empty())
              channel.standard_error.at(column, row) = old.standard_error.at(column, row);
          }
      }
    }
    field->channels.push_back(std::move(channel));
  }
  const RenderSpec& settings = scene->scene.render;
  field->estimator = settings.estimator == Estimator::forward ? "forward" : "backward";
  field->seed = settings.seed;
  field->samples = passes[pass];
  describe(*scene, *field);
  return field;
}

RenderJob::RenderJob(QObject* parent)
    : QObject(parent), task_(Urgency::work, [this](const std::string& message) {
        post(this, [this, message] {
          set_state(State::failed);
          emit failed(QString::fromStdString(message));
        });
      }) {}

void RenderJob::set_state(State state) {
  if (state == state_) return;
  state_ = state;
  emit state_changed();
}

void RenderJob::start(std::shared_ptr<const CompiledScene> scene, int threads) {
  auto run = std::make_shared<Run>();
  run->threads = threads;
  const RenderSettings settings = render_settings(scene->scene);
  run->scene = std::move(scene);
  run->passes = pass_samples(settings.samples, settings.replicates);
  run_ = std::move(run);
  curve_.clear();
  status_ = {};
  status_.passes = static_cast<int>(run_->passes.size());
  launch();
  set_state(State::running);
  emit progressed();
}

void RenderJob::pause() {
  if (state_ != State::running) return;
  task_.cancel();
  set_state(State::paused);
}

void RenderJob::resume() {
  if (state_ != State::paused) return;
  launch();
  set_state(State::running);
}

void RenderJob::stop() {
  task_.cancel();
  run_.reset();
  set_state(State::idle);
}

void RenderJob::launch() {
  const std::shared_ptr<Run> run = run_;
  task_.request([this, run](const std::stop_token& stop) {
    run->launched = run->last_picture = run->last_progress = Clock::now();
    const auto show = [&](std::shared_ptr<LightField> field, const RenderStatistics* done) {
      const LightFieldChannel& first = field->channels.front();
      const int replicates = render_settings(run->scene->scene).replicates;
      const double error =
          first.standard_error.empty()
              ? -1
              : stated_error(first.flux, first.standard_error, replicates).relative_rmse;
      const CurvePoint point{run->elapsed(), error};
      const bool last = done && run->pass + 1 == run->passes.size();
      post(this, [this, run, field, point, last,
                  statistics = done ? std::optional(*done) : std::nullopt] {
        if (run != run_) return;
        if (point.error > 0) curve_.push_back(point);
        status_.relative_error = point.error;
        status_.seconds = point.seconds;
        if (statistics) statistics_ = *statistics;
        if (last) {  // nothing may have been told of a pass that was done in a blink
          status_.pass = status_.passes;
          status_.samples = field->samples;
          status_.rays = statistics->rays;
          status_.rays_per_second = statistics->rays / std::max(1e-9, statistics->seconds);
          status_.fraction = 1;
          status_.remaining_seconds = 0;
        }
        emit image(field);
        if (last) set_state(State::finished);
        emit progressed();
      });
    };
    double work_before = 0, work = 0;
    for (std::size_t i = 0; i < run->passes.size(); ++i) work += run->passes[i];
    for (std::size_t i = 0; i < run->pass; ++i) work_before += run->passes[i];
    for (; run->pass < run->passes.size(); ++run->pass) {
      RenderSettings settings = render_settings(run->scene->scene);
      settings.samples = run->passes[run->pass];
      const bool resumed = run->paused.has_value();
      if (resumed) settings.resume = &*run->paused;
      const int samples = settings.samples, pass = static_cast<int>(run->pass) + 1;
      const Clock::time_point pass_start = Clock::now();
      Execution execution;
      execution.threads = run->threads;
      execution.stop = stop;
      // The share of this pass that was there before a pause.
      const double held = resumed ? run->pass_fraction : 0;
      execution.progress = [&](const Progress& progress) {
        if (seconds_since(run->last_progress) < kProgressInterval) return;
        run->last_progress = Clock::now();
        Status status;
        status.pass = pass;
        status.passes = static_cast<int>(run->passes.size());
        status.samples = samples;
        status.rays = progress.rays;
        status.rays_per_second = progress.rays_per_second;
        status.seconds = run->elapsed();
        // The library reports the batch of tiles that it is at, of about so many.
        constexpr double kBatches = 16;
        const double now =
            std::min(1.0, run->pass_fraction + progress.fraction * (1 - held) / kBatches);
        status.fraction = now;
        const double since = seconds_since(pass_start);
        if (now > held + 0.02)  // later passes take in proportion to their samples
          status.remaining_seconds =
              since / (now - held) * ((1 - now) + (work - work_before - samples) / samples);
        post(this, [this, run, status] {
          if (run != run_ || state_ != State::running) return;
          const double error = status_.relative_error;
          status_ = status;
          status_.relative_error = error;
          emit progressed();
        });
      };
      settings.checkpoint_seconds = 0;
      settings.checkpoint = [&](const Film& film) {
        double done = 0;
        for (const double tile : film.all_tile_samples()) done += tile > 0 ? 1 : 0;
        run->pass_fraction = done / film.tile_count();
        if (!run->picture_due() || stop.stop_requested()) return;
        const Clock::time_point start = Clock::now();
        show(run->merged(film), nullptr);
        run->picture_seconds = seconds_since(start);
        run->last_picture = Clock::now();
      };
      RenderResult result = render(*run->scene, settings, execution);
      if (!result.statistics.complete) {
        run->paused = std::move(result.film);
        run->seconds = run->elapsed();
        // What was done since the last picture is shown, too.
        show(run->merged(*run->paused), nullptr);
        return;
      }
      run->paused.reset();
      run->pass_fraction = 0;
      describe(*run->scene, result.light_field);
      run->earlier = std::make_shared<LightField>(std::move(result.light_field));
      result.film = Film();
      show(run->earlier, &result.statistics);
      run->last_picture = Clock::now();
      work_before += samples;
    }
  });
}

}  // namespace plenoflame::desktop
