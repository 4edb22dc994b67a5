#pragma once
#include <string>
#include <vector>

#include "plenoflame/calibration/white_lattice.h"
#include "plenoflame/camera/microlens_lattice.h"
#include "plenoflame/scene/camera_spec.h"

namespace plenoflame {

/// The array of a camera from the places of its micro-images.
struct ArrayFit {
  ArraySpec array;                 ///< that of the nominal camera with what was found in its place
  int origin_i = 0, origin_j = 0;  ///< lattice point of lens (0, 0)
  /// The lens (0, 0) is that of the nominal camera, as far as its offset tells; otherwise one near
  /// the middle.
  bool same_origin = false;
  double rms = 0;    ///< [pixel] of measured centres from those of rays through this camera
  double worst = 0;  ///< [pixel]
  std::size_t used = 0;
  // Standard errors: of the centres' noise, and, to its order of magnitude, of how the camera
  // differs from the model that goes through them; of the pitch also from what centres are true to.
  double pitch_error = 0;     ///< [m]
  double rotation_error = 0;  ///< [rad]
  Vec2 offset_error;          ///< [m]
  Vec2 tilt_error;            ///< [rad]
  bool tilted = false;        ///< the tilt was fitted
  /// Correlation of the blur of the types with that of the camera's: 0 without
  /// types that can be told apart.
  double type_match = 0;
};

/// Lens of a lattice point: the readout turns the sensor's picture by half a turn.
LensIndex lens_of(const ArrayFit& fit, int i, int j);

/// Pitch, rotation, offset and, where `tilt` is wanted, tilt of the array, so that the rays through
/// the middles of microlenses and stop arrive at the centres of the lattice's model. Main lens,
/// focus and distances stay as they are: a white picture does not tell them.
/// @throws InputError: no array, another lattice, a sensor of another size than the picture
ArrayFit fit_array(const CameraSpec& nominal, const WhiteLattice& lattice, int width, int height,
                   bool tilt);

/// The keys of an array whose microlenses lie above their micro-images: of a main lens whose exit
/// pupil is far away. @param pixel [m] width and height
ArraySpec plain_array(const WhiteLattice& lattice, Vec2 pixel, int width, int height);

/// Half the width of the micro-images' edges [pixel] that each type of a camera has: how far the
/// stop's image is out of focus on the sensor, r |1 - B/f + B/L| (thin lens; L is the distance of
/// the exit pupil).
std::vector<double> expected_blur(const CameraSpec& camera);

}  // namespace plenoflame
