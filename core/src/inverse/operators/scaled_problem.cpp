#include "inverse/operators/scaled_problem.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "inverse/operators/vector_sums.h"
#include "plenoflame/base/error.h"
#include "plenoflame/inverse/csr_matrix.h"
#include "plenoflame/inverse/penalty.h"

namespace plenoflame {
namespace {

constexpr double kSirtRelaxation = 1.9, kSartRelaxation = 1, kMartRelaxation = 0.05;
/// Least squares are solved until the gradient is that much shorter than the one that noise of one
/// deviation has.
constexpr double kGradient = 0.01;

bool is_multiplicative(ReconstructionSolver solver) {
  return solver == ReconstructionSolver::mlem || solver == ReconstructionSolver::osem ||
         solver == ReconstructionSolver::mart;
}

/// Sums of the columns over the rows that have a weight.
std::vector<double> seen_by_counting_rows(const LinearOperator& a,
                                          std::span<const double> weights) {
  std::vector<double> counts(weights.size());
  for (std::size_t i = 0; i < counts.size(); ++i) counts[i] = weights[i] > 0 ? 1 : 0;
  return transposed_times(a, counts);
}

std::vector<char> taking_part(const std::vector<double>& scale) {
  std::vector<char> mask;
  for (const double s : scale) mask.push_back(s > 0);
  return mask;
}

}  // namespace

ChosenPenalty make_penalty_of(const ReconstructionSettings& settings, const Unknowns& unknowns,
                              std::vector<char> mask, bool empty_outside) {
  PenaltyGrid grid;
  grid.shape = unknowns.shape();
  grid.spacing = unknowns.spacing();
  grid.strength = settings.penalty_axes;
  grid.mask = std::move(mask);
  grid.empty_outside = empty_outside;
  grid.begins_at_centre = unknowns.begins_at_centre();
  ChosenPenalty chosen;
  if (is_penalised(settings.solver)) {
    chosen.reference = reference_penalty(grid);
    chosen.l = make_penalty(grid);
  }
  if (chosen.l && !(chosen.l->squared_norm({}) > 0))
    throw InputError("the penalty has no rows: every strength is 0, or all unknowns stand alone");
  return chosen;
}

bool is_penalised(ReconstructionSolver solver) {
  return solver == ReconstructionSolver::fista || solver == ReconstructionSolver::active_set ||
         solver == ReconstructionSolver::cgls || solver == ReconstructionSolver::lsqr;
}

bool wants_matrix(ReconstructionSolver solver) {
  return solver == ReconstructionSolver::sart || solver == ReconstructionSolver::osem ||
         solver == ReconstructionSolver::mart;
}

ScaledColumns::ScaledColumns(const LinearOperator& a, std::vector<double> scale)
    : a_(a), scale_(std::move(scale)) {}

void ScaledColumns::apply(std::span<const double> x, std::span<double> y) const {
  std::vector<double> scaled(x.begin(), x.end());
  scale_by(scale_, scaled);
  a_.apply(scaled, y);
}

void ScaledColumns::apply_transpose(std::span<const double> y, std::span<double> x) const {
  a_.apply_transpose(y, x);
  scale_by(scale_, x);
}

void ScaledColumns::apply_together(std::span<const double> x, std::span<double> y) const {
  std::vector<double> scaled(x.begin(), x.end());
  scale_by<kTogether>(scale_, scaled);
  a_.apply_together(scaled, y);
}

void ScaledColumns::apply_transpose_together(std::span<const double> y, std::span<double> x) const {
  a_.apply_transpose_together(y, x);
  scale_by<kTogether>(scale_, x);
}

/// Every n-th row, with the unknowns as they are.
struct ScaledProblem::Subset {
  std::size_t first, step;
  CsrMatrix<float> matrix;
  std::unique_ptr<LinearOperator> a;
  std::unique_ptr<ScaledColumns> scaled;
  std::vector<double> weights;

