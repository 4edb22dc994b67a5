#pragma once
#include <cstddef>
#include <vector>

#include "plenoflame/base/execution.h"
#include "plenoflame/image/image.h"
#include "plenoflame/lightfield/micro_images.h"

namespace plenoflame {

/// The place of one picture on another: measured(x) = gain * simulated(x - shift) + rest.
struct PictureFit {
  std::size_t pixels = 0;
  double gain = 0, gain_error = 0;
  Vec2 shift;        ///< [pixel] right, down, of the measured against the simulated picture
  Vec2 shift_error;  ///< [pixel] standard errors, from what the fit leaves; infinite where nothing
                     ///< in the picture says
  double residual =
      0;  ///< root mean square of what the fit leaves over that of the simulated light
};

/// The same for one micro-image.
struct LensFit {
  LensIndex lens;
  int type = 0;
  Vec2 centre;  ///< [pixel] of the sensor, pixel (0, 0) has its centre at (0.5, 0.5)
  PictureFit fit;
};

struct Registration {
  PictureFit whole;             ///< one gain and shift for all pixels
  std::vector<LensFit> lenses;  ///< those that are lit, ordered by r, then q
  /// Median over microlenses of the length of their shift [pixel], weighted equally.
  double median_shift = 0;
};

/// Fits a measured to a simulated picture of the same window by least squares. The result is gain
/// and sub-pixel shift, for the whole window and for each micro-image. The simulated picture is
/// interpolated by cubics (Keys, IEEE Trans. ASSP 29 (1981), 1153).
/// @throws InputError where the sizes differ, or the simulated picture has no light; Cancelled
Registration register_pictures(const Image& measured, const Image& simulated,
                               const PixelWindow& window, const MicroImages& micro_images,
                               const Execution& execution = {});

/// The residual of the fit of the whole, measured - gain * simulated(x - shift), pixel by pixel.
Image registration_residual(const Image& measured, const Image& simulated, const PictureFit& fit);

}  // namespace plenoflame
