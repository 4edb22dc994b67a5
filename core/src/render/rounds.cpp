#include "render/rounds.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "render/backward.h"
#include "render/run_control.h"

namespace plenoflame {
namespace {

constexpr int kFirstPoints = 8;  ///< of each replicate in the first round
constexpr int kCheckpointBatches = 16;

/// Mean square error of every tile's lit pixels, and of the whole image, first channel.
struct TileErrors {
  std::vector<double> mean_square;  ///< [W^2] 0: nothing lit
  double mean_flux = 0;             ///< [W] over lit pixels
  StatedError stated;               ///< of the whole image
};

TileErrors measure_errors(const Film& film) {
  TileErrors errors;
  const Image flux = film.flux(0), error = film.standard_error(0);
  const float limit =
      static_cast<float>(kLitShare) * *std::max_element(flux.pixels.begin(), flux.pixels.end());
  double total = 0, lit = 0;
  for (int t = 0; t < film.tile_count(); ++t) {
    const PixelWindow tile = film.tile(t);
    double tile_squares = 0, tile_lit = 0;
    for (int row = tile.y - film.window().y; row < tile.y - film.window().y + tile.height; ++row)
      for (int column = tile.x - film.window().x; column < tile.x - film.window().x + tile.width;
           ++column) {
        if (!(flux.at(column, row) > limit)) continue;
        const double e = static_cast<double>(error.at(column, row));
        tile_squares += e * e;
        total += static_cast<double>(flux.at(column, row));
        tile_lit += 1;
      }
    errors.mean_square.push_back(tile_lit > 0 ? tile_squares / tile_lit : 0);
    lit += tile_lit;
  }
  if (lit > 0) errors.mean_flux = total / lit;
  errors.stated = stated_error(flux, error, film.replicates());
  return errors;
}

void render_fixed(const CompiledScene& scene, const RenderSettings& settings, int points,
                  const Execution& execution, Film& film, RenderStatistics& statistics,
                  RadianceTable* table) {
  std::vector<int> tiles;
  for (int t = 0; t < film.tile_count(); ++t)
    if (film.tile_samples(t) == 0) tiles.push_back(t);
  Checkpoints checkpoints(settings);
  const std::size_t batch =
      settings.checkpoint
          ? std::max<std::size_t>(1, (tiles.size() + kCheckpointBatches - 1) / kCheckpointBatches)
          : std::max<std::size_t>(1, tiles.size());
  const BackwardPass pass(scene, settings, 0, points, table, execution);
  for (std::size_t first = 0; first < tiles.size() && statistics.complete; first += batch) {
    const auto begin = tiles.begin() + static_cast<std::ptrdiff_t>(first);
    const std::vector<int> part(
        begin, begin + static_cast<std::ptrdiff_t>(std::min(batch, tiles.size() - first)));
    statistics.complete = pass.run(part, execution, film, statistics);
    checkpoints.offer(film);
  }
}

/// The mean square error that decides about a tile: that of its lit neighbours, not its own. Errors
/// change little from tile to tile; but samples that decide whether more are taken would bias the
/// mean (where they scatter little they also lie low).
double deciding_error(const Film& film, const TileErrors& errors, int tile, double mean) {
  const int across = film.tiles_across(), down = film.tile_count() / across;
  const int x = tile % across, y = tile / across;
  double sum = 0, count = 0;
  for (int j = std::max(0, y - 1); j <= std::min(down - 1, y + 1); ++j)
    for (int i = std::max(0, x - 1); i <= std::min(across - 1, x + 1); ++i) {
      const double m = errors.mean_square[static_cast<std::size_t>(j * across + i)];
      if ((i == x && j == y) || m <= 0) continue;
      sum += m;
      count += 1;
    }
  return count > 0                                                ? sum / count
         : errors.mean_square[static_cast<std::size_t>(tile)] > 0 ? mean
                                                                  : 0;
}

/// Tiles that the next round is spent on, those of largest error first.
std::vector<int> choose_tiles(const Film& film, const RenderSettings& settings,
                              const TileErrors& errors, int limit) {
  // Half of the target's square, so that tiles just above it do not take turns; without a target,
  // everything that is not already far better than the rest.
  double mean = 0, lit = 0;
  for (const double m : errors.mean_square) {
    mean += m;
    lit += m > 0 ? 1 : 0;
  }
  // It is the bound that has to come below the target.
  const double goal = settings.target_error * errors.mean_flux * errors.stated.relative_rmse /
                      std::max(errors.stated.bound, 1e-300);
  const double threshold =
      settings.target_error > 0 ? 0.5 * goal * goal : 0.25 * mean / std::max(1.0, lit);
  mean /= std::max(1.0, lit);
  std::vector<double> deciding(errors.mean_square.size());
  std::vector<int> tiles;
  for (int t = 0; t < film.tile_count(); ++t) {
    double& error = deciding[static_cast<std::size_t>(t)];
    error = deciding_error(film, errors, t, mean);
    if (film.tile_samples(t) < limit && (film.tile_samples(t) == 0 || error > threshold))
      tiles.push_back(t);
  }
  std::stable_sort(tiles.begin(), tiles.end(), [&](int a, int b) {
    return deciding[static_cast<std::size_t>(a)] > deciding[static_cast<std::size_t>(b)];
  });
  return tiles;
}

void render_progressive(const CompiledScene& scene, const RenderSettings& settings, int limit,
                        const Execution& execution, Film& film, RenderStatistics& statistics,
                        RadianceTable* table) {
  const Deadline deadline(execution.stop, settings.time_limit);
  Execution inner = execution;
  inner.stop = deadline.token();
  Checkpoints checkpoints(settings);
  bool finished = true;
  while (finished) {
    const TileErrors errors = measure_errors(film);
    const bool started = std::all_of(film.all_tile_samples().begin(), film.all_tile_samples().end(),
                                     [](double s) { return s > 0; });
    if (started) statistics.relative_error = errors.stated.relative_rmse;
    if (started && settings.target_error > 0 && errors.stated.bound <= settings.target_error) break;
    const std::vector<int> tiles = choose_tiles(film, settings, errors, limit);
    if (tiles.empty()) break;
    // Each tile goes on where its own sequence stands, doubling it.
    std::map<int, std::vector<int>> by_samples;
    for (const int t : tiles) by_samples[static_cast<int>(film.tile_samples(t))].push_back(t);
    for (const auto& [done, group] : by_samples) {
      const int points = std::min(std::max(done, kFirstPoints), limit - done);
      finished = finished && BackwardPass(scene, settings, static_cast<std::uint32_t>(done), points,
                                          table, inner)
                                 .run(group, inner, film, statistics);
    }
    if (finished) checkpoints.offer(film);
  }
  // A time limit that ran out is no interruption: what is there is what was asked for.
  statistics.complete = !execution.stop.stop_requested();
  statistics.target_reached =
      settings.target_error <= 0 || measure_errors(film).stated.bound <= settings.target_error;
}

}  // namespace

void render_rounds(const CompiledScene& scene, const RenderSettings& settings,
                   const Execution& execution, Film& film, RenderStatistics& statistics) {
  // Every replicate gets the same number of points.
  const int points = (settings.samples + settings.replicates - 1) / settings.replicates;
  const std::unique_ptr<RadianceTable> table = make_radiance_table(scene, settings);
  if (settings.target_error > 0 || settings.time_limit > 0)
    render_progressive(scene, settings, points, execution, film, statistics, table.get());
  else
    render_fixed(scene, settings, points, execution, film, statistics, table.get());
}

}  // namespace plenoflame
