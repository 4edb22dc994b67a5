#include "plenoflame/render/exposure.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <utility>

#include "plenoflame/base/error.h"
#include "plenoflame/base/progress_share.h"
#include "plenoflame/film/reopened.h"
#include "plenoflame/sampling/sobol.h"
#include "render/run/run_control.h"

namespace plenoflame {
namespace {

/// Calls `take` for each row of a tile. Its arguments are the row's first pixel in an image of the
/// window, its first value among the tile's sums, and its width.
template <class Take>
void for_rows(const PixelWindow& tile, const PixelWindow& window, const Take& take) {
  const auto width = static_cast<std::size_t>(tile.width);
  for (int row = 0; row < tile.height; ++row)
    take(
        static_cast<std::size_t>(tile.y - window.y + row) * static_cast<std::size_t>(window.width) +
            static_cast<std::size_t>(tile.x - window.x),
        static_cast<std::size_t>(row) * width, width);
}

bool is_dark(const Image& image, const PixelWindow& tile, const PixelWindow& window) {
  bool dark = true;
  if (image.empty()) return dark;
  for_rows(tile, window, [&](std::size_t at, std::size_t, std::size_t width) {
    const auto first = image.pixels.begin() + static_cast<std::ptrdiff_t>(at);
    dark = dark && std::all_of(first, first + static_cast<std::ptrdiff_t>(width),
                               [](float value) { return value == 0; });
  });
  return dark;
}

/// Adds a moment's picture to the sums over moments (ExposureState::sums).
void add(const LightField& picture, double share, Film& sums) {
  const std::size_t channels = picture.channels.size();
  const bool errors = !picture.channels.front().standard_error.empty();
  if (sums.channels() == 0)
    sums = Film(picture.window, static_cast<int>((errors ? 2 : 1) * channels), 1);
  if (!(sums.window() == picture.window) ||
      sums.channels() != static_cast<int>((errors ? 2 : 1) * channels))
    throw UsageError("the exposure to go on from has another window or other channels");
  for (int t = 0; t < sums.tile_count(); ++t) {
    const PixelWindow tile = sums.tile(t);
    const auto pixels =
        static_cast<std::size_t>(tile.width) * static_cast<std::size_t>(tile.height);
    for (std::size_t c = 0; c < channels; ++c) {
      const LightFieldChannel& channel = picture.channels[c];
      if (is_dark(channel.flux, tile, picture.window) &&
          is_dark(channel.standard_error, tile, picture.window))
        continue;
      double* const flux = sums.tile_sums(t).data() + c * pixels;
      double* const variances = flux + channels * pixels;
      for_rows(tile, picture.window, [&](std::size_t at, std::size_t to, std::size_t width) {
        for (std::size_t i = 0; i < width; ++i)
          flux[to + i] += share * static_cast<double>(channel.flux.pixels[at + i]);
        if (!errors) return;
        for (std::size_t i = 0; i < width; ++i) {
          const double error = share * static_cast<double>(channel.standard_error.pixels[at + i]);
          variances[to + i] += error * error;
        }
      });
    }
  }
}

/// Tiles without sums are dark in every moment.
void put_mean(const Film& sums, LightField& picture) {
  const std::size_t channels = picture.channels.size();
  for (int t = 0; t < sums.tile_count(); ++t) {
    if (sums.tile_sums(t).empty()) continue;
    const PixelWindow tile = sums.tile(t);
    const auto pixels =
        static_cast<std::size_t>(tile.width) * static_cast<std::size_t>(tile.height);
    for (std::size_t c = 0; c < channels; ++c) {
      LightFieldChannel& channel = picture.channels[c];
      const double* const flux = sums.tile_sums(t).data() + c * pixels;
      const double* const variances = flux + channels * pixels;
      for_rows(tile, picture.window, [&](std::size_t at, std::size_t from, std::size_t width) {
        for (std::size_t i = 0; i < width; ++i)
          channel.flux.pixels[at + i] = static_cast<float>(flux[from + i]);
        for (std::size_t i = 0; i < width && !channel.standard_error.empty(); ++i)
          channel.standard_error.pixels[at + i] =
              static_cast<float>(std::sqrt(variances[from + i]));
      });
    }
  }
}

/// Adds the work of one more moment; values of the whole picture are computed again.
void add(const RenderStatistics& one, RenderStatistics& all) {
  all += one;
  all.lenses += one.lenses;
  all.lenses_skipped += one.lenses_skipped;
  all.seconds += one.seconds;
}

/// Renders the moments of an exposure, pass by pass, and keeps its state.
class Exposure {
 public:
  Exposure(const std::vector<SceneMoment>& moments, const MomentCompiler& compile,
           const RenderSettings& settings, const Execution& execution,
           const ExposureKeeping& keeping)
      : moments_(moments),
        compile_(compile),
        settings_(settings),
        execution_(execution),
        keeping_(keeping),
        checkpoints_(settings) {
    if (!keeping.resume) {
      state_.films.resize(moments.size());
      return;
    }
    state_ = *keeping.resume;
    if (state_.films.size() != moments.size() || state_.progress.done >= moments.size())
      throw UsageError("the exposure to go on from has another number of moments");
  }

