#pragma once
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace plenoflame {

/// How a posterior differs from the Gaussian that was taken for it.
struct PosteriorChain {
  double width = 1;     ///< RMS distance from the mode over that of the Gaussian, in the mean
  double accepted = 1;  ///< share of steps that were taken
};

/// A Markov chain by the preconditioned Crank-Nicolson proposal about the Gaussian's mode (Cotter,
/// Roberts, Stuart and White 2013). Beside it a chain that takes every step tells the Gaussian's
/// width by the same random numbers: without an excess the ratio is exactly 1.
/// @param draws of the Gaussian, about 0, at least 2; each is one step
/// @param excess of a displacement from the mode. It is minus the logarithm of the posterior's
/// density over the Gaussian's, up to a constant; infinite where there is no density
/// @param weights of the entries in the mean
PosteriorChain run_posterior_chain(const std::vector<std::vector<double>>& draws,
                                   const std::function<double(std::span<const double>)>& excess,
                                   std::span<const double> weights, std::uint64_t seed);

}  // namespace plenoflame
