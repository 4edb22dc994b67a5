#include "plenoflame/sampling/noise.h"

#include <cmath>

#include "plenoflame/base/constants.h"
#include "plenoflame/sampling/philox.h"

namespace plenoflame {
namespace {

/// ln k!, without the global that std::lgamma writes to. Stirling's series from k = 10 on: its
/// first term left out is below 1e-10.
double log_factorial(double k) {
  if (k < 10) {
    double product = 1;
    for (double i = 2; i <= k; ++i) product *= i;
    return std::log(product);
  }
  const double inverse = 1 / k, square = inverse * inverse;
  return (k + 0.5) * std::log(k) - k + 0.5 * std::log(2 * constants::pi) +
         inverse * (1.0 / 12 - square * (1.0 / 360 - square / 1260));
}

}  // namespace

double NoiseStream::uniform() {
  if (left_ == 0) {
    const auto block = philox(key_, number_, block_++);
    for (std::size_t i = 0; i < 4; ++i) words_[i] = block[i];
    left_ = 2;
  }
  --left_;
  return unit_uniform(words_[2 * left_], words_[2 * left_ + 1]);
}

double NoiseStream::gaussian() {
  const double radius = std::sqrt(-2 * std::log(uniform()));
  return radius * std::cos(2 * constants::pi * uniform());
}

double NoiseStream::poisson(double mean) {
  if (!(mean > 0)) return 0;
  if (mean < 30) {
    double rest = uniform(), probability = std::exp(-mean), k = 0;
    while (rest > probability && probability > 0) {
      rest -= probability;
      k += 1;
      probability *= mean / k;
    }
    return k;
  }
  const double root = std::sqrt(mean), log_mean = std::log(mean);
  const double b = 0.931 + 2.53 * root, a = -0.059 + 0.02483 * b;
  const double inverse_alpha = 1.1239 + 1.1328 / (b - 3.4), v_r = 0.9277 - 3.6224 / (b - 2);
  for (;;) {
    const double u = uniform() - 0.5, v = uniform();
    const double us = 0.5 - std::fabs(u);
    const double k = std::floor((2 * a / us + b) * u + mean + 0.43);
    if (us >= 0.07 && v <= v_r) return k;
    if (k < 0 || (us < 0.013 && v > us)) continue;
    if (std::log(v * inverse_alpha / (a / (us * us) + b)) <= k * log_mean - mean - log_factorial(k))
      return k;
  }
}

}  // namespace plenoflame