  ExposureState& state() { return state_; }

  /// Renders the missing moments of a pass.
  /// @param part the pass' share of all the work
  /// @return without channels if it was stopped
  RenderResult run_pass(const Execution& part) {
    RenderResult result;
    ExposureProgress& progress = state_.progress;
    double before = 0;
    for (std::size_t i = 0; i < progress.done; ++i) before += moments_[i].share;
    for (bool first = true; progress.done < moments_.size(); first = false) {
      const double share = moments_[progress.done].share;
      RenderResult one =
          render_moment(share_of(part, std::min(before, 1 - share), std::min(1.0, before + share)));
      before += share;
      if (execution_.stop.stop_requested() && !one.statistics.complete) {
        RenderResult stopped;
        stopped.statistics.complete = stopped.light_field.complete = false;
        stopped.statistics.rays = result.statistics.rays + one.statistics.rays;
        return stopped;
      }
      take(one);
      if (first) {
        one.film = {};
        result = std::move(one);
      } else {
        add(one.statistics, result.statistics);
      }
    }
    LightField& field = result.light_field;
    put_mean(state_.sums, field);
    field.samples = progress.samples;
    field.seed = settings_.seed;
    field.complete = result.statistics.complete = progress.complete;
    field.texts.erase(kTileSamples);
    return result;
  }

  /// The next pass continues with the films of this one.
  void begin_pass(double target) {
    const int pass = state_.progress.pass + 1;
    state_.progress = {};
    state_.progress.pass = pass;
    state_.progress.target = target;
    state_.sums = {};
  }

 private:
  /// Settings of the moment in progress: its seed, and its share of samples and time.
  RenderSettings moment_settings() const {
    const ExposureProgress& progress = state_.progress;
    const double share = moments_[progress.done].share;
    RenderSettings settings = settings_;
    settings.seed = mix64(settings_.seed ^ mix64(progress.done + 1));
    settings.resume = nullptr;
    settings.checkpoint = {};
    settings.target_error = progress.target;
    if (settings_.time_limit > 0) {
      constexpr double kLeast = 1e-3;  // [s]; 0 would mean no limit
      settings.time_limit = std::max(kLeast, settings_.time_limit * share - progress.seconds);
    }
    if (!(progress.target > 0))
      settings.samples =
          std::max(settings_.replicates, static_cast<int>(std::ceil(settings_.samples * share)));
    return settings;
  }

  RenderResult render_moment(const Execution& part) {
    ExposureProgress& progress = state_.progress;
    RenderSettings settings = moment_settings();
    const Film& film = state_.films[progress.done];
    if (film.channels() > 0) settings.resume = &film;
    bool begun = settings.resume || progress.done > 0 || progress.pass > 0;
    const double before = progress.seconds;
    try {
      const CompiledScene& scene = compile_(moments_[progress.done].scene);
      const auto start = std::chrono::steady_clock::now();
      const auto keep = [&](const Film& current) {
        progress.seconds = before + seconds_since(start);
        keeping_.keep(state_, current);
        checkpoints_.was_kept();
      };
      if (keeping_.keep) settings.checkpoint = keep;
      RenderResult one = render(scene, settings, part);
      begun = begun || one.statistics.rays > 0;
      if (execution_.stop.stop_requested() && !one.statistics.complete && begun && keeping_.keep)
        keep(one.film);
      return one;
    } catch (const Cancelled&) {  // stopped before the first ray of this moment
      if (begun && keeping_.keep) keeping_.keep(state_, film);
      RenderResult stopped;
      stopped.statistics.complete = false;
      return stopped;
    }
  }

