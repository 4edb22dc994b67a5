#include "plenoflame/render/exposure.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "plenoflame/base/progress_share.h"
#include "plenoflame/film/reopened.h"
#include "plenoflame/sampling/sobol.h"

namespace plenoflame {
namespace {

/// Flux and variance of a channel, summed in double precision.
struct ChannelSums {
  std::vector<double> flux, variance;
};

/// @param together errors of the moments are those of the same rays, and add up as they are
void add(const LightField& picture, double share, bool together, std::vector<ChannelSums>& sums) {
  sums.resize(picture.channels.size());
  for (std::size_t c = 0; c < sums.size(); ++c) {
    const LightFieldChannel& channel = picture.channels[c];
    sums[c].flux.resize(channel.flux.pixels.size());
    sums[c].variance.resize(channel.standard_error.pixels.size());
    for (std::size_t i = 0; i < sums[c].flux.size(); ++i)
      sums[c].flux[i] += share * static_cast<double>(channel.flux.pixels[i]);
    for (std::size_t i = 0; i < sums[c].variance.size(); ++i) {
      const double error = share * static_cast<double>(channel.standard_error.pixels[i]);
      double& variance = sums[c].variance[i];
      if (together) {
        const double sum = std::sqrt(variance) + error;
        variance = sum * sum;
      } else {
        variance += error * error;
      }
    }
  }
}

void put_mean(const std::vector<ChannelSums>& sums, LightField& picture) {
  for (std::size_t c = 0; c < sums.size(); ++c) {
    LightFieldChannel& channel = picture.channels[c];
    for (std::size_t i = 0; i < sums[c].flux.size(); ++i)
      channel.flux.pixels[i] = static_cast<float>(sums[c].flux[i]);
    for (std::size_t i = 0; i < sums[c].variance.size(); ++i)
      channel.standard_error.pixels[i] = static_cast<float>(std::sqrt(sums[c].variance[i]));
  }
}

/// Work of one more moment; what is said of the picture as a whole is made anew.
void add(const RenderStatistics& one, RenderStatistics& all) {
  all += one;
  all.lenses += one.lenses;
  all.lenses_skipped += one.lenses_skipped;
  all.seconds += one.seconds;
}

/// One of several moments: its seed, and its share of what is asked for.
RenderSettings settings_of(const RenderSettings& whole, std::size_t index, double share,
                           double target) {
  RenderSettings settings = whole;
  settings.seed = mix64(whole.seed ^ mix64(index + 1));
  settings.resume = nullptr;
  settings.checkpoint = {};
  settings.target_error = target;
  if (whole.time_limit > 0) settings.time_limit = whole.time_limit * share;
  if (!(target > 0))
    settings.samples =
        std::max(whole.replicates, static_cast<int>(std::ceil(whole.samples * share)));
  return settings;
}

/// The mean of one pass over all moments.
struct Pass {
  RenderResult result;
  std::vector<Film> films;  ///< of each moment, where the pass may be gone on with
  bool reached = true;
};

Pass render_all(const std::vector<SceneMoment>& moments, const MomentCompiler& compile,
                const RenderSettings& settings, double target, const std::vector<Film>& earlier,
                const Execution& execution) {
  Pass pass;
  std::vector<ChannelSums> sums;
  double samples = 0, done = 0;
  for (std::size_t i = 0; i < moments.size(); ++i) {
    const double share = moments[i].share;
    RenderSettings own = settings_of(settings, i, share, target);
    if (!earlier.empty()) own.resume = &earlier[i];
    const Execution part =
        share_of(execution, std::min(done, 1 - share), std::min(1.0, done + share));
    RenderResult one = render(compile(moments[i].scene), own, part);
    done += share;
    if (execution.stop.stop_requested()) {
      pass.result.statistics.complete = pass.result.light_field.complete = false;
      return pass;
    }
    add(one.light_field, share, settings.compiled != nullptr, sums);
    samples += one.light_field.samples;
    pass.reached = pass.reached && one.statistics.target_reached;
    if (target > 0) pass.films.push_back(std::move(one.film));
    if (i == 0) {
      one.film = {};
      pass.result = std::move(one);
      continue;
    }
    add(one.statistics, pass.result.statistics);
    pass.result.statistics.complete = pass.result.statistics.complete && one.statistics.complete;
  }
  LightField& field = pass.result.light_field;
  put_mean(sums, field);
  field.samples = samples;
  field.seed = settings.seed;
  field.complete = pass.result.statistics.complete;
  field.texts.erase(kTileSamples);
  return pass;
}

/// States the error of the mean, as render() does of one picture.
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
                             const RenderSettings& settings, const Execution& execution) {
  if (moments.size() == 1) return render(compile(moments.front().scene), settings, execution);
  constexpr int kMostPasses = 4;
  constexpr double kLargestTarget = 0.5;
  // Errors of moments that are alike average out: for shares w the mean of errors e has one of
  // e sqrt(sum w^2). Where they are not alike the passes after the first bring what is missing.
  double squares = 0;
  for (const SceneMoment& moment : moments) squares += moment.share * moment.share;
  const double goal = settings.target_error;
  double target = goal > 0 ? std::min(kLargestTarget, goal / std::sqrt(squares)) : 0;
  Pass pass;
  RenderStatistics work;  // of the passes before
  for (int number = 0; number < kMostPasses; ++number) {
    const double from = number == 0 ? 0 : 1 - std::pow(0.5, number);
    const double to = goal > 0 ? 1 - std::pow(0.5, number + 1) : 1;
    Pass next =
        render_all(moments, compile, settings, target, pass.films, share_of(execution, from, to));
    if (next.result.light_field.channels.empty()) return std::move(next.result);  // stopped
    if (number > 0) add(work, next.result.statistics);
    pass = std::move(next);
    state_error(settings, pass.result);
    const double bound = pass.result.statistics.relative_error_bound;
    pass.result.statistics.target_reached = !(goal > 0) || bound <= goal;
    if (pass.result.statistics.target_reached || !pass.reached || !std::isfinite(bound)) break;
    constexpr double kMargin = 0.9;
    work = pass.result.statistics;
    target *= kMargin * goal / bound;
  }
  pass.result.light_field.numbers["exposure.moments"] = static_cast<double>(moments.size());
  return std::move(pass.result);
}

}  // namespace plenoflame
