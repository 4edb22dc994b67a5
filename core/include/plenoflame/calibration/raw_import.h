#pragma once
#include <cstddef>
#include <string>
#include <vector>

#include "plenoflame/base/execution.h"
#include "plenoflame/calibration/count_frames.h"
#include "plenoflame/image/light_field.h"
#include "plenoflame/scene/scene.h"

namespace plenoflame {

/// From where the variance of a pixel comes.
enum class NoiseSource {
  sensor,  ///< gain and read noise
  series,  ///< a photon transfer curve through the scatter of all pixels of the series
  pixel,   ///< each pixel's own scatter: 10 frames or more
};

/// The unit of an imported picture.
enum class ImportUnit { counts, electrons, watts };

/// Pictures that correct the counts of a sensor. All pictures have the size of the raw picture.
struct RawCorrections {
  const CountFrames* dark = nullptr;  ///< exposed as long as the picture, without light
  /// Pixels evenly lit, without the camera's optics: evens out the pixels' own gains.
  const CountFrames* flat = nullptr;
  const CountFrames* flat_dark = nullptr;  ///< of it; nullptr: as `dark`
  /// A white scene through the camera: pixels become what the camera's model would have recorded.
  const CountFrames* white = nullptr;
  const CountFrames* white_dark = nullptr;
  std::vector<std::uint8_t> defects;  ///< not 0: the pixel says nothing; empty: none is known
};

/// Figures by which a sensor counts.
struct SensorResponse {
  double gain = 0;           ///< [electrons per count]
  double read_noise = 0;     ///< [electrons] RMS
  double black_level = 0;    ///< [counts] where there is no dark frame
  double dark_current = 0;   ///< [electrons/s] where there is no dark frame
  double exposure_time = 0;  ///< [s]; 0: not known
};

struct ImportSettings {
  ImportUnit unit = ImportUnit::electrons;
  NoiseSource noise = NoiseSource::sensor;
  SensorResponse response;
  PhotonTransfer transfer;  ///< noise `series`
  PixelWindow window;       ///< place of the picture on the sensor
  /// One for each channel of the picture in turn; for a mosaic red, green, blue.
  std::vector<std::string> names;
  std::vector<double> watts_per_count;  ///< the same [W]; for watts
  /// The same [1/counts]: a linear sensor would have given c (1 + curvature c) of c counts above
  /// dark. Empty: it is linear.
  std::vector<double> curvatures;
  MosaicPattern mosaic = MosaicPattern::none;
  Image model_white;  ///< white_image() of the camera's model, for RawCorrections::white
};

/// Counts of the pixels that were treated.
struct ImportSummary {
  std::size_t saturated = 0, defective = 0;
  std::size_t too_dark = 0;     ///< of the defective ones: darker in flat or white than they can be
  std::size_t negative = 0;     ///< pixels below 0 by more than 5 standard errors
  double largest = 0;           ///< [unit] of the good pixels
  double dark_level = 0;        ///< [counts] mean of the subtracted level
  double white_correction = 0;  ///< RMS of the factor that makes up for the white picture, from 1
};

/// Turns counts into a light field: channels with their standard errors and the layer
/// "sensor.state". The layer holds the PixelState of each pixel; reconstruct skips pixels that are
/// not good. Defective pixels hold the mean of their neighbours, for display only. For a mosaic,
/// every channel has a value at every pixel: the mean of its neighbours of that colour. The layer
/// "sensor.raw" then holds the recorded values.
/// @throws InputError: pictures that do not fit together or have the wrong content, missing gain or
///         exposure, too many defects
LightField import_counts(const CountFrames& raw, const RawCorrections& corrections,
                         const ImportSettings& settings, ImportSummary& summary);

/// Pixels of dark frames that are brighter than the others by more than noise: `limit` times the
/// scatter of the middle 68 % of the pixels.
std::vector<std::uint8_t> hot_pixels(const CountFrames& dark, double limit = 8);

}  // namespace plenoflame
