#include "model/jobs/render_job.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <numeric>
#include <optional>
#include <utility>

#include "model/jobs/coarse_picture.h"
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

std::vector<int> pass_samples(int samples, int replicates) {
  std::vector<int> passes{samples};
  while (passes.back() / kGrowth >= replicates)
    passes.push_back(passes.back() / kGrowth / replicates * replicates);
  std::reverse(passes.begin(), passes.end());
  return passes;
}

namespace {

/// The passes that are left to do when a picture of the same scene is there already.
std::vector<int> passes_after(std::vector<int> passes, const LightField* shown) {
  if (!shown || shown->samples > passes.back()) return passes;
  const int last = passes.back();
  std::erase_if(passes, [&](int samples) { return samples <= shown->samples && samples < last; });
  return passes;
}

bool has_errors(const LightField& field) {
  return !field.channels.empty() && !field.channels.front().standard_error.empty();
}

}  // namespace

/// Everything that the worker keeps from pause to resume.
struct RenderJob::Run {
  std::shared_ptr<const CompiledScene> scene;
  int threads = 0;
  bool finished_only = false;       ///< nothing is shown before the end
  std::atomic<bool> begun = false;  ///< the coarse picture is made, or not requested
  std::vector<int> passes;
  std::size_t pass = 0;
  std::optional<Film> paused;                 ///< film of a pass that was paused
  std::shared_ptr<const LightField> earlier;  ///< whole picture that this pass is laid over
  std::shared_ptr<CoarseScene> coarse;        ///< the worker's, handed on from run to run
  double seconds = 0;                         ///< spent before this launch
  double pass_seconds = 0;                    ///< of it, in the present pass
  double seconds_per_sample = 0;              ///< of the whole picture; 0: not known yet
  // Since when, and how costly pictures are.
  Clock::time_point launched, pass_began, last_picture, last_progress;
  double picture_seconds = 0;

  RenderSettings settings() const { return render_settings(scene->scene); }
  double elapsed() const { return seconds + seconds_since(launched); }
  double spent_in_pass() const { return pass_seconds + seconds_since(pass_began); }
  bool picture_due() const {
    if (finished_only) return false;
    const double since = seconds_since(last_picture);
    if (picture_seconds == 0) return since > kFirstPicture;
    return since > kPictureInterval && since > kPictureShare * picture_seconds;
  }
  /// Samples of all passes, or of those before the present one.
  double work(bool all) const {
    return std::accumulate(passes.begin(), all ? passes.end() : passes.begin() + long(pass), 0.0);
  }
  /// Time that all passes still take; negative: not known yet.
  /// @param progress of the present pass
  double remaining(const Progress& progress) const;
  /// The film over the picture of the passes before; null while some of it would be empty.
  std::shared_ptr<LightField> merged(const Film& film) const;
};

double RenderJob::Run::remaining(const Progress& progress) const {
  const double samples = passes[pass], later = work(true) - work(false) - samples;
  if (seconds_per_sample > 0) {
    // A pass takes as long for each sample as the previous pass. Its own estimate comes second,
    // because tiles have very different costs.
    const double expected = seconds_per_sample * samples, spent = spent_in_pass();
    const double rest =
        spent < 0.9 * expected ? expected - spent : std::max(0.0, progress.remaining_seconds);
    return rest + seconds_per_sample * later;
  }
  if (progress.fraction < 0.02 || progress.fraction >= 1 || progress.remaining_seconds < 0)
    return -1;
  return progress.remaining_seconds * (1 + later / samples / (1 - progress.fraction));
}