  std::vector<double> own(std::span<const double> all) const {
    std::vector<double> part;
    for (std::size_t i = first; i < all.size(); i += step) part.push_back(all[i]);
    return part;
  }
};

ScaledProblem::ScaledProblem(const CsrMatrix<float>* matrix, const LinearOperator& a,
                             std::vector<double> weights, std::vector<double> scale,
                             const Unknowns& unknowns, const ReconstructionSettings& settings)
    : matrix_(matrix),
      weights_(std::move(weights)),
      scale_(std::move(scale)),
      settings_(settings),
      scaled_a_(a, scale_),
      penalty_(make_penalty_of(settings, unknowns, taking_part(scale_), true)) {
  if (penalty_.l) {
    scaled_penalty_ = std::make_unique<ScaledColumns>(*penalty_.l, scale_);
    std::vector<double> uniform;
    for (const double s : scale_) uniform.push_back(s > 0 ? 1 : 0);
    unit_ = penalty_unit(a, weights_, uniform, penalty_.reference);
  }
  if (is_penalised(settings.solver)) {
    SignSequence signs(3);
    std::vector<double> noise(weights_.begin(), weights_.end());
    for (double& value : noise) value *= signs.next();
    noise_gradient_ = norm(transposed_times(scaled_a_, noise));
  }
  if (!wants_matrix(settings.solver)) return;
  if (!matrix_)
    throw InputError(
        "this solver goes through the rows of the stored matrix, which would take more memory than "
        "it may: give it more, take larger blocks of pixels, or another solver");
  if (settings.solver == ReconstructionSolver::mart) return;
  const auto count = static_cast<std::size_t>(std::max(1, settings.subsets));
  for (std::size_t s = 0; s < count; ++s) {
    auto subset = std::make_unique<Subset>();
    subset->first = s;
    subset->step = count;
    subset->matrix = interleaved_rows(*matrix_, s, count);
    subset->a = make_csr_operator(subset->matrix);
    subset->scaled = std::make_unique<ScaledColumns>(*subset->a, scale_);
    subset->weights = subset->own(weights_);
    subsets_.push_back(std::move(subset));
  }
}

ScaledProblem::~ScaledProblem() = default;

void ScaledProblem::set_prior(std::span<const double> prior) {
  prior_ = scaled(prior);
}

std::vector<double> ScaledProblem::samples(std::span<const double> u) const {
  std::vector<double> x(u.begin(), u.end());
  scale_by(scale_, x);
  return x;
}

std::vector<double> ScaledProblem::scaled(std::span<const double> x) const {
  std::vector<double> u(x.begin(), x.end());
  for (std::size_t j = 0; j < u.size(); ++j) u[j] = scale_[j] > 0 ? u[j] / scale_[j] : 0;
  return u;
}

Regularisation ScaledProblem::regularisation(double strength) const {
  if (!scaled_penalty_) return {};
  return {scaled_penalty_.get(), strength * unit_, prior_};
}

std::size_t ScaledProblem::clipped(std::span<const double> b) const {
  if (!is_multiplicative(settings_.solver)) return 0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < b.size(); ++i) count += weights_[i] > 0 && b[i] < 0;
  return count;
}

Solution ScaledProblem::solve(std::span<const double> b, double strength,
                              const std::vector<double>& start, const SolverOptions& options,
                              const Execution& execution) const {
  return solve_absolute(b, strength * unit_, start.empty() ? start : scaled(start), options,
                        execution);
}

std::vector<double> ScaledProblem::without_bounds(std::span<const double> b, double strength,
                                                  const Execution& execution) const {
  SolverOptions options;
  options.iterations = std::min(settings_.iterations, kLinearRange.iterations);
  options.gradient = kGradient * noise_gradient_;
  options.relative_change = 0;
  Solution solution = solve_cgls(problem(b), regularisation(strength), options, execution);
  for (double& value : solution.x) value = std::max(value, 0.0);
  return samples(solution.x);
}

StrengthChoice ScaledProblem::choose(std::span<const double> b, const StrengthRange& range,
                                     const SolverOptions& options,
                                     const Execution& execution) const {
  SolverOptions own = options;
  own.gradient = kGradient * noise_gradient_;
  own.relative_change = 0;
  StrengthChoice choice =
      choose_strength(problem(b), {scaled_penalty_.get(), 0, prior_}, unit_, range, own, execution);
  for (double& value : choice.solution.x) value = std::max(value, 0.0);
  return choice;
}

Solution ScaledProblem::solve_absolute(std::span<const double> b, double strength,
                                       const std::vector<double>& start,
                                       const SolverOptions& options,
                                       const Execution& execution) const {
  SolverOptions own = options;
  own.start = start;
  if (noise_gradient_ > 0) {
    own.gradient = kGradient * noise_gradient_;
    own.relative_change = 0;  // steps are short after a start, too
  }
  const LinearProblem whole = problem(b);
  Regularisation penalty;
  if (scaled_penalty_) penalty = {scaled_penalty_.get(), strength, prior_};
  Solution kept;
  own.kept = &kept;
  Solution solution;
  try {
    solution = solve_by_solver(whole, penalty, own, execution);
  } catch (const Cancelled&) {
    // The stop came within a product: the result of the iterations before it is kept.
    if (kept.history.empty()) throw;
    solution = std::move(kept);
    solution.reason = StopReason::stopped;
  }
  if (settings_.solver == ReconstructionSolver::cgls ||
      settings_.solver == ReconstructionSolver::lsqr)
    cut_off(b, solution);
  return solution;
}

void ScaledProblem::cut_off(std::span<const double> b, Solution& solution) const {
  for (double& value : solution.x) value = std::max(value, 0.0);
  if (solution.history.empty()) return;
  try {
    // The history tells the misfit of what is handed out.
    const std::vector<double> image = scaled_a_ * solution.x;
    double misfit = 0;
    for (std::size_t i = 0; i < image.size(); ++i)
      if (weights_[i] > 0) misfit += std::pow(weights_[i] * (image[i] - b[i]), 2);
    solution.history.back().misfit = misfit;
  } catch (const Cancelled&) {
    solution.reason = StopReason::stopped;  // it tells that of what negative values belong to
  }
}

