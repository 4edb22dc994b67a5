#include "render/run/run_progress.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "render/run/run_control.h"
#include "render/run/sample_plan.h"

namespace plenoflame {
namespace {

/// The share of a stretch after which the remaining work is unknown. It is small, because later
/// findings can raise the reported share but never lower it.
constexpr double kExploredShare = 0.02;
/// Cost of a tile per sample in addition to its rays, in units of a ray. Tiles that see nothing
/// take some time, too.
constexpr double kTileRays = 200;

}  // namespace

void RunProgress::begin_stretch(double from, double to, double work) {
  from_ = from;
  to_ = to;
  work_ = work;
  work_done_ = 0;
  stretch_start_ = Clock::now();
}

void RunProgress::foresee(double done, double left) {
  const double known = done + left > 0 ? done / (done + left) : 0;
  begin_stretch(std::max(fraction_, known), 1, left);
}

void RunProgress::explore(double work, double share) {
  constexpr double kMostShare = 0.9;  // the unknown rest keeps a share
  begin_stretch(fraction_, std::max({fraction_, kExploredShare, std::min(share, kMostShare)}),
                work);
}

void RunProgress::add(double work, double rays) {
  work_done_ += work;
  rays_ += rays;
  const double share = work_ > 0 ? std::min(1.0, work_done_ / work_) : 1;
  fraction_ = std::max(fraction_, from_ + (to_ - from_) * share);
  // The remaining time is known only if this stretch is the last one.
  const bool is_known = to_ == 1 && share > 0;
  report(is_known ? seconds_since(stretch_start_) * (1 / share - 1) : -1);
}

void RunProgress::complete() {
  fraction_ = 1;
  time_limit_ = 0;
  report(0);
}

void RunProgress::report(double remaining) {
  if (!execution_.progress) return;
  Progress progress;
  const double elapsed = seconds_since(start_);
  if (time_limit_ > 0) {
    fraction_ = std::max(fraction_, std::min(1.0, elapsed / time_limit_));
    const double limit = std::max(0.0, time_limit_ - elapsed);
    remaining = remaining < 0 ? limit : std::min(remaining, limit);
  }
  progress.fraction = fraction_;
  progress.rays = rays_;
  progress.rays_per_second = rays_ / elapsed;
  progress.relative_error = relative_error_;
  progress.remaining_seconds = remaining;
  execution_.progress(progress);
}

TileProgress::Work TileProgress::weigh(const Film& film, const std::vector<double>& samples) {
  double all_rays = 0, all_samples = 0;
  for (std::size_t t = 0; t < rays_.size(); ++t) {
    all_rays += rays_[t];
    all_samples += samples_[t];
  }
  const double mean = all_samples > 0 ? all_rays / all_samples : 0;
  costs_.clear();
  Work work;
  for (std::size_t t = 0; t < rays_.size(); ++t) {
    costs_.push_back(kTileRays + (samples_[t] > 0 ? rays_[t] / samples_[t] : mean));
    const double done = film.tile_samples(static_cast<int>(t));
    work.done += costs_[t] * done;
    work.left += costs_[t] * std::max(0.0, samples[t] - done);
  }
  return work;
}

void TileProgress::foresee(const Film& film, const std::vector<double>& samples) {
  const Work work = weigh(film, samples);
  run_.foresee(work.done, work.left);
}

void TileProgress::explore(const Film& film, const std::vector<double>& samples) {
  run_.explore(weigh(film, samples).left);
}

void TileProgress::measured(const Film& film, double relative_error, std::vector<double> squares) {
  run_.set_relative_error(relative_error);
  double sum = 0;
  for (const double square : squares) sum += square;
  held_ = film.all_tile_samples();
  squares_ = std::move(squares);
  for (double& square : squares_) square *= sum > 0 ? relative_error * relative_error / sum : 0;
  square_ = sum > 0 ? relative_error * relative_error : 0;
}

void TileProgress::add(int tile, double samples, double rays) {
  const auto t = static_cast<std::size_t>(tile);
  rays_[t] += rays;
  samples_[t] += samples;
  if (square_ > 0 && held_[t] > 0) {
    const double left = squares_[t] * std::pow(1 + samples / held_[t], -2 * kErrorSlope);
    square_ += left - squares_[t];
    squares_[t] = left;
    held_[t] += samples;
    run_.set_relative_error(std::sqrt(std::max(0.0, square_)));
  }
  run_.add(costs_[t] * samples, rays);
}

}  // namespace plenoflame
