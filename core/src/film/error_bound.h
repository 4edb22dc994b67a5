#pragma once

namespace plenoflame {

/// The value below which a share `probability` of Fisher's F distribution lies, the ratio of two
/// mean squares with `numerator` and `denominator` degrees of freedom (> 0, need not be whole).
/// Relative error below 1e-10. @param probability in (0, 1)
double f_quantile(double probability, double numerator, double denominator);

/// Probability that a number of Student's t distribution with `freedom` degrees of freedom (> 0,
/// need not be whole) is at least |t| in magnitude. Relative error below 1e-10.
double student_tail(double t, double freedom);

}  // namespace plenoflame
