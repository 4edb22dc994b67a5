#pragma once
#include <chrono>
#include <vector>

#include "plenoflame/base/execution.h"
#include "plenoflame/film/film.h"

namespace plenoflame {

/// Reports the progress of a whole run, whatever batches and rounds it is made of. The share that
/// is reported never falls: where more turns out to be left than was foreseen, it grows the slower.
/// Not for several threads at once.
class RunProgress {
 public:
  /// The run begins now. @param time_limit [s] that may end it; 0: none
  RunProgress(const Execution& execution, double time_limit)
      : execution_(execution), time_limit_(time_limit) {}

  /// From now on `left` is foreseen until the run ends, in units of which `done` are done.
  void foresee(double done, double left);
  /// From now on work is done whose outcome tells how much is left: of that nothing is known yet.
  /// @param work of this stretch
  /// @param share of the run that will be done at its end, at most; 0: not known, little is taken
  void explore(double work, double share = 0);
  /// So much of the work has been done, with so many rays; reports.
  void add(double work, double rays);
  /// All is done, also where it took less than was foreseen; reports.
  void complete();
  /// Estimated relative RMSE that is reported from now on.
  void set_relative_error(double error) { relative_error_ = error; }

  double fraction() const { return fraction_; }

 private:
  using Clock = std::chrono::steady_clock;
  void begin_stretch(double from, double to, double work);
  void report(double remaining);

  const Execution& execution_;
  double time_limit_;
  double fraction_ = 0;              ///< reported last
  double from_ = 0, to_ = 1;         ///< what the stretch stands for
  double work_ = 1, work_done_ = 0;  ///< of the stretch
  double rays_ = 0, relative_error_ = -1;
  Clock::time_point start_ = Clock::now(), stretch_start_ = start_;
};

/// The same for runs in tiles, which cost very different numbers of rays: what a tile has cost
/// tells how much its further samples will.
class TileProgress {
 public:
  TileProgress(RunProgress& run, const Film& film)
      : run_(run), rays_(static_cast<std::size_t>(film.tile_count())), samples_(rays_) {}

  /// From now on each tile is foreseen to hold so many samples per replicate at the end of the run.
  void foresee(const Film& film, const std::vector<double>& samples);
  /// From now on tiles get so many samples, which tell how many more are needed.
  void explore(const Film& film, const std::vector<double>& samples);
  /// Takes the measured error of the film: from now on each report has the error that further
  /// samples leave of it, as kErrorSlope foresees.
  /// @param relative_error of the picture
  /// @param squares share of each tile in its square, up to a factor
  void measured(const Film& film, double relative_error, std::vector<double> squares);
  /// A tile got samples; reports.
  void add(int tile, double samples, double rays);

 private:
  struct Work {
    double done = 0, left = 0;
  };
  Work weigh(const Film& film, const std::vector<double>& samples);

  RunProgress& run_;
  std::vector<double> rays_, samples_;  ///< of each tile, in this run
  std::vector<double> costs_;           ///< of a sample of each tile, as last weighed
  std::vector<double> squares_, held_;  ///< shares in the squared error, samples; empty: not known
  double square_ = 0;                   ///< sum of squares_
};

}  // namespace plenoflame
