#pragma once
#include <cstddef>
#include <string>
#include <vector>

#include "plenoflame/calibration/count_frames.h"
#include "plenoflame/calibration/radiometry_table.h"
#include "plenoflame/calibration/raw_import.h"
#include "plenoflame/image/image.h"
#include "plenoflame/scene/sensor_spec.h"

namespace plenoflame {

/// A picture of an evenly bright source that fills the evaluated part of the picture.
struct SourcePicture {
  const CountFrames* frames = nullptr;
  const CountFrames* dark = nullptr;  ///< of the same exposure; nullptr: `black_level`
  double black_level = 0;             ///< [counts]
  double exposure_time = 0;           ///< [s]
  double radiance = 0;  ///< [W/(m^2 sr)] of the channel; 0: not known, the same in all of these
  double radiance_error = 0;  ///< relative standard error, of this picture alone
};

/// The pixels that make a channel, and the light that the camera's model gives them.
struct EvaluatedPixels {
  Image etendue;       ///< [m^2 sr] white_image() of the camera
  PixelWindow window;  ///< place of the pictures on the sensor
  PixelWindow part;    ///< of the sensor that is evaluated
  MosaicPattern mosaic = MosaicPattern::none;
  int colour = 0;           ///< of the mosaic
  std::size_t channel = 0;  ///< of the pictures
  /// Flat field and white picture. They correct all pictures as import_counts() does, so that its
  /// watts have this scale.
  RawCorrections corrections;
  SensorResponse sensor;  ///< by which their noise is known
};

struct RadiometryFit {
  ChannelScale scale;
  std::size_t pixels = 0;
  /// For each picture its mean counts above dark, and by how much its scale differs from the fit,
  /// relative, and in standard errors.
  struct Residual {
    double counts = 0, relative = 0, errors = 0;
  };
  std::vector<Residual> sources, whites;
  double chi_squared =
      0;  ///< of pictures of known radiance, per degree of freedom; 0: none is left
};

/// Counts c above dark are modelled as E L t / J / (1 + k c) with the energy per count J and the
/// curvature k. J follows from the pictures of known radiance. k follows from pictures of one
/// unknown radiance at three or more exposures (`whites`). Without them, it follows from three or
/// more pictures of known radiance with sufficiently different counts; otherwise k is 0. Pixels
/// count if their etendue is at least 0.8 of the largest and no picture saturates them. With
/// corrections, flat field and white picture must be valid there.
/// @param common relative standard error that all pictures share: emissivity, the camera's etendue
/// @throws InputError: no such pixels, exposure missing, a picture no brighter than dark
RadiometryFit fit_radiometry(const std::vector<SourcePicture>& sources,
                             const std::vector<SourcePicture>& whites,
                             const EvaluatedPixels& pixels, double common);

}  // namespace plenoflame
