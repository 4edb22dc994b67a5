#pragma once

namespace plenoflame {

/// The value below which a share `probability` of Fisher's F distribution lies, the ratio of two
/// mean squares with `numerator` and `denominator` degrees of freedom (> 0, need not be whole).
/// Relative error below 1e-10. @param probability in (0, 1)
double f_quantile(double probability, double numerator, double denominator);

/// Probability that a number of Student's t distribution with `freedom` degrees of freedom (> 0,
/// need not be whole) is at least |t| in magnitude. Relative error below 1e-10.
double student_tail(double t, double freedom);

/// As many pixels of equal variance would tell as much about the sum of their variances as these
/// do (Satterthwaite, Biometrics Bull. 2 (1946) 110), from 1 to as many as there are. Where a few
/// of them make most of the sum, it is fewer than the estimate from their variances: that is
/// largest just when these few came out too small, which is when the sum itself is. By how many
/// standard errors of the sum of squared variances was found by trial (docs/theory/errors.md).
/// @param squares, fourth, eighth sums of estimated variances, of their squares, of those' squares
/// @param freedom degrees of freedom that each variance was estimated with: the expectation of its
/// square is (freedom + 2) / freedom times that of the variance, squared
double effective_pixels(double squares, double fourth, double eighth, double pixels,
                        double freedom);

}  // namespace plenoflame
