#pragma once
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "plenoflame/inverse/linear_operator.h"
#include "plenoflame/inverse/reconstruction.h"
#include "plenoflame/inverse/solvers.h"
#include "plenoflame/inverse/strength.h"

namespace plenoflame {

/// Range of the tested strengths.
inline constexpr StrengthRange kLinearRange{1e-10, 1, 11, 2, 200};

/// The penalty of a reconstruction on one value per unknown.
struct ChosenPenalty {
  std::unique_ptr<LinearOperator> l;  ///< nullptr: none
  double reference = 0;               ///< reference_penalty()
};

/// @param mask unknowns of which it is 0 have no part in the penalty @param empty_outside where
/// none takes part the field is 0
ChosenPenalty make_penalty_of(const ReconstructionSettings& settings, const Unknowns& unknowns,
                              std::vector<char> mask, bool empty_outside);

/// A diag(scale): the unknowns in their own units. Unknowns with scale 0 have no effect.
class ScaledColumns final : public LinearOperator {
 public:
  ScaledColumns(const LinearOperator& a, std::vector<double> scale);
  std::size_t rows() const override { return a_.rows(); }
  std::size_t columns() const override { return a_.columns(); }
  void apply(std::span<const double> x, std::span<double> y) const override;
  void apply_transpose(std::span<const double> y, std::span<double> x) const override;
  void apply_together(std::span<const double> x, std::span<double> y) const override;
  void apply_transpose_together(std::span<const double> y, std::span<double> x) const override;
  const LinearOperator& unscaled() const { return a_; }

 private:
  const LinearOperator& a_;
  std::vector<double> scale_;
};

/// W (A x - b) small, x = diag(scale) u, with any of the solvers.
class ScaledProblem {
 public:
  /// @param matrix A, where it is stored; else nullptr  @param a A as an operator
  /// @param weights 1 / deviation of the rows; 0 leaves a row out
  /// @throws InputError for a solver that wants the stored matrix
  ScaledProblem(const CsrMatrix<float>* matrix, const LinearOperator& a,
                std::vector<double> weights, std::vector<double> scale, const Unknowns& unknowns,
                const ReconstructionSettings& settings);
  ~ScaledProblem();

  /// In units of u. @param strength relative  @param start in x's units; empty: none
  Solution solve(std::span<const double> b, double strength, const std::vector<double>& start,
                 const SolverOptions& options, const Execution& execution) const;
  /// Least squares without bounds, with negative values cut off: a start, in x's units.
  std::vector<double> without_bounds(std::span<const double> b, double strength,
                                     const Execution& execution) const;
  /// By cross-validation. Values of the solution are not negative.
  StrengthChoice choose(std::span<const double> b, const StrengthRange& range,
                        const SolverOptions& options, const Execution& execution) const;

  /// The quadratic problem and its penalty in u, for uncertainties.
  LinearProblem problem(std::span<const double> b) const { return {&scaled_a_, b, weights_}; }
  Regularisation regularisation(double strength) const;
  /// The same penalty on u in place of x: a prior of ratios to the scale.
  Regularisation penalty_of_ratios(double strength) const {
    return {penalty_.l.get(), strength, {}};
  }
  void set_prior(std::span<const double> prior);
  /// A, of the unknowns in their own units, without weights.
  const LinearOperator& unscaled() const { return scaled_a_.unscaled(); }

  std::vector<double> samples(std::span<const double> u) const;
  std::vector<double> scaled(std::span<const double> x) const;
  std::span<const double> weights() const { return weights_; }
  bool has_penalty() const { return penalty_.l != nullptr; }
  /// Rows below 0 that count as 0.
  std::size_t clipped(std::span<const double> b) const;

 private:
  struct Subset;
  Solution solve_absolute(std::span<const double> b, double strength,
                          const std::vector<double>& start, const SolverOptions& options,
                          const Execution& execution) const;
  Solution solve_by_solver(const LinearProblem& whole, const Regularisation& penalty,
                           SolverOptions own, const Execution& execution) const;
  /// Negative values, which least squares may have.
  void cut_off(std::span<const double> b, Solution& solution) const;
  Solution solve_in_subsets(std::span<const double> b, SolverOptions options,
                            const Execution& execution) const;
  Solution solve_rows(std::span<const double> b, SolverOptions options,
                      const Execution& execution) const;
  /// @param seen what the rows that count see of each unknown
  std::vector<double> positive_start(const SolverOptions& options,
                                     std::span<const double> seen) const;

  const CsrMatrix<float>* matrix_;
  std::vector<double> weights_, scale_, prior_;
  const ReconstructionSettings& settings_;
  ScaledColumns scaled_a_;
  ChosenPenalty penalty_;
  std::unique_ptr<LinearOperator> scaled_penalty_;
  double unit_ = 0;
  /// Length of A^T W n for noise n of one deviation in each row: gradients that are much shorter
  /// are an end.
  double noise_gradient_ = 0;
  std::vector<std::unique_ptr<Subset>> subsets_;
};

}  // namespace plenoflame
