#pragma once
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "plenoflame/image/image.h"
#include "plenoflame/image/light_field.h"
#include "plenoflame/inverse/camera_rays.h"
#include "plenoflame/radiometry/source_function.h"
#include "plenoflame/scene/scene.h"

namespace plenoflame {

/// A picture as the right-hand side of a linear problem.
struct Measurement {
  PixelWindow window;
  Image flux;       ///< [W]
  Image deviation;  ///< [W] standard deviation; 0: the pixel says nothing and is left out
  /// [W] by which the model may err in each pixel. It is common to pixels side by side: it adds up
  /// over a block, while noise averages out.
  double model_error = 0;
  double electron = 0;  ///< [W] of one electron: the flux has shot noise; 0: none that is known
  double dark = 0;      ///< [W] of the subtracted dark signal, which has shot noise as well
  /// Relative standard error of all fluxes together: of a radiometric calibration (the picture's
  /// number "scale.error.CHANNEL").
  double scale_error = 0;
  std::size_t saturated = 0;  ///< pixels left out: their well was full
  std::size_t negative = 0;   ///< pixels below 0 by more than 5 standard deviations
};

/// False if a picture says that another camera has taken it: sensor, lens or array differ, or focus
/// and place do by more than 2 %. Less than that is the same camera, calibrated better.
bool may_be_taken_by(const LightField& picture, const Scene& scene);
/// True if a picture says that this very camera has taken it.
bool was_taken_by(const LightField& picture, const Scene& scene);

/// Takes a channel of a picture: fluxes [W] from render, or electrons from develop. The dark signal
/// of electrons is subtracted; its shot noise stays in the deviation. The deviation is that of the
/// picture (standard error, or shot and read noise); `noise` times the largest flux is the error of
/// the model.
/// @param channel number of the scene's channel @param what names the picture in messages
/// @throws InputError: the picture does not belong to the scene (sensor, camera, channel, unit)
/// @throws InputError: NaN or infinite values (names the pixel); no noise is known and `noise` is 0
Measurement take_measurement(const LightField& picture, const Scene& scene, std::size_t channel,
                             double noise, const std::string& what = "the picture");

/// Sums over the pixels of each row.
struct MeasuredRows {
  std::vector<double> flux;       ///< [W]
  std::vector<double> deviation;  ///< [W]; 0: one of the row's pixels is left out
  std::vector<double> electron;   ///< [W] of one electron; 0: shot noise is not known
  std::vector<double> counted;    ///< [W] flux whose shot noise is part of the deviation
};
/// @param measurements one for each view of the rays @param bin of their CameraRaySettings
MeasuredRows measured_rows(const std::vector<Measurement>& measurements, const CameraRays& rays,
                           int bin);

/// The source function of a channel behind the camera's filter.
SourceFunction channel_source(const Scene& scene, std::size_t channel);

/// dS/dT [W/(m^2 sr K)]; 0 at 0 K and below. @throws UsageError for one that shares a whole
double source_slope(const SourceFunction& source, double temperature);

/// The temperature at which a source function has a value, by bisection to rounding.
/// @return 0 for a value that is not above 0; @p highest for what no temperature below it has
double temperature_of(const SourceFunction& source, double value, double highest = 1e5);

}  // namespace plenoflame
