#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "plenoflame/inverse/solvers.h"

/// Resolution and uncertainty of a regularised solution: the share of the data in it, and its
/// standard deviations. The penalty is a Gaussian prior with the inverse covariance strength L^T L.
/// The posterior has the covariance N^-1 with N = A^T W^2 A + strength L^T L. Its deviations
/// include the bias of the penalty, as far as the prior is right. Bounds of the solution are
/// ignored.
namespace plenoflame {

/// Resolution and deviations by linear algebra.
struct Uncertainty {
  /// Diagonal of the resolution matrix N^-1 A^T W^2 A. 1 where the data alone determine the
  /// unknown, 0 where they contain no information about it.
  std::vector<double> resolved;
  /// Standard deviation: square root of the diagonal of N^-1.
  std::vector<double> deviation;
  double resolved_unknowns = 0;  ///< trace of the resolution matrix
};

/// Limits of the iterations.
struct ProbeAccuracy {
  int iterations = 2000;
  double relative_change = 1e-9;
};

/// Random draws, at least one, and the seed of their random numbers.
struct Draws {
  int count;
  std::uint64_t seed;
};

/// Resolution by random signs (Hutchinson 1990; diagonals: Bekas, Kokiopoulou and Saad 2007), each
/// with a solution by conjugate gradients. Relative errors of a diagonal fall as 1/sqrt(probes).
/// @return without deviations
Uncertainty estimate_resolution(const LinearProblem& problem, const Regularisation& regularisation,
                                const Draws& probes, const Execution& execution = {},
                                const ProbeAccuracy& accuracy = {});

/// Draws of the posterior about its mean, by perturbing data and prior (Papandreou and Yuille
/// 2010). A draw is the solution, from 0, for data and a prior that are noise. With 30 draws a
/// deviation is known to 13 %.
/// @param use called with each of them
void draw_posterior(const LinearProblem& problem, const Regularisation& regularisation,
                    const Draws& draws, const std::function<void(std::span<const double>)>& use,
                    const Execution& execution = {}, const ProbeAccuracy& accuracy = {});

/// Draws of the prior about its mean, of a penalty that determines every unknown.
void draw_prior(const Regularisation& regularisation, const Draws& draws,
                const std::function<void(std::span<const double>)>& use,
                const Execution& execution = {}, const ProbeAccuracy& accuracy = {});

/// Resolution and deviations exactly, by dense algebra. @throws UsageError above kMostDense
/// unknowns
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

}  // namespace plenoflame
