#pragma once
#include <string>
#include <vector>

#include "plenoflame/calibration/white_lattice.h"
#include "plenoflame/camera/microlens_lattice.h"
#include "plenoflame/scene/camera_spec.h"

namespace plenoflame {

/// The array of a camera from the places of its micro-images.
struct ArrayFit {
  ArraySpec array;                 ///< the nominal camera's with the fitted values
  int origin_i = 0, origin_j = 0;  ///< lattice point of lens (0, 0)
  /// True if lens (0, 0) is that of the nominal camera, by its offset. Otherwise it is a lens near
  /// the middle.
  bool same_origin = false;
  double rms = 0;    ///< [pixel] of measured centres from those of rays through this camera
  double worst = 0;  ///< [pixel]
  std::size_t used = 0;
  // Standard errors. They contain the noise of the centres and, as an order of magnitude, the
  // camera's deviation from the model. The pitch error also contains the systematic error of
  // centres.
  double pitch_error = 0;     ///< [m]
  double rotation_error = 0;  ///< [rad]
  Vec2 offset_error;          ///< [m]
  Vec2 tilt_error;            ///< [rad]
  bool tilted = false;        ///< the tilt was fitted
  /// Correlation of the measured blurs of the types with the camera's blurs. 0 if types cannot be
  /// distinguished.
  double type_match = 0;
};

/// Lens of a lattice point: the readout turns the sensor's picture by half a turn.
LensIndex lens_of(const ArrayFit& fit, int i, int j);

/// Fits pitch, rotation, offset and, with `tilt`, the tilt of the array. Rays through the middles
/// of microlenses and stop then arrive at the centres of the lattice's model. Main lens, focus and
/// distances are unchanged, because a white picture does not determine them.
/// @throws InputError: no array, another lattice, a sensor of another size than the picture
ArrayFit fit_array(const CameraSpec& nominal, const WhiteLattice& lattice, int width, int height,
                   bool tilt);

/// The keys of an array whose microlenses lie straight above their micro-images, as with a distant
/// exit pupil.
/// @param pixel [m] width and height
ArraySpec plain_array(const WhiteLattice& lattice, Vec2 pixel, int width, int height);

/// Half the width [pixel] of the edges of micro-images, for each type of a camera. It is the blur
/// of the stop's image on the sensor, r |1 - B/f + B/L| (thin lens; L is the distance of the exit
/// pupil).
std::vector<double> expected_blur(const CameraSpec& camera);

}  // namespace plenoflame
