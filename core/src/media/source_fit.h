#pragma once
#include <vector>

#include "plenoflame/radiometry/source_function.h"

namespace plenoflame::voxel {

/// A source function as one exponential for single precision:
///
///   S(T) = highest * (1 - c) E / (1 - c E),  E = exp(v (c_0 + c_1 v + ...)),  v = 1/T - 1/hottest
///
/// For one wavelength, with x = hc/(lambda k), E = exp(-x v) and c = exp(-x / hottest), this is
/// Planck's law. For a band, ln E is almost a straight line in v, so few terms replace the
/// quadrature over the band. Wide responses of several lobes bend more. For them another polynomial
/// follows beyond `split`:
///
///   ln E = at_split + u (d_0 + d_1 u + ...),  u = v - split
struct SourceFit {
  std::vector<double> terms;      ///< highest power first; empty: no fit of that accuracy
  std::vector<double> far_terms;  ///< highest power first; empty: one polynomial does it
  double split = 0, at_split = 0;
  double occupation = 0;  ///< c
  double highest = 0;     ///< S(hottest) [W/(m^2 sr)]
  double hottest = 0;     ///< [K]
  double coldest = 0;     ///< [K] where S leaves the range of single precision, or the lowest
                          ///< requested temperature
  /// v at the coldest [1/K].
  double last() const { return (hottest - coldest) / (coldest * hottest); }
};

/// @param coldest, hottest [K] range of temperatures; 0 <= coldest <= hottest
/// @param tolerance largest error of ln S, relative to 1 + ln(S(hottest) / S): where S has fallen
///        far, rounding the exponent to single precision costs as much
/// @param most_terms of one polynomial @param most_of_two of each of two, when one does not do it
SourceFit fit_source(const SourceFunction& source, double coldest, double hottest, double tolerance,
                     int most_terms, int most_of_two);

/// Used without such a fit: the fewest nodes whose sum is as accurate. They come from the Gauss
/// rule of the source's own nodes under Planck's function at `hottest`.
/// @param tolerance relative, from `coldest` on
std::vector<SourceFunction::Node> fewer_nodes(const SourceFunction& source, double coldest,
                                              double hottest, double tolerance);

}  // namespace plenoflame::voxel
