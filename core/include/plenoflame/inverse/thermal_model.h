#pragma once
#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "plenoflame/base/execution.h"
#include "plenoflame/inverse/camera_rays.h"
#include "plenoflame/inverse/csr_matrix.h"
#include "plenoflame/inverse/linear_operator.h"
#include "plenoflame/inverse/unknowns.h"
#include "plenoflame/radiometry/source_function.h"

/// Pictures as functions of temperature and absorption, and their derivatives: the renderer's own
/// discrete formulas, with the source function at the interpolated temperature
/// (docs/theory/reconstruction.md).
namespace plenoflame {

/// A part of the stop behind a filter, in the light of a channel.
struct ThermalPart {
  /// S(T) of what the filter passes, over the part's pupil_transmission(), which rays weigh.
  SourceFunction source;
  double absorption_ratio = 1;  ///< its absorption over that of its channel
};

/// The parts of a camera's stop, of PupilFilters::parts(); empty: it has no filters. Absorptions
/// are as those of soot, in inverse proportion to the wavelengths.
/// @throws InputError as camera_response
std::vector<ThermalPart> thermal_parts(const Scene& scene, std::size_t channel);

/// A channel of the pictures.
struct ThermalChannel {
  const CameraRays* rays = nullptr;
  SourceFunction source;        ///< S(T) [W/(m^2 sr)]
  double absorption_ratio = 1;  ///< its absorption over the one that is solved for
  /// thermal_parts() of each view; empty: no camera has filters.
  std::vector<std::vector<ThermalPart>> parts = {};
};

/// b = f(x) with the fluxes [W] of the channels' rows in b, one channel after the other. The vector
/// x holds the temperatures [K] of all unknowns, then the logarithms ln(kappa m) of the
/// absorptions. Known temperatures or absorptions are left out.
struct ThermalModel {
  std::vector<ThermalChannel> channels;
  const Unknowns* unknowns = nullptr;
  std::vector<double> temperature = {};  ///< [K] of each unknown, where known
  std::vector<double> absorption = {};   ///< [1/m] of each unknown, where known
  /// Unknowns that absorb; the others' absorption is 0 and their logarithm plays no part. Empty:
  /// all. Only where the absorption is solved for.
  std::vector<char> absorbs = {};

  std::size_t rows() const;
  std::size_t columns() const;  ///< entries of x
};

/// f(x). The same for any number of threads.
/// @throws UsageError where sizes do not fit @throws Cancelled
std::vector<double> thermal_fluxes(const ThermalModel& model, std::span<const double> x,
                                   const Execution& execution = {});

/// J at x without a matrix: rays are followed again each time. The model must outlive it.
std::unique_ptr<LinearOperator> make_thermal_derivative(const ThermalModel& model,
                                                        std::span<const double> x,
                                                        const Execution& execution = {});

/// J at x as a matrix in single precision. @throws Cancelled
CsrMatrix<float> make_thermal_matrix(const ThermalModel& model, std::span<const double> x,
                                     const Execution& execution = {});

/// Entries that such a matrix will have, from a sample of its rows.
std::size_t estimated_entries(const ThermalModel& model, std::span<const double> x);

}  // namespace plenoflame