Solution ScaledProblem::solve_by_solver(const LinearProblem& whole, const Regularisation& penalty,
                                        SolverOptions own, const Execution& execution) const {
  const std::span<const double> b = whole.b;
  switch (settings_.solver) {
    case ReconstructionSolver::fista:
      return solve_nnls(whole, penalty, own, execution);
    case ReconstructionSolver::active_set:
      return solve_nnls_active_set(whole, penalty, execution);
    case ReconstructionSolver::cgls:
      return solve_cgls(whole, penalty, own, execution);
    case ReconstructionSolver::lsqr:
      return solve_lsqr(whole, penalty, own, execution);
    case ReconstructionSolver::sirt: {
      const double relaxation = settings_.relaxation > 0 ? settings_.relaxation : kSirtRelaxation;
      return solve_sirt(std::vector<LinearProblem>{whole}, relaxation, own, execution);
    }
    case ReconstructionSolver::mlem: {
      std::vector<double> counts(b.begin(), b.end());
      for (double& value : counts) value = std::max(value, 0.0);
      own.start = positive_start(own, seen_by_counting_rows(scaled_a_, weights_));
      return solve_mlem(std::vector<LinearProblem>{problem(counts)}, 0, own, execution);
    }
    case ReconstructionSolver::sart:
    case ReconstructionSolver::osem:
      return solve_in_subsets(b, std::move(own), execution);
    case ReconstructionSolver::mart:
      return solve_rows(b, std::move(own), execution);
  }
  throw UsageError("there is no such solver");
}

std::vector<double> ScaledProblem::positive_start(const SolverOptions& options,
                                                  std::span<const double> seen) const {
  // A value of 0 stays 0; one that nothing changes stays what it is: nothing, if nothing is given.
  std::vector<double> start = options.start;
  if (start.empty()) start.assign(scale_.size(), 0.0);
  const double least = options.start.empty() ? 1 : 1e-6;
  for (std::size_t j = 0; j < start.size(); ++j)
    if (scale_[j] > 0 && seen[j] > 0) start[j] = std::max(start[j], least);
  return start;
}

Solution ScaledProblem::solve_in_subsets(std::span<const double> b, SolverOptions options,
                                         const Execution& execution) const {
  const bool positive = settings_.solver == ReconstructionSolver::osem;
  std::vector<std::vector<double>> data;
  std::vector<LinearProblem> problems;
  for (const auto& subset : subsets_) {
    data.push_back(subset->own(b));
    if (positive)
      for (double& value : data.back()) value = std::max(value, 0.0);
  }
  for (std::size_t s = 0; s < subsets_.size(); ++s)
    problems.push_back({subsets_[s]->scaled.get(), data[s], subsets_[s]->weights});
  if (positive) {
    options.start = positive_start(options, seen_by_counting_rows(scaled_a_, weights_));
    return solve_mlem(problems, 0, options, execution);
  }
  const double relaxation = settings_.relaxation > 0 ? settings_.relaxation : kSartRelaxation;
  return solve_sirt(problems, relaxation, options, execution);
}

Solution ScaledProblem::solve_rows(std::span<const double> b, SolverOptions options,
                                   const Execution& execution) const {
  // Rows in units of u and in deviations: only their ratios matter. Dark rows would clear for good
  // what they see: the support has taken account of them. They count where the end is judged, since
  // those that noise has made bright, alone, are never explained.
  constexpr double kLeast = 1;
  CsrRows<float> rows;
  std::vector<double> data, seen(scale_.size(), 0.0);
  for (std::size_t i = 0; i < b.size(); ++i) {
    if (!(weights_[i] > 0)) continue;
    data.push_back(weights_[i] * b[i]);
    const auto begin = static_cast<std::size_t>(matrix_->row_starts()[i]);
    const auto end = static_cast<std::size_t>(matrix_->row_starts()[i + 1]);
    rows.counts.push_back(end - begin);
    for (std::size_t k = begin; k < end; ++k) {
      const std::int32_t column = matrix_->column_indices()[k];
      if (data.back() >= kLeast)
        seen[static_cast<std::size_t>(column)] += static_cast<double>(matrix_->values()[k]);
      rows.columns.push_back(column);
      rows.values.push_back(
          static_cast<float>(weights_[i] * static_cast<double>(matrix_->values()[k]) *
                             scale_[static_cast<std::size_t>(column)]));
    }
  }
  options.start = positive_start(options, seen);
  const double relaxation = settings_.relaxation > 0 ? settings_.relaxation : kMartRelaxation;
  return solve_mart(join_rows<float>({rows}, matrix_->columns()), data, kLeast, relaxation, options,
                    execution);
}

}  // namespace plenoflame
