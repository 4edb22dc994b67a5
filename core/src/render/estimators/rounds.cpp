#include "render/estimators/rounds.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iterator>
#include <map>
#include <memory>
#include <numeric>
#include <utility>

#include "film/image_sums.h"
#include "render/estimators/backward.h"
#include "render/estimators/rank_tiles.h"
#include "render/run/run_control.h"
#include "render/run/run_progress.h"
#include "render/run/sample_plan.h"
#include "render/sampling/batches.h"

namespace plenoflame {
namespace {

constexpr int kFirstPoints = 8;       ///< points of each replicate in the first round
constexpr int kDarkPoints = 64;       ///< points of each replicate before a picture counts as dark
constexpr double kGoalMargin = 0.97;  ///< on the mean square: avoids a short last round

/// Mean square error of every tile's lit pixels, and of the whole image, first channel.
struct TileErrors {
  std::vector<double> mean_square;  ///< [W^2] 0: nothing lit
  std::vector<double> lit;          ///< pixels
  double mean_flux = 0;             ///< [W] over lit pixels
  StatedError stated;               ///< of the whole image
};

TileErrors measure_errors(const Film& film, const Execution& execution) {
  TileErrors errors;
  const auto [flux, error] = film.images(0, execution);
  const ImageParts parts = film.lit_parts();
  const float limit = static_cast<float>(kLitShare) * largest_of(flux, parts, execution);
  const auto tiles = static_cast<std::size_t>(film.tile_count());
  errors.mean_square.resize(tiles);
  errors.lit.resize(tiles);
  std::vector<double> totals(tiles);
  parallel_for(execution.threads_only(), tiles, [&](std::size_t t, int) {
    const PixelWindow tile = film.tile(static_cast<int>(t));
    double tile_squares = 0, tile_lit = 0;
    if (film.tile_sums(static_cast<int>(t)).empty()) return;  // without rays
    for (int row = tile.y - film.window().y; row < tile.y - film.window().y + tile.height; ++row)
      for (int column = tile.x - film.window().x; column < tile.x - film.window().x + tile.width;
           ++column) {
        if (!(flux.at(column, row) > limit)) continue;
        // One replicate has no scatter.
        const double e = error.empty() ? 0 : static_cast<double>(error.at(column, row));
        tile_squares += e * e;
        totals[t] += static_cast<double>(flux.at(column, row));
        tile_lit += 1;
      }
    errors.mean_square[t] = tile_lit > 0 ? tile_squares / tile_lit : 0;
    errors.lit[t] = tile_lit;
  });
  double total = 0, lit = 0;
  for (std::size_t t = 0; t < tiles; ++t) {
    total += totals[t];
    lit += errors.lit[t];
  }
  if (lit > 0) errors.mean_flux = total / lit;
  errors.stated = stated_error(flux, error, film.replicates(), parts, execution);
  return errors;
}

/// Orders the tiles so that the first of them are representative of all. Neighbours cost about the
/// same number of rays. Row by row, the total time would stay unknown until the end. Steps by the
/// golden ratio of the number of tiles (Weyl's sequence) cover it evenly.
std::vector<int> spread(const std::vector<int>& tiles) {
  const std::size_t count = tiles.size();
  auto step = static_cast<std::size_t>(0.6180339887498949 * static_cast<double>(count));
  while (std::gcd(step, count) > 1) ++step;
  std::vector<int> order;
  for (std::size_t i = 0, at = 0; i < count; ++i, at = (at + step) % count)
    order.push_back(tiles[at]);
  return order;
}

/// A rendering in work.
struct Run {
  const CompiledScene& scene;
  const RenderSettings& settings;
  const Execution& execution;
  const Execution& limited;  ///< the same, which also stops at the time limit
  Film& film;
  RenderStatistics& statistics;
  const BackwardShared& shared;
  Checkpoints& checkpoints;
  TileProgress& progress;
  RankTiles* ranks;  ///< nullptr: there are no other ranks
};

/// Runs the jobs of a pass in batches. The state is saved between batches.
/// @param ranges of the pass
bool run_in_batches(const BackwardPass& pass, const std::vector<PointRange>& ranges,
                    const std::vector<TileJob>& jobs, const Run& run) {
  Batches batches(run.settings, jobs.size(), run.limited.thread_count());
  const auto tell = [&](const TileJob& job, double rays) {
    run.progress.add(job.tile, ranges[job.range].points, rays);
  };
  for (std::size_t first = 0; first < jobs.size();) {
    const auto begin = jobs.begin() + static_cast<std::ptrdiff_t>(first);
    const std::size_t count = std::min(batches.size(), jobs.size() - first);
    const std::vector<TileJob> part(begin, begin + static_cast<std::ptrdiff_t>(count));
    const auto start = std::chrono::steady_clock::now();
    const bool finished =
        run.ranks ? run.ranks->run(pass, part, run.limited, run.film, run.statistics, tell)
                  : pass.run(part, run.limited, run.film, run.statistics, tell);
    if (!finished) return false;
    batches.learn(count, seconds_since(start));
    first += count;
    run.checkpoints.offer(run.film);
  }
  if (run.ranks) run.ranks->end_pass(run.statistics);
  return true;
}

/// Runs a pass over the jobs. @return false when it was stopped
bool run_pass(const std::vector<PointRange>& ranges, const std::vector<TileJob>& jobs,
              const Run& run) {
  if (run.ranks) run.ranks->begin_pass(ranges);
  const BackwardPass pass(run.scene, run.settings, ranges, run.shared, run.execution.threads);
  return run_in_batches(pass, ranges, jobs, run);
}

/// Brings every tile to a number of samples in one uninterrupted run.
void render_fixed(const Run& run, int points) {
  const Film& film = run.film;
  std::map<int, std::vector<int>> groups;  // by their number of samples
  const Part& part = run.settings.part;
  std::vector<double> goals(static_cast<std::size_t>(film.tile_count()), points);
  for (int t = 0; t < film.tile_count(); ++t)
    if (part_of_tile(t, film.tiles_across(), part.count) != part.number - 1)
      goals[static_cast<std::size_t>(t)] = film.tile_samples(t);
    else if (film.tile_samples(t) < points)
      groups[static_cast<int>(film.tile_samples(t))].push_back(t);
  run.progress.foresee(film, goals);
  run.statistics.complete = true;
  for (const auto& [done, tiles] : groups) {
    std::vector<TileJob> jobs;
    for (const int tile : spread(tiles)) jobs.push_back({tile});
    // A tile that continues a sequence takes its next points.
    run.statistics.complete =
        run_pass({{static_cast<std::uint32_t>(done), points - done, done > 0}}, jobs, run);
    if (!run.statistics.complete) return;
  }
}

bool is_started(const Film& film) {
  return std::all_of(film.all_tile_samples().begin(), film.all_tile_samples().end(),
                     [](double s) { return s > 0; });
}

/// Tells whether any ray was traced. Without rays the picture is known to be dark.
bool is_sent(const Film& film) {
  for (int t = 0; t < film.tile_count(); ++t)
    if (!film.tile_sums(t).empty()) return true;
  return false;
}

/// Tells whether the target is met. The relative error of a picture that is still dark is unknown.
bool is_met(const Film& film, const TileErrors& errors, const RenderSettings& settings) {
  return settings.target_error > 0 && errors.stated.bound <= settings.target_error &&
         (errors.mean_flux > 0 || !is_sent(film));
}

/// Tells whether the rendering can end because enough rays found no light.
bool seems_dark(const Film& film, const TileErrors& errors) {
  if (errors.mean_flux > 0) return false;
  for (int t = 0; t < film.tile_count(); ++t)
    if (!film.tile_sums(t).empty() && film.tile_samples(t) < kDarkPoints) return false;
  return true;
}

/// Tells whether a round has begun and not ended.
bool in_a_round(const Film& film) {
  for (int t = 0; t < film.tile_count(); ++t)
    if (!film.tile_goals().empty() &&
        film.tile_goals()[static_cast<std::size_t>(t)] > film.tile_samples(t))
      return true;
  return false;
}

/// Error coefficient: mean square error at one sample per replicate, extrapolated with kErrorSlope.
double difficulty_of(const Film& film, const TileErrors& errors, int tile) {
  const double square = errors.mean_square[static_cast<std::size_t>(tile)];
  return square * std::pow(std::max(1.0, film.tile_samples(tile)), 2 * kErrorSlope);
}

/// The error coefficient from which the samples of a tile follow: the mean over its lit neighbours.
/// Errors change little from tile to tile. A tile's own samples must not decide about more samples,
/// since this would bias the mean: samples with little scatter also tend to be low.
double deciding_difficulty(const Film& film, const TileErrors& errors, int tile, double mean) {
  const int across = film.tiles_across(), down = film.tile_count() / across;
  const int x = tile % across, y = tile / across;
  double sum = 0, count = 0;
  for (int j = std::max(0, y - 1); j <= std::min(down - 1, y + 1); ++j)
    for (int i = std::max(0, x - 1); i <= std::min(across - 1, x + 1); ++i) {
      const double d = difficulty_of(film, errors, j * across + i);
      if ((i == x && j == y) || d <= 0) continue;
      sum += d;
      count += 1;
    }
  return count > 0                                                ? sum / count
         : errors.mean_square[static_cast<std::size_t>(tile)] > 0 ? mean
                                                                  : 0;
}

/// Planned samples per replicate of each tile.
struct RoundPlan {
  std::vector<int> samples;    ///< after the next round
  std::vector<double> at_end;  ///< estimate after the last round; empty: unknown
};

/// Estimates the samples of tiles when the goal is met. A single round adds only some doublings.
std::vector<double> foreseen_samples(const std::vector<TileNeed>& needs,
                                     const std::vector<int>& samples, double goal, int limit) {
  double squares = 0, lit = 0;
  for (std::size_t t = 0; t < needs.size(); ++t) {
    lit += needs[t].lit;
    squares += needs[t].lit * needs[t].difficulty * std::pow(samples[t], -2 * kErrorSlope);
  }
  const double factor =
      squares > goal * lit ? std::pow(squares / (goal * lit), 1 / (2 * kErrorSlope)) : 1;
  std::vector<double> at_end;
  for (std::size_t t = 0; t < needs.size(); ++t)
    at_end.push_back(
        std::min(samples[t] * (needs[t].difficulty > 0 ? factor : 1),
                 std::max(static_cast<double>(limit), static_cast<double>(samples[t]))));
  return at_end;
}

/// Plans the next round. Without a target its goal is half the error of the image.
RoundPlan plan_round(const Film& film, const RenderSettings& settings, const TileErrors& errors,
                     int limit) {
  RoundPlan plan;
  std::vector<int>& samples = plan.samples;
  for (const double done : film.all_tile_samples())
    samples.push_back(done > 0 ? static_cast<int>(done) : std::min(kFirstPoints, limit));
  if (std::count(film.all_tile_samples().begin(), film.all_tile_samples().end(), 0.0) > 0)
    return plan;  // a decision needs rays in every tile
  double mean = 0, tiles_lit = 0, squares = 0, lit = 0;
  for (int t = 0; t < film.tile_count(); ++t) {
    const auto i = static_cast<std::size_t>(t);
    mean += difficulty_of(film, errors, t);
    tiles_lit += errors.mean_square[i] > 0 ? 1 : 0;
    squares += errors.mean_square[i] * errors.lit[i];
    lit += errors.lit[i];
  }
  if (!(lit > 0)) {  // the whole image is still dark
    for (int& n : samples) n = std::min(2 * n, limit);
    return plan;
  }
  mean /= std::max(1.0, tiles_lit);
  // The bound of the error has to fall below the target.
  const double goal = settings.target_error * errors.mean_flux * errors.stated.relative_rmse /
                      std::max(errors.stated.bound, 1e-300);
  const double goal_squared =
      settings.target_error > 0 ? kGoalMargin * goal * goal : 0.25 * squares / lit;
  std::vector<TileNeed> needs;
  double foreseen = 0;
  for (int t = 0; t < film.tile_count(); ++t) {
    const auto i = static_cast<std::size_t>(t);
    const double difficulty = deciding_difficulty(film, errors, t, mean);
    needs.push_back({errors.lit[i], film.tile_samples(t), difficulty});
    foreseen += errors.lit[i] * difficulty * std::pow(film.tile_samples(t), -2 * kErrorSlope);
  }
  // The errors of neighbours decide the distribution of samples, and the error of the whole image
  // their number.
  if (foreseen > 0)
    for (TileNeed& need : needs) need.difficulty *= squares / foreseen;
  samples = plan_samples(needs, goal_squared, limit);
  // Without a target, rounds continue until time or samples end.
  plan.at_end =
      foreseen_samples(needs, samples, settings.target_error > 0 ? goal_squared : 0, limit);
  return plan;
}

/// Brings every tile to its goal; each tile continues its own sequence.
/// @return false when it was stopped
bool run_round(const Run& run, int most_points) {
  std::map<std::pair<int, int>, std::vector<int>> groups;
  for (int t = 0; t < run.film.tile_count(); ++t) {
    const int done = static_cast<int>(run.film.tile_samples(t));
    const int points = static_cast<int>(run.film.tile_goals()[static_cast<std::size_t>(t)]) - done;
    if (points > 0) groups[{std::min(points, most_points), done}].push_back(t);
  }
  // The longest ranges come first. One pass takes as many as the memory of the pools allows.
  std::vector<PointRange> ranges;
  std::vector<TileJob> jobs;
  int sum = 0;
  for (auto group = groups.rbegin(); group != groups.rend(); ++group) {
    const auto& [points, done] = group->first;
    for (const int tile : spread(group->second)) jobs.push_back({tile, ranges.size()});
    ranges.push_back({static_cast<std::uint32_t>(done), points, true});
    sum += points;
    const auto next = std::next(group);
    if (next != groups.rend() && sum + next->first.first <= most_points) continue;
    if (!run_pass(ranges, jobs, run)) return false;
    ranges = {};
    jobs = {};
    sum = 0;
  }
  return true;
}

/// @param limit of the points of each replicate
void render_progressive(const Run& run, int limit, int most_points) {
  Film& film = run.film;
  const RenderSettings& settings = run.settings;
  // For a round that an earlier run began, only its goals are known.
  if (in_a_round(film)) run.progress.foresee(film, film.tile_goals());
  for (bool finished = true; finished; finished = run_round(run, most_points)) {
    if (in_a_round(film)) continue;
    const TileErrors errors = measure_errors(film, run.execution);
    if (is_started(film)) {
      run.statistics.relative_error = errors.stated.relative_rmse;
      std::vector<double> squares = errors.mean_square;
      for (std::size_t t = 0; t < squares.size(); ++t) squares[t] *= errors.lit[t];
      run.progress.measured(film, run.statistics.relative_error, std::move(squares));
      if (is_met(film, errors, settings)) break;
      if (settings.target_error > 0 && seems_dark(film, errors)) break;
    }
    const RoundPlan plan = plan_round(film, settings, errors, limit);
    film.tile_goals().assign(plan.samples.begin(), plan.samples.end());
    if (!in_a_round(film)) break;
    if (plan.at_end.empty())
      run.progress.explore(film, film.tile_goals());
    else
      run.progress.foresee(film, plan.at_end);
  }
  // The end of a time limit is no interruption. The picture is complete unless some part of it has
  // no ray yet.
  run.statistics.complete = !run.execution.stop.stop_requested() && is_started(film);
  run.statistics.target_reached =
      settings.target_error <= 0 ||
      (is_started(film) && is_met(film, measure_errors(film, run.execution), settings));
}

}  // namespace

void render_rounds(const CompiledScene& scene, const RenderSettings& settings,
                   const Execution& execution, Film& film, RenderStatistics& statistics,
                   int most_points) {
  const Deadline deadline(execution.stop, settings.time_limit);
  RunProgress progress(execution, settings.time_limit);
  const int points = samples_per_replicate(settings);
  // The other ranks prepare their passes at the same time.
  std::unique_ptr<RankTiles> ranks;
  if (settings.ranks && settings.ranks->size() > 1)
    ranks = std::make_unique<RankTiles>(*settings.ranks, settings, execution.stop);
  const BackwardShared shared(scene, settings, execution);
  count_lenses(scene, shared, film.window(), statistics);
  Execution limited = execution;
  limited.stop = deadline.token();
  Checkpoints checkpoints(settings);
  TileProgress of_tiles(progress, film);
  const Run run{scene,      settings, execution,   limited,  film,
                statistics, shared,   checkpoints, of_tiles, ranks.get()};
  if (has_fixed_samples(settings))
    render_fixed(run, points);
  else
    render_progressive(run, points, most_points);
  if (statistics.complete) progress.complete();
}

}  // namespace plenoflame
