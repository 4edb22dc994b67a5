#pragma once

namespace plenoflame {

/// Quantile of Fisher's F distribution: a share `probability` lies below it. F is the ratio of two
/// mean squares with `numerator` and `denominator` degrees of freedom (> 0, need not be integers).
/// Relative error below 1e-10. @param probability in (0, 1)
double f_quantile(double probability, double numerator, double denominator);

/// Probability that a number of Student's t distribution with `freedom` degrees of freedom (> 0,
/// need not be whole) is at least |t| in magnitude. Relative error below 1e-10.
double student_tail(double t, double freedom);

/// Effective number of pixels, from 1 to `pixels`. This number of pixels of equal variance
/// determines the sum of variances equally well (Satterthwaite, Biometrics Bull. 2 (1946) 110). If
/// a few pixels make most of the sum, the result is lower than the plain estimate. The plain
/// estimate is largest when the variances of these few came out too small, and then the sum is too
/// small as well. The reduction, in standard errors of the sum of squared variances, was found
/// empirically (docs/theory/errors.md).
/// @param squares, fourth, eighth sums of the estimated variances, of their squares, and of their
///        fourth powers
/// @param freedom degrees of freedom of each estimated variance: the expectation of its square is
///        (freedom + 2) / freedom times the squared variance
double effective_pixels(double squares, double fourth, double eighth, double pixels,
                        double freedom);

}  // namespace plenoflame
