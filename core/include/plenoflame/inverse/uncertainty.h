#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "plenoflame/inverse/solvers.h"

/// The worth of a regularised solution: how much of it comes from the data, and how uncertain it
/// is. All of it holds for the linear problem without the constraint x >= 0. The bias of the
/// penalty is not in the deviation: it is what the resolution tells.
namespace plenoflame {

/// With N = A^T W^2 A + strength L^T L.
struct Uncertainty {
  /// Diagonal of the resolution matrix N^-1 A^T W^2 A: 1 where the data alone decide, 0 where they
  /// say nothing.
  std::vector<double> resolved;
  /// Standard deviation from the noise of the data: square root of the diagonal of N^-1 A^T W^2 A
  /// N^-1.
  std::vector<double> deviation;
  double resolved_unknowns = 0;  ///< trace of the resolution matrix
};

/// The solutions of estimate_uncertainty(): how far they go, and which there are.
struct ProbeAccuracy {
  int iterations = 2000;
  double relative_change = 1e-9;
  bool deviations = true;  ///< false: the resolution alone, in half the time
};

/// By random signs (Hutchinson 1990; diagonals: Bekas, Kokiopoulou and Saad 2007), each with two
/// solutions by conjugate gradients. Relative errors of a diagonal fall as 1/sqrt(probes).
/// @param probes at least 1
/// @param moved called with what noise of one deviation moves the unknowns by, once for each probe
/// with deviations: for functions of several unknowns, which err together
Uncertainty estimate_uncertainty(const LinearProblem& problem, const Regularisation& regularisation,
                                 int probes, std::uint64_t seed, const Execution& execution = {},
                                 const ProbeAccuracy& accuracy = {},
                                 const std::function<void(std::span<const double>)>& moved = {});

/// The same exactly, by dense algebra. @throws UsageError above kMostDense unknowns
inline constexpr std::size_t kMostDense = 4000;
Uncertainty exact_uncertainty(const LinearProblem& problem, const Regularisation& regularisation);

/// A column of the resolution matrix: what a 1 at this unknown becomes.
std::vector<double> point_spread(const LinearProblem& problem, const Regularisation& regularisation,
                                 std::size_t unknown, const Execution& execution = {},
                                 const ProbeAccuracy& accuracy = {});

/// Full widths at half of the value at an unknown along each axis of a lattice [its unit of
/// spacing], with straight lines between samples. Infinite where it is above half up to the
/// lattice's end; 0 along axes of one sample.
std::array<double, 3> half_widths(std::span<const double> values, const std::array<int, 3>& shape,
                                  const std::array<double, 3>& spacing, std::size_t unknown);

/// Mean and standard deviation of what solver makes of data with new noise: parametric bootstrap
/// (Efron and Tibshirani 1993), for any solver. Data are model + noise / weight.
/// @param model A x of the solution
struct Bootstrap {
  std::vector<double> mean, deviation;
};
Bootstrap bootstrap(std::span<const double> model, std::span<const double> weights, int draws,
                    std::uint64_t seed,
                    const std::function<std::vector<double>(std::span<const double> b)>& solve,
                    const Execution& execution = {});

}  // namespace plenoflame
