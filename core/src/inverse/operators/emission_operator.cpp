#include "plenoflame/inverse/emission_operator.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "inverse/operators/followed_rows.h"
#include "plenoflame/base/error.h"
#include "plenoflame/base/part_of_progress.h"

namespace plenoflame {
namespace {

/// Rows whose replicates are compared.
constexpr std::size_t kComparedRows = 4096;
/// Number of sampled rows that estimate the number of all entries before rays are drawn. The
/// estimate pays from this number of rays per pixel and replicate on.
constexpr std::size_t kSampledRows = 64;
constexpr int kFewestOfSample = 4;

/// Follows the rays of rows; one for each thread.
class RowWalk {
 public:
  explicit RowWalk(const EmissionProblem& problem) : problem_(problem), rays_(*problem.rays) {}

  /// Calls use(sample, value, replicate) for every contribution to a row's flux [W].
  template <class Use>
  void follow_rays(std::size_t row, const Use& use) {
    for (const CameraRay& ray : rays_.of(row)) {
      intervals_.clear();
      problem_.unknowns->append({ray.origin, ray.direction}, 0, ray.end, intervals_);
      node_weights(intervals_, problem_.absorption, problem_.model, weights_);
      sum_nodes(ray.weight, weights_, intervals_);
      for (const RayInterval& interval : intervals_)
        for (int c = 0; c < interval.count; ++c)
          use(interval.sample[c], interval.weight[0][c], ray.replicate);
    }
  }

  template <class Use>
  void follow(std::size_t row, const Use& use) {
    follow_rays(row, [&](std::size_t sample, double value, int) { use(sample, value); });
  }

 private:
  const EmissionProblem& problem_;
  RowRays rays_;
  RayIntervals intervals_;
  IntervalTransfers weights_;
};

struct EmissionRows {
  EmissionProblem problem;
  std::size_t rows() const { return problem.rays->rows.size(); }
  std::size_t columns() const { return problem.unknowns->size(); }
  RowPieces pieces() const { return pieces_of(*problem.rays); }
  RowWalk walk() const { return RowWalk(problem); }
};

void check(const EmissionProblem& problem) {
  if (!problem.absorption.empty() && problem.absorption.size() != problem.unknowns->size())
    throw UsageError("the absorption needs one value for each unknown");
  if (problem.model == RowModel::source && problem.absorption.empty())
    throw UsageError("a source function that nothing absorbs is not seen: give the absorption");
}

}  // namespace

std::size_t estimated_entries(const EmissionProblem& problem) {
  check(problem);
  return estimate_entries(EmissionRows{problem});
}

std::vector<std::size_t> sampled_rows(const CameraRays& rays) {
  return sampled_rows(pieces_of(rays));
}

std::size_t entries_of_rows(const EmissionProblem& problem, std::span<const std::size_t> rows) {
  check(problem);
  return entries_of(EmissionRows{problem}, rows);
}

double least_entries(const EmissionProblem& problem, const std::vector<CameraView>& views,
                     const CameraRaySettings& settings, const Execution& execution) {
  check(problem);
  if (settings.samples < kFewestOfSample * settings.replicates) return 0;
  const Box box = problem.unknowns->bounds();
  CameraRaySettings fewest = settings;
  fewest.samples = settings.replicates;
  const CameraRays few = counted_camera_rays(views, box, fewest, execution);
  const std::size_t rows = few.rows.size();
  const std::size_t step = std::max<std::size_t>(1, rows / kSampledRows);
  const std::size_t count = rows / step;
  if (count < 2) return 0;
  CameraRaySettings all = settings;
  all.keep = true;
  std::vector<double> entries(count, 0.0);
  const auto task = [&](std::size_t k, int) {
    const std::size_t i = k * step + step / 2;
    const CameraRays::Row& wanted = few.rows[i];
    CameraView view = views[static_cast<std::size_t>(wanted.view)];
    view.window = window_around(few, std::span(&i, 1), settings.bin);
    Execution alone;
    alone.threads = 1;
    const CameraRays rays = draw_camera_rays({view}, box, all, alone);
    EmissionProblem own = problem;
    own.rays = &rays;
    RowWalk walk(own);
    RowSum sum(problem.unknowns->size());
    for (std::size_t row = 0; row < rays.rows.size(); ++row) {
      if (rays.rows[row].column != wanted.column || rays.rows[row].row != wanted.row) continue;
      walk.follow(row, [&](std::size_t column, double value) { sum.add(column, value); });
      sum.take([&](std::size_t, double) { ++entries[k]; });
    }
  };
  const Execution quiet = without_reports(execution);
  for_pieces(quiet, count, task);
  double mean = 0, squares = 0;
  for (const double own : entries) mean += own / static_cast<double>(count);
  for (const double own : entries) squares += (own - mean) * (own - mean);
  const double error = std::sqrt(squares / static_cast<double>(count * (count - 1)));
  return static_cast<double>(rows) * std::max(0.0, mean - 3 * error);
}

CsrMatrix<float> make_emission_matrix(const EmissionProblem& problem, const Execution& execution) {
  check(problem);
  const EmissionRows rows{problem};
  return problem.rays->source ? store_pieces(rows, execution) : store_rows(rows, execution);
}

std::unique_ptr<LinearOperator> make_emission_operator(const EmissionProblem& problem,
                                                       const Execution& execution) {
  check(problem);
  return std::make_unique<FollowedOperator<EmissionRows>>(EmissionRows{problem}, execution);
}

std::vector<std::array<double, 2>> replicate_fluxes(const EmissionProblem& problem,
                                                    std::span<const double> x,
                                                    const Execution& execution) {
  check(problem);
  const std::size_t rows = problem.rays->rows.size();
  const std::size_t step = (rows + kComparedRows - 1) / kComparedRows;
  std::vector<std::array<double, 2>> sums(step > 0 ? (rows + step - 1) / step : 0);
  const RowPieces pieces = pieces_of(*problem.rays);
  const auto task = [&](std::size_t piece, int) {
    RowWalk walk(problem);
    follow_piece(pieces, piece, execution, [&](std::size_t row) {
      if (row % step != 0) return;
      walk.follow_rays(row, [&](std::size_t sample, double value, int replicate) {
        if (replicate < 2)
          sums[row / step][static_cast<std::size_t>(replicate)] += value * x[sample];
      });
    });
  };
  for_pieces(execution, pieces.count(), task);
  if (std::all_of(sums.begin(), sums.end(), [](const auto& sum) { return sum[1] == 0; })) return {};
  return sums;
}

}  // namespace plenoflame
