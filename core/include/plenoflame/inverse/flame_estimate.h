#pragma once
#include <span>
#include <vector>

#include "plenoflame/inverse/reconstruction.h"
#include "plenoflame/media/medium.h"
#include "plenoflame/radiometry/source_function.h"

namespace plenoflame {

/// The flame as a reconstruction finds it, one entry for each unknown; deviations are empty
/// without those of the reconstruction. They include the error of a known absorption.
struct FlameEstimate {
  std::vector<double> emission, emission_deviation;        ///< [W/(m^3 sr)]
  std::vector<double> temperature, temperature_deviation;  ///< [K]; 0: none. Empty: not known
  std::vector<char> decided;  ///< 0: the temperature is that of its neighbours; empty: not known
  std::vector<double> absorption, absorption_deviation;  ///< [1/m]; empty: not known
};

/// [K] Of the surroundings: what shines is hotter, and a colder temperature is none.
inline constexpr double kAmbient = 293.15;

/// Temperatures follow from the source function where it is above `threshold` times its largest
/// value and above that of the surroundings. Darker unknowns have no temperature. Beside hot ones
/// they get the mean temperature of their neighbours, weighted by light, and so little absorption
/// that their emission is unchanged. This matters because the renderer interpolates temperatures:
/// cold samples beside hot ones would darken the cells between.
FlameEstimate estimate_flame(const Reconstruction& reconstruction, const Unknowns& unknowns,
                             const std::vector<double>& absorption, const SourceFunction& source,
                             double threshold = 1e-4);

/// [K] The deviation of a temperature [K] whose source function errs by `deviation`. If this is
/// more than the source function itself, the slope tells nothing: the brighter end of the interval
/// does.
double temperature_deviation(double temperature, double deviation, const SourceFunction& source);

/// [1/m] The deviation of an absorption [1/m] whose logarithm errs by `deviation`: half of its 95 %
/// interval, in units of that of a normal variable.
double absorption_deviation(double absorption, double deviation);

/// Adds an independent part to the deviations of emission and temperature.
/// @param moved [W/(m^2 sr)] standard deviations of the source function, of each unknown
void add_deviation(std::span<const double> moved, const SourceFunction& source,
                   FlameEstimate& estimate);

/// The differences of an estimate from the truth.
struct EstimateErrors {
  double emission = 0;       ///< |j - j*| / |j*|, weighted by volume
  double temperature = 0;    ///< mean |T - T*| / T*, weighted by true emission
  double absorption = 0;     ///< the same of the absorption
  double largest_truth = 0;  ///< [W/(m^3 sr)]
};

/// @param emission, temperature the truth at the unknowns; without temperatures: empty
/// @param volumes of the unknowns @param absorption the truth; empty: not compared
EstimateErrors compare_estimate(const FlameEstimate& estimate, const std::vector<double>& emission,
                                const std::vector<double>& temperature,
                                const std::vector<double>& volumes,
                                const std::vector<double>& absorption = {});

}  // namespace plenoflame
