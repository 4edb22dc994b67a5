#pragma once
#include <chrono>
#include <vector>

#include "plenoflame/base/execution.h"
#include "plenoflame/film/film.h"

namespace plenoflame {

/// Reports the progress of a whole run over all batches and rounds. The reported share never falls:
/// if more work is left than expected, it grows more slowly. Must be used by one thread at a time.
class RunProgress {
 public:
  /// Begins the run. @param time_limit [s] that may end it; 0: none
  RunProgress(const Execution& execution, double time_limit)
      : execution_(execution), time_limit_(time_limit) {}

  /// From now on `left` units of work are expected until the run ends, after `done` units.
  void foresee(double done, double left);
  /// Begins a stretch of work whose outcome tells how much is left. The rest is unknown until then.
  /// @param work of this stretch
  /// @param share largest completed share of the run at its end; 0: unknown, a small share is taken
  void explore(double work, double share = 0);
  /// Adds completed work and its rays; reports.
  void add(double work, double rays);
  /// Ends the run, also if it took less work than expected; reports.
  void complete();
  /// Estimated relative RMSE for the following reports.
  void set_relative_error(double error) { relative_error_ = error; }

  double fraction() const { return fraction_; }

 private:
  using Clock = std::chrono::steady_clock;
  void begin_stretch(double from, double to, double work);
  void report(double remaining);

  const Execution& execution_;
  double time_limit_;
  double fraction_ = 0;              ///< last reported share
  double from_ = 0, to_ = 1;         ///< shares of the run at both ends of the stretch
  double work_ = 1, work_done_ = 0;  ///< of the stretch
  double rays_ = 0, relative_error_ = -1;
  Clock::time_point start_ = Clock::now(), stretch_start_ = start_;
};

/// Progress of runs in tiles, which need very different numbers of rays. The cost of a tile so far
/// predicts the cost of its further samples.
class TileProgress {
 public:
  TileProgress(RunProgress& run, const Film& film)
      : run_(run), rays_(static_cast<std::size_t>(film.tile_count())), samples_(rays_) {}

  /// Sets the samples per replicate that each tile is expected to have at the end of the run.
  void foresee(const Film& film, const std::vector<double>& samples);
  /// Sets the samples per replicate that each tile gets now. Their outcome tells how many more are
  /// needed.
  void explore(const Film& film, const std::vector<double>& samples);
  /// Takes the measured error of the film. Each later report extrapolates it to the samples so far
  /// with kErrorSlope.
  /// @param relative_error of the picture
  /// @param squares contribution of each tile to its square, up to a factor
  void measured(const Film& film, double relative_error, std::vector<double> squares);
  /// Adds samples of a tile; reports.
  void add(int tile, double samples, double rays);

 private:
  struct Work {
    double done = 0, left = 0;
  };
  Work weigh(const Film& film, const std::vector<double>& samples);

  RunProgress& run_;
  std::vector<double> rays_, samples_;  ///< of each tile, in this run
  std::vector<double> costs_;           ///< of a sample of each tile, at the last estimate
  std::vector<double> squares_, held_;  ///< parts of the squared error, samples; empty: unknown
  double square_ = 0;                   ///< sum of squares_
};

}  // namespace plenoflame
