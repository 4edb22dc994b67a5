#pragma once
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

namespace plenoflame::test {

/// One case of the stress suite: collects the worst error, holds it against a bound and prints the
/// line from which tests/stress/write_numerics.py makes docs/numerics.md:
///   stress | area | case | reference | worst error | bound | at
class StressCase {
 public:
  StressCase(std::string area, std::string what, std::string reference, double bound)
      : area_(std::move(area)),
        what_(std::move(what)),
        reference_(std::move(reference)),
        bound_(bound) {}
  StressCase(const StressCase&) = delete;
  StressCase& operator=(const StressCase&) = delete;

  /// NaN counts as infinitely wrong.
  void add(double error, const std::string& where) {
    const double size = std::isnan(error) ? HUGE_VAL : std::fabs(error);
    ++count_;
    if (size <= worst_) return;
    worst_ = size;
    where_ = where;
  }

  ~StressCase() {
    std::printf("stress | %s | %s | %s | %.2g | %.2g | %s\n", area_.c_str(), what_.c_str(),
                reference_.c_str(), worst_, bound_, where_.empty() ? "-" : where_.c_str());
    EXPECT_GT(count_, 0) << what_;
    EXPECT_LE(worst_, bound_) << area_ << ": " << what_ << ", at " << where_;
  }

 private:
  std::string area_, what_, reference_, where_;
  double bound_, worst_ = 0;
  long count_ = 0;
};

/// Short text of a number, for "where".
inline std::string text(const char* label, double value) {
  char buffer[64];
  std::snprintf(buffer, sizeof buffer, "%s %.4g", label, value);
  return buffer;
}

}  // namespace plenoflame::test
