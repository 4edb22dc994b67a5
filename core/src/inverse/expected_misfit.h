#pragma once
#include <algorithm>
#include <cmath>

namespace plenoflame {

/// The misfit that noise explains: the number of rows plus two standard deviations of chi^2.
/// Without this margin, chance may lead to almost no penalty.
inline double expected_misfit(double rows) {
  return rows * (1 + 2 * std::sqrt(2 / rows));
}

/// Noise explains a misfit that is larger than the number of rows by this share: five standard
/// deviations of chi^2, or 5 %.
inline double margin_of_noise(double rows) {
  return std::max(5 * std::sqrt(2 / rows), 0.05);
}
inline bool explained_by_noise(double misfit, double rows) {
  return misfit <= rows * (1 + margin_of_noise(rows));
}

/// Independent errors among the rows: at most five for each unknown. Errors of a lattice are shared
/// by the rows that see them, and have as many degrees of freedom as it has. Experiments chose 5.
inline double independent_errors(double rows, double unknowns) {
  return std::min(rows, 5 * unknowns);
}

/// chi^2 for each row that the unknowns do not determine; at least 1.
/// @param misfit of all rows @param resolved trace of the resolution matrix
inline double free_chi_squared(double misfit, double rows, double resolved) {
  return std::max(1.0, misfit / std::max(0.5 * rows, rows - std::max(0.0, resolved)));
}

/// Factor of posterior deviations. Noise is independent in each row. The rest of the misfit is an
/// error of the lattice, which groups of rows share: their mean errs as one.
inline double deviation_factor(double free_chi_squared, double rows, double unknowns) {
  return std::sqrt(1 + (free_chi_squared - 1) * rows / independent_errors(rows, unknowns));
}

}  // namespace plenoflame
