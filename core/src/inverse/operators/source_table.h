#pragma once
#include <vector>

#include "plenoflame/radiometry/source_function.h"

namespace plenoflame {

/// S(T) and dS/dT by cubic Hermite interpolation of ln S, for walks that need them at every node of
/// every ray. Between 200 K and 6000 K its relative error is h^4 / 384 times the fourth derivative
/// of ln S. That derivative is at most 24 x / T^4 with x = c2 / (lambda T), so the error with h = 1
/// K is below 1e-9 x / 50. Outside, and for a source that is 0 somewhere, the function itself is
/// used.
class SourceTable {
 public:
  explicit SourceTable(const SourceFunction& source);

  struct Value {
    double source = 0;  ///< [W/(m^2 sr)]
    double slope = 0;   ///< [W/(m^2 sr K)]
  };
  Value at(double temperature) const;

 private:
  struct Knot {
    double logarithm = 0, slope = 0;  ///< ln S and d ln S / dT
  };
  SourceFunction source_;
  std::vector<Knot> knots_;
};

}  // namespace plenoflame