  /// Adds a completed moment.
  void take(RenderResult& one) {
    ExposureProgress& progress = state_.progress;
    add(one.light_field, moments_[progress.done].share, state_.sums);
    progress.samples += one.light_field.samples;
    progress.reached = progress.reached && one.statistics.target_reached;
    progress.complete = progress.complete && one.statistics.complete;
    state_.films[progress.done] = progress.target > 0 ? std::move(one.film) : Film();
    progress.seconds = 0;
    ++progress.done;
    if (!keeping_.keep || progress.done == moments_.size() || !checkpoints_.is_due()) return;
    keeping_.keep(state_, state_.films[progress.done]);
    checkpoints_.was_kept();
  }

  const std::vector<SceneMoment>& moments_;
  const MomentCompiler& compile_;
  const RenderSettings& settings_;
  const Execution& execution_;
  const ExposureKeeping& keeping_;
  Checkpoints checkpoints_;
  ExposureState state_;
};

/// States the error of the mean, like render() for one picture.
void state_error(const RenderSettings& settings, RenderResult& result) {
  const LightFieldChannel& first = result.light_field.channels.front();
  result.statistics.flux = 0;
  for (const float value : first.flux.pixels) result.statistics.flux += static_cast<double>(value);
  if (first.standard_error.empty()) return;
  const StatedError error = stated_error(first.flux, first.standard_error, settings.replicates);
  result.statistics.relative_error = error.relative_rmse;
  result.statistics.relative_error_bound = error.bound;
}

}  // namespace

RenderResult render_exposure(const std::vector<SceneMoment>& moments, const MomentCompiler& compile,
                             const RenderSettings& settings, const Execution& execution,
                             const ExposureKeeping& keeping) {
  if (moments.size() == 1) return render(compile(moments.front().scene), settings, execution);
  constexpr int kMostPasses = 4;
  constexpr double kLargestTarget = 0.5;
  // Errors of similar moments average out: with shares w and errors e the mean has the error e
  // sqrt(sum w^2). If the moments differ, later passes add the missing samples.
  double squares = 0;
  for (const SceneMoment& moment : moments) squares += moment.share * moment.share;
  const double goal = settings.target_error;
  Exposure exposure(moments, compile, settings, execution, keeping);
  ExposureProgress& progress = exposure.state().progress;
  if (!keeping.resume)
    progress.target = goal > 0 ? std::min(kLargestTarget, goal / std::sqrt(squares)) : 0;
  RenderResult result;
  for (;;) {
    const double from = progress.pass == 0 ? 0 : 1 - std::pow(0.5, progress.pass);
    const double to = goal > 0 ? 1 - std::pow(0.5, progress.pass + 1) : 1;
    const RenderStatistics work = result.statistics;  // of the passes before
    const bool is_first = result.light_field.channels.empty();
    result = exposure.run_pass(share_of(execution, from, to));
    if (result.light_field.channels.empty()) return result;  // stopped
    if (!is_first) add(work, result.statistics);
    state_error(settings, result);
    const double bound = result.statistics.relative_error_bound;
    result.statistics.target_reached = !(goal > 0) || bound <= goal;
    if (result.statistics.target_reached || !progress.reached || !std::isfinite(bound) ||
        progress.pass + 1 == kMostPasses)
      break;
    constexpr double kMargin = 0.9;
    exposure.begin_pass(progress.target * kMargin * goal / bound);
  }
  result.light_field.numbers["exposure.moments"] = static_cast<double>(moments.size());
  return result;
}

}  // namespace plenoflame
