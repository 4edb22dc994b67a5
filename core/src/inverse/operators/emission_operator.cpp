#include "plenoflame/inverse/emission_operator.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "inverse/operators/followed_rows.h"
#include "plenoflame/base/error.h"

namespace plenoflame {
namespace {

/// Rows whose replicates are compared.
constexpr std::size_t kComparedRows = 4096;

/// Follows the rays of rows; one for each thread.
class RowWalk {
 public:
  explicit RowWalk(const EmissionProblem& problem) : problem_(problem) {}

  /// Calls use(node, weight, replicate) along every ray of a row; the weights are fluxes [W] for a
  /// field of 1.
  template <class Use>
  void follow_nodes(std::size_t row, const Use& use) {
    const CameraRays& all = *problem_.rays;
    for (std::size_t r = all.rows[row].begin; r < all.end_of(row); ++r) {
      const CameraRay& ray = all.rays[r];
      intervals_.clear();
      problem_.unknowns->append({ray.origin, ray.direction}, 0, ray.end, intervals_);
      node_weights(intervals_, problem_.absorption, problem_.model, weights_);
      for (std::size_t i = 0; i < intervals_.size(); ++i)
        for (std::size_t n = 0; n < 2; ++n)
          use(intervals_[i].node[n], ray.weight * weights_[i][n], ray.replicate);
    }
  }

  template <class Use>
  void follow(std::size_t row, const Use& use) {
    follow_nodes(row, [&](const RayNode& node, double weight, int) {
      for (std::size_t c = 0; c < static_cast<std::size_t>(node.count); ++c)
        use(node.sample[c], weight * node.weight[c]);
    });
  }

 private:
  const EmissionProblem& problem_;
  std::vector<RayInterval> intervals_;
  std::vector<std::array<double, 2>> weights_;
};

struct EmissionRows {
  EmissionProblem problem;
  std::size_t rows() const { return problem.rays->rows.size(); }
  std::size_t columns() const { return problem.unknowns->size(); }
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

CsrMatrix<float> make_emission_matrix(const EmissionProblem& problem, const Execution& execution) {
  check(problem);
  return store_rows(EmissionRows{problem}, execution);
}

CsrRows<float> make_emission_rows(const EmissionProblem& problem, const Execution& execution) {
  check(problem);
  std::vector<std::int64_t> starts{0};
  CsrRows<float> rows;
  gather_rows(EmissionRows{problem}, execution, starts, rows.columns, rows.values);
  for (std::size_t i = 0; i + 1 < starts.size(); ++i)
    rows.counts.push_back(static_cast<std::size_t>(starts[i + 1] - starts[i]));
  return rows;
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
  if (std::none_of(problem.rays->rays.begin(), problem.rays->rays.end(),
                   [](const CameraRay& ray) { return ray.replicate > 0; }))
    return {};
  const std::size_t rows = problem.rays->rows.size();
  const std::size_t step = (rows + kComparedRows - 1) / kComparedRows;
  std::vector<std::array<double, 2>> sums((rows + step - 1) / step);
  constexpr std::size_t kRowsOfTask = 64;
  const auto task = [&](std::size_t part, int) {
    RowWalk walk(problem);
    const std::size_t end = std::min(sums.size(), (part + 1) * kRowsOfTask);
    for (std::size_t i = part * kRowsOfTask; i < end; ++i)
      walk.follow_nodes(i * step, [&](const RayNode& node, double weight, int replicate) {
        if (replicate < 2) sums[i][static_cast<std::size_t>(replicate)] += weight * node.value(x);
      });
  };
  if (!parallel_for(execution, (sums.size() + kRowsOfTask - 1) / kRowsOfTask, task))
    throw Cancelled();
  return sums;
}

}  // namespace plenoflame
