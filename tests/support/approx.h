#pragma once
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>

/// Comparisons whose tolerance is in units of the value or of its last place. There is no absolute
/// one on purpose: pixel fluxes are 1e-6 W and far below, where 1e-6 would accept anything.
namespace plenoflame::test {

/// |actual - expected| <= tolerance * |expected|; NaN never passes; expected 0 needs exactly 0.
inline ::testing::AssertionResult relative(double actual, double expected, double tolerance) {
  const double error = std::fabs(actual - expected);
  if (actual == expected || error <= tolerance * std::fabs(expected))
    return ::testing::AssertionSuccess();
  return ::testing::AssertionFailure()
         << "actual " << ::testing::PrintToString(actual) << ", expected "
         << ::testing::PrintToString(expected) << ", relative error " << error / std::fabs(expected)
         << " > " << tolerance;
}

/// |actual - expected| <= tolerance * scale, where scale is the size of what cancels.
inline ::testing::AssertionResult within(double actual, double expected, double tolerance,
                                         double scale) {
  const double error = std::fabs(actual - expected);
  if (error <= tolerance * std::fabs(scale)) return ::testing::AssertionSuccess();
  return ::testing::AssertionFailure()
         << "actual " << actual << ", expected " << expected << ", error " << error << " > "
         << tolerance << " * " << std::fabs(scale);
}

/// |actual - expected| <= k * standard_error.
inline ::testing::AssertionResult within_standard_errors(double actual, double expected,
                                                         double standard_error, double k) {
  const double z = (actual - expected) / standard_error;
  if (std::fabs(z) <= k) return ::testing::AssertionSuccess();
  return ::testing::AssertionFailure() << "actual " << actual << ", expected " << expected << ", "
                                       << z << " standard errors apart (limit " << k << ")";
}

}  // namespace plenoflame::test
