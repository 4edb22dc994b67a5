#pragma once
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace plenoflame {

/// The difference between a posterior and its Gaussian approximation.
struct PosteriorChain {
  double width = 1;     ///< RMS distance from the mode over the Gaussian's, on average
  double accepted = 1;  ///< share of accepted steps
};

/// A Markov chain by the preconditioned Crank-Nicolson proposal about the Gaussian's mode (Cotter,
/// Roberts, Stuart and White 2013). A second chain with the same random numbers accepts every step
/// and measures the Gaussian's width. Without an excess the ratio of widths is therefore exactly 1.
/// @param draws of the Gaussian, about 0, at least 2; each is one step
/// @param excess of a displacement from the mode: minus the logarithm of the posterior's density
///        over the Gaussian's, up to a constant. Infinite where there is no density
/// @param weights of the entries in the mean
PosteriorChain run_posterior_chain(const std::vector<std::vector<double>>& draws,
                                   const std::function<double(std::span<const double>)>& excess,
                                   std::span<const double> weights, std::uint64_t seed);

}  // namespace plenoflame