std::shared_ptr<LightField> RenderJob::Run::merged(const Film& film) const {
  if (!earlier)
    for (int t = 0; t < film.tile_count(); ++t)
      if (film.tile_samples(t) <= 0) return nullptr;
  auto field = empty_picture(*scene);
  field->samples = passes[pass];
  const bool errors = !earlier || has_errors(*earlier);
  for (int c = 0; c < film.channels(); ++c) {
    LightFieldChannel channel;
    channel.name = scene->scene.channels[static_cast<std::size_t>(c)].name;
    FilmImages images = film.images(c);
    channel.flux = std::move(images.flux);
    if (errors) channel.standard_error = std::move(images.standard_error);
    if (earlier) {
      const LightFieldChannel& old = earlier->channels[static_cast<std::size_t>(c)];
      for (int t = 0; t < film.tile_count(); ++t) {
        if (film.tile_samples(t) > 0) continue;
        const PixelWindow tile = film.tile(t);
        for (int row = tile.y; row < tile.y + tile.height; ++row)
          for (int column = tile.x; column < tile.x + tile.width; ++column) {
            channel.flux.at(column, row) = old.flux.at(column, row);
            if (!channel.standard_error.empty())
              channel.standard_error.at(column, row) = old.standard_error.at(column, row);
          }
      }
    }
    field->channels.push_back(std::move(channel));
  }
  return field;
}

RenderJob::RenderJob(QObject* parent)
    : QObject(parent),
      first_(Urgency::waited_for, [this](const std::string& message) { fail(message); }),
      task_(Urgency::work, [this](const std::string& message) { fail(message); }) {}

void RenderJob::fail(const std::string& message) {
  post(this, [this, message] {
    set_state(State::failed);
    emit failed(QString::fromStdString(message));
  });
}

void RenderJob::set_state(State state) {
  if (state == state_) return;
  state_ = state;
  emit state_changed();
}

void RenderJob::start(std::shared_ptr<const CompiledScene> scene, int threads,
                      std::shared_ptr<const LightField> shown) {
  auto run = std::make_shared<Run>();
  run->threads = threads;
  const RenderSettings settings = render_settings(scene->scene);
  run->scene = std::move(scene);
  run->passes = passes_after(pass_samples(settings.samples, settings.replicates), shown.get());
  run->earlier = std::move(shown);
  run->finished_only = finished_only_;
  if (finished_only_) run->passes.erase(run->passes.begin(), run->passes.end() - 1);
  run->begun = run->earlier || run->finished_only;
  run->coarse = run_ ? run_->coarse : std::make_shared<CoarseScene>();
  run_ = std::move(run);
  forget();
  status_.passes = static_cast<int>(run_->passes.size());
  launch();
  set_state(State::running);
  emit progressed();
}

void RenderJob::forget() {
  curve_.clear();
  statistics_ = {};
  status_ = {};
}

void RenderJob::clear() {
  stop();
  forget();
  emit progressed();
}

void RenderJob::pause() {
  if (state_ != State::running) return;
  cancel();
  set_state(State::paused);
}

void RenderJob::resume() {
  if (state_ != State::paused) return;
  launch();
  set_state(State::running);
}

void RenderJob::cancel() {
  first_.cancel();
  task_.cancel();
}

void RenderJob::stop() {
  cancel();
  run_.reset();
  set_state(State::idle);
}

void RenderJob::launch() {
  cancel();  // passes of the scene before would take its processors
  if (run_->begun) return make_passes();
  first_.request([this, run = run_](const std::stop_token& stop) {
    run->launched = Clock::now();
    try {
      if (!run->begun) begin(run, stop);
    } catch (const Cancelled&) {  // it is made again
    }
    run->seconds = run->elapsed();
    if (!run->begun) return;
    post(this, [this, run] {
      if (run == run_ && state_ == State::running) make_passes();
    });
  });
}

void RenderJob::make_passes() {
  task_.request([this, run = run_](const std::stop_token& stop) {
    run->launched = run->pass_began = run->last_picture = run->last_progress = Clock::now();
    for (; run->pass < run->passes.size(); ++run->pass)
      if (!make_pass(run, stop)) return;
  });
}

