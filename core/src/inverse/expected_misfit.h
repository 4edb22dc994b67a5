#pragma once
#include <algorithm>
#include <cmath>

namespace plenoflame {

/// The misfit that noise leaves: two standard deviations of chi^2 itself more than the number of
/// rows, without which chance may ask for next to no penalty.
inline double expected_misfit(double rows) {
  return rows * (1 + 2 * std::sqrt(2 / rows));
}

/// True if noise explains a misfit: within five standard deviations of chi^2, or 5 %, which a
/// search for the strength may leave.
inline bool explained_by_noise(double misfit, double rows) {
  return misfit <= rows * (1 + std::max(5 * std::sqrt(2 / rows), 0.05));
}

}  // namespace plenoflame
