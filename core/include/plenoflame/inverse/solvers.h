#pragma once
#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "plenoflame/base/execution.h"
#include "plenoflame/inverse/csr_matrix.h"
#include "plenoflame/inverse/linear_operator.h"

namespace plenoflame {

/// Data and model of b = A x + noise. Spans and operators are kept by reference.
struct LinearProblem {
  const LinearOperator* a = nullptr;
  std::span<const double> b;
  /// 1 / standard deviation of each entry of b; 0 leaves it out (saturated, dead); empty: all 1.
  std::span<const double> weights = {};
};

/// Adds strength * |L (x - prior)|^2 to the misfit |W (A x - b)|^2.
struct Regularisation {
  const LinearOperator* penalty = nullptr;  ///< L; nullptr: none
  double strength = 0;                      ///< absolute: a relative one times penalty_unit()
  std::span<const double> prior = {};       ///< empty: 0
};

enum class StopReason {
  iterations,   ///< all that were allowed
  discrepancy,  ///< the misfit is as small as the noise lets expect
  change,       ///< the solution changes by less than the limit
  converged,    ///< the gradient is zero up to rounding
  stopped,      ///< Execution::stop
};
std::string name_of(StopReason reason);

/// Criteria for the end of a solver, and its reports.
struct SolverOptions {
  int iterations = 100;
  /// Stop when an iteration changes x by less than this, relative to x; 0: never.
  double relative_change = 1e-4;
  /// Stop when |W (A x - b)|^2 is at most this; 0: never. Its expectation for pure noise is the
  /// number of rows with a weight.
  double misfit = 0;
  /// Stop of cgls, lsqr and nnls when half of the objective's gradient is no longer than this; 0:
  /// never. noise_gradient() gives a suitable value. The change of x is a worse criterion, because
  /// it is also small with short steps: after a start, or with a strong penalty.
  double gradient = 0;
  std::vector<double> start = {};  ///< empty: 0, or 1 for solvers that multiply
  /// Called after each iteration, with x.
  std::function<void(int iteration, double misfit, std::span<const double> x)> watch = {};
  /// Receives x and history after each complete iteration, because an operator may throw Cancelled
  /// within the next one. May be nullptr.
  struct Solution* kept = nullptr;
};

/// The result of an iteration.
struct SolverStep {
  int iteration = 0;
  double misfit = 0;   ///< |W (A x - b)|^2
  double penalty = 0;  ///< |L (x - prior)|^2, without its strength
  double change = 0;   ///< |x - x before| / |x|
};

/// A solution with its history. A further solution may start from `x`.
struct Solution {
  std::vector<double> x;
  std::vector<SolverStep> history;
  StopReason reason = StopReason::iterations;
  double misfit() const { return history.empty() ? 0 : history.back().misfit; }
};

/// All solvers throw UsageError for sizes that do not fit and options out of range. They throw
/// InputError for data that are no numbers. After a stop of the execution they return the latest
/// solution.

/// Conjugate gradients on the normal equations without forming them (Hestenes and Stiefel 1952;
/// Bjorck 1996, 7.4). x may become negative.
Solution solve_cgls(const LinearProblem& problem, const Regularisation& regularisation,
                    const SolverOptions& options, const Execution& execution = {});

/// The same minimum by Golub-Kahan bidiagonalisation (Paige and Saunders 1982), better where the
/// problem is ill conditioned. The penalty acts on the solution, not on the step from the start.
Solution solve_lsqr(const LinearProblem& problem, const Regularisation& regularisation,
                    const SolverOptions& options, const Execution& execution = {});

/// x >= 0 by accelerated projected gradients (Beck and Teboulle 2009) that begin anew when they
/// overshoot (O'Donoghue and Candes 2015).
Solution solve_nnls(const LinearProblem& problem, const Regularisation& regularisation,
                    const SolverOptions& options, const Execution& execution = {});

/// x >= 0 exactly, by active sets (Lawson and Hanson 1974) with dense matrices: for some hundred
/// unknowns. @throws UsageError above kMostActiveSet unknowns
inline constexpr std::size_t kMostActiveSet = 2000;
Solution solve_nnls_active_set(const LinearProblem& problem, const Regularisation& regularisation,
                               const Execution& execution = {});

/// Simultaneous iterative reconstruction: x += C A^T R (b - A x), C and R the inverse sums of
/// columns and rows (Gilbert 1972), clipped at 0. A may not have negative entries.
/// @param subsets with more than one it is SART in ordered subsets (Andersen and Kak 1984); an
///        iteration goes through all of them. Give all of the same columns
/// @param relaxation 0 to 2
Solution solve_sirt(std::span<const LinearProblem> subsets, double relaxation,
                    const SolverOptions& options, const Execution& execution = {});

/// Expectation maximisation for Poisson data: x *= A^T (b / (A x + background)) / A^T 1 (Shepp and
/// Vardi 1982); over several subsets: OSEM (Hudson and Larkin 1994), whose subsets should
/// see every unknown alike, or it ends in a cycle near the solution. Weights only leave rows out.
/// @param background the same in every row, at least 0
/// @throws InputError for negative data
Solution solve_mlem(std::span<const LinearProblem> subsets, double background,
                    const SolverOptions& options, const Execution& execution = {});

/// Multiplicative algebraic reconstruction (Gordon, Bender and Herman 1970), row after row: x_j *=
/// (b_i / a_i x)^(mu a_ij / max a_i). A row with b_i = 0 sets its unknowns to 0 for good.
/// @param least rows with less change nothing, but count in the misfit; at least 0
/// @param relaxation mu, 0 to 1 @throws InputError for a negative entry
Solution solve_mart(const CsrMatrix<float>& matrix, std::span<const double> b, double least,
                    double relaxation, const SolverOptions& options,
                    const Execution& execution = {});

}  // namespace plenoflame
