#include "plenoflame/inverse/posterior_chain.h"

#include <cmath>
#include <random>
#include <utility>

namespace plenoflame {
namespace {

/// Share of a step that is new.
constexpr double kNew = 0.7;

std::vector<double> step_from(std::span<const double> from, std::span<const double> draw) {
  const double kept = std::sqrt(1 - kNew * kNew);
  std::vector<double> to(from.size());
  for (std::size_t j = 0; j < to.size(); ++j) to[j] = kept * from[j] + kNew * draw[j];
  return to;
}

void add_squares(std::span<const double> values, std::vector<double>& squares) {
  for (std::size_t j = 0; j < squares.size(); ++j) squares[j] += values[j] * values[j];
}

}  // namespace

PosteriorChain run_posterior_chain(const std::vector<std::vector<double>>& draws,
                                   const std::function<double(std::span<const double>)>& excess,
                                   std::span<const double> weights, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::vector<double> at = draws.front(), gaussian = at;
  std::vector<double> squares(at.size(), 0.0), of_gaussian(at.size(), 0.0);
  double own = excess(at);
  std::size_t taken = 0;
  for (std::size_t k = 1; k < draws.size(); ++k) {
    gaussian = step_from(gaussian, draws[k]);
    std::vector<double> next = step_from(at, draws[k]);
    const double other = excess(next);
    // Always drawn, so that the numbers do not depend on what was taken.
    if (std::log(uniform(random)) < own - other || !std::isfinite(own)) {
      at = std::move(next);
      own = other;
      ++taken;
    }
    add_squares(at, squares);
    add_squares(gaussian, of_gaussian);
  }
  double sum = 0, all = 0;
  for (std::size_t j = 0; j < squares.size(); ++j) {
    if (!(of_gaussian[j] > 0)) continue;
    sum += weights[j] * squares[j] / of_gaussian[j];
    all += weights[j];
  }
  PosteriorChain chain;
  if (all > 0) chain.width = std::sqrt(sum / all);
  chain.accepted = static_cast<double>(taken) / static_cast<double>(draws.size() - 1);
  return chain;
}

}  // namespace plenoflame
