#include "film/error_bound.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "film/lit_runs.h"
#include "plenoflame/film/film.h"

namespace plenoflame {
namespace {

constexpr double kMostFreedom = 1e6;  ///< more change the bound by less than 0.2 %

/// Continued fraction of the incomplete beta function, by Lentz' method (DLMF 8.17.22).
double beta_fraction(double a, double b, double x) {
  constexpr double kTiny = 1e-300;
  const auto away_from_zero = [](double v) { return std::fabs(v) < kTiny ? kTiny : v; };
  double c = 1, d = 1 / away_from_zero(1 - (a + b) * x / (a + 1)), value = d;
  // Converges in some sqrt(max(a, b)) steps.
  const int most = 200 + static_cast<int>(8 * std::sqrt(std::max(a, b)));
  for (int m = 1; m <= most; ++m) {
    const double even = m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m));
    d = 1 / away_from_zero(1 + even * d);
    c = away_from_zero(1 + even / c);
    value *= c * d;
    const double odd = -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1));
    d = 1 / away_from_zero(1 + odd * d);
    c = away_from_zero(1 + odd / c);
    value *= c * d;
    if (std::fabs(c * d - 1) < 1e-15) break;
  }
  return value;
}

/// Regularised incomplete beta function I_x(a, b); y = 1 - x, given for its digits.
double regularised_beta(double a, double b, double x, double y) {
  const double front = std::exp(std::lgamma(a + b) - std::lgamma(a) - std::lgamma(b) +
                                a * std::log(x) + b * std::log(y));
  if (x < (a + 1) / (a + b + 2)) return front * beta_fraction(a, b, x) / a;
  return 1 - front * beta_fraction(b, a, y) / b;
}

}  // namespace

double f_quantile(double probability, double numerator, double denominator) {
  // P(F < f) = I_x(n/2, d/2), x = n f / (n f + d). By bisection of log f.
  const auto below = [&](double f) {
    const double sum = numerator * f + denominator;
    return regularised_beta(0.5 * numerator, 0.5 * denominator, numerator * f / sum,
                            denominator / sum);
  };
  double low = -700, high = 700;
  for (int i = 0; i < 200 && high - low > 1e-13 * std::fabs(high); ++i) {
    const double middle = 0.5 * (low + high);
    (below(std::exp(middle)) < probability ? low : high) = middle;
  }
  return std::exp(0.5 * (low + high));
}

double student_tail(double t, double freedom) {
  // I_x(n/2, 1/2), x = n / (n + t^2) (Abramowitz and Stegun 26.7.1 with 26.5.27).
  const double t2 = t * t, sum = freedom + t2;
  if (!(t2 > 0)) return 1;
  return regularised_beta(0.5 * freedom, 0.5, freedom / sum, t2 / sum);
}

StatedError stated_error(const Image& flux, const Image& standard_error, int replicates) {
  StatedError stated;
  if (flux.empty()) return stated;
  if (standard_error.empty() || replicates < 2) {
    stated.bound = std::numeric_limits<double>::infinity();
    return stated;
  }
  const double limit = kLitShare * static_cast<double>(largest_of(flux.pixels));
  double squares = 0, fourth = 0, total = 0, lit = 0, lit_at_most = 0;
  // Where there is no flux there is no scatter.
  for_lit_runs(flux.pixels, [&](std::size_t first, std::size_t end) {
    for (std::size_t i = first; i < end; ++i) {
      const double f = static_cast<double>(flux.pixels[i]);
      const double e = static_cast<double>(standard_error.pixels[i]);
      if (f + 2 * e > limit) lit_at_most += 1;
      if (!(f > limit)) continue;
      const double e2 = e * e;
      squares += e2;
      fourth += e2 * e2;
      total += f;
      lit += 1;
    }
  });
  if (!(lit > 0)) return stated;
  stated.relative_rmse = std::sqrt(squares * lit) / total;
  if (!(squares > 0)) return stated;
  // For normal errors of variances v_i the sums of (image - truth)^2 and of the squared standard
  // errors are both like v times chi^2 / n with n = (sum v)^2 / sum v^2 and n (R - 1) degrees of
  // freedom (Welch-Satterthwaite); the expectation of e^4 is v^2 (R + 1)/(R - 1). There are no more
  // than there are pixels, which an estimate from few pixels may say.
  const double r = replicates;
  const double freedom = std::clamp(squares * squares * (r + 1) / ((r - 1) * fourth), 1.0,
                                    std::min(kMostFreedom, lit));
  stated.bound =
      std::sqrt(squares * lit_at_most * f_quantile(kErrorConfidence, freedom, freedom * (r - 1))) /
      total;
  return stated;
}

}  // namespace plenoflame