void RenderJob::show(const std::shared_ptr<Run>& run, std::shared_ptr<const LightField> field,
                     const RenderStatistics* done) {
  const int replicates = run->settings().replicates;
  double error = -1;
  if (has_errors(*field)) {
    const LightFieldChannel& first = field->channels.front();
    error = stated_error(first.flux, first.standard_error, replicates).relative_rmse;
  }
  const CurvePoint point{run->elapsed(), error};
  const bool last = done && run->pass + 1 == run->passes.size();
  post(this,
       [this, run, field, point, last, statistics = done ? std::optional(*done) : std::nullopt] {
         if (run != run_) return;
         if (point.error > 0) curve_.push_back(point);
         status_.relative_error = point.error;
         status_.seconds = point.seconds;
         if (statistics) statistics_ = *statistics;
         if (last) {  // a very short pass may have reported nothing
           status_.pass = status_.passes;
           status_.samples = static_cast<int>(field->samples);
           status_.rays = statistics->rays;
           status_.rays_per_second = statistics->rays / std::max(1e-9, statistics->seconds);
           status_.fraction = 1;
           status_.remaining_seconds = 0;
         }
         emit image(field);
         if (last) set_state(State::finished);
         emit progressed();
       });
}

void RenderJob::begin(const std::shared_ptr<Run>& run, const std::stop_token& stop) {
  Execution execution;
  execution.threads = run->threads;
  execution.stop = stop;
  run->earlier = coarse_picture(*run->scene, execution, *run->coarse);
  if (run->earlier) show(run, run->earlier, nullptr);
  run->begun = true;
}

void RenderJob::tell(const std::shared_ptr<Run>& run, const Progress& progress) {
  if (seconds_since(run->last_progress) < kProgressInterval) return;
  run->last_progress = Clock::now();
  Status status;
  status.pass = static_cast<int>(run->pass) + 1;
  status.passes = static_cast<int>(run->passes.size());
  status.samples = run->passes[run->pass];
  status.rays = progress.rays;
  status.rays_per_second = progress.rays_per_second;
  status.seconds = run->elapsed();
  status.fraction = (run->work(false) + status.samples * progress.fraction) / run->work(true);
  status.remaining_seconds = run->remaining(progress);
  post(this, [this, run, status] {
    if (run != run_ || state_ != State::running) return;
    const double error = status_.relative_error;
    status_ = status;
    status_.relative_error = error;
    emit progressed();
  });
}

bool RenderJob::make_pass(const std::shared_ptr<Run>& run, const std::stop_token& stop) {
  RenderSettings settings = run->settings();
  settings.samples = run->passes[run->pass];
  if (run->paused) settings.resume = &*run->paused;
  Execution execution;
  execution.threads = run->threads;
  execution.stop = stop;
  execution.progress = [&](const Progress& progress) { tell(run, progress); };
  settings.checkpoint_seconds = 0;
  settings.checkpoint = [&](const Film& film) {
    if (!run->picture_due() || stop.stop_requested()) return;
    const Clock::time_point start = Clock::now();
    if (auto field = run->merged(film)) show(run, std::move(field), nullptr);
    run->picture_seconds = seconds_since(start);
    run->last_picture = Clock::now();
  };
  RenderResult result = render(*run->scene, settings, execution);
  if (!result.statistics.complete) {
    run->seconds = run->elapsed();
    run->paused = std::move(result.film);
    run->pass_seconds = run->spent_in_pass();
    // The work since the last picture is shown, too.
    if (auto field = run->merged(*run->paused)) show(run, std::move(field), nullptr);
    return false;
  }
  run->paused.reset();
  describe(*run->scene, result.light_field);
  run->earlier = std::make_shared<const LightField>(std::move(result.light_field));
  result.film = Film();
  show(run, run->earlier, &result.statistics);
  run->seconds_per_sample = run->spent_in_pass() / settings.samples;
  run->pass_seconds = 0;
  run->last_picture = run->pass_began = Clock::now();
  return true;
}

}  // namespace plenoflame::desktop
