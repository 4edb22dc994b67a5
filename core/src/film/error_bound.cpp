#include "film/error_bound.h"

#include <algorithm>
#include <cmath>

namespace plenoflame {
namespace {

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

double effective_pixels(double squares, double fourth, double eighth, double pixels,
                        double freedom) {
  constexpr double kMost = 1e6;  // more change bounds by less than 0.2 %
  // The ratio of unbiased estimates of (sum v)^2 and of sum v^2.
  const double estimate =
      std::clamp(squares * squares * (freedom + 2) / (freedom * fourth) - 2 / freedom, 1.0,
                 std::min(kMost, pixels));
  // Squared relative standard error of sum v^2, estimated from its terms. The same for equal pixels
  // with normal errors (moments of chi^2) is subtracted.
  const double alike = (freedom + 4) * (freedom + 6) / (freedom * (freedom + 2) * pixels);
  const double scatter = std::max(0.0, eighth / (fourth * fourth) - alike);
  const double errors = 1 + 3 / freedom;  // by trial
  return std::max(1.0, estimate / (1 + errors * std::sqrt(scatter)));
}

}  // namespace plenoflame
